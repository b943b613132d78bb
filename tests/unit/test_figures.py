"""Figures: axes with units, the right panels and lines, and results that lack something."""

import pickle
import struct
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.conftest import COARSE
from thermobearing.cyclic.figures import NothingToDrawError, TimeAxis
from thermobearing.results import drawing
from thermobearing.results.drawing import ambient_colours, thin, thin_loops
from thermobearing.results.figure_style import COLUMNS, SMALLEST, figure_style

pytestmark = pytest.mark.drawn


BEARING = "shen-hdr-specimen"
NAMES = ["imposed_displacement", "loops", "measures", "layer_temperatures", "profiles"]
NAMES += ["energy_balance"]
PNG = b"\x89PNG\r\n\x1a\n"
TEMPERATURES = [-20.0, 0.0, 23.0]


def steps(*given: dict[str, object]) -> tb.CyclicTest:
    return tb.CyclicTest.model_validate({"name": "test", "dt": "0.02 s", "steps": list(given)})


@pytest.fixture(scope="module")
def result() -> tb.Result:
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=3, dt=0.02)
    return tb.run(BEARING, test, ambient=TEMPERATURES)


def labels(ax: Axes) -> tuple[str, str]:
    return ax.get_xlabel(), ax.get_ylabel()


def titles(figure: Figure) -> list[str]:
    return [ax.get_title(loc="left").replace("\n", " ") for ax in figure.axes]


def shown(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def drawn(ax: Axes) -> list[np.ndarray]:
    """Ordinates of the lines of a panel that are not straight reference lines."""
    return [np.asarray(y) for line in ax.get_lines() if len(y := line.get_ydata(orig=True)) > 2]


def drawn_names(result: tb.Result) -> list[str]:
    """Names of all figures that can be drawn; they are drawn, but not written."""
    return [name for name, draw in result.plot.draw_all().items() if draw().axes]


@pytest.mark.thorough
def test_save_all_writes_six_png(result: tb.Result, tmp_path: Path) -> None:
    files = result.plot.save_all(tmp_path / "new" / "figures")
    assert [file.stem for file in files] == NAMES
    for file in files:
        head = file.read_bytes()[:24]
        width, height = struct.unpack(">II", head[16:])
        assert head[:8] == PNG
        assert width > 5 * COARSE
        assert height > 2.5 * COARSE


def test_displacement_cuts_the_rest_out(result: tb.Result) -> None:
    figure = result.plot.displacement()
    ax = figure.axes[0]
    assert "[s]" in ax.get_xlabel()
    assert ax.get_ylabel() == "shear displacement [mm]"
    assert ax.child_axes[0].get_ylabel() == "shear strain [%]"
    line = ax.get_lines()[0]
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert np.nanmax(y) == 30.0
    assert np.nanmin(y) == -30.0
    assert np.nanmax(x) < 30.0  # 6.4 s and 12.4 s of loading and a gap, not 4500 s
    texts = [text.get_text() for text in ax.texts]
    assert "1.25 h rest" in texts
    assert {"50 %", "100 %"} <= set(texts)
    figure.draw_without_rendering()
    low, high = ax.get_ylim()
    assert ax.child_axes[0].get_ylim() == pytest.approx((low / 0.3, high / 0.3))


@pytest.mark.parametrize("count", [1, 5])
def test_loops_have_a_panel_per_temperature(count: int) -> None:
    ambient = [-30.0, -20.0, 0.0, 10.0, 23.0][:count]
    figure = tb.run(BEARING, tb.cyclic_test(strain=[1.0], cycles=1, dt=0.02), ambient).plot.loops()
    assert len(figure.axes) == count
    assert titles(figure)[0] == "ambient −30 °C (outside calibration range)"
    assert labels(figure.axes[0])[1] == "shear stress [MPa]"
    assert labels(figure.axes[-1])[0] == "shear strain [%]"
    limits = {(ax.get_xlim(), ax.get_ylim()) for ax in figure.axes}
    assert len(limits) == 1
    assert len({ax.get_lines()[0].get_color() for ax in figure.axes}) == count


def test_loops_reach_the_peaks(result: tb.Result) -> None:
    for run, ax in enumerate(result.plot.loops().axes):
        line = ax.get_lines()[0]
        stress = result["stress"].values[run]
        assert np.nanmax(line.get_xdata()) == 100.0
        assert np.nanmax(line.get_ydata()) == stress.max()
        assert np.nanmin(line.get_ydata()) == stress.min()


def test_closing_cycles_are_grey_lines_of_their_own_size() -> None:
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=1, closing_strain=0.2, dt=0.02)
    figure = tb.run(BEARING, test, [23.0]).plot.loops()
    (ax,) = figure.axes
    ((loops, closing), zeros) = ax.get_lines()[:2], ax.get_lines()[2:]
    assert len(zeros) == 2
    assert closing.get_color() == drawing.GREY
    x = closing.get_xdata()
    assert np.count_nonzero(np.isnan(x)) == 2  # one after each loading
    assert (np.nanmin(x), np.nanmax(x)) == (-20.0, 20.0)
    assert np.nanmax(loops.get_xdata()) == 100.0
    (label,) = shown(figure)
    assert "20 %" in label
    without = tb.cyclic_test(strain=[0.5], cycles=1, closing_strain=None, dt=0.02)
    assert not tb.run(BEARING, without, [23.0]).plot.loops().legends


