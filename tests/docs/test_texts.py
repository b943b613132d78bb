"""The texts tell the truth: every command and example in them runs, every number is generated."""

import ast
import importlib
import importlib.util
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from docs import generate
from tests import tolerances as tol
from tests.docs.test_coverage import nothing_wrong_with_command
from tests.documented_numbers import disagreements
from tests.unit.inputs import command
from tests.unit.studies import small_study
from thermobearing.studies.run.engine import run_study
from thermobearing.studies.store import Store

pytestmark = pytest.mark.drawn


LIBRARY = Path(str(resources.files("thermobearing") / "data"))
ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
FILES = sorted((DOCS / "files").glob("*.md"))
TEXTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md")), *FILES]
GUIDE = sorted((ROOT / "docs" / "guide").glob("*.md"))  # its blocks run in test_site.py
README = (ROOT / "README.md").read_text()
TWO_SCREENS = 100  # lines


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def commands(program: str) -> list[str]:
    """Lines of all bash blocks that start with the program, without their comments."""
    result = [block for path in TEXTS for block in blocks(path.read_text(), "bash")]
    lines = [line for block in result for line in block.splitlines()]
    return [line.split("#")[0].strip() for line in lines if line.startswith(program)]


def test_readme_examples_run_and_the_first_is_short(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    examples = blocks(README, "python")
    assert len([line for line in examples[0].splitlines() if line.strip()]) <= 6
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for example in examples:
        exec(compile(example, "README.md", "exec"), names)
    for figure in re.findall(r'savefig\("(\w+\.png)"\)', README):
        assert (tmp_path / figure).stat().st_size > 10_000, figure


def test_readme_is_short() -> None:
    assert README.count("\n") <= TWO_SCREENS


@pytest.mark.thorough
def test_examples_in_python_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One after the other, as in a notebook; the integrator is short and gives what it should."""
    examples = blocks((ROOT / "docs" / "python.md").read_text(), "python")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for example in examples:
        exec(compile(example, "python.md", "exec"), names)
    lines = [line for line in examples[0].splitlines() if line and not line.startswith("import")]
    assert len(lines) == 10
    halved = "\n".join(lines).replace("motion.dt", "0.5 * motion.dt")
    halved = halved.replace("in motion.acceleration", "in np.repeat(motion.acceleration, 2)")
    finer: dict[str, Any] = {"tb": names["tb"], "np": np}
    exec(compile(halved, "python.md, half the step", "exec"), finer)
    assert 50.0 < finer["peak"] < 300.0
    assert names["peak"] == pytest.approx(finer["peak"], rel=tol.SIMPLEST_INTEGRATOR)
    assert names["farthest"][0] == names["peak"]


def test_the_mass_of_the_python_page_is_that_of_its_integrator(tmp_path: Path) -> None:
    """A structure of one mass: Newmark and the simplest of all integrators move it as far."""
    (table,) = blocks((ROOT / "docs" / "python.md").read_text(), "toml")
    (tmp_path / "mass.toml").write_text(table)
    study = tb.bridge(
        "shen-hdr-bridge", "jra-ii-i-1", [-20], structure=str(tmp_path / "mass.toml"), duration=10
    )
    assert study.outcome == "completed"
    x = study["bearing_displacement"].values[0]
    bearing = tb.element("shen-hdr-bridge", ambient=-20)
    motion = tb.load_motion("jra-ii-i-1")
    at, speed, force, peak = 0.0, 0.0, 0.0, 0.0
    for acceleration in motion.acceleration[:1000]:
        speed -= (acceleration + force / 0.08) * motion.dt
        at += speed * motion.dt
        force = bearing.set_trial(at, motion.dt).force
        bearing.commit()
        peak = max(peak, abs(at))
    assert peak == pytest.approx(float(np.abs(x).max()), rel=tol.SIMPLEST_INTEGRATOR)


def test_readme_commands_can_be_given() -> None:
    for line in commands("thermobearing"):
        words = shlex.split(re.sub(r"\w+/history\.csv", "TEST.csv", line))  # what others wrote
        nothing_wrong_with_command(words[1:])


@pytest.mark.thorough
def test_readme_commands_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first as a separate program, the others in this process, which is quicker.

    Their figures are drawn by other tests, and would take half of the time.
    """
    first, *others = (shlex.split(text) for text in commands("thermobearing"))
    assert len(others) >= 2
    program = Path(sys.executable).parent / first[0]
    done = subprocess.run([program, *first[1:]], cwd=tmp_path, capture_output=True, check=False)
    assert done.returncode == 0, f"{first}: {done.stderr.decode()}"
    monkeypatch.chdir(tmp_path)
    for words in others:
        quicker = ["--no-figures"] if "-o" in words else []
        result = command(*words[1:], *quicker)
        assert result.exit_code == 0, f"{words}: {result.stderr}"


@pytest.mark.parametrize(
    ("now", "same"),
    [
        ("2.3e-04, 16.6 K of 22", True),
        ("2.4e-04, 16.7 K of 22", True),  # one unit of the last digit
        ("2.3e-04, 18.6 K of 22", False),
        ("2.3e-03, 16.6 K of 22", False),
        ("2.3e-04, 16.6 % of 22", False),
        ("2.3e-04, -16.6 K of 22", False),
    ],
)
def test_numbers_of_a_run_are_held_against_the_docs(now: str, same: bool) -> None:
    reported = [
        {"what": "rise", "value": "2.3e-04, 16.6 K of 22"},
        {"what": "x", "value": "3.1e-15"},
    ]
    run = [{"what": "rise", "value": now}, {"what": "x", "value": "8.9e-15"}]
    result = disagreements([*run, {"what": "new", "value": "1"}], reported)
    assert result == ([] if same else [f"rise: the docs say 2.3e-04, 16.6 K of 22, this run {now}"])


def test_make_targets_exist() -> None:
    for target in {*commands("make"), "make demo", "make test"}:
        done = subprocess.run(
            ["make", "--dry-run", *target.split()[1:]],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{target}: {done.stderr}"


def test_case_in_the_docs_is_valid(tmp_path: Path) -> None:
    from thermobearing.commands.check import check_file

    result = {}
    cases = [case for path in FILES for case in blocks(path.read_text(encoding="utf-8"), "toml")]
    for case in cases:
        path = tmp_path / "case.toml"
        path.write_text(case)
        (tmp_path / "mine.toml").write_text(
            (LIBRARY / "bearings" / "lrb-example.toml").read_text(encoding="utf-8"),
            encoding="utf-8",
        )
        (tmp_path / "record.csv").write_text("t_s,acc_gal\n0,0\n0.01,300\n0.02,-200\n0.03,0\n")
        result[check_file(path).kind] = path
    assert set(result) == {"case", "earthquake case", "sequence case", "structure", "study"}


def test_library_files_are_described(tmp_path: Path) -> None:
    from thermobearing.commands.check import check_file

    for folder, kind in (
        ("bearings", "bearing"),
        ("bilinear", "bilinear bearing"),
        ("compounds", "compound"),
        ("structures", "structure"),
    ):
        for path in (LIBRARY / folder).glob("*.toml"):
            assert check_file(path).kind == kind, path


def test_texts_are_the_generated_ones() -> None:
    for path, text in generate.generated_texts().items():
        assert path.read_text(encoding="utf-8") == text, f"{path.name}: make docs"


def test_every_measured_number_has_its_test() -> None:
    for row in generate.load(generate.MEASURED):
        path, name = row["test"].split("::")
        assert f"def {name}(" in (ROOT / path).read_text()


def test_links_between_texts_lead_somewhere() -> None:
    for path in [*TEXTS, *GUIDE]:
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text()):
            assert (path.parent / target).exists(), f"{path.name}: {target}"


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """Return what is in a node, but not expressions, of which there are many."""
    for inner in ast.iter_child_nodes(node):
        if not isinstance(inner, ast.expr):
            yield inner
            yield from _statements(inner)


def test_files_and_functions_stay_small() -> None:
    """Files have at most 700 lines and functions fewer than 60."""
    for path in [
        *ROOT.glob("src/**/*.py"),
        *ROOT.glob("reproduction/*.py"),
        *ROOT.glob("tests/**/*.py"),
        *ROOT.glob("benchmarks/*.py"),
        *ROOT.glob("docs/**/*.py"),
    ]:
        text = path.read_text()
        assert text.count("\n") <= 700, path
        for node in _statements(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                assert (node.end_lineno or 0) - node.lineno < 60 + _docstring(node), (
                    path,
                    node.name,
                )


def _docstring(node: "object") -> int:
    import ast

    assert isinstance(node, ast.FunctionDef)
    first = node.body[0]
    is_text = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
    return (first.end_lineno or 0) - first.lineno + 1 if is_text else 0


def test_lines_that_read_a_study_do(tmp_path: Path) -> None:
    factor = {"distribution": "uniform", "low": 0.9, "high": 1.1}
    study = small_study(**{"bearing.K_r": factor})
    study = study.model_copy(update={"design": study.design.model_copy(update={"samples": 1})})
    run_study(study, tmp_path / "DIR", jobs=1, size=3)
    text = (DOCS / "files" / "study.md").read_text(encoding="utf-8")
    result = {}
    for line in text.splitlines():
        name = line.split(".")[0]
        if name not in ("pandas", "polars", "duckdb", "pyarrow"):
            continue
        if importlib.util.find_spec(name) is None:
            continue
        module = importlib.import_module(name)
        if name == "pyarrow":
            importlib.import_module("pyarrow.parquet")
        result[name] = eval(line.replace("DIR", str(tmp_path / "DIR")), {name: module})
    table = Store(tmp_path / "DIR").table()
    for (bearing, air), mean in result["pandas"].items():
        rows = table[(table["bearing"] == bearing) & (table["ambient_degC"] == air)]
        np.testing.assert_allclose(mean, rows["pier_ductility"].mean(), rtol=tol.ROUNDING)
    assert len(result["pandas"]) == 4
    expected = {key: round(float(mean), 12) for key, mean in result["pandas"].items()}
    for name in set(result) & {"polars", "duckdb"}:
        rows = result[name].rows() if name == "polars" else result[name].fetchall()
        assert {(one, air): round(mean, 12) for one, air, mean in rows} == expected
    assert result["pyarrow"] == {b"unit": b"kN", b"meaning": b"largest force of one bearing"}
    # A bilinear bearing has no K_r: null, for those who tell that from NaN.
    stored = importlib.import_module("pyarrow.parquet").read_table(tmp_path / "DIR" / "shards")
    assert stored["bearing.K_r"].null_count == 4
    assert table["bearing.K_r"].isna().sum() == 4
