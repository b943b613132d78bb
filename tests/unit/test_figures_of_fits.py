"""Figures of fits, factors and bounds: scales, bands, legends, verdicts."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests.quick import quick_cases
from tests.unit.made_up_study import HAZARD, ask, made_up
from tests.unit.test_figures import overlaps
from thermobearing.design.figures import DesignFigures
from thermobearing.design.run import run_bounds, run_factors
from thermobearing.identify.records.figures import RecordFigures, draw_record
from thermobearing.identify.uncertainty.bands import Band, Predicted
from thermobearing.identify.uncertainty.posterior import forecast
from thermobearing.results.figure_style import figure_style

pytestmark = pytest.mark.drawn


HDR = tb.load_bearing("shen-hdr-specimen")


@pytest.fixture(scope="module")
def fit() -> tb.Identification:
    """A warm test, and a cold one that is 5 % stronger than the law."""
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, rest=None)
    warm, cold = (tb.synthetic_record(HDR, ambient, test) for ambient in (23.0, -20.0))
    records = [warm, replace(cold, force=1.05 * cold.force)]
    return tb.identify_bearing(records, HDR, free=["K_r"], starts=1)


def test_loops_of_a_fit_have_one_force_scale(fit: tb.Identification) -> None:
    """The cold test is the stronger one, and looks it; the test is a band around the model."""
    warm, cold = fit.plot.loops().axes
    assert warm.get_ylim() == cold.get_ylim()
    assert warm.get_xlim() == cold.get_xlim()
    band, line = cold.get_lines()
    assert band.get_linewidth() > 3.0 * line.get_linewidth()
    assert np.max(band.get_ydata()) == fit.records[1].force.max()


def test_cycles_of_a_fit_are_absolute(fit: tb.Identification) -> None:
    modulus, _, energy, peak = fit.plot.cycles().axes
    assert energy.get_ylabel() == "energy [kJ = kN m]"
    assert peak.get_ylim()[0] == 0.0
    test, model = (np.asarray(line.get_ydata(), dtype=float) for line in peak.get_lines()[2:])
    assert np.nanmax(model) == fit.predictions[1].force.max()
    # The band is as far from the line as the title and the table say: noise does not raise it.
    drawn = np.asarray(modulus.get_lines()[0].get_ydata(), dtype=float)
    line = np.asarray(modulus.get_lines()[1].get_ydata(), dtype=float)
    reported = [cycle.errors["G_eq_error"] for cycle in fit.fits[0].loops]
    assert (line / drawn - 1.0)[np.isfinite(line)] == pytest.approx(reported, abs=1e-12)
    assert np.nanmax(test) == pytest.approx(fit.records[1].force.max(), rel=0.07)
    errors = [cycle.errors["energy_error"] for one in fit.fits for cycle in one.loops]
    text = f"model error {100.0 * min(errors):+.1f} to {100.0 * max(errors):+.1f} %"
    assert text.replace("-", "−") in energy.get_title(loc="left")


@pytest.mark.thorough
def test_a_band_lies_around_the_loops(fit: tb.Identification) -> None:
    band = forecast(fit, [-30.0]).bands[0]
    loops, turns = fit.plot.band(band).axes
    tops = [path.vertices[:, 1].max() for c in loops.collections for path in c.get_paths()]
    assert max(tops) == pytest.approx(band.upper.max())
    (dots,) = turns.get_lines()
    assert np.max(dots.get_ydata()) == pytest.approx(band.peak, rel=0.01)
    assert len(dots.get_xdata()) >= 8  # two to each side at each of two strains
    inside, outside = (
        fit.plot.band(item).legends[0].get_texts()[0].get_text()
        for item in (forecast(fit, [0.0], narrow=False).bands[0], band)
    )
    assert (inside, outside) == (
        "95 % band (parameters only)",
        "95 % band (parameters and extrapolation)",
    )


@pytest.mark.parametrize("after", [0.1, 0.4, 0.6, 0.9])
def test_forces_at_reversals_are_those_before_the_turn(
    fit: tb.Identification, after: float
) -> None:
    """Steps that straddle a turn: the sample after it may be the farthest, where the force drops.

    Each leg ends 29.7 mm out, with a force of 100 kN, of which a step takes 80 kN in the next leg.
    """
    tip, step = 29.7, 1.0
    distance = np.arange(after - 2.0, 8.0 * tip, step)  # of the motion: half a leg, then legs
    distance = np.maximum(distance, 0.0)
    leg = ((distance + tip) // (2.0 * tip)).astype(int)
    along = (distance + tip) % (2.0 * tip)  # since the last turn
    side = np.where(leg % 2 == 0, 1.0, -1.0)
    x = side * (along - tip)
    force = side * np.where(leg > 0, np.minimum(-100.0 + 160.0 * along, 50.0 + along), 50.0 + along)
    force *= 100.0 / (50.0 + 2.0 * tip)
    predicted = (Predicted("force", 100.0, 90.0, 110.0),)
    band = Band(-30.0, x, force, 0.9 * force, 1.1 * force, predicted)
    figure = fit.plot.band(band)
    (dots,) = figure.axes[1].get_lines()
    heights = np.asarray(dots.get_ydata(), dtype=float)
    assert len(heights) == 4
    assert heights == pytest.approx(100.0, abs=1.0)  # within a step of the end of the leg
    (ends,) = figure.axes[1].collections
    spans = [path.vertices[:, 1] for path in ends.get_paths()]
    assert np.array(spans) == pytest.approx(np.outer(heights, [0.9, 1.1]))


def design_of_two_groups() -> DesignFigures:
    """Two rounds for each of two groups, and a loop of two bearings for each."""
    x = np.array([-200.0, 200.0, -200.0])
    names = ("G8-650-9x14-1 (bilinear)", "hdr-530-7x17")
    groups = ("stiff pier", "on A")
    assumed = ((200.0, 199.4), (199.4, 200.4))
    rounds = [
        SimpleNamespace(
            group=group,
            found=b,
            row=lambda n=n, a=a, b=b: {"round": n, "u_B_assumed_mm": a, "u_found_mm": b},
        )
        for group in groups
        for n, (a, b) in enumerate(assumed, 1)
    ]
    design: Any = SimpleNamespace(
        case=SimpleNamespace(structure=SimpleNamespace(name="two piers")),
        rounds=rounds,
        taken=rounds[1::2],
        bearings=[HDR, HDR],
        loops={group: {name: (x, 2.5 * x) for name in names} for group in groups},
    )
    return DesignFigures(design)


def study() -> Any:
    part = made_up().parts()["shen-hdr-bridge"]
    return ask(part, np.linspace(-20.0, 23.0, 50), capacity=1.0, hazard=HAZARD).plot


WIDTHS = ["single-column", pytest.param("double-column", marks=pytest.mark.thorough)]


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize(
    "kind", quick_cases(["calibration", "check", "design", "study", "bounds"], 1)
)
def test_figures_of_a_paper_have_no_overlaps(kind: str, width: str, fit: tb.Identification) -> None:
    known: dict[str, Callable[[], Any]] = {
        "calibration": lambda: fit.with_forecast(forecast(fit, [-30.0])).plot,
        "check": lambda: RecordFigures({"check": lambda: draw_record(fit.checks[0])}),
        "design": design_of_two_groups,
        "study": study,
        "bounds": lambda: run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0]).plot,
    }
    wide = {"single-column": 90.0, "double-column": 190.0}[width]
    with figure_style({"width": width}):
        for name, draw in known[kind]().draw_all().items():
            figure = draw()
            assert overlaps(figure) == [], name
            assert figure.get_figwidth() * 25.4 == pytest.approx(wide), name
            panels = [ax for ax in figure.axes if ax.get_visible()]
            assert min(ax.get_window_extent().height for ax in panels) > 0.4 * figure.dpi, name


def test_factors_have_one_legend_outside() -> None:
    report = run_factors(["shen-hdr-specimen"], temperatures=[-20.0], strains=[1.0])
    figure = report.plot.factors()
    *panels, free = figure.axes
    assert figure.axes[0].get_subplotspec().get_gridspec().get_geometry() == (2, 3)
    assert [ax.get_legend() for ax in panels] == [None] * 5
    assert len({ax.get_xlim() for ax in panels}) == 1
    named = [text.get_text() for text in free.get_legend().get_texts()]
    assert {"first cycle", "Toyo G0.35, design"} <= set(named)


def test_bounds_show_every_dot_and_the_verdict() -> None:
    """No dot on the frame; bounds by the bearing they come from; unsafe ones in red."""
    report = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0])
    table = report.studies["shen-hdr-bridge"].set_index("demand")
    for ax, demand in zip(report.plot.demands("shen-hdr-bridge").axes, table.index, strict=True):
        row = table.loc[demand]
        assert ax.get_ylim()[1] > 1.05 * max(row["coupled_max"], row["upper_bound"])
        ratio = ax.texts[0]
        assert ratio.get_text() == f"{row['envelope_over_coupled']:.2f}"
        assert (ratio.get_color() == "#aa0000") == (row["verdict"] == "unsafe")
