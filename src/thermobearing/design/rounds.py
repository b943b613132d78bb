"""Rounds of the design loop, and the search for the displacement of each group of lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from thermobearing.design.sizing import Size


@dataclass(frozen=True)
class Round:
    """One turn of the loop, of one group of bearing lines.

    Attributes
    ----------
    number : from 1.
    assumed : design displacement u_B that the bearing was sized for [mm].
    size : the bearing.
    stiffness, damping : K_B [kN/mm] and h_B at u_B.
    strength, post_yield, initial : Q_d [kN], K_2, K_1 [kN/mm] of the bilinear model.
    found : displacement over the motions [mm], as the rule of the case has it.
    ductility : of the pier over the motions, as the rule has it.
    largest : displacement of all motions [mm].
    group : name of the group of lines; empty where there is only one.
    """

    number: int
    assumed: float
    size: Size
    stiffness: float
    damping: float
    strength: float
    post_yield: float
    initial: float
    found: float
    ductility: float
    largest: float = math.nan
    group: str = ""

    @property
    def difference(self) -> float:
        """Found over assumed displacement, less one."""
        return self.found / self.assumed - 1.0

    def row(self) -> dict[str, Any]:
        """The round as people read it."""
        return {
            "round": self.number,
            **({"group": self.group} if self.group else {}),
            "u_B_assumed_mm": self.assumed,
            "side_mm": self.size.side,
            "layers": self.size.layers,
            "layer_thickness_mm": self.size.layer_thickness,
            "K_B_kN_mm": self.stiffness,
            "h_B": self.damping,
            "Q_d_kN": self.strength,
            "K_1_kN_mm": self.initial,
            "K_2_kN_mm": self.post_yield,
            "u_found_mm": self.found,
            "u_largest_mm": self.largest,
            "difference": self.difference,
            "pier_ductility": self.ductility,
        }


def size_name(turn: Round) -> str:
    """A size in words.

    Parameters
    ----------
    turn : a round of the loop.

    Returns
    -------
    str

    Examples
    --------
    >>> size_name(Round(1, 178.0, Size(600.0, 8, 14.0), 2.6, 0.15, 125.4, 1.8, 9.5, 180.0, 1.2))
    '600 mm with 8x14 mm'
    """
    size = turn.size
    return f"{size.side:g} mm with {size.layers}x{size.layer_thickness:g} mm"


def two_sizes(rounds: Sequence[Round], tolerance: float) -> tuple[Round, Round] | None:
    """Rounds on both sides of a jump between two sizes where no design is; None if there may be.

    Parameters
    ----------
    rounds : so far.
    tolerance : on found over assumed displacement, > 0.

    Returns
    -------
    The round that moves farther than it is sized for, and the one that moves less; they are sized
    for nearly the same displacement. None while such a pair is not known.

    Examples
    --------
    >>> two_sizes([], 0.01) is None
    True
    """
    short = [turn for turn in rounds if turn.difference > tolerance]
    ample = [turn for turn in rounds if turn.difference < -tolerance]
    if not short or not ample:
        return None
    low = max(short, key=lambda turn: turn.assumed)
    high = min(ample, key=lambda turn: turn.assumed)
    close = 0.0 < high.assumed - low.assumed <= tolerance * low.assumed
    return (low, high) if close and low.size != high.size else None


@dataclass
class Search:
    """The search for the displacement that one group of lines is sized for.

    The found displacement replaces the assumed one; where they cross over, the next guess goes
    half-way only. Between two sizes that alternate it holds the larger one, until the other groups
    have changed so much that this one moves farther than it is sized for.

    Attributes
    ----------
    assumed : displacement of the next round [mm].
    gain : share of the difference that is taken, in (0, 1].
    rounds : since the group was last set free.
    held : the two rounds of `two_sizes`, of which the larger size is held.
    """

    assumed: float
    gain: float = 1.0
    rounds: list[Round] = field(default_factory=list)
    held: tuple[Round, Round] | None = None

    def settled(self, turn: Round, tolerance: float) -> bool:
        """Return whether a round needs no other: it agrees, or its held size is large enough."""
        is_held = self.held is not None and turn.assumed == self.held[1].assumed
        return turn.difference <= tolerance and (is_held or turn.difference >= -tolerance)

    def advance(self, turn: Round, tolerance: float) -> None:
        """Take a round and choose the next assumed displacement."""
        if self.held is not None and turn.difference > tolerance:
            self.rounds, self.held, self.gain = [], None, 1.0
        before, self.rounds = self.rounds[-1:], [*self.rounds, turn]
        self.held = self.held or two_sizes(self.rounds, tolerance)
        if before and turn.difference * before[0].difference < 0.0:
            self.gain *= 0.5
        free = self.assumed + self.gain * (turn.found - self.assumed)
        self.assumed = self.held[1].assumed if self.held else free
