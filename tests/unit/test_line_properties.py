"""Equivalent properties of bearing lines: against bilinear loops and closed forms."""

import math
import re
import tomllib

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.quick import quick_cases
from tests.unit.test_lines_and_piers import MOTION, two_piers
from thermobearing.bearing.exposure import Exposure, exposed
from thermobearing.bearing.sources import COEFFICIENTS, assumed_properties
from thermobearing.bearing.state import RubberState, in_state
from thermobearing.border.schema import validated
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import (
    find_backbone,
    isothermal_cycle,
    post_yield_ratio,
    stated_backbone,
)
from thermobearing.earthquake.properties.bridge import (
    bridge_properties,
    damping_factor,
    hysteretic_ratios,
    nominal_stiffness,
    periods_table,
    structure_devices,
)
from thermobearing.earthquake.properties.lines import line_properties, motions_for_mean
from thermobearing.earthquake.properties.links import link_text
from thermobearing.earthquake.properties.notes import initial_stiffness_note, temperature_note
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.constants import softening_beyond_tests
from thermobearing.model.earlier import BilinearParameters
from thermobearing.quantities.words import plain
from thermobearing.structure.matrices import (
    Matrices,
    build_matrices,
    find_modes,
    hinge_stiffness,
    line_stiffness,
)
from thermobearing.structure.model import Structure, load_structure

HDR, BILINEAR, LHDR = "shen-hdr-bridge", "shen-bilinear-bridge", "shen-lhdr-bridge"


@pytest.fixture(scope="module")
def pier() -> EarthquakeResult:
    return tb.bridge([HDR, BILINEAR], ["jra-ii-i-1", "jra-ii-i-2"], [23, -20], duration=10)


def test_a_bilinear_bearing_keeps_its_own_loop(pier: EarthquakeResult) -> None:
    table = line_properties(pier)
    row = table[table["bearing"] == BILINEAR].iloc[0]
    displacement = row["design_displacement_mm"]
    assert_allclose(row["K_eff_kN_mm"], row["Q_d_kN"] / displacement + row["K_d_kN_mm"])
    yielding = row["Q_d_kN"] / (row["K_1_kN_mm"] - row["K_d_kN_mm"])
    energy = 4.0 * row["Q_d_kN"] * (displacement - yielding)
    assert_allclose(row["h_eff"], energy / (2.0 * np.pi * row["K_eff_kN_mm"] * displacement**2))


def _links(result: EarthquakeResult, lines: pd.DataFrame) -> str:
    return link_text(lines, bridge_properties(result, lines))


def test_an_assumed_initial_stiffness_is_stated_beside_the_number(pier: EarthquakeResult) -> None:
    table = line_properties(pier).assign(beyond_tests="", assumed="")  # K_1 alone is marked
    assert set(table.loc[table["bearing"] == HDR, "kind"]) == {"HDR"}
    ratio = post_yield_ratio("HDR")
    note = initial_stiffness_note(table)
    assert f"{1.0 / ratio.K_2_over_K_1:.3g} (HDR)" in note
    assert ratio.source in note
    assert _links(pier, table).count(" (assumed) ") == 2 * int((table["kind"] == "HDR").sum())
    bilinear = table[table["bearing"] == BILINEAR]
    assert initial_stiffness_note(bilinear) == ""
    assert " (assumed) " not in _links(pier, bilinear)


def test_links_name_the_motion_of_the_design_displacement(pier: EarthquakeResult) -> None:
    lines = line_properties(pier)
    runs = pier.table.set_index(["bearing", "ambient_degC", "motion"])["bearing_strain_max"]
    runs = runs.sort_index()
    text = _links(pier, lines)
    for row in lines.to_dict("records"):
        governing = runs[row["bearing"], row["ambient_degC"]].idxmax()
        assert governing in row["design_displacement_of"]
        assert f"m ({row['design_displacement_of']})" in text


def test_links_state_cycle_and_rubber(pier: EarthquakeResult) -> None:
    """A bearing of tested rubber has the third cycle at all temperatures; a bilinear one none."""
    lines = line_properties(pier)
    layered = lines["bearing"] == HDR
    assert set(lines.loc[layered, "cycle"]) == {3}
    assert _links(pier, lines).count("third cycle without heating, scragged rubber") == int(
        layered.sum()
    )


