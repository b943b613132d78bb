"""A state that cannot be true: impossible temperatures, energy from nowhere."""

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.core.types import State, new_state
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.outcomes import is_physical

HDR = tb.load_bearing("shen-hdr-specimen")
MODEL = build_model(HDR)


def line_state(**books: float) -> State:
    """100 kN mm of work, 70 of them heat: 20 stored, 30 lost at the ends, 20 at the sides."""
    state = new_state(MODEL.constants, np.full(len(MODEL.stack.part), 20.0))
    given = {
        "work_in": 100.0, "heat_released": 70.0, "recoverable": 30.0, "heat_stored": 20.0,
        "heat_lost_ends": 30.0, "heat_lost_sides": 20.0, **books,
    }  # fmt: skip
    for name, value in given.items():
        setattr(state.books[0], name, value)
    return state


@pytest.mark.parametrize("cell", [0, -1])
@pytest.mark.parametrize(
    ("degrees", "possible"), [(-273.0, True), (-274.0, False), (1499.0, True), (1501.0, False)]
)
def test_temperatures(cell: int, degrees: float, possible: bool) -> None:
    state = line_state()
    state.temperature[cell] = degrees
    assert is_physical(MODEL.constants, state) is possible


def test_nan_is_not_physical() -> None:
    state = line_state()
    state.temperature[3] = np.nan
    assert not is_physical(MODEL.constants, state)
    assert not is_physical(MODEL.constants, line_state(work_in=np.nan))


@pytest.mark.parametrize("name", ["work_in", "recoverable", "heat_stored", "heat_lost_ends",
                                  "heat_lost_sides"])  # fmt: skip
@pytest.mark.parametrize(("missing", "possible"), [(0.09, True), (0.2, False), (-0.2, False)])
def test_books(name: str, missing: float, possible: bool) -> None:
    """0.1 % of the largest energy may be missing, in either balance and either way."""
    state = line_state()
    setattr(state.books[0], name, getattr(state.books[0], name) + missing)
    assert is_physical(MODEL.constants, state) is possible


def test_published_books_have_gaps_of_their_own() -> None:
    published = build_model(HDR, ModelOptions(scheme="published")).constants
    assert is_physical(published, line_state(heat_stored=50.0))
    hot = line_state()
    hot.temperature[:] = 2000.0
    assert not is_physical(published, hot)
