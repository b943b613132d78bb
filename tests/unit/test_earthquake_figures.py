"""Figures of earthquake studies: what an engineer must be able to read off each of them."""

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from tests.unit.test_earthquake_components import two_piers

HDR, LHDR, BILINEAR = "shen-hdr-bridge", "shen-lhdr-bridge", "shen-bilinear-bridge"
MOTIONS = ["jra-ii-i-1", "jra-ii-ii-1"]


@pytest.fixture(scope="module")
def study() -> tb.EarthquakeResult:
    """Long enough for the strong part of both motions, with room before and after it."""
    return tb.bridge(
        [LHDR, BILINEAR], MOTIONS, [23, -20], duration=20, dt=0.01, keep=tb.Keep(every=1)
    )


def texts(ax: Axes) -> list[str]:
    return [text.get_text() for text in ax.texts]


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def long_lines(ax: Axes) -> list[Any]:
    return [line for line in ax.get_lines() if len(np.asarray(line.get_xdata())) > 2]


@pytest.mark.parametrize("name", quick_cases(["strain", "pier", "deck", "pier_acceleration"], 2))
def test_histories_show_the_strong_part_with_peaks(study: Any, name: str) -> None:
    figure = getattr(study.plot, name)()
    first, second = (figure.axes[k].get_xlim() for k in (0, 1))
    assert first != second  # a motion has its own time axis
    assert figure.axes[2].get_xlim() == first  # which its bearings share
    data = study.sel(motion=MOTIONS[0]).dataset
    time, ground = (data[k].values[0].astype(float) for k in ("time", "ground_acceleration"))
    inside = (time >= first[0]) & (time <= first[1])
    assert 0.9 <= (ground[inside] ** 2).sum() / (ground**2).sum() < 1.0
    assert first[0] > 1.0
    variable, factor = {
        "strain": ("bearing_strain", 100.0),
        "pier": ("pier_displacement", 1.0),
        "deck": ("deck_acceleration", 1.0),
        "pier_acceleration": ("pier_top_acceleration", 1.0),
    }[name]
    marks = [line for line in figure.axes[0].get_lines() if line.get_marker() == "o"]
    reported = study.dataset[f"{variable}_max"].values[:2]
    result = sorted(abs(float(mark.get_ydata()[0])) for mark in marks)
    assert_allclose(result, sorted(factor * reported), rtol=tol.HISTORY_DIGITS)
    assert all(first[0] < mark.get_xdata()[0] < first[1] for mark in marks)
    cold_to_warm = [f"{factor * value:.3g}" for value in reported[::-1]]
    assert [text for text in texts(figure.axes[0]) if text in cold_to_warm] == cold_to_warm[::-1]


def test_no_temperature_hides_another(study: Any) -> None:
    """The smallest is drawn last, and thinnest: those of a bilinear bearing are the same."""
    for ax in study.plot.strain().axes:
        lines = long_lines(ax)
        sizes = [float(np.abs(line.get_ydata()).max()) for line in lines]
        assert sizes == sorted(sizes, reverse=True)
        assert lines[0].get_linewidth() > 1.5 * lines[-1].get_linewidth()


def test_hinge_shows_its_yield_point_and_ductility(study: Any) -> None:
    figure = study.plot.hinge()
    axes = figure.axes
    assert "ductility" in figure.get_suptitle()
    hinge = tb.load_structure("pier-p1").hinges[0]
    for ax in axes:
        marks = [line for line in ax.get_lines() if line.get_marker() == "D"]
        assert_allclose([abs(mark.get_xdata()[0]) for mark in marks], 1e3 * hinge.yield_rotation)
        moment = hinge.yield_moment / 1e6
        assert_allclose([abs(mark.get_ydata()[0]) for mark in marks], moment, rtol=1e-5)
        assert ax.get_ylim()[1] > moment
    assert "stays elastic" in texts(axes[0])
    assert "stays elastic" not in texts(axes[1])  # ductility 12
    assert f"{float(study.dataset['pier_ductility'][0]):.3g}" in texts(axes[0])


def test_the_only_bearing_and_motion_stand_in_the_title(study: Any) -> None:
    one = study.sel(bearing=LHDR, motion=MOTIONS[0])
    for name, draw in one.plot.draw_all().items():
        figure = draw()
        words = {word for ax in figure.axes for word in (ax.get_title(), *texts(ax))}
        assert not {LHDR, MOTIONS[0]} & words, name
        title = figure.get_suptitle().replace("\n", "")
        assert all(word in title for word in (LHDR, MOTIONS[0])), name
    assert one.plot.deck().axes[0].get_ylabel() == "acceleration [m/s²]"