@pytest.mark.parametrize("temperature", quick_cases([23.0, -20.0], 1))
def test_linear_rubber_with_lead_has_its_own_bilinear_loop(temperature: float) -> None:
    """Q_d and K_d of the cyclic test at all displacements; K_1 is K_d and the lead."""
    bearing = tb.load_bearing("lrb-example")
    assert bearing.lead is not None
    loops = []
    for strain in (1.0, 1.75):
        amplitude = strain * bearing.total_rubber_thickness
        cycle = isothermal_cycle(bearing, strain, 100.0, temperature)
        loop = stated_backbone(bearing, cycle, amplitude)
        assert loop is not None
        assert_allclose(loop.strength, cycle.characteristic_strength_kN, rtol=1e-3)
        assert_allclose(loop.post_yield, cycle.post_yield_stiffness_kN_mm)
        assert_allclose(loop.initial - loop.post_yield, bearing.lead.stiffness)
        assert_allclose(loop.energy(amplitude), cycle.energy_kN_mm, rtol=1e-2)
        loops.append(loop)
    assert_allclose(loops[0].strength, loops[1].strength, rtol=1e-3)
    assert_allclose(loops[0].post_yield, loops[1].post_yield, rtol=1e-3)
    hardens = tb.load_bearing(HDR)
    assert stated_backbone(hardens, isothermal_cycle(hardens, 1.0), 102.0) is None


@pytest.mark.parametrize("part_of_yield", quick_cases([0.5, 1.02, 1.3, 3.0], 1))
def test_a_loop_near_or_below_yield_is_that_beyond_it(part_of_yield: float) -> None:
    bearing = tb.load_bearing("lrb-example")
    rubber = bearing.total_rubber_thickness
    beyond = stated_backbone(bearing, isothermal_cycle(bearing, 1.0, 100.0, 23.0), rubber)
    assert beyond is not None
    amplitude = part_of_yield * beyond.yield_displacement
    cycle = isothermal_cycle(bearing, amplitude / rubber, 100.0, 23.0)
    loop, is_stated = find_backbone(bearing, cycle, amplitude, 100.0, 23.0)
    assert is_stated
    assert loop is not None
    assert_allclose(
        [loop.strength, loop.post_yield, loop.initial],
        [beyond.strength, beyond.post_yield, beyond.initial],
        rtol=1e-3,
    )


@pytest.fixture(scope="module")
def still() -> pd.DataFrame:
    """Lines that hardly move; a motion of a fiftieth of a record."""
    motions = [{"name": "jra-ii-i-1", "factor": 0.02}]
    bearings = ["lrb-example", HDR, BILINEAR]
    result = tb.bridge(bearings, motions, [23, -20], duration=10)
    lines = line_properties(result)
    return lines.assign(text=[_links(result, lines.loc[[index]]) for index in lines.index])


@pytest.mark.parametrize("name", ["lrb-example", BILINEAR])
def test_a_bearing_that_does_not_yield_keeps_the_loop_that_it_has(
    name: str, still: pd.DataFrame
) -> None:
    for row in still[still["bearing"] == name].to_dict("records"):
        assert row["design_displacement_mm"] < row["D_y_mm"]
        assert row["h_eff"] == 0.0
        assert row["kind"] == ""
        assert_allclose(row["K_1_kN_mm"], row["K_eff_kN_mm"], rtol=1e-6)
        assert row["K_d_kN_mm"] < 0.5 * row["K_1_kN_mm"]
        yields = row["Q_d_kN"] + row["K_d_kN_mm"] * row["D_y_mm"]
        assert f"{yields:.5g} kN\n" in row["text"]
        displacement = f"{row['design_displacement_mm']:.1f} mm"
        assert f"does not yield at its design displacement of {displacement}" in row["text"]


def test_rubber_without_a_yield_has_no_loop(still: pd.DataFrame) -> None:
    columns = ["Q_d_kN", "K_d_kN_mm", "K_1_kN_mm", "D_y_mm"]
    rows = still[still["bearing"] == HDR]
    assert rows[columns].isna().all().all()
    assert (rows["h_eff"] >= 0.0).all()
    for text in rows["text"]:
        assert "no yield can be found" in text
        assert "stiffness before yielding" not in text
        assert "yield strength  " not in text


def two_lines(bearing: str, *, other: str | None = None) -> EarthquakeResult:
    """Two lines with different displacements: one pier is stiff, the other yields."""
    structure = validated(Structure, two_piers(), "test")
    lines = [{"line": "on A", "bearing": other}] if other else []
    settings = {"structure": structure, "lines": lines}
    return tb.bridge(bearing, ambient=[23.0, -20.0], **MOTION, **settings)


def test_the_nominal_stiffness_is_that_of_the_structure(pier: EarthquakeResult) -> None:
    """2615.3 N/mm of pier P1, whichever bearing runs; of lines that differ the range."""
    assert nominal_stiffness(pier) == "2.62 kN/mm"
    table = two_piers()
    table["bearings"][0]["equivalent_stiffness"] = "3 kN/mm"
    structure = validated(Structure, table, "test")
    result = tb.bridge("lrb-example", ambient=23.0, structure=structure, **MOTION)
    assert nominal_stiffness(result) == "2.6 to 3 kN/mm"


