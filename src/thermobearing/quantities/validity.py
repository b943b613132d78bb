"""Values of runs that became unstable: until when they are results, and how tables mark them.

The shear law under an axial force is not valid beyond the critical load, so that force and
displacement after its first exceedance are not quoted as results.
"""

from collections.abc import Iterable
from typing import Final

from thermobearing.border.lazy import pd

VALID_UNTIL: Final = "valid_until_s"  # column: when a run first became unstable; else NaN
NOTE: Final = 'Marked: of unstable runs; values later than "Valid until" are no results.'


def invalid_marks(frame: "pd.DataFrame", names: Iterable[str]) -> dict[str, list[bool]]:
    """Return marks of some columns in the rows of unstable runs; none where no run is unstable.

    >>> rows = pd.DataFrame({"force_kN": [3.0, 4.0], VALID_UNTIL: [float("nan"), 1.5]})
    >>> invalid_marks(rows, ["force_kN"])
    {'force_kN': [False, True]}
    """
    if VALID_UNTIL not in frame or frame[VALID_UNTIL].isna().all():
        return {}
    invalid = frame[VALID_UNTIL].notna().tolist()
    return {name: list(invalid) for name in names if name in frame}
