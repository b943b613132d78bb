"""Small runs of every command whose numbers are kept in golden/, and how they are carried out."""

import contextlib
import json
import os
import shutil
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from unittest.mock import patch

from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from tests.regression.comparison import collect_texts
from thermobearing.cli import app
from thermobearing.commands.common import COMPILING

INPUTS = Path(__file__).with_name("inputs")
BEARINGS = resources.files("thermobearing") / "data" / "bearings"
HDR, LHDR, LRB = "shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example"
BRIDGE, LEAD_BRIDGE = "shen-hdr-bridge", "shen-lhdr-bridge"
Make = Callable[[Path], None]  # writes a result directory

# Command lines; one that writes gets "-o" and the name of the case besides.
PRINTED = {
    "list": "list --json",
    "check-bearing": "check mine.toml --json",
    "check-case": "check steps.toml",
    "check-study": "check weather.toml",
    "measure": "measure cold.csv --bearing shen-hdr-specimen --json",
    "motions-list": "motions list --json",
    "refused": "cyclic --bearing shen-hdr-specimn --json",
}
WRITTEN = {
    "cyclic-conservative": f"cyclic cycles.toml --bearing {HDR} --ambient -20 --ambient 23",
    "cyclic-published": f"cyclic cycles.toml --bearing {HDR} --model-option scheme=published "
    "--model-option integrator=euler --dt 0.005",
    "cyclic-dissipation": f"cyclic cycles.toml --bearing {BRIDGE} "
    "--model-option heat_source=dissipation "
    "--ambient 0",
    "cyclic-lead": f"cyclic cycles.toml --bearing {LHDR} --ambient -20 --ambient 0",
    "cyclic-lead-published": f"cyclic cycles.toml --bearing {LHDR} --model-option scheme=published",
    "cyclic-lead-ends": f"cyclic cycles.toml --bearing {LEAD_BRIDGE} "
    "--model-option lead_ends=half-space",
    "cyclic-natural-rubber": f"cyclic cycles.toml --bearing {LRB} --ambient 20",
    "cyclic-single-temperature": f"cyclic cycles.toml --bearing {LHDR} --ambient -20 "
    "--model single-temperature",
    "cyclic-compare": f"cyclic cycles.toml --bearing {LHDR} --ambient -20 --compare",
    "cyclic-steps": "cyclic steps.toml",
    "cyclic-recorded": "cyclic recorded.toml",
    "cyclic-coarse": "cyclic coarse.toml",
    "cyclic-ended-early": "cyclic coarse.toml --model-option scheme=published "
    "--model-option integrator=euler",
    "cyclic-restart": "cyclic restart.toml",
    "bridge": f"bridge --bearing shen-bilinear-bridge --bearing {BRIDGE} --bearing {LEAD_BRIDGE} "
    "--motion shake.csv --ambient -20 --ambient 23",
    "bridge-natural-rubber": f"bridge --bearing {LRB} --motion shake.csv --ambient -20 "
    "--method linear-acceleration --mass published --duration 3",
    "bridge-predictor": f"bridge --bearing {BRIDGE} --motion jra-ii-i-1 --ambient -20 "
    "--method predictor-corrector --damping source --duration 6",
    "bridge-weather": "bridge weather.toml",
    "hybrid": f"hybrid --bearing {LHDR} --motion shake.csv --ambient 0 --laboratory delay=0.013",
    "hybrid-slow": "hybrid laboratory.toml",
    "sequence": "sequence sequence.toml",
    "bridge-lines": "bridge lines.toml",
    "bridge-plan": f"bridge --structure five-span-bridge --bearing {LEAD_BRIDGE} "
    "--motion jra-ii-i-1 --across jra-ii-i-2 --angle 30deg --ambient -20 --duration 3 "
    "--components 1 --components 2",
    "structures-show": "structures show pier-p1 --fixed-base",
    "motions-show": "motions show station.NS --baseline",
    "motions-spectrum": "motions spectrum shake.csv --kind II --ground II --damping 0.1",
    "motions-make": "motions make --seed 7 --kind II --ground II --zone-factor 0.85 --dt 0.02",
    "identify-check": "identify cold.toml warm.toml --check",
    "identify": "identify cold.toml warm.toml --free K_r,d_y,n_T --starts 1 --predict -30",
    "identify-robust": "identify warm.toml --free K_r,d_y --starts 2 --temperatures --loss huber",
    "identify-posterior": "identify cold.toml --free K_r,d_y --starts 1 --loss cauchy --posterior",
    "design": "design design.toml",
    "design-lines": "design design-lines.toml",
    "bounds": f"bounds --bearing {BRIDGE} --motion jra-ii-i-1 --ambient 23 --ambient -20",
    "lambda": f"lambda {BRIDGE} {HDR} --temperature -20 --temperature 40 --strain 1 --scale",
    "lambda-lead": f"lambda {LEAD_BRIDGE} --temperature -20 --strain 1",
    "lambda-speed": f"lambda {LRB} --reference 20 --temperature -20 --strain 1 --speed 300 "
    "--cycles 2,3",
}