@pytest.mark.parametrize(("name", "kind"), quick_cases([("lrb-example", ""), (LHDR, "LHDR")], 1))
def test_lines_with_the_same_bearing_have_one_loop(name: str, kind: str) -> None:
    lines = line_properties(two_lines(name))
    assert set(lines["kind"]) == {kind}
    for _, group in lines.groupby("ambient_degC"):
        assert np.ptp(group["design_displacement_mm"]) > 0.01
        if not kind:
            assert_allclose(group["Q_d_kN"], group["Q_d_kN"].iloc[0], rtol=0.02)
            assert_allclose(group["K_d_kN_mm"], group["K_d_kN_mm"].iloc[0], rtol=0.02)
            ratio = group["K_1_kN_mm"] / group["K_d_kN_mm"]
            assert_allclose(ratio, ratio.iloc[0], rtol=0.02)
        else:
            ratio = group["K_1_kN_mm"] / group["K_d_kN_mm"]
            assert_allclose(ratio, ratio.iloc[0])


def test_a_fat_loop_at_one_temperature_leaves_others_their_ratio() -> None:
    """A fat loop needs a larger K_1/K_d; links at the other temperature are as without it."""
    case = {"motion": "jra-ii-i-1", "duration": 15}
    both = line_properties(tb.bridge(LHDR, ambient=[23.0, -20.0], **case))
    ratio = (both["K_1_kN_mm"] / both["K_d_kN_mm"]).to_numpy()
    smaller = int(ratio.argmin())
    assert ratio.max() > 1.2 * ratio.min()
    ambient = both["ambient_degC"].iloc[smaller]
    (alone,) = line_properties(tb.bridge(LHDR, ambient=ambient, **case)).to_dict("records")
    for name in ("Q_d_kN", "K_d_kN_mm", "K_1_kN_mm"):
        assert_allclose(both[name].iloc[smaller], alone[name])


def test_the_loop_has_peak_and_energy_of_the_bearing(pier: EarthquakeResult) -> None:
    """At the largest displacement of the two motions, at the temperature and mean speed 4 D/T."""
    table = line_properties(pier)
    period = float(np.atleast_1d(pier.dataset.attrs["periods_s"])[0])
    bearing = tb.load_bearing(HDR)
    runs = pier.table[pier.table["bearing"] == HDR]
    for ambient in (23.0, -20.0):
        mine = table[(table["bearing"] == HDR) & (table["ambient_degC"] == ambient)]
        (row,) = mine.to_dict("records")
        strain = runs[runs["ambient_degC"] == ambient]["bearing_strain_max"].max()
        displacement = strain * bearing.total_rubber_thickness
        assert_allclose(row["design_displacement_mm"], displacement)
        cycle = isothermal_cycle(bearing, strain, 4.0 * displacement / period, ambient)
        assert_allclose(
            row["Q_d_kN"] + row["K_d_kN_mm"] * displacement, cycle.stiffness_kN_mm * displacement
        )
        yielding = row["Q_d_kN"] / (row["K_1_kN_mm"] - row["K_d_kN_mm"])
        assert_allclose(4.0 * row["Q_d_kN"] * (displacement - yielding), cycle.energy_kN_mm)
    cold, warm = (
        table[(table["bearing"] == HDR) & (table["ambient_degC"] == t)].iloc[0]
        for t in (-20.0, 23.0)
    )
    assert cold["K_eff_kN_mm"] > warm["K_eff_kN_mm"]


@pytest.mark.parametrize("stated_of_line", quick_cases([False, True], 1))
def test_the_bearing_is_the_one_that_was_run(stated_of_line: bool) -> None:
    """With the exposure of the analysis, and with virgin rubber of the analysis or of the line."""
    exposure = {"stiffness": 1.3, "strength": 1.5, "source": "test"}
    state = (
        {"lines": [{"line": "G1-G5", "state": "virgin"}]} if stated_of_line else {"state": "virgin"}
    )
    result = tb.bridge([HDR, BILINEAR], "jra-ii-i-1", -20, duration=6, exposure=exposure, **state)
    rows = line_properties(result).set_index("bearing")
    period = float(np.atleast_1d(result.dataset.attrs["periods_s"])[0])
    moved = rows.loc[HDR, "design_displacement_mm"]
    bearing = exposed(tb.load_bearing(HDR), Exposure(**exposure))
    virgin = in_state(bearing, RubberState(rubber="virgin"))
    states = [(virgin, 1), (virgin, 3), (bearing, 3)]
    cycles = [
        isothermal_cycle(
            device, moved / device.total_rubber_thickness, 4.0 * moved / period, -20.0, number
        )
        for device, number in states
    ]
    stiffness = rows.loc[HDR, "K_eff_kN_mm"]
    # The largest force of the first cycle, with the energy of the third.
    assert_allclose(stiffness * moved, max(cycles[0].force_max_kN, -cycles[0].force_min_kN))
    energy = 2.0 * math.pi * rows.loc[HDR, "h_eff"] * stiffness * moved**2
    assert_allclose(energy, cycles[1].energy_kN_mm)
    assert cycles[1].energy_kN_mm < 0.9 * cycles[0].energy_kN_mm
    assert stiffness > 1.3 * cycles[2].stiffness_kN_mm
    assert_allclose(rows.loc[HDR, "over_scragged"], stiffness / cycles[2].stiffness_kN_mm)
    assert (rows.loc[HDR, "cycle"], rows.loc[HDR, "rubber"]) == (1, "virgin")
    # The peak force of the run, which warms, is that of the upper values within 7 %.
    peak = result.table.set_index("bearing").loc[HDR, "bearing_force_max_kN"]
    assert_allclose(stiffness * moved, peak, rtol=0.07)
    text = _links(result, line_properties(result))
    assert "largest force of the first cycle" in text
    assert f"{rows.loc[HDR, 'over_scragged']:.2f} times" in text
    file = tb.load_bilinear(BILINEAR)
    assert_allclose(rows.loc[BILINEAR, "Q_d_kN"], 1.5 * file.strength)
    assert_allclose(rows.loc[BILINEAR, "K_d_kN_mm"], 1.3 * file.post_yield_stiffness)