def test_measures_draw_cycles_by_temperature(result: tb.Result) -> None:
    figure = result.plot.measures()
    left, right = figure.axes
    assert labels(left) == ("amplitude of the shear strain [%]", "equivalent shear modulus [MPa]")
    assert labels(right)[1] == "equivalent damping ratio"
    assert len(left.get_lines()) == len(right.get_lines()) == 9
    assert shown(figure)[3:] == ["cycle 1", "cycle 2", "cycle 3"]
    table = result.cycles
    first = table[(table["ambient_degC"] == -20) & (table["cycle"] == 1)]
    np.testing.assert_array_equal(left.get_lines()[0].get_ydata(), first["G_eq_MPa"])
    np.testing.assert_array_equal(left.get_lines()[0].get_xdata(), [50.0, 100.0])


@pytest.mark.parametrize(("cycles", "expected"), [(1, [1]), (4, [1, 2, 4]), (7, [1, 2, 5])])
def test_measures_take_the_cycles_there_are(cycles: int, expected: list[int]) -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=cycles, dt=0.02)
    figure = tb.run(BEARING, test).plot.measures()
    assert shown(figure)[1:] == [f"cycle {n}" for n in expected]


def test_layer_temperatures(result: tb.Result) -> None:
    figure = result.plot.layer_temperatures()
    assert titles(figure) == ["ambient −20 °C", "ambient 0 °C", "ambient 23 °C"]
    assert all(ax.get_ylabel() == "rubber temperature [°C]" for ax in figure.axes)
    assert "[s]" in figure.axes[-1].get_xlabel()
    assert shown(figure) == ["layer 1 (outermost)", "layer 2", "layer 3 (innermost)", "ambient"]
    spans = [np.ptp(ax.get_ylim()) for ax in figure.axes]
    np.testing.assert_allclose(spans, spans[0])
    for run, ax in enumerate(figure.axes):
        lines = drawn(ax)
        assert len(lines) == 3
        for layer, line in enumerate(lines):
            values = result["rubber_temperature"].values[run, :, layer]
            assert np.nanmax(line) == values.max()
            assert line[-2] == values[-1]  # the last point before the closing NaN


def test_profiles_are_those_at_the_end_of_the_cycles(result: tb.Result) -> None:
    figure = result.plot.profiles()
    assert labels(figure.axes[0]) == ("temperature [°C]", "distance from the upper face [mm]")
    assert shown(figure) == ["50 %", "100 %", "ambient"]
    low, high = figure.axes[0].get_ylim()
    assert low > 48.0 > 0.0 > high  # the upper face on top
    segment = result["segment"].values[0]
    for run, ax in enumerate(figure.axes):
        lines = [line for line in ax.get_lines() if line.get_marker() != "None"]
        assert len(lines) == 2
        for line, number in zip(lines, (0, 3), strict=True):
            row = np.flatnonzero(segment == number)[-1]
            np.testing.assert_array_equal(line.get_xdata(), result["temperature"].values[run, row])
        assert "plane of symmetry" in [text.get_text() for text in ax.texts]


