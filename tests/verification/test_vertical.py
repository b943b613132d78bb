"""Axial forces of a line in time: the cases 7 and 8 of the specification (shared/spec/axial.md)."""

import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

import thermobearing as tb
from tests.verification.test_axial import BEARING_L, CLOSED, LEAD, layer_sums
from thermobearing.bearing.model import CircularPlan
from thermobearing.core.records import rows
from thermobearing.earthquake.axial import _pressed_lines, with_axial_outcome
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.axial import build_column
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure import run, vertical
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.types import (
    NO_SECTIONS,
    LineFactors,
    Section,
    SectionEnergies,
    SectionPeak,
    Support,
    System,
)
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.prepare import Preparer

PLACES = np.array([-4500.0, -1500.0, 1500.0, 4500.0])
DEAD, STIFFNESS = 1500.0, 1393.391
GRAVITY = 9810.0  # of the case [mm/s2]
LINEAR = 1e6  # GPa: modulus at which nothing cavitates


def _system(joint):
    """Four bearings L under a rigid section with 1500 kN on each."""
    column = build_column(BEARING_L, LEAD)
    compression, shear, softest = layer_sums(column[0], [0.45e-3], [22])
    sections, supports = rows(Section, 1), rows(Support, 4)
    section = sections[0]
    section.first, section.last, section.moves, section.dowelled = 0, 4, 1, int(joint == "dowelled")
    section.scale, section.weight, section.span = 1.0, 4.0 * DEAD, (PLACES**2).sum()
    section.compression, section.shear, section.overlap = compression, shear, 1.0
    section.softest = LINEAR if joint == "linear" else softest
    vertical.set_law.py_func(section, column[0])
    section.shortening = DEAD / STIFFNESS
    for i, place in enumerate(PLACES):
        supports[i].place, supports[i].axial_force, supports[i].memory = place, DEAD, 1.0
        supports[i].shortening = section.shortening
    filled = {
        "number": np.zeros(1, dtype=np.int64),
        "columns": column,
        "sections": sections,
        "energies": rows(SectionEnergies, 1),
        "peaks": rows(SectionPeak, 1),
        "supports": supports,
    }
    nothing = [None] * 7
    return System(*nothing, rows(LineFactors, 1), NO_SECTIONS._replace(**filled))


FORCES = {
    "linear": ((-300, 900, 2100, 3300), (-900, 700, 2300, 3900)),
    "bolted": ((-300, 900, 2100, 3300), (-501.45, 168.60, 2167.15, 4165.70)),
    "dowelled": ((0, 500, 2000, 3500), (0, 0, 1000, 5000)),
}
MOTION = {
    "linear": (1.076511, 3.827594e-4),
    "bolted": (0.838156, 4.781015e-4),
    "dowelled": (-0.717674, 9.568985e-4),
}


@pytest.mark.parametrize("joint", list(FORCES))
def test_section(joint):
    system = _system(joint)
    forces = []
    for moment in (9e6, 18e6, 24e6):
        assert vertical.commit_section.py_func(system, 0, moment, 0.0, 1.0)
        forces.append(system.sections.supports["axial_force"].copy())
    assert forces[0] == pytest.approx([600, 1200, 1800, 2400], rel=CLOSED)
    for computed, expected in zip(forces[1:], FORCES[joint], strict=True):
        assert computed == pytest.approx(expected, abs=6e-3)
    section = system.sections.sections[0]
    assert (section.shortening, section.roll) == pytest.approx(MOTION[joint], rel=2e-6)
    assert system.sections.energies[0].iterations <= 3 + 2 * (joint != "linear") + 2