def stiffness_without_bearings(result: EarthquakeResult) -> tuple[Structure, Matrices, Floats]:
    """Return the structure of a result, its matrices, and the stiffness of all but the bearings."""
    case = tomllib.loads(result.dataset.attrs["case"])
    structure = validated(Structure, case["structure"], "structure")
    matrices = build_matrices(structure, "consistent")
    return structure, matrices, matrices.springs + hinge_stiffness(structure, matrices)


def test_the_bridge_has_the_ratio_of_its_lines_and_a_longer_period_when_warm(
    pier: EarthquakeResult,
) -> None:
    lines = line_properties(pier)
    bridges = bridge_properties(pier, lines).set_index(["bearing", "ambient_degC"])
    structure, matrices, rigid = stiffness_without_bearings(pier)
    for row in lines.to_dict("records"):
        whole = bridges.loc[(row["bearing"], row["ambient_degC"])]
        assert_allclose(whole["bearing_damping_ratio"], row["h_eff"])
        each = np.array([row["K_eff_kN_mm"]])
        modes = find_modes(matrices.mass, rigid + line_stiffness(structure, matrices, each))
        shape = modes.shapes[:, 0]
        others = shape @ rigid @ shape / modes.frequencies[0] ** 2
        assert_allclose(whole["effective_damping_ratio"], row["h_eff"] * (1.0 - others))
        assert others > 0.1
        assert_allclose(whole["B_L"], min((whole["effective_damping_ratio"] / 0.05) ** 0.3, 1.7))
    warm, cold = (bridges.loc[(HDR, t)]["effective_period_s"] for t in (23.0, -20.0))
    assert warm > cold
    # The deck alone on its bearings moves faster than with the flexible pier below them.
    stiffness = 5.0 * lines[lines["bearing"] == HDR]["K_eff_kN_mm"].to_numpy(dtype=float)
    deck = 2.0 * math.pi / np.sqrt(stiffness / mass_of_deck(pier))
    assert np.all(np.array([warm, cold]) > deck)


def damping_of_pole(mass: Floats, stiffness: Floats, damping: Floats, frequency: float) -> float:
    """Return the damping ratio of the complex eigenvalue of M, C and K next to a frequency."""
    size = len(mass)
    state = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)],
        ]
    )
    poles = np.linalg.eigvals(state)
    pole = poles[np.argmin(np.abs(poles - 1j * frequency))]
    return float(-pole.real / abs(pole))


def first_harmonic(row: dict[str, float]) -> tuple[float, float]:
    """Return the stiffness in phase and the loss of a bilinear loop, its first harmonics."""
    moved, strength, core = (
        row["design_displacement_mm"],
        row["Q_d_kN"],
        row["K_1_kN_mm"] - row["K_d_kN_mm"],
    )
    phase = (np.arange(20000) + 0.5) * np.pi / 20000
    displacement = moved * np.cos(phase)  # half a cycle, from the peak down
    force = row["K_d_kN_mm"] * displacement
    force += np.maximum(strength - core * (moved - displacement), -strength)
    return (
        2.0 * float(np.mean(force * np.cos(phase))) / moved,
        -2.0 * float(np.mean(force * np.sin(phase))) / moved,
    )