def test_layers_are_drawn_at_their_last_peak() -> None:
    """Half the layers make half of the displacement; the outer one, the coldest, the least."""
    test = tb.cyclic_test(strain=[0.5, 2.0], cycles=2, rest=None, dt=0.02)
    keep = ["rubber", "layer_displacement"]
    actual = tb.run("shen-hdr-specimen", test, [-20.0, 23.0], keep=keep)
    figure = actual.plot.layer_shear()
    lines = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) == 3]
    small, large = (np.asarray(line.get_xdata()) for line in lines[:2])
    assert_allclose([small.sum(), large.sum()], [7.5, 30.0], rtol=1e-6)
    assert large[0] < min(large[1:])
    peaks = np.flatnonzero(np.abs(actual["displacement"].values[0]) > 60.0 - 1e-6)
    layers = np.abs(actual["layer_displacement"].values[0])
    assert_allclose(large, layers[peaks[-1]])
    assert np.abs(large - layers[peaks[0]]).max() > 0.01
    # 25 mm of end plate, 5 mm layers, 3.2 mm shims.
    assert_allclose(lines[0].get_ydata(), [27.5, 35.7, 43.9])
    with pytest.raises(tb.InputError, match="layer_displacement"):
        tb.run("shen-hdr-specimen", test).plot.layer_shear()


def test_energy_gives_the_residual(result: tb.Result) -> None:
    figure = result.plot.energy()
    assert all(ax.get_ylabel() == "energy [kJ = kN m]" for ax in figure.axes)
    assert all(len(drawn(ax)) == 6 for ax in figure.axes)
    assert len(set(shown(figure))) == 6
    assert "thermal" in titles(figure)[0]
    assert "%" not in titles(figure)[0]
    work = drawn(figure.axes[0])[0]
    assert np.nanmax(work) == pytest.approx(result["work_in"].values[0].max() / 1000.0)
    test = tb.cyclic_test(strain=[1.0], cycles=2, dt=0.02)
    lossy = tb.run(BEARING, test, -20, model=tb.ModelOptions(scheme="published"))
    expected = 100.0 * lossy.energy["thermal_residual"][0]
    assert f"thermal {expected:.2g} %".replace("-", "−") in titles(lossy.plot.energy())[0]


def test_full_stack_shows_the_whole_height() -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.02)
    result = tb.run(BEARING, test, model=tb.ModelOptions(lower_face=tb.EndFace(film=5.0)))
    figure = result.plot.profiles()
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert {"upper face", "lower face", "rubber 6"} <= set(texts)
    assert figure.axes[0].get_ylim()[0] > 96.0
    assert "layers 1 to 6 (lower face)" in shown(result.plot.layer_temperatures())
    assert drawn_names(result) == NAMES


def test_recorded_history_gives_points() -> None:
    time = np.arange(0.0, 8.0, 0.02)
    displacement = 30.0 * np.sin(np.pi * time) * np.sin(np.pi * time / 8.0)
    result = tb.run(BEARING, (time, displacement), [-20, 23])
    assert len(result.cycles) > 0
    figure = result.plot.measures()
    assert {line.get_linestyle() for line in figure.axes[0].get_lines()} == {"None"}
    assert shown(figure)[-1] == "every cycle"
    assert drawn_names(result) == NAMES


def test_ramp_has_no_measures() -> None:
    result = tb.run(BEARING, steps({"step": "ramp", "to_strain": 1, "speed": "10 mm/s"}), -20)
    with pytest.raises(NothingToDrawError, match="no closed cycle"):
        result.plot.measures()
    assert list(result.plot.draw_all()) == [name for name in NAMES if name != "measures"]
    assert shown(result.plot.profiles())[0] == "ramp to 30 mm"


def test_slow_ramps_are_reported_in_hours() -> None:
    slow = {"step": "ramp", "to": "30 mm", "duration": "10 h"}
    back = {"step": "ramp", "to": "0 mm", "duration": "10 h"}
    result = tb.run(BEARING, steps(slow, {"step": "rest", "duration": "5 h"}, back), dt=10.0)
    assert "[h]" in result.plot.displacement().axes[0].get_xlabel()


def test_rest_only_is_drawn_to_scale() -> None:
    result = tb.run(BEARING, steps({"step": "rest", "duration": "5 h"}), -20, initial=20)
    assert result.plot.layer_temperatures().axes[0].get_xlabel() == "time [min]"
    without = ("loops", "measures")
    assert list(result.plot.draw_all()) == [name for name in NAMES if name not in without]


