"""A result is repeated by its resolved case: every option of a command is a key of it."""

import json
import re
import shlex
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from tests.unit.test_help import COMMANDS
from thermobearing.cli import app
from thermobearing.cyclic.case import Analysis, Case
from thermobearing.earthquake.case import EarthquakeAnalysis, EarthquakeCase, Laboratory
from thermobearing.model.options import ModelOptions

# Options that no case states, and why they change neither results nor documents but by their form.
OF_FORM = {
    "case": "the case itself",
    "output": "where the result is written",
    "overwrite": "where the result is written",
    "quiet": "what the screen shows",
    "as_json": "what the screen shows",
    "table": "what the screen shows",
    "no_figures": "which files are written",
    "figure_format": "look of the figures",
    "figure_width": "look of the figures",
    "no_titles": "look of the figures",
    "report": "which files are written",
    "workbook": "which files are written",
    "template": "order of the report",
    "no_live": "which files are written",
    "title": "title block, which report.toml of the result holds",
}
# Options whose values are under another key of the resolved case.
OTHER_KEYS = {
    "model_option": list(ModelOptions.model_fields),
    "laboratory": list(Laboratory.model_fields),
    "law": ["bearings"],  # each with the key of its law; the stated command has the option
    "across": ["motions"],
    "angle": ["motions"],
    "resample": ["motions"],
    "fixed_base": ["structure"],
    "components": ["components", "compare_components"],
    "complete": ["histories"],
}
# Of a test in a few words, in the table `test`.
OF_TEST = ("strain", "cycles", "wave", "path", "ratio", "speed", "frequency", "period", "rest")
KEYS = {
    "bridge": {*EarthquakeCase.model_fields, *EarthquakeAnalysis.model_fields},
    "hybrid": {
        *EarthquakeCase.model_fields,
        *EarthquakeAnalysis.model_fields,
        *Laboratory.model_fields,
    },
    "cyclic": {*Case.model_fields, *Analysis.model_fields, *OF_TEST, "dt"},
}


@pytest.mark.parametrize("command", KEYS)
def test_every_option_is_a_key_of_the_case_or_changes_no_result(command: str) -> None:
    names = {parameter.name for parameter in COMMANDS[command,].params} - {"help"}
    places = KEYS[command] | ({"bearings"} if command == "cyclic" else set())
    unstated = {
        name for name in names - set(OF_FORM) if not set(OTHER_KEYS.get(name, [name])) <= places
    }
    assert not unstated
    assert names >= {"report", "exposure", "compare"}


def test_the_command_of_factors_is_stated_with_all_its_options(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A result of `lambda` has no case: its summary states the command that was typed."""
    words = ["lambda", "shen-hdr-bridge", "--strain", "1", "--temperature", "0", "--cycles", "3"]
    words += ["--no-figures", "-o", str(tmp_path / "out")]
    monkeypatch.setattr("sys.argv", ["thermobearing", *words])
    _run(*words)
    stated = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["command_line"]
    assert shlex.split(stated) == ["thermobearing", *words]


def _flat(table: Mapping[str, Any]) -> set[str]:
    return set(table) | set(table.get("analysis", {}))


CHECKED = {"--codes": "aashto", "--rotation": "0.005", "--zone": "2"}
SHORT = "--bearing shen-hdr-bridge --motion jra-ii-i-1 --ambient 23 --duration 1 --no-figures -q"


def _run(*words: str | Path) -> None:
    done = CliRunner().invoke(app, list(map(str, words)))
    assert done.exit_code == 0, done.output


def test_the_stated_command_repeats_checks_bands_and_comparison(tmp_path: Path) -> None:
    options = [word for pair in CHECKED.items() for word in pair]
    force = ["--axial-force", "800", "--bands", "--compare"]
    first, again = tmp_path / "first", tmp_path / "again"
    _run("bridge", *SHORT.split(), *options, *force, "-o", first)
    _run("bridge", first / "case.resolved.toml", "--no-figures", "-q", "-o", again)
    table = tomllib.loads((again / "case.resolved.toml").read_text("utf-8"))
    assert (table["codes"], table["rotation"], table["zone"]) == (["aashto"], "0.005 rad", 2)
    assert {"bands", "compare"} <= _flat(table)
    for name in ("case.resolved.toml", "summary.json", "comparison.csv", "bands.csv"):
        assert (first / name).read_bytes() == (again / name).read_bytes()


def test_codes_of_an_earlier_check_are_checked_again_with_the_rotation() -> None:
    result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23, duration=2, axial_force=800)
    first = tb.check_bearings(result, ["aashto"])
    both = tb.check_bearings(first, ["jra"], rotation=0.01, zone=1)
    rows = {
        name: table.bearing_checks.query("code != ''").set_index(["code", "what"])
        for name, table in (("first", first), ("both", both))
    }
    strain = ("AASHTO GSID (2014)", "total shear strain")
    assert rows["both"].loc[strain, "value"] > rows["first"].loc[strain, "value"] + 0.01
    assert "default" in rows["first"].loc[strain, "source"]
    assert "0.01 rad" in rows["both"].loc[strain, "source"]
    assert "default" not in rows["both"].loc[strain, "source"]
    zoned = [what for _, what in rows["both"].index if "1.2 times" in what]
    assert zoned == ["1.2 times the vertical load at twice the displacement"]
    summary = both.summary()
    assert (summary["codes"], summary["rotation"], summary["zone"]) == (
        ["aashto", "jra"],
        "0.01 rad",
        1,
    )


@pytest.mark.usefixtures("no_other_laws")
def test_a_law_of_the_user_is_an_option_of_the_stated_command(
    law_file: Path, tmp_path: Path
) -> None:
    """The case holds its name and digest: without the file the command is refused."""
    out = tmp_path / "out"
    _run("bridge", *SHORT.split(), "--law", law_file, "--report", "-o", out)
    case = out / "case.resolved.toml"
    (stated,) = re.findall("Command: (.+)", (out / "links.txt").read_text("utf-8"))
    assert shlex.split(stated)[:4] == ["thermobearing", "bridge", case.name, "--law"]
    assert CliRunner().invoke(app, ["bridge", str(case), "-o", f"{out}-2"]).exit_code == 2
    _run("bridge", case, "--law", law_file, "--no-figures", "-q", "-o", f"{out}-3")
    assert (Path(f"{out}-3") / case.name).read_bytes() == case.read_bytes()


@pytest.mark.parametrize("key", ["rotation", "zone"])
def test_what_only_checks_count_on_needs_codes(key: str, tmp_path: Path) -> None:
    words = ["bridge", f"--{key}", "1" if key == "zone" else "0.1", "-o", str(tmp_path / "out")]
    done = CliRunner().invoke(app, words)
    assert (done.exit_code, (tmp_path / "out").exists()) == (2, False)
    assert f"--{key}: needs codes" in done.output