@pytest.mark.parametrize("name", quick_cases([HDR, BILINEAR], 1))
def test_the_damping_of_pier_p1_is_that_of_complex_eigenvalues(
    pier: EarthquakeResult, name: str
) -> None:
    """Its masses load the foundation as well, and (D + D_sub) of codes does not count them."""
    lines = line_properties(pier)
    bridges = bridge_properties(pier, lines).set_index(["bearing", "ambient_degC"])
    structure, matrices, rigid = stiffness_without_bearings(pier)
    mass = matrices.mass
    deck = np.eye(len(mass))[0]
    for row in lines[lines["bearing"] == name].to_dict("records"):
        whole = bridges.loc[(name, row["ambient_degC"])]
        ratio, frequency = (
            whole["effective_damping_ratio"],
            2.0 * np.pi / whole["effective_period_s"],
        )
        bearings = line_stiffness(structure, matrices, np.array([row["K_eff_kN_mm"]]))
        dashpots = 2.0 * row["h_eff"] / frequency * bearings
        # Shares of strain energy are exact as damping vanishes: 1e-4 of it leaves errors of 1e-8.
        small = damping_of_pole(mass, rigid + bearings, 1e-4 * dashpots, frequency) / 1e-4
        assert_allclose(small, ratio, rtol=1e-5)
        # What the loop itself does in a cycle: its force in phase is below K_eff D.
        in_phase, loss = first_harmonic(row)
        assert_allclose(loss, 2.0 * row["h_eff"] * row["K_eff_kN_mm"], rtol=1e-3)
        each = line_stiffness(structure, matrices, np.array([1.0]))
        of_loop = damping_of_pole(mass, rigid + in_phase * each, loss / frequency * each, frequency)
        moved = np.linalg.solve(rigid + bearings, deck)
        static = row["h_eff"] * (moved @ bearings @ moved) / (moved @ deck)
        assert_allclose(ratio, of_loop, rtol=0.15)
        assert static > 1.25 * ratio
        assert static > 1.1 * of_loop
        if (name, row["ambient_degC"]) == (HDR, 23.0):  # the numbers of theory.md
            assert_allclose([ratio, of_loop, static], [0.073, 0.081, 0.098], atol=5e-4)


def test_light_piers_lower_the_damping_as_their_displacement_does() -> None:
    """xi = sum n E/(2 pi sum F (D + D_sub)), with F = n K_eff D and D_sub = F/k of each pier."""
    table = two_piers()
    table["masses"] = [table["masses"][0], *(m | {"mass": "1 t"} for m in table["masses"][1:])]
    structure = validated(Structure, table, "test")
    result = tb.bridge(HDR, "jra-ii-i-1", [23.0], duration=10, structure=structure)
    lines = line_properties(result)
    pier_stiffness = np.array([400.0, 30.0])  # [kN/mm] at the lines, 10 m above the feet
    force = (lines["count"] * lines["K_eff_kN_mm"] * lines["design_displacement_mm"]).to_numpy()
    moved = lines["design_displacement_mm"].to_numpy()
    energy = (lines["h_eff"] * force * moved).sum()
    expected = energy / (force * (moved + force / pier_stiffness)).sum()
    (bridge,) = bridge_properties(result, lines).to_dict("records")
    assert expected < 0.97 * bridge["bearing_damping_ratio"]
    assert_allclose(bridge["effective_damping_ratio"], expected, rtol=0.01)


def test_modes_have_the_damping_of_the_bearings_by_their_strain_energy(
    pier: EarthquakeResult,
) -> None:
    """What springs and hinges do not store of the energy of a mode, the bearings damp."""
    lines = line_properties(pier)
    result = hysteretic_ratios(pier, lines)
    warm = lines[lines["ambient_degC"] == 23.0].set_index("bearing")["h_eff"]
    structure, matrices, rigid = stiffness_without_bearings(pier)
    equivalent = np.array([line.equivalent_stiffness for line in structure.bearings])
    modes = find_modes(matrices.mass, rigid + line_stiffness(structure, matrices, equivalent))
    for name, ratios in result.items():
        for k, (ratio, shape) in enumerate(zip(ratios, modes.shapes.T, strict=True)):
            others = shape @ rigid @ shape / modes.frequencies[k] ** 2
            assert_allclose(ratio, warm[name] * (1.0 - others), rtol=1e-9, atol=1e-12)
    table, frame = periods_table(pier, result, mode_limit=3)
    assert (len(table.rows), len(frame)) == (3, 4)
    assert_allclose(frame[f"hysteretic_{HDR}"], result[HDR])
    assert 0.3 * warm[HDR] < result[HDR][0] < 0.4 * warm[HDR]  # the foundation has the most


def test_both_initial_stiffnesses_have_their_number_beside_them(pier: EarthquakeResult) -> None:
    """K_0 of the model gives the initial periods; K_1 of the loop of rubber is another."""
    lines = line_properties(pier)
    bearing, warm = tb.load_bearing(HDR), lines["ambient_degC"] == 23.0
    row = lines[(lines["bearing"] == HDR) & warm].iloc[0]
    hysteresis = bearing.hysteresis
    assert_allclose(row["K_0_kN_mm"], hysteresis.layer_stiffness / bearing.geometry.rubber_layers)
    assert row["K_1_kN_mm"] > 1.5 * row["K_0_kN_mm"]
    bilinear = lines[lines["bearing"] == BILINEAR]
    assert_allclose(bilinear["K_0_kN_mm"], bilinear["K_1_kN_mm"])
    numbers = [f"{row[name]:.2f}" for name in ("K_1_kN_mm", "K_0_kN_mm")]
    table, _ = periods_table(pier, lines=lines)
    for text in (_links(pier, lines), initial_stiffness_note(lines), table.note):
        assert all(number in text for number in numbers)


