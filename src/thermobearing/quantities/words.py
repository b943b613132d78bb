"""Sentences and cells of a document: lists in words, temperatures, units as one prints them."""

import hashlib
import re
from collections.abc import Iterable, Sequence

from thermobearing.quantities.register import FACTORS, MINUS, TYPESET, format_number

number = format_number
SHARE = re.compile(r"(\d)%")
NEGATIVE = re.compile(r"(?<![\w.-])-(?=\d)")
# From a unit of the package to one that engineers quote; the others are only set in type.
QUOTED = {"kN s^2/mm": "t", "kN mm s^2": "t m²", "kN mm": "kN m", "kN mm/rad": "kN m/rad"}


def joined(items: Iterable[str], last: str = "and") -> str:
    """Return items as a list in a sentence: "a, b and c"."""
    texts = list(items)
    if len(texts) < 2:
        return "".join(texts)
    return f"{', '.join(texts[:-1])} {last} {texts[-1]}"


def part_label(kind: str, name: str) -> str:
    """Return a line or pier as "line A1"; a name that begins so stands alone.

    >>> part_label("pier", "P1"), part_label("pier", "Pier 1")
    ('pier P1', 'Pier 1')
    """
    return name if name.lower().startswith(kind) else f"{kind} {name}"


def degrees(values: Sequence[float]) -> str:
    """Return temperatures in a sentence, each once: "23 and −20 °C"."""
    text = joined(dict.fromkeys(f"{round(value, 2) + 0.0:g}" for value in values))
    return f"{text} °C".replace("-", MINUS)


def first_sentences(text: str, length: int) -> str:
    """Return the complete sentences that fit into a line, or the first clause in full.

    A clause ends with a semicolon or a sentence. It may be longer than the line: a warning that
    ends in the middle of a clause does not say what it is about.

    >>> first_sentences("The force is off by 3 kN (1 % of the peak); an offset removes it.", 30)
    'The force is off by 3 kN (1 % of the peak).'
    """
    if len(text) <= length:
        return text
    sentence = text[:length].rpartition(". ")[0]
    if sentence:
        return f"{sentence}."
    for end in re.finditer(r"; |\. ", text):
        clause = text[: end.start()]
        # A semicolon inside a parenthesis ends no clause.
        if clause.count("(") == clause.count(")"):
            return f"{clause}."
    return text


def percent(share: float, digits: int = 0) -> str:
    """Return a share as per cent: "45 %"."""
    text = f"{100.0 * share:.{digits}f}"
    text = text.lstrip("-") if float(text) == 0.0 else text
    return f"{text} %".replace("-", MINUS)


def change(ratio: float, more: str = "more", less: str = "less") -> str:
    """Return a ratio as a change: "45 % more"."""
    if abs(ratio - 1.0) < 0.005:
        return "the same within 0.5 %"
    if ratio > 3.0:
        return f"{ratio:.1f} times as much"
    return f"{percent(abs(ratio - 1.0))} {more if ratio > 1.0 else less}"


def counted(count: int, singular: str, plural: str = "") -> str:
    """Return a number of things: "1 run", "12 runs"."""
    return f"{count} {singular if count == 1 else plural or singular + 's'}"


def plain(words: str) -> str:
    """Return words of a result as a document prints them: °C, true minus signs, spaced %."""
    return SHARE.sub(r"\1 %", NEGATIVE.sub(MINUS, words.replace(" degC", " °C")))


def quantity(text: str) -> str:
    """Return a number with its unit, as TOML has it, in a sentence: "−10 °C"."""
    value, _, unit = str(text).partition(" ")
    shown = plain(f"{number(float(value), '.6g')} {printed_unit(unit)[0] or unit}".strip())
    return shown.replace(" 1/", "/")


def tidy(sentence: str) -> str:
    """Return a sentence of a result as a document prints it, with its full stop."""
    text = plain(sentence.strip())
    return text if text.endswith((".", "!", "?")) else f"{text}."


def printed_unit(unit: str) -> tuple[str, float]:
    """Return how one prints a unit of the package, and the factor on its numbers."""
    if shown := QUOTED.get(unit):
        return shown, FACTORS[unit, shown]
    return TYPESET.get(unit, unit), 1.0


def identity_rows(
    version: str, inputs: str, command: str, what: str = "case.resolved.toml"
) -> dict[str, str]:
    """Return version, command, and the digest by which a reader can verify the file `what`."""
    digest = hashlib.sha256(inputs.encode("utf-8", "surrogateescape")).hexdigest()
    rows = {"Version": f"thermobearing {version}", "Command": command}
    return rows | {f"SHA-256 of {what}": digest}
