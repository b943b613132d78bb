"""The clock of lead on a half-space: who chooses it, and where a choice would do nothing."""

import tomllib
from typing import Any

import numpy as np
import pytest
import tomli_w
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import thermobearing as tb
from thermobearing.bearing.model import Bearing
from thermobearing.cli import app
from thermobearing.cyclic.case import make_case
from thermobearing.model.constants import with_parameters
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.sequences.case import make_sequence_case

LHDR = tb.load_bearing("shen-lhdr-specimen")
SHORT = tb.cyclic_test(strain=[0.5], cycles=1)
PART = {"part": "cyclic", "steps": [{"step": "ramp", "to": "5 mm", "speed": "5 mm/s"}]}
FORMULA = {"lead_ends": "half-space"}


def says(clock: Any) -> Bearing:
    assert LHDR.lead is not None
    return LHDR.model_copy(update={"lead": LHDR.lead.model_copy(update={"clock": clock})})


def core_rate(medium: str) -> float:
    """Diffusivity over r_l^2 [1/s], Eq. 5.6."""
    assert LHDR.materials.lead is not None
    material = LHDR.materials.steel if medium == "steel" else LHDR.materials.lead
    return material.conductivity / 1e3 / material.volumetric_heat / 17.25**2


@pytest.mark.parametrize(
    ("own", "options", "expected"),
    [
        (None, {"scheme": "published"}, "lead"),
        (None, FORMULA, "steel"),
        (None, {"model": "lead-alone"}, "steel"),
        ("steel", {"scheme": "published"}, "steel"),
        ("lead", FORMULA, "lead"),
        ("lead", {"scheme": "published", "clock": "steel"}, "steel"),
        ("steel", {**FORMULA, "clock": "lead"}, "lead"),
        (None, {"model": "lead-alone", "clock": "lead"}, "lead"),
    ],
)
def test_the_option_goes_before_the_bearing_and_that_before_the_scheme(
    own: Any, options: dict[str, Any], expected: str
) -> None:
    bearing = says(own)
    model = build_model(bearing, ModelOptions(**options))
    assert model.options.clock == expected
    assert_allclose(model.constants.lead.clock_rate, core_rate(expected))
    # A fit changes rubber, lead and rate numbers, not the clock.
    again = with_parameters(model.constants, bearing, model.stack)
    assert again.lead.clock_rate == model.constants.lead.clock_rate


def test_it_reaches_the_lead_and_the_resolved_case() -> None:
    """A clock of lead runs faster than that of steel: less heat leaves, the lead is warmer."""
    warm = {}
    for clock in (None, "lead", "steel"):
        result = tb.run(
            "shen-lhdr-specimen", SHORT, 0.0, model=tb.ModelOptions(scheme="published", clock=clock)
        )
        warm[clock] = np.nanmax(result["lead_temperature"].values)
        case = make_case({}, "table", bearing="shen-lhdr-specimen", scheme="published", clock=clock)
        table = tomllib.loads(case.to_toml())
        assert table["analysis"]["clock"] == (clock or "lead")
        assert make_case(table, "again").to_toml() == case.to_toml()
    assert warm[None] == warm["lead"] > warm["steel"] + 0.1


NOTHING = [
    ("shen-lhdr-specimen", {}, ["finite-plate", "half-space", "published", "omit it"]),
    ("shen-lhdr-specimen", {"model": "temperature-blind"}, ["finite-plate"]),
    ("shen-lhdr-specimen", {"model": "adiabatic"}, ['model "adiabatic" has no clock']),
    ("shen-lhdr-specimen", {"model": "single-temperature"}, ["has no clock; omit it"]),
    ("shen-hdr-specimen", {"scheme": "published"}, ["needs a bearing with lead", "has none"]),
]


@pytest.mark.parametrize(("bearing", "options", "words"), NOTHING)
def test_a_clock_that_does_nothing_is_refused(
    bearing: str, options: dict[str, Any], words: list[str]
) -> None:
    asked = {**options, "clock": "lead"}
    model = ModelOptions(**asked)
    ways = [
        lambda: tb.run(bearing, SHORT, 0.0, model=model),
        lambda: tb.BearingElement(bearing, model=model),
        lambda: make_sequence_case(
            {"bearing": bearing, "ambient": "0 degC", "parts": [PART], "analysis": asked}, "table"
        ),
    ]
    if bearing == "shen-lhdr-specimen":  # a study has bearings with and without lead
        ways.append(lambda: tb.hybrid(bearing, ambient=0, duration=1, model=model))
        ways.append(lambda: tb.bridge(bearing, "jra-ii-i-1", 0, duration=1, model=model))
    for way in ways:
        with pytest.raises(tb.InputError) as reported:
            way()
        for word in ['clock = "lead"', *words]:
            assert word in str(reported.value)


def test_it_passes_by_bearings_without_lead() -> None:
    both = ["shen-hdr-specimen", "shen-lhdr-specimen"]
    options: dict[str, Any] = {"ambient": 0, "duration": 3}
    lead, steel = (
        tb.hybrid(both, model=tb.ModelOptions(scheme="published", clock=clock), **options)
        for clock in ("lead", "steel")
    )
    hottest = [float(np.nanmax(study["lead_temperature"].values)) for study in (lead, steel)]
    assert hottest[0] > hottest[1]


def test_on_the_command_line(tmp_path: Any) -> None:
    case = tmp_path / "case.toml"
    steps = [{"step": "cycles", "strain": 0.5, "speed": "30 mm/s", "count": 1}]
    case.write_text(tomli_w.dumps({"ambient": ["0 degC"], "test": {"name": "a", "steps": steps}}))
    words = ["cyclic", str(case), "--bearing", "shen-lhdr-specimen", "--model-option", "clock=lead"]
    where = ["-o", str(tmp_path / "out"), "--no-figures", "--quiet"]
    refused = CliRunner().invoke(app, [*words, *where], env={"COLUMNS": "200"})
    assert refused.exit_code == 2
    assert not (tmp_path / "out").exists()
    done = CliRunner().invoke(app, [*words, "--model-option", "lead_ends=half-space", *where])
    assert done.exit_code == 0
    assert 'clock = "lead"' in (tmp_path / "out" / "case.resolved.toml").read_text()