def test_a_report_shows_ten_modes_and_writes_all(pier: EarthquakeResult) -> None:
    many = {"periods_s": np.linspace(2.0, 0.1, 27), "damping_ratios": np.zeros(27)}
    many |= {f"initial_periods_s:{name}": np.ones(27) for name in (HDR, BILINEAR)}
    pieces = build_pieces(EarthquakeResult(pier.dataset.assign_attrs(many)))
    assert len(pieces.tables["periods"].rows) == 10
    assert len(pieces.files["modes.csv"].splitlines()) == 1 + 27


def mass_of_deck(result: EarthquakeResult) -> float:
    """Return the mass of the deck [kN s2/mm]."""
    case = tomllib.loads(result.dataset.attrs["case"])
    structure = validated(Structure, case["structure"], "structure")
    return sum(one.mass for one in structure.masses if one.body == "deck")


@pytest.mark.parametrize(("ratio", "factor"), [(0.05, 1.0), (0.1, 2.0**0.3), (0.5, 1.7)])
def test_damping_factor(ratio: float, factor: float) -> None:
    assert_allclose(damping_factor().at(ratio), factor)


def test_means_count_from_seven_motions() -> None:
    motions = [{"name": "jra-ii-i-1", "factor": f} for f in np.linspace(0.4, 0.7, 7)]
    for number, measure in ((motions_for_mean(), np.mean), (motions_for_mean() - 1, np.max)):
        result = tb.bridge(BILINEAR, motions[:number], 23, duration=8)
        strain = measure(result.table["bearing_strain_max"].to_numpy(dtype=float))
        (row,) = line_properties(result).to_dict("records")
        moved = np.nanmax(np.abs(result["bearing_displacement"].values))
        thickness = moved / np.nanmax(np.abs(result["bearing_strain"].values))
        assert_allclose(row["design_displacement_mm"], strain * thickness, rtol=1e-5)


def test_links_have_metres_and_the_yield_strength(pier: EarthquakeResult) -> None:
    lines = line_properties(pier)
    text = _links(pier, lines)
    blocks = text.split("\n\n")[1:]
    assert len(blocks) == len(lines)
    for block, row in zip(blocks, lines.to_dict("records"), strict=True):
        values = dict(re.findall(r"^  (\S.*?\S)(?: \(assumed\))? {2,}(\S+)", block, re.M))
        share = row["K_d_kN_mm"] / row["K_1_kN_mm"]
        assert_allclose(float(values["effective stiffness"]), 1e3 * row["K_eff_kN_mm"], rtol=1e-4)
        assert_allclose(float(values["yield strength"]) * (1.0 - share), row["Q_d_kN"], rtol=1e-4)
        assert_allclose(
            float(values["design displacement"]), row["design_displacement_mm"] / 1e3, rtol=1e-4
        )


def test_links_have_the_coefficient_of_a_dashpot(pier: EarthquakeResult) -> None:
    """C = h K_eff T_eff/pi, the c = 2 h m w of a mass on the bearing with the period T_eff."""
    lines = line_properties(pier)
    bridges = bridge_properties(pier, lines)
    blocks = link_text(lines, bridges).split("\n\n")[1:]
    periods = bridges.set_index(["bearing", "ambient_degC"])["effective_period_s"]
    for block, row in zip(blocks, lines.to_dict("records"), strict=True):
        (value,) = re.findall(r"^  effective damping(?: \(assumed\))? +(\S+) kN s/m", block, re.M)
        frequency = 2.0 * np.pi / periods[row["bearing"], row["ambient_degC"]]
        mass = 1e3 * row["K_eff_kN_mm"] / frequency**2  # kN s2/m
        assert_allclose(float(value), 2.0 * row["h_eff"] * mass * frequency, rtol=1e-4)


def test_links_have_the_devices(pier: EarthquakeResult) -> None:
    structure = load_structure("pier-p1")
    line = structure.bearings[0].name
    damper = {"kind": "damper", "name": "D1", "line": line, "force": 400.0, "exponent": 0.3}
    table = structure.model_dump(exclude_none=True) | {"devices": [damper]}
    devices = Structure(**table).devices or ()
    lines, bridges = line_properties(pier).head(1), bridge_properties(pier, line_properties(pier))
    text = link_text(lines, bridges, devices)
    assert f"\nD1: 1 viscous damper parallel to the line {line}\n" in text
    assert re.search(r"^  damping coefficient C +400 kN \(s/m\)\^alpha$", text, re.M)
    assert re.search(r"^  damping exponent alpha +0.3$", text, re.M)
    assert "viscous" not in link_text(lines, bridges)
    assert structure_devices(pier) == ()


