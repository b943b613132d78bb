"""Exceptions whose messages name the fault and the valid input."""

import difflib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from itertools import islice
from pathlib import Path
from unicodedata import category

HIDDEN = ("Cc", "Cf", "Cs")  # control characters, marks without a shape, lone surrogates
LONGEST_NAME = 500  # characters of a path that a message shows
MOST_BESIDE = 2000  # files of a folder that are searched for a similar name
ALIKE, STEMS_ALIKE = 0.6, 0.75  # least similarity of names, and of files without their suffix


class ThermobearingError(Exception):
    """Base class of all errors that this package raises."""


class InputError(ThermobearingError, ValueError):
    """Input that cannot be used; the message names the value, its place and what is allowed.

    `problems` holds one sentence per fault, so that all faults of a file are reported at once.
    """

    def __init__(self, problems: str | Iterable[str], where: str = "") -> None:
        given = [problems] if isinstance(problems, str) else problems
        self.problems, self.where = [printable(text) for text in given], printable(where)
        super().__init__(self.message())

    def lines(self, key: str = "") -> list[str]:
        """Return each problem with the name of its file, for a file that refers to it."""
        before = "".join(f"{part}: " for part in (key, self.where) if part)
        return [f"{before}{problem}" for problem in self.problems]

    def located(self, where: object) -> "InputError":
        """Return the same fault under the name of a file, unless it names one already."""
        return self if self.where else InputError(self.problems, str(where))

    def message(self) -> str:
        """Return all problems as one text, under the name of the file they are in."""
        if not self.where:
            return "\n".join(self.problems)
        if len(self.problems) == 1:
            return f"{self.where}: {self.problems[0]}"
        listed = "\n".join(f"  - {problem}" for problem in self.problems)
        return f"{self.where}: {len(self.problems)} problems\n{listed}"


class OutputError(ThermobearingError):
    """A result that could not be written; no partial files remain."""

    def __init__(self, message: str) -> None:
        super().__init__(printable(message))


def read_bytes(path: Path, most: int) -> bytes:
    """Return the content of a file, at most so many bytes (a device may be endless)."""
    shown, hint = shortened(str(path), LONGEST_NAME), ""
    try:
        if path.is_fifo() and not str(path).startswith(("/dev/", "/proc/")):
            raise InputError("is a named pipe, not a file", shown)  # it would wait for a writer
        with path.open("rb") as file:
            raw = file.read(most + 1)
    except InputError:
        raise
    except FileNotFoundError:
        with suppress(OSError, ValueError):  # name a file of nearly that name
            beside = sorted(islice(path.parent.iterdir(), MOST_BESIDE))
            beside.sort(key=lambda item: item.suffix == path.suffix)  # the last of a stem counts
            names = {item.stem: item.name for item in beside}
            hint = _suggestion(path.stem, names, STEMS_ALIKE)
        raise InputError(f"no such file{hint}", shown) from None
    except IsADirectoryError:
        raise InputError("is a directory, not a file", shown) from None
    except OSError as error:  # a name too long, no permission, a failing disk
        raise InputError(f"cannot be read: {error.strerror or error}", shown) from None
    except ValueError as error:  # a null byte in the path
        raise InputError(f"cannot be read: {error}", repr(shown)) from None
    if len(raw) > most:
        raise InputError(f"is larger than {most / 1e6:g} MB", shown)
    return raw


def is_file(path: Path) -> bool:
    """Return whether a file exists; False for impossible names, such as too long ones."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_folder(path: Path) -> bool:
    """Return whether a folder exists; False for impossible names."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def closest(name: str, known: Iterable[str]) -> str:
    """Return a clause '; did you mean "..."?' with the closest known name, or nothing."""
    return _suggestion(name, {one: one for one in known}, ALIKE)


def _suggestion(name: str, shown: Mapping[str, str], cutoff: float) -> str:
    """Return the clause with the value of the closest key, if that is similar enough."""
    close = difflib.get_close_matches(str(name), sorted(shown), n=1, cutoff=cutoff)
    return f'; did you mean "{shown[close[0]]}"?' if close else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return a clause '; did you mean "..."?' with the closest name, or the list of names."""
    names = sorted(known)
    listed = f"; known: {', '.join(names)}" if names else ""
    return closest(name, names) or listed


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


def shortened(text: str, longest: int = 60) -> str:
    """Return the text, shortened for use in a message."""
    return text if len(text) <= longest else f"{text[: longest - 3]}..."
