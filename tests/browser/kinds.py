"""A small result directory of every kind that a document is made of."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import thermobearing as tb
from tests.unit.inputs import command
from thermobearing.bearing.model import Validity
from thermobearing.cyclic.case import make_case
from thermobearing.cyclic.comparison import compare_models
from thermobearing.cyclic.run import run_case
from thermobearing.design.case import make_design_case
from thermobearing.design.run import run_bounds, run_design, run_factors
from thermobearing.identify.records.checks import save_checks
from thermobearing.motions.library import load_motion
from thermobearing.motions.run import examine_motion
from thermobearing.results.drawing import save_figures
from thermobearing.sequences.case import make_sequence_case
from thermobearing.sequences.run import run_sequence

SPECIMEN = "shen-hdr-specimen"
BACK = {"step": "ramp", "to": "0 mm", "speed": "10 mm/s"}
CYCLE = {"step": "cycles", "strain": 3.0, "speed": "60 mm/s", "count": 1}
PARTS = [
    {"part": "hybrid", "name": "first", "duration": "2 s", "motion": "jra-ii-ii-1"},
    {"part": "cyclic", "name": "loading", "dt": "20 ms", "steps": [BACK, CYCLE]},
    {"part": "rest", "name": "pause", "duration": "10 min"},
]


@cache
def record() -> tb.TestRecord:
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, closing_strain=None, dt=0.02)
    return replace(tb.synthetic_record(SPECIMEN, -20.0, test), name="cold")


def cyclic(folder: Path) -> Path:
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, dt=0.02)
    case = make_case({"bearing": "shen-lhdr-specimen"}, "case", test=test, ambient=[-20.0, 23.0])
    result = run_case(case)
    result.compared = compare_models(case)
    return result.save(folder, figures=False)


def bridge(folder: Path) -> Path:
    """Two temperatures, into the strong part; those through the height are kept."""
    air, keep = [23.0, -20.0], ["rubber", "cells"]
    result = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", air, duration=9.0, keep=keep)
    return result.save(folder, figures=False)


def hybrid(folder: Path) -> Path:
    result = tb.hybrid("shen-lhdr-specimen", ambient=-20.0, duration=2.0)
    return result.save(folder, figures=False)


def sequence(folder: Path) -> Path:
    table = {"name": "short", "bearing": "shen-lhdr-specimen", "ambient": "-20 degC"}
    case = make_sequence_case(table | {"parts": PARTS}, "case.toml", rig="shen-rig")
    return run_sequence(case).save(folder, figures=False)


def identify(folder: Path) -> Path:
    result = tb.identify_bearing(record(), SPECIMEN, free=["K_r", "d_y"], starts=1)
    saved = result.save(folder, figures=False)
    save_figures({"loops": result.plot.loops}, saved / "figures", vector=True)
    return saved


def checked(folder: Path) -> Path:
    return save_checks([tb.check_test(record())], folder, figures=False)


def validate(folder: Path) -> Path:
    bearing = tb.load_bearing(SPECIMEN)
    soft = bearing.hysteresis.model_copy(update={"layer_stiffness": 20.0})
    tested = Validity(ambient=[0.0, 30.0])
    changed = bearing.model_copy(update={"hysteresis": soft, "tested_range": tested})
    result = tb.validate_bearing(changed, record())
    saved = result.save(folder, figures=False)
    save_figures({"loops": result.plot.loops}, saved / "figures", vector=True)
    return saved


def design(folder: Path) -> Path:
    case = make_design_case({"tolerance": 0.1}, "example", motions=["jra-ii-i-1"])
    return run_design(case).save(folder, figures=False)


def factors(folder: Path) -> Path:
    result = run_factors(["shen-hdr-bridge"], temperatures=[-20.0, 40.0], strains=[1.0])
    return result.save(folder, figures=False)


def bounds(folder: Path) -> Path:
    result = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0], duration=8)
    return result.save(folder, figures=False)


def motion(folder: Path) -> Path:
    return examine_motion(load_motion("jra-ii-i-1")).save(folder, figures=False)


def structure(folder: Path) -> Path:
    """A structure before it is shaken: with no text specific to it for a document."""
    assert command("structures", "show", "pier-p1", "-o", folder, "-q").exit_code == 0
    return folder


KINDS: Mapping[str, Callable[[Path], Path]] = {
    "cyclic": cyclic,
    "bridge": bridge,
    "hybrid": hybrid,
    "sequence": sequence,
    "identify": identify,
    "identify --check": checked,
    "validate": validate,
    "design": design,
    "lambda": factors,
    "bounds": bounds,
    "motions show": motion,
    "structures show": structure,
}