def test_numbers_that_were_not_measured_are_marked(pier: EarthquakeResult) -> None:
    """Yield stress marks strength and damping, not K_1; temperature coefficients only the cold."""
    lines = line_properties(pier).head(1).assign(kind="", assumed="lead.yield_stress")
    text = _links(pier, lines)
    assert "yield strength (assumed)" in text
    assert "before yielding (assumed)" not in text
    text = _links(pier, lines.assign(assumed="lead.stiffness lead.yield_stress"))
    assert "before yielding (assumed)" in text
    sources = {"lead.yield_stress": "compound a; chosen", COEFFICIENTS[0]: "borrowed from b; c"}
    assert assumed_properties(sources, at_reference=True) == ("lead.yield_stress",)
    assert assumed_properties(sources, at_reference=False)[1] == COEFFICIENTS[0]


COLDER = -30.0  # than the tests of the rubber, whose law is of -20 to 34 degC


@pytest.fixture(scope="module")
def cold_states() -> dict[str, EarthquakeResult]:
    states = {"scragged": {}, "virgin": {"state": "virgin"}}
    motion = {"motion": "jra-ii-i-1", "ambient": [23, COLDER], "duration": 6}
    return {name: tb.bridge(HDR, **motion, **state) for name, state in states.items()}


def _marked_rows(result: EarthquakeResult) -> set[int]:
    return {row for row, _ in build_pieces(result).tables["properties"].marked}


def test_temperatures_outside_the_law_of_the_rubber_are_marked(
    cold_states: dict[str, EarthquakeResult],
) -> None:
    """10 K below the law: in links.txt, in the column `assumed` and in the table of the report."""
    result = cold_states["scragged"]
    lines = line_properties(result).set_index("ambient_degC")
    assert {key: text.split()[0] for key, text in lines["assumed"].items()} == {
        23.0: "tested_range.strain",  # of 6 s of a motion, below the 50 % of the tests
        COLDER: "temperature_law",
    }
    assert lines["outside_law_K"].to_dict() == {23.0: 0.0, COLDER: -10.0}
    lines = lines.assign(beyond_tests="")
    lines["assumed"] = lines["assumed"].str.replace("tested_range.strain", "")
    warm, cold = _links(result, lines.reset_index()).split("\n\n")[1:]
    for words in ("effective stiffness", "effective damping ratio", "yield strength"):
        assert (f"{words} (assumed)" in warm, f"{words} (assumed)" in cold) == (False, True)
    assert "10 K below" in cold
    assert _marked_rows(result) == {0, 1, 2}  # scragged, and scragged and virgin in the cold


@pytest.mark.parametrize(
    ("tested", "key", "words"),
    [
        ({"ambient": [0.0, 23.0]}, "", ""),
        ({"strain": [0.01, 0.05]}, "tested_range.strain", "above the 5 % tested"),
        ({"strain": [2.0, 3.0]}, "tested_range.strain", "below the 200 % tested"),
        ({"ambient": [25.5, 30.0]}, "tested_range.ambient", "below the 25.5 degC tested"),
    ],
)
def test_properties_outside_the_tests_are_marked(
    tested: dict[str, list[float]], key: str, words: str
) -> None:
    """At 23 degC: in the table of the report, in links.txt and in properties.csv."""
    device = tb.changed_bearing(HDR, tested_range={"strain": [0.01, 3.0]} | tested)
    result = tb.bridge(device, "jra-ii-i-1", 23, duration=3)
    (row,) = line_properties(result).to_dict("records")
    assert row["assumed"] == key
    assert words in row["beyond_tests"]
    text = " ".join(_links(result, line_properties(result)).split())
    assert words in text
    for name in ("effective stiffness", "effective damping ratio", "yield strength"):
        assert (f"{name} (assumed)" in text) == bool(key)
    pieces = build_pieces(result)
    marked = {row for row, _ in pieces.tables["properties"].marked}
    assert len(marked) == 1 + bool(key)  # the excess of the virgin row is assumed
    assert plain(words) in pieces.tables["properties"].note
    content = pieces.files["properties.csv"]
    assert key in (content if isinstance(content, str) else content.decode())


def test_assumed_excess_of_virgin_rubber_is_marked(
    cold_states: dict[str, EarthquakeResult],
) -> None:
    result = cold_states["virgin"]
    lines = line_properties(result)
    assert [text.rpartition(" ")[0] for text in lines["assumed"]] == [
        "scragging",
        "scragging temperature_law",
    ]
    text = _links(result, lines)
    assert text.count("effective stiffness (assumed)") == len(lines)
    assert "--state tested" in text
    assert "vertical stiffness (assumed)" not in text  # that of scragged rubber
    assert _marked_rows(result) == {0, 1, 2}
    stated = tb.changed_bearing(HDR, scragging={"amplitude": 0.2})
    result = tb.bridge(stated, "jra-ii-i-1", 23, duration=3)
    assert "scragging" not in line_properties(result)["assumed"].iloc[0]
    # Natural rubber is as stiff while virgin: nothing of it is assumed.
    natural = line_properties(
        tb.bridge("lrb-example", "jra-ii-i-1", 20, duration=3, state="virgin")
    )
    assert "scragging" not in natural["assumed"].iloc[0]