def test_a_specimen_at_a_scale_has_the_law_of_the_bearing():
    """Half of all lengths, at scale 0.5: stiffness, cavitation and critical load are the same."""
    laws = []
    for scale in (1.0, 0.5):
        geometry = BEARING_L.model_copy(
            update={
                "plan": CircularPlan(shape="circular", diameter=700 * scale),
                "rubber_thickness": 8.0 * scale,
                "shim_thickness": 3.2 * scale,
            }
        )
        lead = LEAD.model_copy(update={"diameter": 140 * scale})
        column, section = build_column(geometry, lead)[0], rows(Section, 1)[0]
        section.compression, section.shear, section.softest = layer_sums(column, [0.45e-3], [22])
        section.scale, section.x, section.overlap = scale, 200.0 * scale, 1.0
        vertical.set_law.py_func(section, column)
        limit = vertical.critical_load_at.py_func(section, column, section.x, 0.0)
        laws.append((section.stiffness, section.strength, limit))
    assert laws[1] == pytest.approx(laws[0], rel=1e-12)


def test_a_section_that_overturns_has_no_equilibrium():
    system = _system("dowelled")
    within, beyond = 0.99 * 4.0 * DEAD * PLACES[-1], 1.01 * 4.0 * DEAD * PLACES[-1]
    assert vertical.commit_section.py_func(system, 0, within, 0.0, 1.0)
    assert not vertical.commit_section.py_func(system, 0, beyond, 0.0, 1.0)
    assert np.isfinite(system.sections.supports["axial_force"]).all()


def _rest(system):
    """Let displacements begin from the dead loads, as in an analysis."""
    section, supports = system.sections.sections[0], system.sections.supports
    section.shortening = 0.0
    section.offset = 4.0 * DEAD / section.stiffness
    supports["offset"] = supports["shortening"] = DEAD / section.stiffness
    return section


def _oscillator(mass, damping, stiffness, load, dt):
    """Displacements of one mass from rest, by the average acceleration."""
    by_a, by_v = 4.0 / dt**2, 2.0 / dt
    u, v, a = 0.0, 0.0, load[0] / mass
    rows = [u]
    for force in load[1:]:
        start = mass * (by_a * (u + dt * v) + a) + damping * (by_v * u + v)
        moved = (force + start) / (mass * by_a + damping * by_v + stiffness) - u
        v, a = by_v * moved - v, by_a * (moved - dt * v) - a
        u += moved
        rows.append(u)
    return np.array(rows)


def test_spans_are_a_spring_in_series_with_the_bearings():
    """The line moves by its share of an oscillator on both springs, whose mass is on the spans."""
    system, dt, mass, damping, spans = _system("bolted"), 0.002, 0.6, 0.9, 4000.0
    section = _rest(system)
    section.mass, section.damping, section.span_stiffness = mass, damping, spans
    ground = 1500.0 * np.sin(16.0 * np.pi * dt * np.arange(501))
    bearings = 4.0 * section.stiffness
    series = 1.0 / (1.0 / bearings + 1.0 / spans)
    expected = _oscillator(mass, damping, series, mass * ground, dt)
    rows = [(0.0, 0.0)]
    for acceleration in ground[1:]:
        assert vertical.commit_section.py_func(system, 0, 0.0, acceleration, dt)
        rows.append((section.sunk, section.shortening))
    sunk, shortening = np.array(rows).T
    assert np.abs(sunk - expected).max() < 5e-10 * np.ptp(expected)
    assert np.abs(shortening - series / bearings * expected).max() < 5e-10 * np.ptp(expected)
    works = system.sections.energies[0]
    taken = works.axial_work + works.vertical_damping + works.vertical_kinetic + works.span_stored
    assert works.weight + works.vertical_input == pytest.approx(taken, rel=1e-10)


def test_roll_with_an_inertia():
    """An oscillator on the rotational stiffness of the bearings."""
    system, dt, inertia = _system("bolted"), 0.002, 2e6
    section = _rest(system)
    section.roll_inertia = inertia
    moment = 5e6 * np.sin(6.0 * np.pi * dt * np.arange(501))
    expected = _oscillator(inertia, 0.0, section.stiffness * section.span, moment, dt)
    rolls = [0.0]
    for value in moment[1:]:
        assert vertical.commit_section.py_func(system, 0, value, 0.0, dt)
        rolls.append(section.roll)
    assert np.abs(np.array(rolls) - expected).max() < 1e-9 * np.ptp(expected)
    works = system.sections.energies[0]
    taken = works.axial_work + works.vertical_kinetic
    assert works.weight + works.overturning == pytest.approx(taken, rel=1e-9)


