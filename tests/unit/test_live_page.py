"""The live page without a browser: what stands in it, what it refuses, how sizes scale."""

import base64
import gzip
import hashlib
import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import thermobearing as tb
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.scaling import EXPONENTS, resized
from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.library import data_path
from thermobearing.cli import app
from thermobearing.earthquake.measures import LARGEST_DAMPING_SHARE, damping_sentence
from thermobearing.live import page

ENGINE = "import { a } from './a.js';\nexport async function createEngine() { return 1; }\n"
DATA = {"bearings": {"b": {}}, "motions": {}}


@pytest.fixture
def html() -> str:
    return page.assemble(DATA, b"module", ENGINE, "b", "b.toml")


def within(html: str, name: str) -> str:
    result = re.search(rf'<script [^>]*id="{name}">(.*?)</script>', html, re.DOTALL)
    assert result is not None
    return result[1]


def test_the_policy_allows_only_this_script_and_this_style(html: str) -> None:
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', html)
    assert policy is not None
    allowed = policy[1]
    assert allowed.startswith("default-src 'none'")
    assert "unsafe-inline" not in allowed
    for tag in ('<script type="module">', "<style>"):
        text = html.split(tag)[1].split(tag.split()[0].replace("<", "</").rstrip(">") + ">")[0]
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"sha256-{digest}" in allowed.replace("&#43;", "+")


def test_the_modules_are_one_script(html: str) -> None:
    script = html.split('<script type="module">')[1]
    assert not re.search(r"^(import|export) ", script, re.MULTILINE)
    assert "const { createEngine } = (() =>" in script


def test_data_and_module_are_packed(html: str) -> None:
    packed = gzip.decompress(base64.b64decode(within(html, "engine-data")))
    assert json.loads(packed) == DATA
    assert gzip.decompress(base64.b64decode(within(html, "engine-module"))) == b"module"


def test_ranges_are_those_of_check(html: str) -> None:
    fields = json.loads(within(html, "page-data"))["fields"]
    assert (fields["strain"]["low"], fields["strain"]["high"]) == (1e-6, 5)
    assert fields["count"]["integer"]
    assert (fields["ambient"]["low"], fields["ambient"]["high"]) == (-100, 100)
    with pytest.raises(InputError) as refused:
        tb.cyclic_test(strain=9, frequency=1)
    assert fields["strain"]["allowed"] in str(refused.value)


def test_every_text_has_both_languages_and_a_use() -> None:
    words = tomllib.loads(data_path("live", "words.toml").read_text(encoding="utf-8"))
    labels, outcomes = words.pop("labels"), words.pop("outcomes")
    used = "".join(data_path("live", name).read_text("utf-8") for name in ("app.js", "page.html"))
    for key, texts in (words | labels).items():
        assert set(texts) == {"en", "ja"}
        braces = [set(re.findall(r"\{(\w+)\}", texts[each])) for each in ("en", "ja")]
        assert braces[0] == braces[1], key
    made = ("what_", "view_")  # names put together in the script
    unused = [key for key in words if not key.startswith(made) and key not in used]
    assert unused == []
    asked = set(re.findall(r'\bt\("(\w+)"', used)) | set(re.findall(r'data-word="(\w+)"', used))
    assert asked <= set(words)
    assert outcomes


@pytest.mark.parametrize("name", ["shen-lhdr-specimen", "lrb-example", "shen-hdr-bridge"])
def test_powers_of_sizes_are_the_scaling_rules(name: str) -> None:
    before = tb.load_bearing(name)
    geometry = before.geometry.model_copy(update={"rubber_layers": 9, "rubber_thickness": 11.0})
    core = None if before.lead is None else 1.3 * before.lead.diameter
    after = resized(before, geometry, core)

    def _sizes(bearing: Bearing) -> dict[str, float]:
        result = {
            "net_area": bearing.area - bearing.lead_area,
            "layer": bearing.geometry.rubber_thickness,
            "height": bearing.total_rubber_thickness,
        }
        return result | ({"core_area": bearing.lead.core_area} if bearing.lead else {})

    old, new = _sizes(before), _sizes(after)
    for path, powers in EXPONENTS.items():
        table, key = path.split(".")
        if getattr(before, table) is None:
            continue
        factor = 1.0
        for size, power in powers.items():
            factor *= (new[size] / old[size]) ** power
        result = getattr(getattr(after, table), key)
        assert result == pytest.approx(factor * getattr(getattr(before, table), key))


def test_without_kernels_the_command_says_what_to_run(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("thermobearing.live.data.FOLDER", tmp_path)
    file = tmp_path / "page.html"
    done = CliRunner().invoke(app, ["live", "-o", str(file)])
    assert done.exit_code == 2
    assert "make kernels" in done.output
    assert not file.exists()


def test_a_page_opens_inside_the_calibration_range() -> None:
    ranges = calibration_ranges(tb.load_bearing(page.START))
    assert ranges is not None
    low, high = ranges["strain_rate"]
    assert low < 2.0 * np.pi * page.OPENING["frequency"] * page.OPENING["strain"] < high
    assert page.OPENING["strain"] < ranges["strain"][1]


def test_a_page_links_to_the_documents_where_it_has_their_address() -> None:
    link = page.assemble(DATA, b"module", ENGINE, "b", "b.toml", documents="../index.html")
    assert '<a href="../index.html"' in link
    assert 'data-word="documents"' not in page.assemble(DATA, b"module", ENGINE, "b", "b.toml")


def test_help_names_the_bearing_that_a_page_opens_with() -> None:
    done = CliRunner().invoke(app, ["live", "--help"])
    assert f"{page.START} by" in " ".join(done.output.split())


def test_a_page_replaces_no_file_unless_asked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(page, "page_html", lambda _, documents: f"page{documents}")
    file = tmp_path / "page.html"
    done = CliRunner().invoke(app, ["live", "shen-hdr-specimen", "-o", str(file), "--json"])
    assert done.exit_code == 0
    assert json.loads(done.output.splitlines()[-1])["bytes"] == 4
    with pytest.raises(OutputError, match=r"page\.html"):
        tb.live_page(file)
    assert tb.live_page(file, overwrite=True) == file
    words = ["live", "-o", str(file), "--overwrite", "--documents", "../index.html"]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert file.read_text() == "page../index.html"


def test_viscous_damping_has_the_words_of_bridge() -> None:
    """The page fills the sentence that `bridge` prints, from the same limit."""
    words = tomllib.loads(data_path("live", "words.toml").read_text(encoding="utf-8"))
    values = {"least": "25", "n": "1", "all": "2", "v": "43"}
    shown = words["damping_note"]["en"].format_map(values).replace(" %", "%").removesuffix(".")
    printed = damping_sentence(np.array([0.43, 0.21]), "modal").replace(" (modal)", "")
    assert printed.lower().startswith(shown.lower())
    assert f"{LARGEST_DAMPING_SHARE:.0%}" == "25%"