def test_lower_values_state_the_strength_of_warm_lead() -> None:
    """sigma_Y exp(-E2 dT): the strength at the highest temperature of the lead in the run."""
    result = tb.bridge("lrb-example", "jra-ii-i-1", 23, duration=20)
    lines = line_properties(result)
    (row,) = lines.to_dict("records")
    lead = tb.load_bearing("lrb-example").lead
    assert lead is not None
    assert row["lead_degC"] == pytest.approx(result.hottest(0)["lead"])
    rates = lead.softening, softening_beyond_tests(lead)
    assert rates[0] == rates[1]
    fall = math.exp(-rates[0] * (row["lead_degC"] - 23.0))
    assert_allclose(row["Q_d_heated_kN"], fall * row["Q_d_kN"], rtol=2e-3)
    assert f"Q_d {row['Q_d_heated_kN']:.1f} instead of" in _links(result, lines)


def test_lead_has_a_second_block_when_warm_and_a_note_when_cold() -> None:
    """LRB at 23 and -20 degC: a link with the lead of the runs, and E_2 below T_0 = 20 degC."""
    result = tb.bridge("lrb-example", "jra-ii-i-1", [23, -20], duration=25)
    lines = line_properties(result)
    warm, cold = lines.to_dict("records")
    text = _links(result, lines)
    warm_text, cold_text = text.split("\n\n")[1:3]
    first, second = warm_text.split("  with the lead at ")
    assert second.startswith(f"{warm['lead_degC']:.1f} degC")
    assert "with the lead at 2" not in first
    assert "\n  with the lead" not in cold_text
    period = bridge_properties(result, lines)["effective_period_s"].iloc[0]
    stiffness, strength = warm["K_eff_heated_kN_mm"], warm["Q_d_heated_kN"]
    ratio = warm["K_d_kN_mm"] / warm["K_1_kN_mm"]
    loop = BilinearParameters(strength, warm["K_d_kN_mm"], warm["K_1_kN_mm"])
    displacement = warm["design_displacement_mm"]
    # The heated link is a bilinear loop too.
    assert_allclose(loop.stiffness(displacement), stiffness, rtol=1e-3)
    damping = loop.energy(displacement) / (2.0 * math.pi * stiffness * displacement**2)
    assert_allclose(warm["h_eff_heated"], damping, rtol=0.01)
    coefficient = 1e3 * warm["h_eff_heated"] * stiffness * period / math.pi
    for value in (1e3 * stiffness, coefficient, strength / (1.0 - ratio), ratio):
        assert re.search(rf" {re.escape(f'{value:.5g}')}( |$)", second, re.MULTILINE)
    lead = tb.load_bearing("lrb-example").lead
    assert lead is not None
    factor = math.exp(lead.softening * (20.0 + 20.0))
    assert f"Q_d is {factor:.2f} times that with the lead at 20 degC" in " ".join(cold_text.split())
    assert ("lead.softening" in cold["assumed"], "lead.softening" in warm["assumed"]) == (
        True,
        False,
    )
    assert "yield strength (assumed)" in cold_text


def test_upper_values_below_the_stiffness_of_a_run_say_so(pier: EarthquakeResult) -> None:
    """The motion with the smaller displacement is stiffer than the link of the larger one."""
    lines = line_properties(pier)
    layered = lines[lines["bearing"] == HDR]
    assert (layered["secant_kN_mm"] > 0).all()
    bound = 1.1 * layered["K_eff_kN_mm"]
    assert "of a run" in _links(pier, layered.assign(secant_kN_mm=bound))
    assert "of a run" not in _links(pier, layered.assign(secant_kN_mm=0.9 * bound / 1.1))


def test_borrowed_temperature_coefficients_are_named(pier: EarthquakeResult) -> None:
    sources = {COEFFICIENTS[0]: "compound a; borrowed from b; c", COEFFICIENTS[1]: "fitted"}
    case = {"bearings": [{"name": "x", "kind": "HDR"}], "sources": {"x": sources}}
    assert "of x borrowed from b. " in temperature_note(case)
    assert temperature_note(case | {"sources": {"x": {COEFFICIENTS[1]: "fitted"}}}) == ""
    assert temperature_note(tomllib.loads(pier.dataset.attrs["case"])) == ""  # measured


def test_links_over_scragged_rubber_say_how_to_get_virgin(pier: EarthquakeResult) -> None:
    lines = line_properties(pier)
    assert lines["excess"].tolist() == (lines["bearing"] == HDR).tolist()
    assert "--state virgin" in _links(pier, lines)
    assert "--state virgin" not in _links(pier, lines[lines["bearing"] == BILINEAR])


def test_a_report_has_tables_and_files(pier: EarthquakeResult) -> None:
    pieces = build_pieces(pier)
    assert len(pieces.tables["properties"].rows) == 5  # one of virgin rubber in the cold
    assert len(pieces.tables["bridge_properties"].rows) == 5
    assert set(pieces.files) == {"properties.csv", "links.txt", "links.csv"}