def _bearing():
    """Bearing L of the case: K_el u beside a Bouc-Wen term of its lead, at any temperature."""
    constants = bilinear_constants(BilinearParameters(1.0, 1.0, 2.0))
    rubber = constants.rubber._replace(
        elastic_stiffness=0.944620,
        hysteretic_stiffness=153.938 / 18.107,
        yield_displacement=18.107,
        per_yield_displacement=1.0 / 18.107,
        unloading_curvature=0.8 / 18.107**2,
    )
    column = build_column(BEARING_L, LEAD, secant=0.0)
    # One layer stands for all of them, and its stiffness is that of the net area.
    column["layer_thickness"], column["layer_count"] = 176.0, 1.0
    lead = constants.lead._replace(cores=0.0)
    return constants._replace(rubber=rubber, lead=lead), column


def _run(level, *, mass=0.6, upwards=1500.0, dt=0.002, joint="bolted", mirrored=1.0, duration=6.0):
    constants, column = _bearing()
    structure = Structure(
        name="line",
        bodies=[{"name": "deck", "moves": True, "base_height": 0}],
        masses=[{"body": "deck", "height": 0, "mass": mass}],
        bearings=[
            {
                "name": "line",
                "body": "deck",
                "base": "ground",
                "count": 4,
                "equivalent_stiffness": 1.5,
            }
        ],
        damping={"kind": "none"},
        report={"deck": "deck"},
    )
    time = dt * np.arange(round(duration / dt) + 1)
    hann = np.sin(np.pi * time / 6.0) ** 2
    ground = mirrored * 1300.0 * np.sin(1.2 * np.pi * time) * hann
    up = upwards * np.sin(16.0 * np.pi * time) * hann
    pressed = None
    if level != "off":
        pressed = run.PressedLine(
            columns=column,
            dead_loads=np.full(4, 0.25 * mass * GRAVITY if level != "negligible" else 1e-6),
            places=PLACES,
            moves=level in ("overturning", "vertical"),
            overturns=level in ("overturning", "vertical"),
            height=1800.0,
            dowelled=joint == "dowelled",
            mass=mass,
            damping_ratio=0.03,
        )
    line = run.Line(constants, np.full(1, 23.0), pressed=pressed)
    prepared = run.prepare_structure(structure)
    ambient = np.full(len(ground) - 1, 23.0)
    record = up if level == "vertical" else None
    return run.run_structure(prepared, [line], ground, dt, ambient, vertical=record)


CASES = {
    "overturning": (
        {"level": "overturning"},
        (81.241, 916.03),
        (1660.6, 1534.8, 1533.9, 1658.2),
        (1285.3, 1409.6, 1408.9, 1283.0),
    ),
    "vertical": (
        {"level": "vertical"},
        (81.254, 915.85),
        (1888.1, 1796.1, 1844.9, 1971.9),
        (979.6, 1099.9, 1149.9, 1056.3),
    ),
    "strong": (
        {"level": "vertical", "upwards": 6000.0},
        (81.396, 918.99),
        (2731.6, 2660.7, 2785.8, 2915.8),
        (58.2, 169.4, 274.3, 237.0),
    ),
}


@pytest.mark.parametrize("name", list(CASES))
def test_line(name):
    options, peaks, largest, least = CASES[name]
    history = _run(**options)
    response = history.bearing()
    computed = np.abs(response["displacement"]).max(), 4.0 * np.abs(response["force"]).max()
    assert computed == pytest.approx(peaks, rel=1e-4)
    assert history.axial.supports["largest"] == pytest.approx(largest, abs=0.1)
    assert history.axial.supports["least"] == pytest.approx(least, abs=0.1)


