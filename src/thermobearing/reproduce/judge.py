"""A rule and what was computed: the verdict."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.core.types import Floats
from thermobearing.reproduce.claims import Comparison, Limit, NeedsTestData, Order, Rule, Within

REPRODUCED, ECHOES, HOLDS = "reproduced", "echoes an input", "trend holds"
CONTRADICTED, CLOSE = "contradicted", "within 1 %"
UNDECIDED, NEEDS = "not decidable without the motion", "needs the test data"
FAILED = "failed"
VERDICTS = (REPRODUCED, ECHOES, HOLDS, CONTRADICTED, CLOSE, UNDECIDED, NEEDS, FAILED)
ROUNDING = 1e-6  # per cent, or of the unit
SETTLED = (REPRODUCED, ECHOES, HOLDS)
NOISE = 0.01  # relative difference below which a comparison is neither for nor against
USUALLY = 2.0 / 3.0  # more than this share is "usually", "typically", "tends"


@dataclass(frozen=True)
class Verdict:
    """What became of a claim.

    Attributes
    ----------
    kind : one of `VERDICTS`.
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
        return _compared(rule, _margins(rule, numbers), numbers)
    if numbers.ndim == 0 or numbers.shape[-1] < 2:
        return Verdict(FAILED, "failed: one number has no order")
    if isinstance(rule, Order) and numbers.shape[-1] != len(rule.names):
        return Verdict(FAILED, f"failed: {numbers.shape[-1]} numbers, {len(rule.names)} names")
    falls = isinstance(rule, Order) or rule.direction == "falls"
    steps = np.diff(numbers, axis=-1) * (-1.0 if falls else 1.0)
    size = np.maximum(np.abs(numbers[..., 1:]), np.abs(numbers[..., :-1]))
    return _compared(rule, _relative(steps, size), numbers)


def of_motions(verdict: Verdict, others: Sequence[Verdict]) -> Verdict:
    """Return the verdict on one stand-in, or that the motion decides.

    Parameters
    ----------
    verdict : on the chosen stand-ins.
    others : on others of the same spectra; those that failed are not counted.

    Examples
    --------
    >>> yes, no = Verdict(HOLDS, "trend holds"), Verdict(CONTRADICTED, "contradicted: 0.9")
    >>> of_motions(no, [no, yes]).words
    'not decidable without the motion: contradicted: 0.9; trend holds with another stand-in'
    """
    for other in others:
        same = (other.settled, other.kind == CLOSE) == (verdict.settled, verdict.kind == CLOSE)
        if not same and other.kind != FAILED:
            words = f"{UNDECIDED}: {verdict.words}; {other.words} with another stand-in"
            return Verdict(UNDECIDED, words)
    return verdict


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


def _relative(gaps: Floats, sizes: Floats) -> Floats:
    return np.divide(gaps, sizes, out=np.zeros_like(gaps), where=sizes > 0.0)


def _margins(rule: Limit, numbers: Floats) -> Floats:
    """How far inside the limits each number is, of the larger of it and the limit."""
    sides = [(rule.above, 1.0), (rule.below, -1.0)]
    found = [
        _relative(sign * (numbers - limit), np.maximum(np.abs(numbers), abs(limit)))
        for limit, sign in sides
        if limit is not None
    ]
    return np.asarray(np.min(found, axis=0))


def _compared(rule: Comparison, margins: Floats, numbers: Floats) -> Verdict:
    """Of relative differences that are positive where the statement holds."""
    noise = 0.0 if rule.exact else NOISE
    total, good, bad = margins.size, int((margins > noise).sum()), int((margins < -noise).sum())
    same = total - good - bad
    beside = f", {same} within 1 %" if same else ""
    told = f"{good} of {total} as said{beside}"
    if bad and not (rule.usually and good > USUALLY * (good + bad)):
        if numbers.size == 1:
            told = f"{numbers.item():.4g} {rule.unit}".rstrip()
        return Verdict(CONTRADICTED, f"{CONTRADICTED}: {told}")
    if 2 * good < total:
        return Verdict(CLOSE, f"{CLOSE}: too close to tell ({told})")
    return Verdict(HOLDS, HOLDS + (f" ({told})" if good < total else ""))


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
