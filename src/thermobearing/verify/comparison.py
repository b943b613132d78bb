"""What a comparison returns."""

from typing import NamedTuple


class Comparison(NamedTuple):
    """The error of one comparison, in the unit of its row."""

    error: float
    note: str = ""
    recomputed: bool = False  # whether a reference that is stored was computed here
