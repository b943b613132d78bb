"""Axial forces in earthquakes: case 9 of the specification, random inputs, steps, turned plans."""

import math

import numpy as np
import pytest

from tests.shared_data import shared_data
from tests.verification.lead_rubber import LeadRubber, make_line, shake
from tests.verification.test_vertical import _run
from thermobearing.core.records import Floats
from thermobearing.earthquake.axial import with_axial_outcome
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.outcomes import AXIAL_SENTENCES
from thermobearing.structure import run

PARTS = 5  # steps of the integration in one of the record
GAL = 10.0  # mm/s2
WIDE = LeadRubber(900, 180, 20, 10, 4, 0.4e-3, 10e-3)
WIDE_COLD = LeadRubber(900, 180, 20, 10, 4, 0.76e-3, 14e-3)
SLENDER = LeadRubber(600, 120, 20, 10, 3, 0.4e-3, 10e-3)
SLENDER_COLD = LeadRubber(600, 120, 20, 10, 3, 0.76e-3, 14e-3)
SMALL = LeadRubber(540, 100, 6, 17, 6.4, 0.9e-3, 12e-3)
STABLE = {  # bearing, pressure [GPa], factor, peaks without and with axial forces [mm, kN]
    "wide": (WIDE, 6e-3, 0.7, (281.29, 598.05), (279.15, 558.13)),
    "wide, cold": (WIDE_COLD, 6e-3, 0.7, (286.78, 1021.81), (286.08, 993.10)),
    "wide, strong": (WIDE, 6e-3, 1.0, (393.64, 735.28), (393.63, 642.33)),
    "slender, cold": (SLENDER_COLD, 10e-3, 0.5, (203.44, 368.17), (196.99, 273.48)),
    "small": (SMALL, 3.4e-3, 1.0, (460.04, 992.01), (511.23, 795.06)),
}
UNSTABLE = {
    "warm": (SLENDER, 10e-3, 0.5),
    "warm, strong": (SLENDER, 10e-3, 1.0),
    "cold, strong": (SLENDER_COLD, 10e-3, 1.0),
}


def record() -> tuple[Floats, float]:
    """Ground acceleration [mm/s2] of the cases, and the step [s]."""
    path = shared_data("motions/II-II-1_like_TAK000.csv")
    time, acceleration = np.loadtxt(path, delimiter=",", skiprows=1).T
    dt = float(time[1] - time[0]) / PARTS
    fine = dt * np.arange(round(time[-1] / dt) + 1)
    return GAL * np.interp(fine, time, acceleration), dt


def peaks(history: run.StructureHistory) -> tuple[float, float]:
    """Largest displacement [mm] and force [kN] of one bearing."""
    response = history.bearing()
    return float(np.abs(response["displacement"]).max()), float(np.abs(response["force"]).max())


@pytest.mark.parametrize("name", list(STABLE))
def test_one_bearing_in_an_earthquake(name: str) -> None:
    """The mass moves vertically too, since the stiffness there falls with the displacement."""
    bearing, pressure, factor, plain, axial = STABLE[name]
    ground, dt = record()
    load = pressure * bearing.area
    assert peaks(shake(bearing, load, factor * ground, dt, acts=False)) == pytest.approx(
        plain, rel=2e-5
    )
    history = shake(bearing, load, factor * ground, dt, upwards=np.zeros_like(ground))
    # 0.4 %: the displacement of the small bearing is 513.1 mm, in LeadRubberX 512.9.
    assert peaks(history) == pytest.approx(axial, rel=3e-3 if name != "small" else 4e-3)
    assert history.axial is not None
    assert history.axial.peaks[0].share < 0.9
    assert with_axial_outcome(history.outcome, history.axial) == "completed"


@pytest.mark.parametrize("name", list(UNSTABLE))
def test_one_bearing_that_is_unstable(name: str) -> None:
    bearing, pressure, factor = UNSTABLE[name]
    ground, dt = record()
    upwards = np.zeros_like(ground)
    history = shake(bearing, pressure * bearing.area, factor * ground, dt, upwards=upwards)
    assert history.axial is not None
    assert with_axial_outcome("completed", history.axial) == "unstable"
    assert history.axial.peaks[0].share > (1.2 if name == "warm" else 1.9)


def test_steps() -> None:
    """Peaks with steps of 4 ms, a sixteenth of the vertical period, over those with 0.6 ms."""
    coarse, fine = (_run("vertical", dt=dt) for dt in (0.004, 0.0006))
    assert peaks(coarse)[0] == pytest.approx(peaks(fine)[0], rel=3e-3)
    spread = np.ptp(fine.axial.force)
    for name in ("largest", "least"):
        off = np.abs(coarse.axial.supports[name] - fine.axial.supports[name]).max()
        assert off < 0.015 * spread


