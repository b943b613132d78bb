"""A rule and what was computed: the verdict."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.core.types import Floats
from thermobearing.reproduce.claims import Limit, NeedsTestData, Order, Rule, Within

REPRODUCED, HOLDS = "reproduced", "trend holds"
CONTRADICTED, NEEDS, FAILED = "contradicted", "needs the test data", "failed"
VERDICTS = (REPRODUCED, HOLDS, CONTRADICTED, NEEDS, FAILED)
ROUNDING = 1e-6  # per cent, or of the unit
SETTLED = (REPRODUCED, HOLDS)


@dataclass(frozen=True)
class Verdict:
    """What became of a claim.

    Attributes
    ----------
    kind : "reproduced", "trend holds", "contradicted", "needs the test data" or "failed".
    words : the same with its number, "reproduced within 0.31 %", or the reason.
    """

    kind: str
    words: str

    @property
    def settled(self) -> bool:
        """Whether the source's words hold."""
        return self.kind in SETTLED


def verdict_of(rule: Rule, computed: ArrayLike) -> Verdict:
    """The verdict of a rule on computed numbers.

    Parameters
    ----------
    rule : of a claim.
    computed : a number, numbers in a row, or rows of numbers.

    Returns
    -------
    Verdict : "failed" for numbers that are none, or not as many as the rule has.

    Examples
    --------
    >>> from thermobearing.reproduce.claims import Trend
    >>> verdict_of(Within(value=12.0, per_cent=1.0), 12.06).words
    'reproduced within 0.50 %'
    >>> verdict_of(Trend(direction="rises", along="23, 0, -20 degC"), [1.2, 1.7, 2.4]).kind
    'trend holds'
    """
    if isinstance(rule, NeedsTestData):
        return Verdict(NEEDS, f"needs the test data: {rule.why}")
    numbers = np.asarray(computed, dtype=float)
    if not numbers.size or not np.isfinite(numbers).all():
        return Verdict(FAILED, "failed: what was computed is not a number")
    if isinstance(rule, Within):
        return _near(rule, numbers)
    if isinstance(rule, Limit):
        return _between(rule, numbers)
    if numbers.ndim == 0 or numbers.shape[-1] < 2:
        return Verdict(FAILED, "failed: one number has no order")
    if isinstance(rule, Order) and numbers.shape[-1] != len(rule.names):
        return Verdict(FAILED, f"failed: {numbers.shape[-1]} numbers, {len(rule.names)} names")
    falls = isinstance(rule, Order) or rule.direction == "falls"
    steps = np.diff(numbers, axis=-1) * (-1.0 if falls else 1.0)
    return _told(int((steps > 0.0).sum()), steps.size, "steps")


def _near(rule: Within, numbers: Floats) -> Verdict:
    printed = np.asarray(rule.value, dtype=float)
    if printed.shape not in (numbers.shape, ()):
        return Verdict(FAILED, f"failed: {numbers.size} numbers, {printed.size} printed")
    gap = np.abs(numbers - printed)
    if rule.absolute is not None:
        far, allowed, unit = float(gap.max()), rule.absolute, rule.unit
    else:
        far, allowed, unit = float((100.0 * gap / np.abs(printed)).max()), rule.per_cent or 0.0, "%"
    if far <= allowed:
        near = f"within {_size(far)} {unit}".rstrip() if far > ROUNDING else "to rounding"
        return Verdict(REPRODUCED, f"reproduced {near}")
    return Verdict(CONTRADICTED, f"contradicted: {_size(far)} {unit}".rstrip() + " away")


def _between(rule: Limit, numbers: Floats) -> Verdict:
    low = -np.inf if rule.above is None else rule.above
    high = np.inf if rule.below is None else rule.below
    inside = (numbers > low) & (numbers < high)
    if numbers.size == 1 and not inside.all():
        return Verdict(CONTRADICTED, f"contradicted: {numbers.item():.4g} {rule.unit}".rstrip())
    return _told(int(inside.sum()), inside.size, "numbers")


def _told(good: int, total: int, what: str) -> Verdict:
    if good == total:
        return Verdict(HOLDS, "trend holds")
    return Verdict(CONTRADICTED, f"contradicted: {good} of {total} {what} as said")


def _size(value: float) -> str:
    """Two digits, without an exponent down to rounding.

    Examples
    --------
    >>> _size(41.7), _size(0.0312), _size(4.96e-5), _size(0.0)
    ('42', '0.031', '0.00005', '0.0')
    """
    if value >= 10.0:
        return f"{value:.0f}"
    if value >= 1e-4 or value == 0.0:
        return f"{value:#.2g}"
    return f"{value:.6f}".rstrip("0") if value >= ROUNDING else f"{value:.0e}"