def test_what_was_not_kept_is_skipped() -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.02)
    result = tb.run(BEARING, test, keep=[])
    with pytest.raises(NothingToDrawError, match=r'keep=\["cells"'):
        result.plot.profiles()
    with pytest.raises(NothingToDrawError, match=r'keep=\["rubber"'):
        result.plot.layer_temperatures()
    held = ["imposed_displacement", "loops", "measures", "energy_balance"]
    assert list(result.plot.draw_all()) == held


def test_unequal_clocks() -> None:
    cycle = {"step": "cycles", "strain": 1, "speed": "30 mm/s", "count": 2}
    result = tb.run(BEARING, steps(cycle, {"step": "rest", "within": "0.5 K"}, cycle), [-20, 23])
    assert "clock" in result.dataset
    axis = TimeAxis(result)
    rest = axis.stretches[1]
    assert rest.shortest < rest.longest
    assert "–" in rest.label()
    for run in range(2):  # the second loading starts at the same place on the axis
        x, _ = axis.trace(run, result["displacement"].values[run])
        assert np.isclose(x, axis.stretches[2].left).any()
    assert drawn_names(result) == NAMES


def test_interrupted_run_is_drawn_as_far_as_it_got() -> None:
    def stop(done: int, _: int) -> None:
        if done > 2000:
            raise KeyboardInterrupt

    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, dt=0.01)
    result = tb.run(BEARING, test, TEMPERATURES, progress=stop)
    assert result.outcome == "interrupted"
    assert (result["segment"].values == -1).any()
    assert titles(result.plot.loops())[-1].endswith("(interrupted)")
    assert drawn_names(result) == NAMES


def test_shortened_rest_starts_to_scale_and_fills_its_room(result: tb.Result) -> None:
    axis = TimeAxis(result)
    rest = axis.stretches[1]
    assert rest.rest
    assert rest.shortened
    slope = (rest.place(np.array(1e-7)) - rest.left) / 1e-7
    assert float(slope) == pytest.approx(1.0)
    assert float(rest.place(np.array(rest.longest))) == pytest.approx(rest.right)


def test_thinning_keeps_ends_and_extremes() -> None:
    values = np.sin(np.linspace(0.0, 300.0, 100_001))
    values[41_234] = 5.0
    kept = thin(values, 100)
    assert len(kept) < 400
    assert kept[0] == 0
    assert kept[-1] == 100_000
    assert 41_234 in kept
    assert values[kept].min() == values.min()
    np.testing.assert_array_equal(thin(values[:150], 100), np.arange(150))


def test_thinned_loops_keep_their_turning_points() -> None:
    t = np.arange(200_001) * (2.0 * np.pi / 1000.0)
    x, y = np.sin(t), np.cos(t)
    kept = thin_loops(x, y, 2.0, 2.0)
    assert len(kept) < 70_000
    np.testing.assert_array_equal(np.sort(x[kept])[-100:], np.ones(100))


def test_colours_go_from_cold_to_warm() -> None:
    """Lighter with each temperature, and dark enough to be read on white paper."""
    cold, warm = ambient_colours(np.array([-20.0])), ambient_colours(np.array([40.0]))
    assert ambient_colours(np.array([23.0, -20.0])) == [*warm, *cold]
    colours = np.array([to_rgb(colour) for colour in ambient_colours(np.linspace(-40, 40, 12))])
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    luminance = linear @ [0.2126, 0.7152, 0.0722]  # sRGB, IEC 61966-2-1
    assert (np.diff(luminance) > 0.0).all()
    assert (1.05 / (luminance + 0.05) > 2.99).all()  # contrast of WCAG 2.2 with white


def test_long_history_stays_small() -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=250, dt=0.01)
    result = tb.run(BEARING, test, keep=["rubber"])
    assert result.dataset.sizes["time"] > 100_000
    for ax in result.plot.layer_temperatures().axes:
        assert all(len(line) <= 4100 for line in drawn(ax))