def _python_restart(target: Path) -> None:
    """From one of several runs of a result: the one at the same ambient temperature."""
    sine = {"step": "cycles", "strain": 2.0, "wave": "sine", "period": 2.0, "count": 2}
    test = tb.CyclicTest(dt=0.02, steps=[sine])
    first = tb.run(LHDR, test, [-20.0, 5.0, 23.0])
    tb.run(LHDR, test, 5.0, initial=first, keep=tb.Keep(every=1000)).save(target, figures=False)


def _python_full_stack(target: Path) -> None:
    test = tb.cyclic_test(strain=[1.0, 2.5], cycles=2, rest=600.0, dt=0.02)
    options = tb.ModelOptions(heat_source="dissipation", stack="full")
    result = tb.run(HDR, test, -20.0, model=options, keep=tb.Keep(every=1000))
    result.save(target, figures=False)


# Cases whose complete input is kept too; in the others it would repeat bearing and structure.
RESOLVED = {"cyclic-steps", "cyclic-restart", "bridge-weather", "hybrid-slow", "design"}
PYTHON: dict[str, Make] = {
    "python-restart": _python_restart,
    "python-full-stack": _python_full_stack,
}
CASES = [*PRINTED, *WRITTEN, *PYTHON]


def carry_out(name: str, folder: Path) -> tuple[str, Path | None]:
    """Run a case in a folder; what it printed, and its result directory if it writes one."""
    shutil.copytree(INPUTS, folder, dirs_exist_ok=True)
    shutil.copy(str(BEARINGS / f"{LRB}.toml"), folder / "mine.toml")
    with contextlib.chdir(folder):
        if name in PYTHON:
            PYTHON[name](folder / name)
            return "", folder / name
        if name == "cyclic-restart":
            _invoke("cyclic first.toml -o first --no-figures")
        if name in PRINTED:
            return _invoke(PRINTED[name]), None
        return _invoke(f"{WRITTEN[name]} -o {name} --no-figures"), folder / name


def case_tolerance(name: str) -> float:
    return tol.GOLDEN_FITTED if name.startswith("identify") else tol.GOLDEN


def case_results(name: str, folder: Path) -> dict[str, str]:
    result = collect_texts(*carry_out(name, folder))
    # Parts of a sequence are results of commands that have separate cases.
    result = {k: v for k, v in result.items() if not k.startswith("parts/")}
    if "summary.json" in result:  # bearing and structure, which other files have
        reported = json.loads(result["summary.json"])
        reported.pop("inputs", None)
        result["summary.json"] = json.dumps(reported, indent=0, ensure_ascii=False) + "\n"
    return {k: v for k, v in result.items() if k != "case.resolved.toml" or name in RESOLVED}


def _invoke(words: str) -> str:
    with patch("thermobearing.commands.common.PROGRESS_LINES_PRINTED", False):
        done = CliRunner().invoke(app, words.split(), env={"COLUMNS": "500", "NO_COLOR": "1"})
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    output = done.output.replace(f"{COMPILING}\n", "")  # in the first run of a new machine code
    return f"{output}exit status {done.exit_code}\n".replace(os.getcwd(), "<here>")
