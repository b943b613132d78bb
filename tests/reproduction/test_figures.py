"""The computed figures of Shen (2023): captions, and a drawing of each family."""

import io
import re

import numpy as np
import pytest
from matplotlib.figure import Figure

from reproduction.figures import COLUMNS, DETERMINED, LOOP, figure_words, load_figures
from reproduction.runs import LHDR, LHDR_BRIDGE, MOTIONS, Runs
from tests.quick import quick_cases
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.drawing import WIDEST

pytestmark = pytest.mark.drawn


FIGURES = load_figures()
COMPUTED = [
    *(f"3.{k}" for k in (*range(5, 13), *range(14, 30))),
    *(f"4.{k}" for k in (1, *range(7, 17))),
    *(f"5.{k}" for k in range(6, 22)),
    *(f"6.{k}" for k in (3, 4, 6, *range(8, 27))),
]
TESTS = [f"3.{k}" for k in (*range(7, 13), *range(15, 30))]  # the source shows measurements
FAMILIES = ("3.5", "3.14", "3.16", "3.25", "4.1", "4.13", "4.14", "5.10")
KEPT = 1e-3  # of a peak, in the kept half of the steps
WIDE = WIDEST + 1e-9


def hybrid_tests(runs: Runs, *words: str) -> EarthquakeResult:
    result: EarthquakeResult = figure_words(runs)["hybrid_tests"](*words)
    return result


def test_every_computed_figure_is_listed() -> None:
    assert list(FIGURES) == COMPUTED
    drawn = {name for row in FIGURES.values() for name in re.findall(r"draw_\w+", row.draw)}
    assert drawn == {name for name in figure_words(Runs()) if name.startswith("draw_")}
    assert FIGURES["3.7"].name == "fig_3_07"


@pytest.mark.parametrize("number", COMPUTED)
def test_a_caption_says_what_is_run_and_drawn(number: str) -> None:
    caption = FIGURES[number].caption
    assert caption.startswith(f"Fig. {number}: ")
    assert " Run: " in caption
    assert " Drawn: " in caption
    assert caption.endswith(".")
    assert ("Prediction" in caption) == (number in TESTS)


@pytest.mark.parametrize("number", quick_cases(FAMILIES, 0, 4))
def test_a_figure_is_drawn(runs: Runs, number: str) -> None:
    figure: Figure = FIGURES[number].figure(runs)
    figure.savefig(io.BytesIO(), dpi=30)
    assert figure.get_figwidth() <= WIDE
    for ax in figure.axes:
        lines = [np.asarray(line.get_ydata(), float) for line in ax.get_lines()]
        assert any(np.isfinite(values).any() for values in lines)


def test_both_modes_lie_over_each_other(runs: Runs) -> None:
    figure = FIGURES["3.19"].figure(runs)
    tests = hybrid_tests(runs, LHDR)
    table = tests.table
    for ax, ambient in zip(figure.axes, (-20.0, 0.0, 23.0), strict=True):
        real, slow = ax.get_lines()
        for line, mode in ((real, "rt"), (slow, "pd")):
            mine = table[(table["ambient_degC"] == ambient) & (table["mode"] == mode)]
            largest = 100.0 * mine["bearing_strain_max"].iloc[0]
            assert np.abs(line.get_ydata()).max() == pytest.approx(largest, rel=KEPT)
            assert any(text.get_text() == f"{largest:.3g}" for text in ax.texts)
        assert slow.get_linestyle() == "--"


def test_bars_are_the_numbers_of_the_table(runs: Runs) -> None:
    figure = FIGURES["6.20"].figure(runs)
    table = figure_words(runs)["bridge_tests"](LHDR_BRIDGE).table
    for ax, column in zip(figure.axes, ("pier_displacement_max_mm", "pier_ductility"), strict=True):
        for bars, ambient in zip(ax.containers, (23.0, 0.0, -20.0), strict=True):
            mine = table[table["ambient_degC"] == ambient].set_index("motion")[column]
            heights = [bar.get_height() for bar in bars.patches]
            assert heights == pytest.approx(list(mine.loc[list(MOTIONS)]))
    assert [text.get_text() for text in figure.axes[0].get_xticklabels()] == list(MOTIONS)
    assert any(text.get_text() == "yields" for text in figure.axes[1].texts)


def test_ratios_of_the_models(runs: Runs) -> None:
    figure = FIGURES["5.11"].figure(runs)
    layered, single = (
        hybrid_tests(runs, LHDR, "rt", model).largest_loops
        for model in ("multi-layer", "single-temperature")
    )
    cold = figure.axes[0].containers[0].patches
    run = layered.index[layered["ambient_degC"] == -20.0][0]
    for bar, column in zip(cold, LOOP.values(), strict=False):
        assert bar.get_height() == pytest.approx(single[column][run] / layered[column][run])
    assert [text.get_text() for text in figure.axes[0].get_xticklabels()] == [*LOOP, DETERMINED]
    assert 0.9 < cold[-1].get_height() < 1.0


@pytest.mark.thorough
def test_the_design_bearing_beside_the_layered_one(runs: Runs) -> None:
    figure = FIGURES["6.9"].figure(runs)
    assert len(figure.axes) == len(MOTIONS)
    assert len(MOTIONS) % COLUMNS == 0
    for ax in figure.axes:
        assert [line.get_linestyle() for line in ax.get_lines()] == ["-", "-", "-", "--"]


def test_the_bilinear_loop_has_its_stiffnesses(runs: Runs) -> None:
    printed = FIGURES["6.3"].figure(runs).axes[0].get_lines()[0]
    x, y = np.asarray(printed.get_xdata(), float), np.asarray(printed.get_ydata(), float)
    slopes = np.diff(y) / np.diff(x)
    assert slopes == pytest.approx([9.51, 1.81, 9.51, 1.81])
    assert np.interp(0.0, x[[3, 4]], y[[3, 4]]) == pytest.approx(125.4)