def test_lead_has_its_own_figures() -> None:
    result = tb.run("shen-lhdr-specimen", tb.cyclic_test(strain=[0.5, 1.0], cycles=2), [-20, 23])
    assert {"lead_temperature", "force_shares"} <= set(result.plot.draw_all())
    shares = result.plot.force_shares()
    assert len(shares.axes) == 4
    assert shares.axes[0].get_ylabel() == "force [kN]"
    profiles = result.plot.profiles().axes
    assert [ax.get_xlabel() for ax in profiles] == ["rubber and steel [°C]", "lead [°C]"] * 2
    assert profiles[0].get_xlim()[1] < result["temperature"].values[0].max() + 5.0  # lead is off it
    dashed = [line for line in profiles[1].get_lines() if str(line.get_linestyle()) != "-"]
    lead = [np.asarray(line.get_xdata(), dtype=float)[0] for line in dashed]
    assert len(lead) >= 3  # two cores and the ambient
    assert max(lead) > profiles[0].get_xlim()[1]


def test_no_lead_no_lead_figures(result: tb.Result) -> None:
    with pytest.raises(NothingToDrawError, match="no lead"):
        result.plot.force_shares()


def test_letters_without_a_font_give_one_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing, "_east_asian_fonts", list)

    def titled() -> Figure:
        figure, (ax,) = drawing.panels(1, 1, (3.0, 3.0), "\u6771\u4eac \ue123")
        ax.plot([0.0, 1.0])
        return figure

    with pytest.warns(drawing.MissingLettersWarning) as caught:
        drawing.save_figures({"a": titled, "b": titled}, tmp_path, vector=True)
    (one,) = caught
    assert {"\u6771", "\u4eac", "\ue123"} == one.message.letters  # type: ignore[union-attr]
    assert "\u4eac\u6771 (U+4EAC, U+6771, U+E123)" in str(one.message)
    assert "fonts-noto-cjk" in str(one.message)
    assert str(pickle.loads(pickle.dumps(one.message))) == str(one.message)  # of another process


def test_a_figure_without_data_is_not_written(tmp_path: Path) -> None:
    """Points and areas that are not numbers, and lines across a panel, are no data."""

    def drawn(*, data: bool) -> Figure:
        number = 1.0 if data else np.nan
        figure, axes = drawing.panels(1, 5, (9.0, 3.0), "title")
        axes[0].axhline(1.0)
        axes[1].plot([0.0, 1.0], [np.nan, number])
        axes[2].barh([0.0, 1.0], [np.nan, np.nan])
        axes[3].fill_between([0.0, 1.0], [0.0, 0.0], [np.nan, np.nan])
        axes[4].scatter([np.nan], [1.0])
        return figure

    with pytest.warns(drawing.EmptyFigureWarning, match="empty"):
        written = drawing.save_figures(
            {"empty": lambda: drawn(data=False), "full": lambda: drawn(data=True)}, tmp_path
        )
    assert [path.name for path in written] == ["full.png"]
    assert [path.name for path in tmp_path.iterdir()] == ["full.png"]
    for draw in ("barh", "scatter", "fill_between", "imshow"):
        figure, (ax,) = drawing.panels(1, 1, (3.0, 3.0), "")
        words = {"imshow": [[[1.0]]], "fill_between": [[0.0, 1.0], [1.0, 2.0]]}
        getattr(ax, draw)(*words.get(draw, [[0.0], [1.0]]))
        assert drawing.holds_data(figure), draw


def test_an_installed_font_draws_letters_that_the_first_lacks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    """STIX, which comes with matplotlib, stands for a font with East Asian letters."""
    monkeypatch.setattr(drawing, "EAST_ASIAN", ("absent", "STIXGeneral"))
    monkeypatch.setattr(drawing, "FIRST_EAST_ASIAN", "\u2000")
    drawing._east_asian_fonts.cache_clear()
    figure, (ax,) = drawing.panels(1, 1, (3.0, 3.0), "")
    ax.plot([0.0, 1.0])
    drawing.name_axes(ax, "only in STIX: \u2332")
    drawing.save_figures({"a": lambda: figure}, tmp_path)
    drawing._east_asian_fonts.cache_clear()
    assert [str(one.message) for one in recwarn] == []