def test_a_heavy_line_is_unstable():
    peak = _run("vertical", mass=2.4, duration=2.5).axial.peaks[0]
    assert peak.first == pytest.approx(1.822, abs=1e-9)
    assert peak.share > 1.0
    bearing = _run("vertical", mass=2.4, duration=1.822).axial.peaks[0]
    assert (bearing.share_bearing, bearing.share_time) == (3, pytest.approx(1.822))


@pytest.mark.parametrize("options", [{}, {"upwards": 9000.0}, {"joint": "dowelled"}])
def test_energy_balance(options):
    """Horizontal and vertical; the vertical one is that of the section and its bearings."""
    history = _run("vertical", duration=3.0, **options)
    energies = history.rows.energies
    stored = energies["kinetic"] + energies["damping"] + energies["springs"] + energies["bearings"]
    assert np.abs(energies["input"] - stored).max() < 1e-10 * np.abs(energies["input"]).max()
    own = history.axial.energies[0]
    given = own.weight + own.overturning + own.vertical_input
    taken = own.axial_work + own.vertical_damping + own.vertical_kinetic
    assert given - taken == pytest.approx(0.0, abs=1e-10 * own.vertical_input)
    # The structure feels less work than the bearings take up: the axial forces lend the rest.
    bearing = 4.0 * history.bearing()["work_in"][-1]
    assert bearing - energies["bearings"][-1] == pytest.approx(own.lent, rel=1e-9)


def test_negligible_axial_forces_change_nothing():
    plain, pressed = _run("off", duration=2.0), _run("negligible", duration=2.0)
    for name in ("force", "displacement"):
        expected = plain.bearing()[name]
        assert pressed.bearing()[name] == pytest.approx(expected, abs=1e-9 * expected.max())


def test_a_mirrored_motion_mirrors_the_axial_forces():
    first = _run("overturning", duration=3.0)
    second = _run("overturning", duration=3.0, mirrored=-1.0)
    scale = np.abs(first.bearing()["displacement"]).max()
    sums = first.bearing()["displacement"] + second.bearing()["displacement"]
    assert np.abs(sums).max() < 1e-12 * scale
    assert first.axial.force == pytest.approx(second.axial.force[:, ::-1], rel=1e-12)


def test_uplift_and_cavitation():
    lifted = _run("vertical", upwards=12000.0, joint="dowelled", duration=4.0).axial.peaks[0]
    assert lifted.uplift > 0.0
    assert lifted.least == 0.0
    pulled = _run("vertical", upwards=18000.0, duration=4.0).axial.peaks[0]
    assert pulled.tension > 1.0
    assert 0.0 < pulled.damage <= 0.75
    assert lifted.unbalanced == pulled.unbalanced == 0.0


# A pier with five bearings, as cases of a user.
TABLE = {
    "dead_load": "1200 kN",
    "places": ["-4.5 m", "-2.25 m", "0 m", "2.25 m", "4.5 m"],
    "across": True,
    "deck_height": "1.8 m",
}


def _case(level, motion=None, **changes):
    table = {key: value for key, value in (TABLE | changes).items() if value is not None}
    return make_earthquake_case(
        {
            "command": "bridge",
            "bearings": ["lrb-example"],
            "ambient": ["-10 degC"],
            "structure": "pier-p1",
            "motions": [{"name": "jra-ii-i-1", "vertical": "jra-ii-i-2"} | (motion or {})],
            "duration": "11 s",
            "analysis": {"axial": level} if level else {},
            "lines": [{"line": "G1-G5", "axial": table}],
        },
        "case.toml",
    )


@pytest.fixture(scope="module")
def pier():
    """The pier without axial forces, and with all of them."""
    return {level: run_earthquake(_case(level)) for level in ("off", "dead", "vertical")}


