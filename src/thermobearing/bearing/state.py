"""State of the rubber at the start: tested, virgin, or recovered after a time at rest.

The parameters of a bearing are those of rubber that has been strained before (tested). Virgin
rubber is stiffer, by the excesses b and a of the table `scragging` (core/scragging.py). A recovered
rubber has the share r of both excesses, r = 1 - exp(-t/tau) after the time t: none at once, all
after a long time.
"""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from thermobearing.bearing.model import Bearing, Scragging
from thermobearing.border.errors import InputError, closest
from thermobearing.border.library import read_data
from thermobearing.border.schema import FieldError, Strict, in_unit
from thermobearing.border.units import parse_quantity
from thermobearing.quantities.warned import ASSUMED, Warned

RECOVERED = "recovered after "
WORDS = ("tested", "virgin", f"{RECOVERED}5 years")
Time = Annotated[float, in_unit("year")]


class RubberState(Strict):
    """State of the rubber at the start of an analysis.

    Attributes
    ----------
    rubber : "tested" (it has been strained as in the tests behind its parameters), "virgin", or
        "recovered" (tested, then at rest for a time).
    after : that time [year], in [0, 1000].
    time_constant : tau of the share 1 - exp(-t/tau) that has recovered [year], in [1e-4, 1000];
        0.5 by default, which is assumed (data/scragging/assumed.toml: 90 % between 0.05 and 5).

    Examples
    --------
    >>> round(RubberState(rubber="recovered", after=0.5).share, 2)
    0.63
    """

    rubber: Literal["tested", "virgin", "recovered"]
    after: Annotated[Time, Field(ge=0, le=1000)] | None = None
    time_constant: Annotated[Time, Field(ge=1e-4, le=1000)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        times = [key for key in ("after", "time_constant") if key in values]
        if values.get("rubber") != "recovered":
            return [f"{key}: only of recovered rubber" for key in times]
        return [] if "after" in times else ['recovered rubber needs after = "... year"']

    @property
    def share(self) -> float:
        """The share of the virgin excess of stiffness that the rubber has, in [0, 1]."""
        if self.rubber != "recovered" or self.after is None:
            return float(self.rubber == "virgin")
        return -math.expm1(-self.after / (self.time_constant or assumed().recovery.time_constant))

    def describe(self) -> str:
        """Return the state in words."""
        if self.rubber != "recovered":
            return self.rubber
        return f"recovered after {self.after:g} years (share {self.share:.2f} of virgin)"


class Recovery(Strict):
    """Median and 90 % interval of the time constant of recovery [year]."""

    time_constant: Time
    lowest: Time
    highest: Time


class AssumedScragging(Scragging):
    """Scragging of rubbers whose bearing has no table of it, of some kinds of bearings."""

    kinds: list[str]


class Assumed(Strict):
    """Content of data/scragging/assumed.toml."""

    recovery: Recovery
    high_damping: AssumedScragging
    natural: AssumedScragging


def assumed() -> Assumed:
    """Return what is assumed of recovery and of rubbers without a table `scragging`."""
    return read_data(Assumed, "scragging", "assumed.toml")


def _state_table(value: Any) -> Any:
    """Return the table of a state that may be given in words, with its time constant."""
    if isinstance(value, str):
        value = _state_from_words(value.strip())
    if isinstance(value, dict) and value.get("rubber") == "recovered":
        usual = f"{assumed().recovery.time_constant!r} year"
        return {"time_constant": usual, **{k: v for k, v in value.items() if v is not None}}
    return value


def _state_from_words(words: str) -> dict[str, Any]:
    """Return the table of a state in words."""
    if words in WORDS[:2]:
        return {"rubber": words}
    time = words.removeprefix(RECOVERED)
    if time == words:
        choices = ", ".join(f'"{word}"' for word in WORDS[:2])
        raise FieldError(f'must be {choices} or "{WORDS[2]}"{closest(words, list(WORDS))}')
    try:
        return {"rubber": "recovered", "after": f"{parse_quantity(time, 'year')!r} year"}
    except InputError as error:
        raise FieldError(str(error)) from None


State = Annotated[RubberState | None, BeforeValidator(_state_table)]


def scragging_of(bearing: Bearing) -> tuple[Scragging, bool]:
    """Return the scragging of a bearing's rubber, and whether it is assumed."""
    if bearing.scragging is not None:
        return bearing.scragging, False
    data = assumed()
    kinds = (data.high_damping, data.natural)
    scragging = next(kind for kind in kinds if bearing.kind in kind.kinds)
    return Scragging(**scragging.model_dump(exclude={"kinds"})), True


def has_excess(bearing: Bearing) -> bool:
    """Return whether the rubber of a bearing is stiffer if it is virgin, as known or assumed."""
    law, _ = scragging_of(bearing)
    return law.amplitude > 0.0 or law.mullins_amplitude > 0.0


def in_state(bearing: Bearing, state: RubberState | None) -> Bearing:
    """Return a bearing whose rubber is in a state; None: as its file says.

    A file without the table `scragging` is of tested rubber, one with it of virgin rubber.
    """
    if state is None:
        return bearing
    # Both excesses of the virgin stiffness recover in the same share.
    share = state.share
    if share == 0.0:
        return bearing.model_copy(update={"scragging": None}) if bearing.scragging else bearing
    law, _ = scragging_of(bearing)
    excess = {name: share * getattr(law, name) for name in ("amplitude", "mullins_amplitude")}
    return bearing.model_copy(update={"scragging": law.model_copy(update=excess)})


def opposite(state: RubberState | None, bearing: Bearing) -> RubberState:
    """Return the other bound of a state: virgin of tested rubber, tested of any other."""
    tested = bearing.scragging is None if state is None else state.share == 0.0
    return RubberState(rubber="virgin" if tested else "tested")


def states_table(
    states: Mapping[str, tuple[Bearing, RubberState | None]],
) -> dict[str, dict[str, Any]]:
    """Return the stated states of some bearings by label: share of virgin, numbers, origin."""
    table = {}
    for label, (bearing, state) in states.items():
        if state is None:
            continue
        row: dict[str, Any] = {"state": state.describe(), "share": state.share}
        if state.share > 0.0:
            law, is_assumed = scragging_of(bearing)
            row |= {"assumed": is_assumed, **law.model_dump()}
        table[label] = row
    return table


def describe_states(table: Mapping[str, Mapping[str, Any]]) -> list[Warned]:
    """Return a sentence for each state other than tested whose scragging is assumed."""
    groups: dict[str, list[str]] = {}
    for label, row in table.items():
        if row.get("assumed"):
            groups.setdefault(row["state"], []).append(label)
    return [
        Warned(
            f"the excess stiffness of {state} rubber is assumed, from one test of another "
            "compound; the table scragging in the bearing file replaces it",
            f"assumed_scragging.{state}",
            ASSUMED,
            ", ".join(labels),
        )
        for state, labels in groups.items()
    ]


def state_attribute(table: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the states as an attribute of a dataset; none where none is stated."""
    return {"rubber_state": dict(table)} if table else {}
