"""Exceptions whose messages name the fault and the valid input."""

import difflib
from collections.abc import Iterable, Mapping
from unicodedata import category

HIDDEN = ("Cc", "Cf", "Cs")  # control characters, marks without a shape, lone surrogates
LONGEST_BITS = 1024  # of an integer that a message shows; Python does not write much larger ones
LONGEST_NAME = 500  # characters of a path that a message shows
NAME_SIMILARITY = 0.6  # least similarity of names, from 0 to 1
STEM_SIMILARITY = 0.75  # the same of files without their suffix


class ThermobearingError(Exception):
    """Base class of all errors that this package raises."""


class InputError(ThermobearingError, ValueError):
    """Input that cannot be used; the message names the value, its place and what is allowed.

    `problems` holds one sentence per fault, so that all faults of a file are reported at once.
    """

    def __init__(self, problems: str | Iterable[str], where: str = "") -> None:
        texts = [problems] if isinstance(problems, str) else problems
        self.problems, self.where = [printable(text) for text in texts], printable(where)
        super().__init__(self.message())

    def lines(self, key: str = "") -> list[str]:
        """Return each problem with the name of its file, for a file that refers to it."""
        prefix = "".join(f"{part}: " for part in (key, self.where) if part)
        return [f"{prefix}{problem}" for problem in self.problems]

    def located(self, where: object) -> "InputError":
        """Return the same fault under the name of a file, unless it names one already."""
        return self if self.where else InputError(self.problems, str(where))

    def message(self) -> str:
        """Return all problems as one text, under the name of the file they are in."""
        if not self.where:
            return "\n".join(self.problems)
        if len(self.problems) == 1:
            return f"{self.where}: {self.problems[0]}"
        bullets = "\n".join(f"  - {problem}" for problem in self.problems)
        return f"{self.where}: {len(self.problems)} problems\n{bullets}"


class OutputError(ThermobearingError):
    """A result that could not be written; no partial files remain."""

    def __init__(self, message: str) -> None:
        super().__init__(printable(message))


def closest(name: str, candidates: Iterable[str]) -> str:
    """Return a clause '; did you mean "..."?' with the closest known name, or nothing."""
    return suggestion(name, {candidate: candidate for candidate in candidates}, NAME_SIMILARITY)


def suggestion(name: str, display_names: Mapping[str, str], cutoff: float) -> str:
    """Return the clause with the value of the closest key, if that is similar enough."""
    close = difflib.get_close_matches(str(name), sorted(display_names), n=1, cutoff=cutoff)
    return f'; did you mean "{display_names[close[0]]}"?' if close else ""


def nearest(name: str, candidates: Iterable[str]) -> str:
    """Return a clause '; did you mean "..."?' with the closest name, or the list of names."""
    names = sorted(candidates)
    all_names = f"; known: {', '.join(names)}" if names else ""
    return closest(name, names) or all_names


def printable(text: str) -> str:
    r"""Return the text with escapes for invisible characters and those that move the cursor.

    Names and values come from files and from the system; what is no text at all is there as lone
    surrogates, which cannot be printed either.

    >>> printable("免震\x1b[2J")
    '免震\\x1b[2J'
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        repr(mark)[1:-1] if mark != "\n" and category(mark) in HIDDEN else mark for mark in text
    )


def short_repr(value: object, longest: int = 60) -> str:
    """Return any value as one line for a message, also one that has no text.

    >>> short_repr("x"), short_repr(10**5000)
    ("'x'", 'an integer of 16610 bits')
    """
    if isinstance(value, int) and not isinstance(value, bool) and value.bit_length() > LONGEST_BITS:
        return f"an integer of {value.bit_length()} bits"
    try:
        return shortened(" ".join(repr(value).split()), longest)
    except Exception:  # an object of another library, or a list of such integers
        return f"<{type(value).__name__}>"


def shortened(text: str, longest: int = 60) -> str:
    """Return the text, shortened for use in a message."""
    return text if len(text) <= longest else f"{text[: longest - 3]}..."