def random_run(seed: int) -> run.StructureHistory:
    """A line with random places, dead loads, joint and motion, for two seconds."""
    random = np.random.default_rng([44, seed])
    count = int(random.integers(1, 7))
    diameter = float(random.uniform(300.0, 900.0))
    bearing = LeadRubber(
        diameter,
        core=0.2 * diameter,
        layers=int(random.integers(5, 30)),
        thickness=float(random.uniform(5.0, 17.0)),
        shim=float(random.uniform(2.0, 6.0)),
        modulus=float(random.uniform(0.3e-3, 1.5e-3)),
        yield_stress=float(random.uniform(5e-3, 15e-3)),
    )
    time, dt = 0.005 * np.arange(401), 0.005
    strong, upwards = (
        sum(
            random.normal(0.0, 1.0) * np.sin(2.0 * math.pi * random.uniform(0.3, limit) * time)
            for _ in range(5)
        )
        for limit in (3.0, 15.0)
    )
    return make_line(
        bearing,
        10.0 ** random.uniform(-3.0, -1.8) * bearing.area * random.uniform(0.2, 1.0, count),
        float(10.0 ** random.uniform(2.0, 3.7)) * strong,
        dt,
        upwards=float(10.0 ** random.uniform(1.0, 4.0)) * upwards,
        damping_ratio=float(random.uniform(0.0, 0.1)),
        places=random.uniform(-6000.0, 6000.0, count),
        height=float(random.uniform(100.0, 5000.0)),
        dowelled=bool(random.integers(0, 2)),
        dowel_length=float(random.choice([0.0, 10.0])),
    )


KNOWN = {"completed", "not_physical", "no_equilibrium", "diverged", *AXIAL_SENTENCES}


@pytest.mark.thorough
def test_random_lines() -> None:
    """No NaN, balances of energy, an outcome for each of 500 runs."""
    outcomes = []
    for seed in range(500):
        history = random_run(seed)
        axial, energies = history.axial, history.rows.energies
        assert axial is not None
        outcome = with_axial_outcome(history.outcome, axial)
        outcomes.append(outcome)
        assert outcome in KNOWN, (seed, outcome)
        for values in (axial.force, axial.limit, axial.peaks, axial.supports, axial.energies):
            for name in values.dtype.names or [...]:
                assert np.isfinite(values[name]).all(), (seed, name)
        # Of the energy that moves: a line that has buckled takes and gives it many times.
        stored = energies["kinetic"] + energies["bearings"] + energies["damping"]
        scale = max(np.abs(energies[name]).max() for name in ("input", "kinetic", "bearings"))
        assert np.abs(energies["input"] - stored).max() <= 1e-9 * scale, seed
        work = axial.energies[0]
        parts = [work.weight, work.overturning, work.vertical_input]
        taken = [work.axial_work, work.vertical_damping, work.vertical_kinetic]
        scale = max(map(abs, parts + taken))
        assert abs(sum(parts) - sum(taken)) <= 1e-9 * scale, seed
    counts = {name: outcomes.count(name) for name in dict.fromkeys(outcomes)}
    assert {"completed", "unstable", "cavitated", "uplift"} <= set(counts), counts


TABLE = {
    "dead_load": "1500 kN",
    "places": ["-3 m", "-1 m", "1 m", "3 m"],
    "deck_height": "1.8 m",
}


def _on_ground(*, plan: bool, angle: str, level: str = "vertical"):
    """A deck of 600 t on four bearings, moved along the bridge or, in plan, at an angle."""
    structure = {
        "name": "deck",
        "plan": plan,
        "bodies": [{"name": "deck", "moves": True, "base_height": "0 m"}],
        "masses": [{"body": "deck", "height": "0 m", "mass": "600 t"}],
        "bearings": [
            {
                "name": "line",
                "body": "deck",
                "height": "0 m",
                "count": 4,
                "equivalent_stiffness": "1.5 kN/mm",
                "axial": TABLE if plan else TABLE | {"across": True},
            }
        ],
        "damping": {"kind": "none"},
        "report": {"deck": "deck"},
    }
    motion = {"name": "jra-ii-i-1", "vertical": "jra-ii-i-2", "factor": 0.7}
    return run_earthquake(
        make_earthquake_case(
            {
                "bearings": ["lrb-example"],
                "ambient": ["0 degC"],
                "structure": structure,
                "motions": [motion | ({"angle": angle} if plan else {})],
                "duration": "9 s",
                "analysis": {"axial": level, "keep_every": 1},
            },
            "case.toml",
        )
    )


def test_a_plan_turned_by_a_right_angle() -> None:
    """Across the bridge in plan, the numbers are those of a transverse structure in one line."""
    line = _on_ground(plan=False, angle="")
    plan = _on_ground(plan=True, angle="90 deg")
    assert np.nanmax(line["axial_force"].values) > 1800.0
    for name in ("axial_force", "critical_load", "cavitation_force"):
        assert plan[name].values == pytest.approx(line[name].values, rel=1e-6, nan_ok=True)
    across = plan["bearing_displacement"].values[0, :, 1]
    assert across == pytest.approx(line["bearing_displacement"].values[0], abs=1e-4)


def test_a_turned_motion_turns_the_answer() -> None:
    """Of round bearings under constant axial forces, which have no direction."""
    straight, turned = (
        _on_ground(plan=True, angle=angle, level="dead")["bearing_displacement"].values[0]
        for angle in ("0 deg", "30 deg")
    )
    along = straight[:, 0]
    directions = np.array([math.cos(math.pi / 6.0), math.sin(math.pi / 6.0)])
    off = np.abs(turned[:, :2] - along[:, np.newaxis] * directions).max()
    assert off < 1e-6 * np.abs(along).max()  # kept with seven digits
