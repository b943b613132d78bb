"""Drawings of structures: parts to scale, names apart from each other and from the marks."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.quick import quick_cases
from tests.unit.test_figures import overlaps
from tests.unit.test_lines_and_piers import make_bridge, two_piers
from tests.verification.frames import TWO_PIERS, written
from thermobearing.results.figure_style import figure_style
from thermobearing.structure.figures import BELOW_DECK, _lay_out
from thermobearing.structure.model import load_structure


def test_piers_stand_side_by_side_and_the_deck_lies_over_them() -> None:
    layout = _lay_out(make_bridge(two_piers()))
    assert layout.columns["A"] < layout.columns["deck"] < layout.columns["B"]
    assert layout.ends["A"] == (0.0, 10.0)
    assert layout.ends["deck"] == (10.0, 10.0)
    assert layout.scaled
    assert not _lay_out(load_structure("hybrid-pier")).scaled


def test_masses_and_lines_are_drawn_at_their_heights() -> None:
    """One of them above the deck, one line below it; the symbols of lines have one size."""
    bridge = make_bridge(two_piers())
    heights = {"deck": 11_500.0}
    masses = [
        mass.model_copy(update={"height": heights.get(mass.body, mass.height)})
        for mass in bridge.masses
    ]
    lines = [
        line.model_copy(update={"height": 9_500.0 - 500.0 * k})
        for k, line in enumerate(bridge.bearings)
    ]
    changed = bridge.model_copy(update={"masses": masses, "bearings": lines})
    (ax,) = tb.examine_structure(changed).plot.model().axes
    drawn = [line for line in ax.lines if line.get_marker() == "o" and line.get_markersize() == 7]
    assert [line.get_ydata()[0] for line in drawn] == [mass.height / 1e3 for mass in masses]
    symbols = [line for line in ax.lines if line.get_marker() == BELOW_DECK]
    assert [line.get_ydata()[0] for line in symbols] == [line.height / 1e3 for line in lines]
    (size,) = {line.get_markersize() for line in symbols}
    assert size / 3.0 < 12.0  # points: the square is a third of its marker


def test_names_of_bearing_lines_lie_apart_and_inside_the_frame() -> None:
    bridge = make_bridge(two_piers())
    for first in ("P1", "pier 1, on the left"):
        named = [first, *(f"{first}, line {k}" for k in range(2, 1 + len(bridge.bearings)))]
        lines = [
            line.model_copy(update={"name": name})
            for line, name in zip(bridge.bearings, named, strict=True)
        ]
        figure = tb.examine_structure(bridge.model_copy(update={"bearings": lines})).plot.model()
        figure.draw_without_rendering()
        (ax,) = figure.axes
        shown = {text.get_text().replace("\n", " "): text for text in ax.texts}
        boxes = [shown[name].get_window_extent() for name in named]
        for k, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[k + 1 :])
            assert box.y1 < ax.get_window_extent().y1


@pytest.mark.thorough
def test_a_name_stands_next_to_the_mass_of_the_deck_above_its_line() -> None:
    """Of three lines, the mass of the deck stands over the one in the middle."""
    structure = two_piers()
    structure["masses"][0]["height"] = "11 m"
    bridge = make_bridge(structure)
    (first, *_), places = bridge.bearings, {"A1": "0 m", "P1": "40 m", "A2": "80 m"}
    table = first.model_dump(exclude_unset=True) | {"base": "ground"}
    lines = [
        type(first).model_validate(table | {"name": name, "x": place})
        for name, place in places.items()
    ]
    figure = tb.examine_structure(bridge.model_copy(update={"bearings": lines})).plot.model()
    figure.draw_without_rendering()
    names = {text.get_text(): text for text in figure.axes[0].texts}
    sides = [names[name].get_horizontalalignment() for name in places]
    assert sides == ["center", "right", "center"]


def test_names_in_plan_lie_apart_and_off_the_marks() -> None:
    """Six lines along the bridge, then the same with long names, each second one 1 m aside."""
    bridge = load_structure("five-span-bridge")
    crowded = [
        line.model_copy(update={"name": f"{line.name}, upstream side", "x": 2e4 * (k // 2), "y": y})
        for k, line in enumerate(bridge.bearings)
        for y in [1e3 * (k % 2)]
    ]
    for lines in (bridge.bearings, crowded):
        plan = bridge.model_copy(update={"bearings": lines})
        figure = tb.examine_structure(plan).plot.plan()
        figure.draw_without_rendering()
        (ax,) = figure.axes
        boxes = [text.get_window_extent() for text in ax.texts if len(text.get_text()) > 1]
        assert len(boxes) == len(lines) + 4 + 1  # lines, piers, deck
        frame = ax.get_window_extent()
        for k, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[k + 1 :])
            assert frame.y0 < box.y0 < box.y1 < frame.y1
            for mark in ax.lines:
                (at,) = ax.transData.transform(mark.get_xydata())
                assert not box.contains(*at)
    scale = np.diff(ax.transData.transform([(0.0, 0.0), (1.0, 1.0)]), axis=0)[0]
    assert_allclose(scale[0], scale[1])  # to scale


def test_supports_with_coordinates_stand_to_scale() -> None:
    layout = _lay_out(load_structure("five-span-bridge"))
    assert list(layout.seats.values()) == [0.0, 40.0, 80.0, 120.0, 160.0, 200.0]
    assert layout.columns["footing P2"] == layout.columns["P2"] == 80.0
    assert layout.placed
    assert not _lay_out(load_structure("five-span-girder")).placed


@pytest.mark.parametrize("name", quick_cases(["pier-p1", "five-span-bridge"], 0))
def test_a_structure_fits_in_a_column_of_a_paper(name: str) -> None:
    """Its legend is wrapped, and takes no room from the panel."""
    with figure_style({"width": "single-column"}):
        result = tb.examine_structure(name)
        shown = [result.plot.model(), *([result.plot.plan()] if result.structure.plan else [])]
        for figure in shown:
            assert overlaps(figure) == []
            assert figure.axes[0].get_window_extent().height > 1.5 * figure.dpi


@pytest.mark.thorough
def test_a_frame_is_drawn_with_its_nodes_apart(tmp_path: Path) -> None:
    """Each node is named once, nodes at one place together; the structure is in the other panel."""
    result = tb.import_frame(written(tmp_path, "frame.csv", TWO_PIERS))
    figure = result.plot.frame()
    left, right = figure.axes
    names = [text for text in left.texts if text.get_text()]
    drawn = ", ".join(text.get_text() for text in names).split(", ")
    assert sorted(drawn) == sorted(result.frame.nodes)
    assert "T1, D1" in {text.get_text() for text in names}
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in names]
    for k, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:k])
    dashed = [line for line in left.lines if line.get_linestyle() == "--"]
    assert len(dashed) == 1
    assert {"A1", "P1", "P2", "A2", "deck"} <= {text.get_text() for text in right.texts}
