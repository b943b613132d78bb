"""What kernels say in place of `if` where runs in lockstep may differ.

    select(mask, a, b)   a where the mask holds, b elsewhere
    any_lane(mask)       whether it holds anywhere
    all_lanes(mask)      whether it holds everywhere
    no(mask)             where it does not hold

For one run a mask is True or False: the first is `a if mask else b`, the others are the mask
itself and `not`, and the machine code is that of `if`. In lockstep, `if any_lane(mask):` is entered
if any run enters it, and `select` keeps the values of the others; a loop continues until all runs
have converged, and those that have converged do not change. NaN must end every loop: a run that
failed continues with NaN until the other runs are done.
"""

from typing import TypeVar

T = TypeVar("T")


def select(condition: bool, a: T, b: T) -> T:
    """`a` where the condition holds, `b` elsewhere; both are computed."""
    return a if condition else b


def any_lane(condition: bool) -> bool:
    """Whether it holds in any run; for one, whether it holds."""
    return condition


def all_lanes(condition: bool) -> bool:
    """Whether it holds in all runs; for one, whether it holds."""
    return condition


def no(condition: bool) -> bool:
    """Where it does not hold."""
    return not condition