def test_levels_of_a_pier(pier):
    assert {result.outcome for result in pier.values()} == {"completed"}
    assert pier["off"].axial.empty
    assert "axial_force" not in pier["off"].dataset
    assert (
        np.nanmax(pier["dead"]["axial_force"]) == np.nanmin(pier["dead"]["axial_force"]) == 1200.0
    )
    forces = pier["vertical"]["axial_force"].values[0]
    assert np.nanmax(forces) > 1800.0
    assert forces[0].tolist() == [1200.0] * 5
    (row,) = pier["vertical"].axial.to_dict("records")
    share = forces / pier["vertical"]["critical_load"].values[0]
    assert row["critical_share"] == pytest.approx(np.nanmax(share), rel=0.01)  # of all steps
    assert row["axial_bearing"] in (1, 5)
    check = pier["vertical"].bearing_checks.set_index("what").filter(like="analysis", axis=0)
    assert (check["value"].iloc[0], check["limit"].iloc[0]) == (
        row["axial_force_kN"],
        row["critical_load_kN"],
    )
    for level in ("dead", "vertical"):
        assert abs(pier[level].energy["structure_residual"].iloc[0]) < 1e-10
        peak = float(pier[level]["bearing_displacement_max"][0])
        assert 0.001 < peak / float(pier["off"]["bearing_displacement_max"][0]) - 1.0 < 0.02


def test_off_is_the_default(pier):
    plain = make_earthquake_case(
        {
            "command": "bridge",
            "bearings": ["lrb-example"],
            "ambient": ["-10 degC"],
            "structure": "pier-p1",
            "motions": [{"name": "jra-ii-i-1"}],
            "duration": "11 s",
        },
        "case.toml",
    )
    assert run_earthquake(plain)["bearing_force"].equals(pier["off"]["bearing_force"])
    resolved = _case("vertical").to_toml()
    again = make_earthquake_case(tomllib.loads(resolved), "again.toml")
    assert again.to_toml() == resolved
    assert again.structure.bearings[0].axial == _case("vertical").structure.bearings[0].axial


def test_an_unstable_pier():
    result = run_earthquake(_case("overturning", dead_load="10500 kN"))
    assert result.outcome == "unstable"
    assert result.axial["critical_share"].iloc[0] > 1.0
    assert result.axial["axial_exceeded_s"].iloc[0] > 0.0
    assert any("G1-G5, bearing" in text for text in result.warnings)


@pytest.mark.parametrize(
    ("level", "changes", "key"),
    [
        ("vertical", {"places": None}, "places"),
        ("vertical", {"places": ["1 m"]}, "places"),
        ("overturning", {"places": ["1 m"] * 5}, "places"),
        ("dead", {"dead_load": ["1 kN", "2 kN"]}, "dead_load"),
        ("dead", {"dead_load": "-1 kN"}, "dead_load"),
        ("overturning", {"across": None}, "across"),
        ("vertical", {"motion": {"vertical": "jra-i-i-1"}}, "vertical"),
        ("dead", {"dowel_length": "40 mm"}, "dowel_length"),
    ],
)
def test_refused_tables(level, changes, key):
    motion = changes.pop("motion", None) if "motion" in changes else None
    with pytest.raises(tb.InputError) as caught:
        _case(level, motion, **changes)
    assert key in str(caught.value)
    assert "case.toml" in str(caught.value)


def test_refused_analyses():
    with pytest.raises(tb.InputError, match="critical load"):
        run_earthquake(_case("dead", dead_load="20000 kN"))
    table = {"structure": "pier-p1", "analysis": {"axial": "dead"}, "bearings": ["lrb-example"]}
    for changes, key in (
        ({}, "dead_load"),
        ({"bearings": ["shen-bilinear-bridge"]}, "bilinear"),
        ({"command": "hybrid"}, "hybrid"),
        ({"analysis": {"axial_factor": "potential"}}, "axial_factor"),
        ({"analysis": {"axial": "vertical"}, "motions": ["jra-i-i-1"]}, "vertical"),
    ):
        with pytest.raises(tb.InputError, match=key):
            make_earthquake_case(table | changes, "case.toml")


