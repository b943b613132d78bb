"""The pictures of the documents show what the program draws now.

Those that blocks of pages draw are compared where the blocks run, in test_site.py.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from docs.builder import contact, pictures
from tests.opensees import needs_opensees


def sources() -> list[Any]:
    """Return the functions that draw pictures as cases; the slow ones with the mark `thorough`."""
    return [
        pytest.param(
            source,
            id=source.pictures[0],
            marks=[
                *([needs_opensees] if "opensees" in source.function else []),
                *([pytest.mark.thorough] if source.slow else []),
            ],
        )
        for source in pictures.SOURCES
    ]


def test_every_picture_has_one_source_and_what_it_shows() -> None:
    files = pictures.FIGURES.rglob("*.png")
    there = {path.relative_to(pictures.FIGURES).as_posix() for path in files}
    drawn = [f"{name}.png" for source in pictures.SOURCES for name in source.pictures]
    drawn += [name for page in pictures.PAGES for name in pictures.page_pictures(page)]
    assert len(drawn) == len({*drawn})
    assert {name for name in there if not name.startswith("contact/")} == {*drawn}
    assert {*pictures.load_shown()} == there


@pytest.mark.parametrize("source", sources())
def test_pictures_of_functions_are_up_to_date(source: pictures.Source) -> None:
    shown = {f"{name}.png": pictures.describe(figure) for name, figure in source.draw().items()}
    assert {*shown} == {f"{name}.png" for name in source.pictures}
    message = pictures.outdated(shown)
    assert not message, message


@pytest.mark.thorough
def test_the_contact_sheet_is_up_to_date(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shown = contact.shown_by_commands(contact.run_all())
    assert {*shown} == {name for name in pictures.load_shown() if name.startswith("contact/")}
    message = pictures.outdated(shown)
    assert not message, message


def drawn(end: float = 1.0, colour: str = "#013aa8", title: str = "1.00 s") -> Figure:
    figure = Figure()
    ax = figure.subplots()
    ax.plot([0.0, 1.0], [0.0, end], color=colour)
    ax.fill_between([0.0, 1.0], [0.0, 0.0], [1.0, 2.0])
    ax.imshow([[0.0, 1.0]])
    ax.set_title(title)
    figure.suptitle("above")
    return figure


def test_another_line_colour_or_text_is_another_picture_but_rounding_is_not() -> None:
    before = pictures.describe(drawn())
    assert pictures.differences(pictures.describe(drawn(1.0 + 1e-4, title="1.01 s")), before) == []
    fewer = pictures.without_extent(before)
    assert (
        pictures.differences(pictures.without_extent(pictures.describe(drawn(1.02))), fewer) == []
    )
    for changed in (drawn(1.02), drawn(colour="#e67502"), drawn(title="1.00 m"), Figure()):
        assert len(pictures.differences(pictures.describe(changed), before)) == 1
    without = drawn()
    without.axes[0].lines[0].set_data([0.0, 1.0], [np.nan, np.nan])
    assert len(pictures.differences(pictures.describe(without), before)) == 1


def test_an_old_picture_is_named_with_the_command_that_redraws_it() -> None:
    name = "takeda.png"
    assert pictures.outdated({name: pictures.load_shown()[name]}) == ""
    assert f"{pictures.REDRAW} {name}" in pictures.outdated({name: pictures.describe(drawn())})


def test_a_picture_is_known_after_its_folder_was_renamed(tmp_path: Path) -> None:
    (tmp_path / "new").mkdir()
    with pictures.recorded() as shown:
        drawn().savefig(tmp_path / "new" / "a.png")
    (tmp_path / "new").rename(tmp_path / "done")
    assert shown[tmp_path / "done" / "a.png"] == pictures.describe(drawn())
