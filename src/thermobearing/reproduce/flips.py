"""The smallest change of a named parameter that flips a verdict that holds.

Changes are looked at on a short list, outwards; between the last that leaves the verdict and the
first that flips it the border is halved until it is known to a sixteenth of their distance.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from thermobearing.border.errors import InputError
from thermobearing.reproduce.claims import Claim
from thermobearing.reproduce.judge import FAILED, Verdict
from thermobearing.reproduce.runs import Runs

STEPS = (0.05, 0.2, 0.5, 1.0, 2.0, 3.0)  # relative changes that are looked at first
HALVINGS = 4  # 0.15 between two of them becomes one per cent
MORE = 0.05  # more K_r: what stands it has to say why
SYMBOL = "K_r"
KEPT = 24  # changes whose simulations are kept: claims of one chapter ask for the same ones


@dataclass(frozen=True)
class Flip:
    """The smallest change of a parameter that flips a verdict.

    Attributes
    ----------
    parameter : symbol of `data/claims/parameters.toml`.
    change : relative, 0.05 is 5 % more; None if none within reach flips it.
    """

    parameter: str
    change: float | None

    @property
    def words(self) -> str:
        """As text."""
        if self.change is None:
            return f"{self.parameter}: none"
        return f"{self.parameter} {100.0 * self.change:+.1f} %"


class Variants:
    """Simulations with changed parameters; the last few are kept."""

    def __init__(self, base: Runs | None = None) -> None:
        self.base = base or Runs()
        self._kept: OrderedDict[tuple[str, float], Runs] = OrderedDict()

    def runs(self, parameter: str, change: float) -> Runs:
        """Those with one parameter changed by a share of itself."""
        key = (parameter, round(change, 6))
        if key not in self._kept:
            changes = {parameter: 1.0 + change}
            self._kept[key] = Runs(changes, light=True, **self.base.options)
            if len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]


Judged = Callable[[Runs], Verdict]


def find_flip(claim: Claim, judged: Judged, variants: Variants, parameter: str) -> Flip:
    """The smallest change of one parameter, to either side, that flips a verdict that holds.

    Parameters
    ----------
    claim : its `reach` is how far is looked.
    judged : verdict of the claim on simulations.
    variants : simulations with changes.
    parameter : a symbol of `data/claims/parameters.toml`.

    Returns
    -------
    Flip

    Examples
    --------
    >>> from thermobearing.reproduce.claims import Within
    >>> from thermobearing.reproduce.judge import verdict_of
    >>> claim = Claim(id="a", place="-", statement="-", computed="a.b", rule=Within(value=1.0,
    ...     per_cent=10.0))
    >>> def judged(runs):
    ...     return verdict_of(claim.rule, runs.change.get("K_r", 1.0))
    >>> find_flip(claim, judged, Variants(), "K_r").words
    'K_r +10.6 %'
    """

    def flipped(change: float) -> bool:
        try:
            verdict = judged(variants.runs(parameter, change))
        except InputError:  # no bearing has such a number: as far as one can go
            return False
        return not verdict.settled and verdict.kind != FAILED

    found = [
        change for sign in (1.0, -1.0) if (change := _first(flipped, sign, claim.reach / 100.0))
    ]
    return Flip(parameter, min(found, key=abs) if found else None)


def _first(flipped: Callable[[float], bool], sign: float, reach: float) -> float | None:
    """The smallest change to one side that flips, or None."""
    stands = 0.0
    for size in (step for step in STEPS if step <= reach):
        if flipped(sign * size):
            return _border(flipped, sign, stands, size)
        stands = size
    return None


def _border(flipped: Callable[[float], bool], sign: float, stands: float, falls: float) -> float:
    for _ in range(HALVINGS):
        middle = 0.5 * (stands + falls)
        stands, falls = (stands, middle) if flipped(sign * middle) else (middle, falls)
    return sign * falls


def last_that_stands(change: float) -> float:
    """The largest change that was seen to leave the verdict, below the one that flips it.

    Examples
    --------
    >>> round(last_that_stands(0.05), 6), round(last_that_stands(-0.059375), 6)
    (0.046875, -0.05)
    """
    size = abs(change)
    above = next(step for step in STEPS if step >= size)
    below = max((step for step in STEPS if step < above), default=0.0)
    sign = 1.0 if change > 0.0 else -1.0
    return sign * (size - (above - below) / 2.0**HALVINGS)


def stands_more_stiffness(judged: Judged, variants: Variants) -> bool:
    """Whether a verdict that holds stands 5 % more K_r."""
    return judged(variants.runs(SYMBOL, MORE)).settled


def all_flips(claim: Claim, judged: Judged, variants: Variants) -> Sequence[Flip]:
    """Of every parameter that the claim names."""
    return [find_flip(claim, judged, variants, parameter) for parameter in claim.flips]
