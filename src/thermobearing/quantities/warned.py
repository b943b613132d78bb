"""Warnings as small records: what is said, about what, of which kind, and how much it changes.

A warning is made where its cause is noticed, where the numbers are known. Screens choose and sort
warnings by these fields, never by the words of their sentences.
"""

from collections.abc import Iterable
from typing import Final

# The effect of a warning on a result. `outside_tests` adds the relative uncertainty of the force,
# which is below one, so that it sorts within its level.
UNUSABLE: Final = 4.0  # numbers that cannot be used
EXCEEDED: Final = 3.0  # a limit is exceeded
UNTESTED: Final = 2.0  # beyond what was tested
ASSUMED: Final = 1.0  # an effect is assumed
OTHER: Final = 0.0

# Codes of warnings on the range behind the parameters of a bearing, or their beginning.
BEYOND_TESTS, BEYOND_LAW, NO_RANGE = "beyond_tests", "beyond_law", "no_range"


class Warned(str):
    """A warning: text for all who read, compare or save it, with the record that it is made of.

    Parameters
    ----------
    sentence : str
    code : str
        The kind, such as "beyond_tests.strain": warnings of one code have one cause.
    effect : float
        How much it changes a result: UNUSABLE to OTHER.
    place : str
        What it is about, such as a bearing; the text begins with it.

    Examples
    --------
    >>> warning = Warned("lifts", "uplift", EXCEEDED, "abutment")
    >>> str(warning), warning.about("run 3").place
    ('abutment: lifts', 'run 3')
    """

    sentence: str
    code: str
    effect: float
    place: str

    def __new__(cls, sentence: str, code: str, effect: float = OTHER, place: str = "") -> "Warned":
        """Return the text with its record."""
        warning = super().__new__(cls, f"{place}: {sentence}" if place else sentence)
        warning.sentence, warning.code = sentence, code
        warning.effect, warning.place = effect, place
        return warning

    def __getnewargs__(self) -> tuple[str, str, float, str]:  # type: ignore[override]
        """Return what makes the same warning in another process."""
        return self.sentence, self.code, self.effect, self.place

    def about(self, place: str) -> "Warned":
        """Return the warning with another place in front of its text."""
        return Warned(str(self), self.code, self.effect, place)


def as_warned(text: str) -> Warned:
    """Return a text as a warning; one of a saved file has no record, and its text is its kind."""
    return text if isinstance(text, Warned) else Warned(text, text)


def one_per_cause(warnings: Iterable[str]) -> list[str]:
    """Return one warning for each code, whichever bearings or parts it concerns.

    >>> strain = [Warned(f"strain {k}", "beyond_tests.strain", place=f"b{k}") for k in (3, 4)]
    >>> one_per_cause([*strain, "cold"])
    ['b3: strain 3; b4: strain 4', 'cold']
    """
    causes: dict[str, list[Warned]] = {}
    for warning in map(as_warned, warnings):
        causes.setdefault(warning.code, []).append(warning)
    return [
        Warned(
            "; ".join([group[0].sentence, *group[1:]]),
            code,
            max(warning.effect for warning in group),
            group[0].place,
        )
        for code, group in causes.items()
    ]
