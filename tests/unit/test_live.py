"""Data and module of the live page; what it computes is in verification/test_live_engine.py."""

import hashlib
import json
from pathlib import Path
from typing import Any

import pytest

import thermobearing as tb
from thermobearing.bearing.library import load_bearing
from thermobearing.core.compiled.sources import sources_digest
from thermobearing.live import data
from thermobearing.model.options import build_model


def put_module(folder: Path, sources: str, content: bytes = b"module", **library: Any) -> None:
    (folder / data.MODULE).write_bytes(content)
    wasm = {"file": data.MODULE, "sha256": hashlib.sha256(b"module").hexdigest()}
    known = {"sources": sources, "libraries": {"wasm32": wasm}}
    (folder / data.DESCRIPTION).write_text(json.dumps(known), encoding="utf-8")


@pytest.mark.parametrize(
    ("sources", "content", "says"),
    [
        ("", b"", "make kernels"),
        ("other", b"module", "other sources"),
        (sources_digest(), b"changed", "not what was built"),
    ],
)
def test_a_module_that_does_not_fit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sources: str, content: bytes, says: str
) -> None:
    monkeypatch.setattr(data, "FOLDER", tmp_path)
    if sources:
        put_module(tmp_path, sources, content)
    with pytest.raises(tb.InputError, match=says):
        data.live_module()


def test_a_module_of_these_sources_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(data, "FOLDER", tmp_path)
    put_module(tmp_path, sources_digest())
    assert data.live_module() == b"module"


def test_fields_have_the_limits_of_files() -> None:
    result = data._fields([load_bearing("lrb-example"), load_bearing("shen-lhdr-specimen")])
    layers, side = result["geometry.rubber_layers"], result["geometry.plan.side"]
    assert (layers["low"], layers["high"], layers["integer"], layers["unit"]) == (
        1,
        200,
        True,
        None,
    )
    assert (side["low"], side["high"], side["unit"]) == (1.0, 1e5, "mm")
    assert result["hysteresis.shape"]["low"] == -0.999
    assert set(result) >= {"geometry.plan.diameter", "lead.yield_stress", "rate.damping"}


def test_numbers_of_a_bearing_are_those_of_its_file() -> None:
    bearing = load_bearing("shen-lhdr-specimen")
    known = data._bearing(bearing, build_model(bearing))
    assert json.dumps(known, allow_nan=False)
    assert known["values"]["lead.cores"] == bearing.lead.cores  # type: ignore[union-attr]
    assert len(known["stack"]["part"]) == known["constants"]["cells"]["capacity"]["shape"][0]
    assert known["lead_ends"] == "finite-plate"


def test_a_page_has_the_rate_branch_that_acts() -> None:
    plain, half = (
        tb.changed_bearing("shen-lhdr-bridge", rate_band={"factor": factor}) for factor in (1, 0.5)
    )
    assert data._values(half)["rate.damping"] == 0.5 * data._values(plain)["rate.damping"]
    assert "rate.damping" not in data._values(load_bearing("shen-hdr-bridge"))
    borrowed = tb.changed_bearing("shen-hdr-bridge", rate_band={"factor": 1.0})
    assert data._values(borrowed)["rate.damping"] > 0.0
