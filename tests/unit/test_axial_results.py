"""What an analysis with axial forces shows: figure, warnings, and where results end."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.verification.test_vertical import _case
from thermobearing.cyclic.tables import ratio_table
from thermobearing.earthquake.axial import axial_forces_change, governing_axial_line, valid_until
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.run import run_earthquake
from thermobearing.earthquake.tables import governing_runs
from thermobearing.live.report import live_section
from thermobearing.model.options import build_model
from thermobearing.quantities.tables import make_table
from thermobearing.quantities.validity import NOTE, VALID_UNTIL, with_invalid_marked
from thermobearing.report.html import SEE_NOTE
from thermobearing.results.screen import shown_warnings

UNSTABLE_LOAD = "10500 kN"


@pytest.fixture(scope="module")
def results():
    """A pier with light dead loads, and one whose bearings become unstable."""
    return {
        "light": run_earthquake(_case("vertical", dead_load="400 kN")),
        "dowelled": run_earthquake(_case("vertical", dead_load="400 kN", joint="dowelled")),
        "unstable": run_earthquake(_case("overturning", dead_load=UNSTABLE_LOAD)),
        "dead": run_earthquake(_case("dead")),
    }


def _labels(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def _line(ax, value):
    """The line of a panel with a value at its start, or None."""
    matches = [line for line in ax.lines if line.get_ydata()[0] == pytest.approx(value, rel=1e-6)]
    return matches[0] if matches else None


def test_figure_of_axial_forces(results):
    figure = results["light"].plot.axial_forces()
    (ax,) = figure.axes
    bearings = [f"bearing {number}" for number in range(1, 6)]
    assert _labels(figure) == [*bearings, "no axial force", "cavitation, 3 G A"]
    data = results["light"].dataset.isel(run=0)
    forces = data["axial_force"].values
    drawn = [line for line in ax.lines if line.get_ydata()[0] == pytest.approx(400.0)]
    assert [line.get_ydata().min() for line in drawn] == pytest.approx(forces.min(axis=0).tolist())
    strength = data["cavitation_force"].values[:, 0]
    assert _line(ax, -float(strength[0])) is not None
    low, high = ax.get_xlim()
    least = float(data["time"].values[forces.min(axis=1).argmin()])
    assert low <= least <= high
    least_limit = f"at least {float(data['critical_load'].min()):.0f} kN"
    assert any(least_limit in text.get_text() for text in ax.texts)
    assert "G1-G5" in figure.get_suptitle()


def test_figure_of_dowelled_and_unstable_bearings(results):
    assert "cavitation, 3 G A" not in _labels(results["dowelled"].plot.axial_forces())
    assert np.isnan(results["dowelled"]["cavitation_force"].values).all()
    figure = results["unstable"].plot.axial_forces()
    assert {"critical load", "no results: unstable"} <= set(_labels(figure))
    (first,) = valid_until(results["unstable"])
    assert figure.axes[0].patches[0].get_x() == pytest.approx(first)


def test_figure_is_drawn_where_axial_forces_change(results):
    drawn = {name: set(result.plot.draw_all()) for name, result in results.items()}
    assert {name for name, figures in drawn.items() if "axial_forces" in figures} == {
        "light",
        "dowelled",
        "unstable",
    }
    assert not axial_forces_change(results["dead"].dataset)
    with pytest.raises(tb.InputError, match=r"analysis\.axial"):
        results["dead"].plot.axial_forces()
    with pytest.raises(tb.InputError, match="G1-G5"):
        results["light"].plot.axial_forces(line="G1-G6")
    assert governing_axial_line(results["light"]) == "G1-G5"


def test_cavitation_force_is_three_times_shear_modulus_and_area(results):
    """By hand at the start, from the secant modulus at 100 % strain at the ambient temperature."""
    data = results["light"].dataset.isel(run=0)
    bearing = tb.load_bearing("lrb-example")
    rubber, law = build_model(bearing).constants.rubber, bearing.hysteresis
    geometry, change = bearing.geometry, -10.0 - rubber.reference_temperature
    share = (1.0 + law.hardening) * law.yield_displacement / geometry.rubber_thickness
    secant = rubber.elastic_stiffness * np.exp(rubber.elastic_exponent * change)
    secant += share * rubber.hysteretic_stiffness * np.exp(rubber.hysteretic_exponent * change)
    net_area = np.pi / 4.0 * (geometry.plan.diameter**2 - bearing.lead.diameter**2)
    modulus = secant * geometry.rubber_thickness / net_area
    start = float(data["cavitation_force"].values[0, 0])
    assert start == pytest.approx(3.0 * modulus * net_area, rel=1e-6)


def test_results_end_where_a_bearing_becomes_unstable(results):
    unstable, light = results["unstable"], results["light"]
    row = unstable.axial.iloc[0]
    share = unstable["axial_force"].values[0] / unstable["critical_load"].values[0]
    above = unstable["time"].values[0][(share > 1.0).any(axis=1)]
    kept = float(unstable["time"].values[0, 1])
    assert 0.0 <= float(above[0]) - row["axial_first_s"] < kept
    assert unstable.table["valid_until_s"].tolist() == [row["axial_first_s"]]
    assert "valid_until_s" not in light.table
    assert np.isnan(valid_until(light)).all()
    peaks = unstable.tables()["peaks"]
    assert "valid_until_s" in [column.name for column in peaks.columns]
    # The run reaches its end: its checks are those of all steps.
    assert unstable["time"].values[0, -1] == pytest.approx(11.0)
    assert not any("until then only" in text for text in unstable.warnings)


def test_instability_is_the_first_warning_on_the_screen(results):
    """After it, the numbers cannot be used; that the dead loads are unusual comes later."""
    shown = shown_warnings(results["unstable"].warnings, most=20)
    assert "unstable" in shown[0]
    assert any("dead loads of the bearing lines" in text for text in shown[1:])


def test_warnings_on_dead_loads_and_steps(results):
    def _count(result, words):
        return sum(words in text for text in result.warnings)

    assert _count(results["light"], "dead loads of the bearing lines are 2000 kN") == 1
    balanced = run_earthquake(_case("vertical", dead_load="800 kN"))  # of 3923 kN on five bearings
    assert _count(balanced, "dead loads") == 0
    # Light loads have a short vertical period, which the step does not resolve.
    assert _count(results["light"], "vertical period") == 1
    assert _count(results["unstable"], "vertical period") == 0  # which does not move vertically
    heavy = run_earthquake(_case("vertical", dead_load="800 kN", mass="4000 t"))
    assert _count(heavy, "vertical period") == 0


def test_saved_results_have_the_table_and_the_figure(results, tmp_path):
    folder = results["light"].save(tmp_path / "light", figures=False)
    table = pd.read_csv(folder / "axial.csv")
    assert table["axial_force_min_kN"].tolist() == pytest.approx(
        results["light"].axial["axial_force_min_kN"].tolist()
    )
    assert "axial_forces" in tb.load_result(folder).plot.draw_all()
    pieces = build_pieces(tb.load_result(folder))
    assert "cavitates" in pieces.figures["axial_forces"].caption


def test_a_warning_before_a_limit():
    """Of a bearing that comes within a fifth of its critical load, and not of one farther off."""
    near, far = (run_earthquake(_case("dead", dead_load=load)) for load in ("9000 kN", "6000 kN"))
    assert near.outcome == far.outcome == "completed"
    share = near.axial["critical_share"].iloc[0]
    assert 0.8 < share < 1.0
    assert far.axial["critical_share"].iloc[0] < 0.8
    texts = [
        [text for text in result.warnings if "of its critical load at" in text]
        for result in (near, far)
    ]
    assert [len(sentences) for sentences in texts] == [1, 0]
    assert f"{share:.2f}" in texts[0][0]


def _marked(table):
    return {table.columns[place].name for _, place in table.marked}


def test_all_tables_mark_what_an_unstable_run_gives(results):
    """Force and displacement after the critical load was exceeded are not quoted as results."""
    tables, light = results["unstable"].tables(), results["light"].tables()
    assert {"bearing_strain_max", "bearing_force_max_kN"} <= _marked(tables["peaks"])
    assert tables["peaks"].note.startswith(NOTE)
    assert NOTE not in light["peaks"].note
    pieces = build_pieces(results["unstable"])
    assert pieces.answer[0].startswith("The analysis passed a limit in 1 run")
    assert any("unstable: no result" in sentence for sentence in pieces.answer)


def test_parts_and_the_largest_of_all_are_marked():
    """A structure with several lines, one analysis of which is unstable."""
    lines = pd.DataFrame(
        {"line": ["A1", "P1"], "strain_max": [1.0, 2.0], VALID_UNTIL: [np.nan, 3.0]}
    )
    table = make_table(lines, ["line", "strain_max"], "Lines")
    marked = with_invalid_marked(table, lines, ["strain_max", "absent"])
    assert marked.marked == {(1, 1)}
    assert marked.note == NOTE
    assert with_invalid_marked(table, lines.drop(columns=VALID_UNTIL), ["strain_max"]) == table


def test_the_largest_of_all_are_those_of_stable_runs():
    runs = pd.DataFrame(
        {
            "bearing": ["a", "a", "b"],
            "motion": ["m1", "m2", "m1"],
            "ambient_degC": 23.0,
            "bearing_strain_max": [9.0, 1.5, 7.0],
            VALID_UNTIL: [2.0, np.nan, 3.0],
        }
    )
    empty = pd.DataFrame()
    largest = governing_runs(SimpleNamespace(table=runs, lines=empty, piers=empty))
    assert largest["largest"].tolist() == [1.5, 7.0]  # of b there is no other
    assert largest[VALID_UNTIL].tolist()[1] == 3.0
    assert np.isnan(largest[VALID_UNTIL].tolist()[0])


@pytest.fixture(scope="module")
def cyclic():
    """Cycles of growing strain, of which the last exceeds the critical load."""
    bearing = tb.new_bearing("slender", "shen-hdr", plan="350x350mm", layers="8x17mm", shim="4 mm")
    test = tb.cyclic_test(strain=[0.5, 1.5], cycles=2, rest=60, dt=0.02)
    return tb.run(bearing, test, ambient=[23.0, -20.0], axial_force=1400.0, axial="constant")


def test_cycles_after_instability_are_marked(cyclic, tmp_path):
    data = cyclic.dataset
    above = data["axial_force"].values[0] > data["critical_load"].values[0]
    first = float(cyclic.time(0)[above.argmax()])
    cycles = cyclic.cycles[cyclic.cycles["ambient_degC"] == 23.0]
    assert cycles[VALID_UNTIL].isna().tolist() == [True, True, False, False]
    assert cycles[VALID_UNTIL].iloc[-1] == first
    assert list(data["outcome"].values) == ["unstable", "completed"]
    table = cyclic.tables()["cycles"]
    assert {"G_eq_MPa", "h_eq", "peak_force_kN"} <= _marked(table)
    assert {row for row, _ in table.marked if _ >= 3} >= {2, 3}
    again = tb.load_result(cyclic.save(tmp_path / "cyclic", figures=False))
    assert again.cycles[VALID_UNTIL].equals(cyclic.cycles[VALID_UNTIL])
    assert (tmp_path / "cyclic" / "summary.json").read_text().count(VALID_UNTIL) == 8
    ratios = ratio_table(cyclic)
    assert {row for row, _ in ratios.marked} == {1}


def test_no_live_section_computes_without_axial_forces(cyclic, results):
    """The engine of pages has none, so that its numbers would contradict the report."""
    assert live_section(cyclic) is None
    assert all(live_section(result) is None for result in results.values())


def test_pages_name_the_mark_of_unstable_runs(cyclic, tmp_path):
    (page,) = tb.make_report(cyclic, tmp_path, pdf=False)
    text = page.read_text(encoding="utf-8")
    assert SEE_NOTE in text
    assert "unstable: no result" in text
