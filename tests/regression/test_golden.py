"""Everything that the commands write stays what it was, unless somebody says why it changes.

`python -m tests.regression.regenerate` prints what differs; with a reason it is accepted.
"""

from pathlib import Path

import pytest

from tests import tolerances as tol
from tests.regression import regenerate
from tests.regression.cases import CASES, case_results, case_tolerance
from tests.regression.comparison import GOLDEN, differences, stored
from tests.regression.regenerate import REASONS, main
from tests.unit.inputs import command
from thermobearing import laws
from thermobearing.commands.check import check_file

SHOWN = 20
# Commands whose files are inputs again, and the kind of the whole case among them.
READ_AGAIN = {"cyclic-steps": "case", "sequence": "sequence case", "design": "design case"}
READ_AGAIN |= dict.fromkeys(["bridge-weather", "hybrid-slow"], "earthquake case")
READ_AGAIN |= {"identify-robust": ""}
# Commands have another case that is quick; the walk of a posterior has separate tests.
LONG = ("cyclic-published", "cyclic-dissipation", "cyclic-lead-ends", "cyclic-single-temperature")
LONG += ("cyclic-natural-rubber", "cyclic-recorded", "cyclic-coarse", "bridge-plan", "hybrid-slow")
LONG += ("identify", "identify-posterior", "design-lines", "lambda-speed")
LONG += ("lambda-lead", "python-restart", "bridge-lines")


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, marks=pytest.mark.thorough if case in LONG else ()) for case in CASES],
)
def test_golden(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(laws, "_REGISTERED", {})  # without those of other tests
    result = differences(stored(case), case_results(case, tmp_path), case_tolerance(case))
    reported = "\n".join(result[:SHOWN])
    assert not result, f"{len(result)} lines differ from golden/{case}:\n{reported}"
    if case in READ_AGAIN:
        assert_inputs_again(tmp_path / case, READ_AGAIN[case])


def assert_inputs_again(folder: Path, whole: str) -> None:
    """Check the files that a command wrote as inputs of other commands."""
    written = sorted(folder.rglob("*.toml"))
    assert all(check_file(path).kind for path in written)
    assert not whole or check_file(folder / "case.resolved.toml").kind == whole
    if whole == "design case":
        assert {check_file(path).kind for path in (folder / "bearings").iterdir()} == {
            "bearing",
            "bilinear bearing",
        }
    assert command("check", written[0], "--json").exit_code == 0


def test_every_golden_file_belongs_to_a_case_and_has_a_reason() -> None:
    assert {path.name for path in GOLDEN.iterdir()} == {*CASES, REASONS.name}
    assert all(stored(case) for case in CASES)
    output = REASONS.read_text()
    assert [case for case in CASES if f"{case} (" not in output] == []


LINE = '"h_eq": 0.123456789, "steps": 12, "name": "inner 3"'


@pytest.mark.parametrize(
    ("other", "seen"),
    [
        (LINE, False),
        (LINE.replace("0.123456789", "0.12345679"), False),  # the last digit
        (LINE.replace("0.123456789", "0.1234569"), True),
        (LINE.replace("0.123456789", "0.1235"), True),  # digits are lost
        (LINE.replace("0.123456789", "null"), True),
        (LINE.replace("0.123456789", "-0.123456789"), True),
        (LINE.replace("12,", "13,"), True),  # a count
        (LINE.replace("h_eq", "h_e"), True),
        (LINE.replace("inner 3", "inner 4"), True),
        ('"steps": 12, "h_eq": 0.123456789, "name": "inner 3"', True),  # order
    ],
)
def test_comparison_sees(other: str, seen: bool) -> None:
    assert bool(differences({"a.json": LINE}, {"a.json": other}, tol.GOLDEN)) is seen


def test_comparison_sees_files_and_lines_that_come_and_go() -> None:
    old = {"a.csv": "x\n1.0\n"}
    assert differences(old, {}, tol.GOLDEN) == ["a.csv: is gone"]
    assert differences(old, old | {"b.csv": ""}, tol.GOLDEN) == ["b.csv: is new"]
    assert differences(old, {"a.csv": "x\n1.0\n2.0\n"}, tol.GOLDEN) == ["a.csv:3: None -> '2.0'"]


def test_regenerating_needs_a_reason(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    import tests.regression.regenerate as script

    monkeypatch.setattr(script, "stored", lambda case: {"screen.txt": "old\n"})
    monkeypatch.setattr(script, "write", lambda case, texts: pytest.fail("written"))
    monkeypatch.setattr("sys.argv", ["regenerate", "", "refused"])
    with pytest.raises(SystemExit, match="give a reason"):
        main()
    assert "refused: 3 lines differ" in capsys.readouterr().out


def test_help_of_the_regeneration_writes_nothing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(regenerate, "compute", lambda case: pytest.fail("computed"))
    for given, status, reported in (("--help", 0, "usage: "), ("--froce", 2, "unrecognized")):
        monkeypatch.setattr("sys.argv", ["regenerate", given])
        with pytest.raises(SystemExit) as ended:
            regenerate.main()
        assert ended.value.code == status
        assert reported in "".join(capsys.readouterr())
    assert regenerate.words(["why", "lambda"]) == ("why", ["lambda"])
    assert regenerate.words([]) == ("", [])
