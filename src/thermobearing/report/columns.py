"""How wide the columns of a printed table are: every word fits, and nothing is cut."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

UPRIGHT, TURNED = 170.0, 267.0  # room [mm]
SIZES = (8.5, 8.0, 7.5, 7.0)  # of letters [pt], upright; below these a page is turned
TURNED_SIZES = (*SIZES, 6.5, 6.0)
# Widths of letters, of their size; bold ones of a head are wider.
NARROW, FIGURE, WIDE, CAPITAL, FULL, BOLD = 0.31, 0.5, 0.82, 0.68, 1.05, 1.08
POINT = 25.4 / 72.0  # [mm]
GAP = 3.2  # between columns [mm]
LONGEST_WORD = 12.0  # a longer one (a path, a digest) may be broken; of the size of letters
ROUNDING = 0.01  # of widths, of the size of letters
SHORT = 7.0  # such a text is not broken between words either
SEAM = "\N{ZERO WIDTH SPACE}"


@dataclass(frozen=True)
class Columns:
    """Columns of a table that stand beside each other.

    Attributes
    ----------
    places : their numbers in the table.
    widths : [mm].
    size : of the letters [pt].
    turned : whether they need a turned page.
    """

    places: list[int]
    widths: list[float]
    size: float
    turned: bool

    def broken(self, text: str, column: int) -> str:
        """Text of a column with places where long words may be broken."""
        room = self.widths[self.places.index(column)] - GAP
        most = room / (POINT * self.size) + ROUNDING
        return re.sub(r"\S+", lambda word: _seamed(word[0], most), text)


def _seamed(word: str, most: float) -> str:
    """A word that may be broken after signs, and else wherever it is too long."""
    if _width(word) <= most:
        return word
    parts = re.findall(r"[^/\\_.,;:=-]*[/\\_.,;:=-]?", word)
    count = max(3, int(most / CAPITAL))
    pieces = [part[k : k + count] for part in parts for k in range(0, len(part), count)]
    return SEAM.join(pieces)


def fitted(
    heads: Sequence[str], cells: Sequence[Sequence[str]], numbers: set[int], keys: int
) -> list[Columns]:
    """Columns in parts that fit a page, as large as can be.

    Parameters
    ----------
    heads : with units.
    cells : rows of text.
    numbers : columns of numbers, which are never broken.
    keys : leading columns that each part begins with.
    """
    everything = list(range(len(heads)))
    least = [_least(heads[k], [row[k] for row in cells], k in numbers) for k in everything]
    most = [max([least[k], *(_width(row[k]) for row in cells)]) for k in everything]
    for room, sizes, turned in ((UPRIGHT, SIZES, False), (TURNED, TURNED_SIZES, True)):
        for size in sizes:
            if _total(least, size) <= room:
                return [Columns(everything, _shared(least, most, room, size), size, turned)]
    return _in_parts(least, most, min(keys, len(heads) - 1))


def _in_parts(least: list[float], most: list[float], keys: int) -> list[Columns]:
    """More columns than even a turned page holds: parts below each other."""
    size = TURNED_SIZES[-2]
    first = list(range(keys))
    groups: list[list[int]] = [[]]
    for column in range(keys, len(least)):
        together = [least[k] for k in (*first, *groups[-1], column)]
        if groups[-1] and _total(together, size) > TURNED:
            groups.append([])
        groups[-1].append(column)
    parts = []
    for group in groups:
        places = [*first, *group]
        few, many = [least[k] for k in places], [most[k] for k in places]
        parts.append(Columns(places, _shared(few, many, TURNED, size), size, True))
    return parts


def _total(widths: Sequence[float], size: float) -> float:
    """Width of columns [mm] from widths of their texts, of the size of letters."""
    return sum(widths) * POINT * size + GAP * len(widths)


def _shared(least: list[float], most: list[float], room: float, size: float) -> list[float]:
    """Widths [mm]: what each needs at least, and of what is left what it would like."""
    letter = POINT * size
    left = room - _total(least, size)
    wanted = [(high - low) * letter for low, high in zip(least, most, strict=True)]
    share = min(1.0, left / sum(wanted)) if sum(wanted) > 0.0 else 0.0
    low = [width * letter + GAP for width in least]
    return [round(width + share * more, 2) for width, more in zip(low, wanted, strict=True)]


def _width(text: str) -> float:
    """Width of a line, of the size of its letters."""
    return sum(map(_letter, text))


def _letter(mark: str) -> float:
    if mark in "ijlt.,;:'|!()[]-/ ":
        return NARROW
    if mark in "mwMW%@":
        return WIDE
    if ord(mark) > 0x2E7F:  # Chinese and Japanese
        return FULL
    return CAPITAL if mark.isupper() else FIGURE


def _least(head: str, cells: Sequence[str], number: bool) -> float:
    """What a column needs: its longest word, or its longest number."""
    told = [BOLD * _width(word) for word in head.split(" ")]
    told += [_width(text) for text in cells] if number else [_words(text) for text in cells]
    return max([1.5, *told])


def _words(text: str) -> float:
    """The longest word of a text; short texts stay on a line."""
    whole = _width(text)
    if whole <= SHORT:
        return whole
    return max(min(_width(word), LONGEST_WORD) for word in text.split() or [""])