def test_precedence_of_outcomes():
    history = _run("vertical", upwards=12000.0, duration=4.0).axial
    assert with_axial_outcome("completed", history) == "cavitated"
    assert with_axial_outcome("pier_beyond_limit", history) == "pier_beyond_limit"
    assert with_axial_outcome("completed", None) == "completed"
    lifted = _run("vertical", upwards=12000.0, joint="dowelled", duration=4.0).axial
    assert with_axial_outcome("completed", lifted) == "completed"
    lifted.sections["dowel_length"] = 1e-6
    assert with_axial_outcome("completed", lifted) == "uplift"
    history.peaks["first"] = 1.0
    assert with_axial_outcome("pier_beyond_limit", history) == "unstable"
    # What moves too far after it buckled is unstable: the cause goes before its effects.
    assert with_axial_outcome("not_physical", history) == "unstable"
    history.peaks["first"] = -1.0
    assert with_axial_outcome("not_physical", history) == "not_physical"


def test_one_line_of_a_structure_in_plan():
    structure = load_structure("five-span-bridge")
    line = structure.bearings[1]
    places = [f"{2.0 * number} m" for number in range(line.count)]
    table = {"dead_load": "1200 kN", "places": places, "deck_height": "1.8 m"}
    motion = {"name": "jra-ii-i-1", "across": "jra-ii-i-2", "vertical": "jra-ii-i-3"}
    case = make_earthquake_case(
        {
            "bearings": ["lrb-example"],
            "ambient": ["23 degC"],
            "structure": "five-span-bridge",
            "motions": [motion],
            "duration": "9 s",
            "analysis": {"axial": "vertical"},
            "lines": [{"line": line.name, "axial": table}],
        },
        "case.toml",
    )
    result = run_earthquake(case)
    assert result.axial["line"].tolist() == [line.name]
    assert abs(result.energy["structure_residual"].iloc[0]) < 1e-9
    across = result["line_displacement"].values[0, :, 1, 1]
    forces = result["axial_force"].values[0]
    # What sways to one side presses the bearings there.
    lean = np.nansum(forces * (np.arange(line.count) - 0.5 * (line.count - 1)), axis=1)
    assert np.corrcoef(lean[np.isfinite(across)], across[np.isfinite(across)])[0, 1] > 0.8


def test_peaks_and_works_are_those_of_their_lines():
    """Of two lines whose axial forces act, numbers 2 and 0, and a run without any."""
    pressed = SimpleNamespace(
        lines=[2, 0], peaks=["peak 2", "peak 0"], energies=["work 2", "work 0"]
    )
    histories = [SimpleNamespace(axial=None), SimpleNamespace(axial=pressed)]
    lines = list(_pressed_lines(["first", "second"], histories))
    assert lines == [("second", 2, "peak 2", "work 2"), ("second", 0, "peak 0", "work 0")]


def test_a_study_scales_the_vertical_motion_too():
    """A run at scale 1.5 shakes like the motion times 1.5, in all directions."""
    motion = {"name": "jra-ii-i-1", "vertical": "jra-ii-i-2"}
    table = {
        "kind": "study",
        "name": "vertical",
        "case": {
            "structure": "pier-p1",
            "duration": "2 s",
            "analysis": {"axial": "vertical"},
            "lines": [{"line": "G1-G5", "axial": TABLE}],
        },
        "factors": {
            "bearing": "lrb-example",
            "motion": [motion],
            "scale": [1.0, 1.5],
            "ambient": ["-10 degC"],
        },
    }
    plan = Plan(make_study(table, "study.toml"))
    preparer, runs = Preparer(plan), plan.runs.to_dict("records")
    plain, scaled = (preparer.make_task(run).shaking for run in runs)
    assert plain.vertical is not None
    assert np.abs(plain.vertical).max() > 0.0
    for name in ("ground", "vertical"):
        assert getattr(scaled, name) == pytest.approx(1.5 * getattr(plain, name), rel=1e-14)