def test_paths_fill_their_panels() -> None:
    pair = {"name": MOTIONS[0], "across": "jra-ii-i-2"}
    figure = tb.bridge(LHDR, pair, 23, structure=two_piers(), duration=4).plot.orbit()
    figure.canvas.draw()
    assert len({round(ax.get_position().y0, 3) for ax in figure.axes}) == 1  # side by side
    for ax, what in zip(figure.axes, ("displacement", "force"), strict=True):
        assert what in ax.get_xlabel()
        path = np.array(long_lines(ax)[-1].get_xydata())
        assert np.ptp(ax.get_xlim()) < 1.5 * np.ptp(path, axis=0).max()


def test_rises_have_no_empty_panel_and_lead_its_own(study: Any) -> None:
    figure = study.plot.temperature()
    assert len(figure.axes) == 4  # rubber and lead of the LHDR bearing, none of the bilinear one
    rises = study.rises(0)
    rubber, lead = figure.axes[0], figure.axes[2]
    sides = [texts(figure.axes[1])[0], texts(figure.axes[3])[0]]
    assert sides == [f"{LHDR}\nrubber", f"{LHDR}\nlead"]
    assert [ax.get_title() for ax in figure.axes] == [*MOTIONS, "", ""]
    tops = [
        max(float(np.max(line.get_ydata())) for line in long_lines(ax)) for ax in (rubber, lead)
    ]
    assert_allclose(tops[1], rises["lead"], rtol=tol.HISTORY_DIGITS)
    assert tops[0] < 0.5 * tops[1]
    assert all(float(line.get_ydata()[0]) == 0.0 for line in long_lines(rubber))


def test_shares_are_named_right_and_of_the_largest_loop(study: Any) -> None:
    figure = study.plot.shares()
    assert figure.axes[-1].get_xlabel() == "displacement [mm]"
    assert {"lead cores", "bilinear: yielding part", "total force"} <= set(legend(figure))
    only = study.sel(bearing=BILINEAR).plot.shares()
    assert "lead cores" not in legend(only)
    loop = study.largest_loops.loc[2 * len(MOTIONS)]
    whole = long_lines(only.axes[1])[0]
    assert np.max(whole.get_ydata()) == pytest.approx(loop["F_plus_kN"], rel=tol.HISTORY_DIGITS)
    assert np.abs(whole.get_xdata()[[0, -1]]).max() < 0.1 * loop["D_plus_mm"]


def test_peaks_have_a_mark_a_motion_a_mean_and_limits(study: Any) -> None:
    figure = study.plot.peaks()
    assert legend(figure) == [*MOTIONS, "mean"]
    table = study.table
    marks = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) == 1]
    mine = table[table["bearing"] == LHDR].sort_values("ambient_degC", kind="stable")
    expected = 100.0 * mine["bearing_strain_max"].to_numpy()
    assert_allclose([line.get_ydata()[0] for line in marks], expected)
    means = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) == 2]
    assert means[0].get_ydata()[0] == pytest.approx(expected[:2].mean())
    ductility = next(ax for ax in figure.axes if ax.get_ylabel() == "pier ductility")
    assert "yields" in texts(ductility)


def test_speed_is_drawn_in_the_time_of_the_laboratory() -> None:
    """A pseudo-dynamic test of 4 s lasts as long as its way takes at 10 mm/s."""
    short: Any = {"duration": 4.0, "keep": tb.Keep(every=1)}
    modes = {"mode": ["rt", "pd"]}
    lab = tb.hybrid("shen-lhdr-specimen", ambient=-20, laboratory=modes, **short)
    fast, slow = lab.plot.speed().axes
    assert slow.get_title(loc="left") == "shen-lhdr-specimen, pseudo-dynamic"
    assert fast.get_lines()[0].get_xdata()[-1] == pytest.approx(4.0)
    way = np.abs(np.diff(lab["bearing_displacement"].values[1])).sum()
    assert slow.get_lines()[0].get_xdata()[-1] >= way / 10.0 * (1.0 - tol.HISTORY_DIGITS)
    assert slow.get_xlabel() == "time in the laboratory [s]"
