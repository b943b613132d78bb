"""Numbers and rules of a claim as a reader sees them."""

from typing import Any

import numpy as np

from thermobearing.reproduce.claims import Claim, Limit, NeedsTestData, Order, Rule, Within

MOST = 12  # numbers that are told one by one


def number_words(value: float) -> str:
    """Four digits at most, a true minus sign.

    Examples
    --------
    >>> number_words(1703.4), number_words(0.12341)
    ('1703', '0.1234')
    """
    text = f"{value:.0f}" if 1000.0 <= abs(value) < 1e6 else f"{value:.4g}"
    return text.replace("-", "\N{MINUS SIGN}")


def reason(error: Exception) -> str:
    """What broke, in a line.

    Examples
    --------
    >>> reason(ValueError("no root"))
    'failed: ValueError: no root'
    """
    told = str(error).splitlines()[0] if str(error) else "no reason given"
    return f"failed: {type(error).__name__}: {told}"


def computed_words(claim: Claim, computed: Any) -> str:
    """What was computed, with its unit; the ends of the range where there are many numbers."""
    if computed is None:
        return ""
    values = np.atleast_1d(np.asarray(computed, dtype=float))
    unit = getattr(claim.rule, "unit", "")
    if values.size > MOST:
        low, high = number_words(float(values.min())), number_words(float(values.max()))
        text = f"{values.size} numbers, {low} to {high}"
    else:
        rows = [", ".join(map(number_words, row)) for row in np.atleast_2d(values)]
        text = "; ".join(rows)
    return f"{text} {unit}".strip()


def rule_words(rule: Rule) -> str:
    """What decides, in words.

    Examples
    --------
    >>> rule_words(Limit(above=1.0, unit="kN"))
    'above 1 kN'
    """
    if isinstance(rule, NeedsTestData):
        return "the source's measurements"
    if isinstance(rule, Within):
        printed = np.atleast_1d(np.asarray(rule.value, dtype=float))
        near = f"{rule.per_cent:g} %" if rule.per_cent else f"{rule.absolute:g} {rule.unit}".strip()
        return f"{', '.join(map(number_words, printed))} {rule.unit}".strip() + f" within {near}"
    if isinstance(rule, Limit):
        sides = (("above", rule.above), ("below", rule.below))
        told = " and ".join(f"{n} {number_words(v)}" for n, v in sides if v is not None)
        told = f"{told} {rule.unit}".strip()
    elif isinstance(rule, Order):
        told = " > ".join(rule.names)
    else:
        told = f"{rule.direction}: {rule.along}"
    return f"usually {told}" if rule.usually else told
