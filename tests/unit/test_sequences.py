"""A sequence as data and as files: what is refused, what is written, what is read back."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.unit.inputs import command
from thermobearing.cyclic.case import load_rig, make_case
from thermobearing.earthquake.case import load_earthquake_case, make_earthquake_case
from thermobearing.earthquake.run import run_earthquake
from thermobearing.sequences.case import load_sequence_case, make_sequence_case
from thermobearing.sequences.result import SequenceResult

CYCLE = {"step": "cycles", "strain": 0.5, "speed": "60 mm/s", "count": 1}
BACK = {"step": "ramp", "to": "0 mm", "speed": "10 mm/s"}
CYCLIC = {"part": "cyclic", "name": "CL: 1st", "dt": "20 ms", "steps": [CYCLE]}
HYBRID = {"part": "hybrid", "duration": "1 s"}
REST = {"part": "rest", "duration": "10 min", "ambient": "-10 degC"}
TABLE = {"name": "short", "ambient": "-20 degC", "parts": [CYCLIC, REST, HYBRID]}
RIG = {"force": "30 kN", "stroke": "200 mm"}


STEPS = {"steps": [BACK | {"to": "9 mm"}]}
AS_LEFT = {"between": "as-left"}
BAD: dict[str, tuple[dict[str, Any], str]] = {
    "another bearing": (
        {"parts": [CYCLIC, CYCLIC | {"bearing": "shen-lhdr-specimen"}]},
        "parts[1].bearing = 'shen-lhdr-specimen'",
    ),
    "bearings of a hybrid test": (
        {"parts": [HYBRID | {"bearings": ["shen-hdr-bridge"]}]},
        "parts[0].bearings",
    ),
    "unknown key": ({"parts": [CYCLIC | {"stepps": []}]}, "parts[0].stepps"),
    "unknown key at the top": ({"ambiant": "3 degC"}, '"ambient"'),
    "unknown part": ({"parts": [{"part": "hybird"}]}, '"hybrid"'),
    "no part": ({"parts": [{"duration": "1 s"}]}, '"parts[0].part"'),
    "nothing": ({"parts": []}, "at least 1"),
    "no unit": ({"parts": [REST | {"duration": 3}]}, "parts[0].duration"),
    "rest twice": ({"parts": [REST | {"within": "1 K"}]}, "exactly one of duration, within"),
    "no ramp after hybrid": ({"parts": [HYBRID, REST, CYCLIC]} | AS_LEFT, "parts[2]"),
    "no way between": ({"between": "zero"}, "as-left"),
    "not at zero": ({"parts": [CYCLIC | STEPS, CYCLIC]} | AS_LEFT, "parts[1].steps[0]"),
    "motion": ({"parts": [HYBRID | {"motion": "jra-i-i-9"}]}, "parts[0].motion"),
    "structure": ({"parts": [HYBRID | {"structure": "hybrid-peer"}]}, "hybrid-pier"),
    "bearing": ({"bearing": "shen-hdr-specimn"}, "shen-hdr-specimen"),
    "bilinear": ({"bearing": "shen-bilinear-bridge"}, "bearing"),
    "lead model": ({"analysis": {"model": "lead-alone"}}, "needs a bearing with lead"),
    "rig without unit": ({"rig": {"force": 400}}, "rig.force = 400"),
    "rig of no limit": ({"rig": {"name": "x"}}, "at least"),
    "rig of another name": ({"rig": "shen-rigg"}, "shen-rig"),
    "rig of no force": ({"rig": {"force": "-3 kN"}}, "rig.force"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_sequences_get_one_message(name: str) -> None:
    table, output = BAD[name]
    with pytest.raises(tb.InputError) as caught:
        make_sequence_case(TABLE | table, "case.toml")
    assert output in str(caught.value)
    assert str(caught.value).count("one specimen") <= 1


@pytest.fixture(scope="module")
def result() -> SequenceResult:
    return tb.sequence(TABLE | {"rig": RIG})


def test_parts_follow_each_other(result: SequenceResult) -> None:
    table = result.table
    assert list(table["part"]) == ["01-CL-1st", "02-rest", "03-hybrid"]
    assert list(table["ambient_degC"]) == [-20.0, -10.0, -20.0]
    ends, starts = table["rubber3_end_degC"][:-1], table["rubber3_start_degC"][1:]
    np.testing.assert_allclose(ends, starts, atol=0.2)  # unloading takes seconds
    # The rig unloads the specimen after each part and zeroes its instruments.
    np.testing.assert_allclose(table["displacement_start_mm"], 0.0, atol=1e-6)
    np.testing.assert_allclose(table["force_start_kN"], 0.0, atol=1e-5)
    assert table["rubber3_end_degC"][1] > table["rubber3_start_degC"][1]  # the air is warmer


def test_what_passes_the_rig_is_said_and_goes_on(result: SequenceResult) -> None:
    assert result.outcome == "completed"
    assert any("limit of the rig is 30 kN" in text for text in result.warnings)
    assert not any("mm" in text for text in result.warnings)  # the stroke is enough
    rows = result.rig
    assert set(rows["limit"]) == {"force", "stroke"}
    passed = rows[rows["part"] == "01-CL-1st"].set_index("limit")["outside"]
    assert dict(passed) == {"force": True, "stroke": False}
    assert result.summary()["rig"] == rows.to_dict("records")
    assert result.table["beyond_rig"][0] == "force"
    assert result.table["beyond_rig"][2] in ("", "force")


def test_files_are_whole_and_read_back(result: SequenceResult, tmp_path: Path) -> None:
    out = result.save(tmp_path / "out", figures=False)
    files = {"case.resolved.toml", "rig.csv", "summary.json", "table.csv", "tested_range.csv"}
    assert {path.name for path in out.iterdir()} == files | {"parts"}
    assert json.loads((out / "summary.json").read_text())["outcome"] == "completed"
    again = tb.load_result(out)
    assert isinstance(again, SequenceResult)
    assert again.table.equals(result.table)
    assert again.summary() == result.summary()
    with pytest.raises(tb.OutputError, match="--overwrite"):
        result.save(out, figures=False)
    case = load_sequence_case(out / "case.resolved.toml")
    assert case.to_toml() == result.case.to_toml()
    assert tb.sequence(case).table.equals(result.table)


@pytest.mark.thorough
def test_each_part_runs_again_by_itself(result: SequenceResult, tmp_path: Path) -> None:
    out = result.save(tmp_path / "out", figures=False)
    place = out / "parts" / "03-hybrid" / "case.resolved.toml"
    alone = run_earthquake(load_earthquake_case(place))
    assert np.array_equal(alone["bearing_force"], result[2].dataset["bearing_force"])


def test_a_part_that_ends_early_is_the_last() -> None:
    hot = CYCLIC | {"steps": [CYCLE | {"strain": 2.5, "speed": "1 m/s", "count": 80}]}
    actual = tb.sequence(TABLE | {"bearing": "shen-lhdr-specimen", "parts": [hot, REST]})
    assert actual.outcome == "lead_melted"
    assert len(actual.parts) == 1
    assert actual.sentence


def test_a_specimen_is_unloaded_after_rests() -> None:
    """The force is zero elsewhere in a fast motion than in the slow one that finds the place."""
    parts: list[dict[str, Any]] = [
        {"part": "hybrid", "duration": "0.1 s", "dt": "0.02 s", "motion": "jra-ii-i-1"},
        {"part": "rest", "within": "20 K"},
        {"part": "rest", "within": "20 K"},
    ]
    given = {"bearing": "shen-hdr-specimen", "ambient": "23 degC", "parts": parts}
    actual = tb.sequence(make_sequence_case(given, "sequence"))
    assert actual.outcome == "completed"
    for part in actual.parts[1:]:
        assert abs(float(part["force"].values.ravel()[0])) < 1e-6


def test_a_rig_in_a_test_and_in_a_study() -> None:
    """The limits of the source, of Table 3.2; the speed of a slow test is that of the specimen."""
    rig = load_rig("shen-rig")
    assert (rig.force, rig.stroke, rig.speed) == (400.0, 200.0, 630.0)
    table = {"rig": "shen-rig", "ambient": ["-20 degC"], "bearing": "shen-lhdr-specimen"}
    test = tb.cyclic_test([2.5], cycles=1, wave="sine", dt=0.02)
    cold = tb.run_case(make_case(table, "case", test=test))
    assert any("limit of shen-rig is 400 kN" in text for text in cold.summary()["warnings"])
    rows = cold.rig.set_index("limit")
    assert rows.loc["force", "demand"] == np.abs(cold["force"]).max()
    assert abs(rows.loc["speed", "demand"] / (30.0 * np.pi / 2.0) - 1.0) < 1e-3
    assert cold.outcome == "completed"
    lab = {"mode": "pd", "speed": "10 mm/s"}
    study = {"command": "hybrid", "rig": {"speed": "9 mm/s"}, "laboratory": lab}
    case = make_earthquake_case(study, "case", ambient=[23.0], duration=1.0)
    reported = run_earthquake(case)
    assert [row["limit"] for row in reported.summary()["rig"]] == ["speed", "speed"]
    assert reported.rig["outside"].all()
    assert list(reported.table["beyond_rig"]) == ["speed", "speed"]
    assert any("limit of the rig is 9 mm/s" in text for text in reported.warnings)


def test_a_rig_by_name_in_python_and_on_the_command_line(tmp_path: Path) -> None:
    """A small one, which every command is too much for; the built-in ones are listed."""
    (tmp_path / "small.toml").write_text('name = "small"\nforce = "1 kN"\n')
    small = tmp_path / "small.toml"
    test = tb.cyclic_test(strain=[0.5], cycles=1, rest=None)
    reported = tb.run("shen-hdr-specimen", test, rig=small).summary()["warnings"]
    assert any("limit of small is 1 kN" in text for text in reported)
    quick = ["--rig", small, "--no-figures", "--ambient", "0", "--bearing", "shen-hdr-specimen"]
    for name, more in (("cyclic", ["--dt", "1"]), ("hybrid", ["--duration", "1"])):
        done = command(name, *quick, *more, "-o", tmp_path / name)
        assert done.exit_code == 0, done.output
        (row,) = pd.read_csv(tmp_path / name / "rig.csv").to_dict("records")
        assert (row["limit"], row["largest"], row["outside"]) == ("force", 1.0, True)
    wrong = command("cyclic", "--rig", "shen-rigg", "-o", tmp_path / "wrong")
    assert wrong.exit_code == 2
    assert 'did you mean "shen-rig"' in wrong.stderr
    listed = command("list", "--json")
    assert json.loads(listed.stdout.splitlines()[-1])["rigs"] == ["shen-rig"]
    assert "Biaxial rig" in listed.stdout