def overlaps(figure: Figure) -> list[tuple[str, str]]:
    """Pairs of texts that overlap by more than a pixel, and texts that leave the figure."""
    figure.draw_without_rendering()
    hidden = set()
    for ax in [*figure.axes, *[child for one in figure.axes for child in one.child_axes]]:
        for axis in (ax.xaxis, ax.yaxis):  # type: ignore[attr-defined]
            low, high = sorted(axis.get_view_interval())
            for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
                if not low <= tick.get_loc() <= high:
                    hidden |= {tick.label1, tick.label2}
    texts = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
    shown = [(t.get_text(), t.get_window_extent()) for t in texts if t not in hidden]
    actual = []
    for number, (text, box) in enumerate(shown):
        if not (box.x0 > -1.0 and box.x1 < figure.bbox.x1 + 1.0 and box.y0 > -1.0):
            actual.append((text, "edge of the figure"))
        for other, taken in shown[:number]:
            wide = min(box.x1, taken.x1) - max(box.x0, taken.x0)
            if wide > 1.0 and min(box.y1, taken.y1) - max(box.y0, taken.y0) > 1.5:
                actual.append((text, other))
    return actual


WIDTHS = ["single-column", pytest.param("double-column", marks=pytest.mark.thorough)]


@pytest.mark.thorough
@pytest.mark.parametrize("width", WIDTHS)
def test_figures_of_a_paper_have_its_width_and_no_overlaps(result: tb.Result, width: str) -> None:
    with figure_style({"width": width, "titles": False}):
        figures = {name: draw() for name, draw in result.plot.draw_all().items()}
    for name, figure in figures.items():
        grid = figure.axes[0].get_gridspec()
        across = width if grid and grid.ncols < 3 else "double-column"
        assert figure.get_figwidth() * 25.4 == pytest.approx(COLUMNS[across]), name
        assert figure.get_suptitle() == ""
        assert overlaps(figure) == [], name
        texts = [t for t in figure.findobj(Text) if t.get_text()]
        assert min(t.get_fontsize() for t in texts) >= SMALLEST  # type: ignore[attr-defined]


def test_notes_move_away_from_data() -> None:
    figure, (ax,) = drawing.panels(1, 1, (4.0, 3.0), "")
    ax.plot([0.0, 0.5, 0.5], [0.05, 0.05, 0.5], color="k")  # through the usual place
    ax.set(xlim=(0, 1), ylim=(0, 1))
    drawing.say_why(ax, "a note on data")
    figure.draw_without_rendering()
    box, line = ax.texts[0].get_window_extent(), ax.lines[0]
    path = line.get_path().transformed(line.get_transform())
    assert not path.intersects_bbox(box, filled=False)


@pytest.mark.thorough
def test_saved_vectors_hold_text_and_the_font(result: tb.Result, tmp_path: Path) -> None:
    plots = type(result.plot)(result)
    plots.draw_all = lambda: {"loops": result.plot.loops}  # type: ignore[method-assign]
    (svg,) = plots.save_all(tmp_path, format="svg", width="single-column", titles=False)
    assert 'width="538.58' in (text := svg.read_text())  # three panels: 190 mm in points
    assert "[MPa]</text>" in text
    (pdf,) = plots.save_all(tmp_path, format="pdf", width="120 mm")
    content = pdf.read_bytes()
    assert b"/FontFile2" in content  # TrueType, whole letters
    assert b"/Type3" not in content
    assert (tmp_path / "loops.png").is_file()
    for wrong in ("tripel", "3", "2 m", "5 s"):
        with pytest.raises(tb.InputError, match="figure_width"):
            plots.save_all(tmp_path, width=wrong)
    with pytest.raises(tb.InputError, match="png, pdf, svg"):
        plots.save_all(tmp_path, format="gif")


@pytest.mark.parametrize("words", [4, 8, 11, 60])
def test_titles_have_at_most_two_lines(words: int) -> None:
    title = f"a bridge of five spans, x: {' '.join(['displacement'] * words)}"
    figure, _ = drawing.panels(1, 1, (6.0, 3.0), title)
    reported = figure.get_suptitle()
    assert reported.count("\n") <= 1
    assert reported.startswith("a bridge of five spans, x")
    assert reported.endswith("\N{HORIZONTAL ELLIPSIS}") == (words == 60)
    figure.draw_without_rendering()
    box = figure._suptitle.get_window_extent()
    assert box.width <= figure.bbox.width
