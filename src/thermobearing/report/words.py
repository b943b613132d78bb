"""Sentences and cells of a document: lists in words, temperatures, units as one prints them."""

import hashlib
import re
from collections.abc import Iterable, Sequence

MINUS = "\N{MINUS SIGN}"
SHARE = re.compile(r"(\d)%")
NEGATIVE = re.compile(r"(?<![\w.-])-(?=\d)")
# Of the package's units: how one prints them, and the factor to a unit that engineers quote.
PRINTED = {
    "1": ("", 1.0),
    "degC": ("°C", 1.0),
    "m/s2": ("m/s²", 1.0),
    "mm2": ("mm²", 1.0),
    "kg/m^3": ("kg/m³", 1.0),
    "W/(m^2 K)": ("W/(m² K)", 1.0),
    "kJ/(m^2 K)": ("kJ/(m² K)", 1.0),
    "kN s^2/mm": ("t", 1e3),
    "kN mm s^2": ("t m²", 1e-3),
    "kN mm": ("kN m", 1e-3),
    "kN mm/rad": ("kN m/rad", 1e-3),
}


def joined(items: Iterable[str], last: str = "and") -> str:
    """Items of a list in a sentence.

    Examples
    --------
    >>> joined(["a", "b", "c"])
    'a, b and c'
    """
    found = list(items)
    if len(found) < 2:
        return "".join(found)
    return f"{', '.join(found[:-1])} {last} {found[-1]}"


def number(value: float, form: str = ".3g") -> str:
    """A number in a sentence, with a true minus sign and no exponent below a million.

    Examples
    --------
    >>> number(1234.6), number(-0.0321)
    ('1235', '−0.0321')
    """
    text = format(value, form)
    if "e" in text and 1e-4 <= abs(value) < 1e6:
        text = format(value, ".0f") if abs(value) >= 1.0 else format(value, ".6f").rstrip("0")
    return text.replace("e-0", "e-").replace("e+0", "e").replace("-", MINUS)


def degrees(values: Sequence[float]) -> str:
    """Temperatures in a sentence, each once.

    Examples
    --------
    >>> degrees([23.0, -20.0])
    '23 and −20 °C'
    """
    told = joined(f"{value:g}" for value in dict.fromkeys(values))
    return f"{told} °C".replace("-", MINUS)


def percent(share: float, digits: int = 0) -> str:
    """A share as per cent.

    Examples
    --------
    >>> percent(0.453), percent(-0.02)
    ('45 %', '−2 %')
    """
    text = f"{100.0 * share:.{digits}f}"
    text = text.lstrip("-") if float(text) == 0.0 else text
    return f"{text} %".replace("-", MINUS)


def change(ratio: float, more: str = "more", less: str = "less") -> str:
    """A ratio as a change: "45 % more".

    Examples
    --------
    >>> change(1.45), change(0.9, "higher", "lower"), change(1.001)
    ('45 % more', '10 % lower', 'the same within 0.5 %')
    """
    if abs(ratio - 1.0) < 0.005:
        return "the same within 0.5 %"
    if ratio > 3.0:
        return f"{ratio:.1f} times as much"
    return f"{percent(abs(ratio - 1.0))} {more if ratio > 1.0 else less}"


def counted(count: int, one: str, many: str = "") -> str:
    """A number of things.

    Examples
    --------
    >>> counted(1, "run"), counted(12, "run")
    ('1 run', '12 runs')
    """
    return f"{count} {one if count == 1 else many or one + 's'}"


def plain(words: str) -> str:
    """Words of a result as a document prints them: °C, and true minus signs before numbers.

    Examples
    --------
    >>> plain("jra-i-i-1, -20 degC")
    'jra-i-i-1, −20 °C'
    """
    return SHARE.sub(r"\1 %", NEGATIVE.sub(MINUS, words.replace(" degC", " °C")))


def quantity(text: str) -> str:
    """A number with its unit, as TOML has it, in a sentence.

    Examples
    --------
    >>> quantity("-10.0 degC"), quantity("600.0 s")
    ('−10 °C', '600 s')
    """
    value, _, unit = str(text).partition(" ")
    return plain(f"{number(float(value), '.6g')} {printed_unit(unit)[0] or unit}".strip())


def tidy(sentence: str) -> str:
    """A sentence of a result as a document prints it, with its full stop."""
    text = plain(sentence.strip())
    return text if text.endswith((".", "!", "?")) else f"{text}."


def printed_unit(unit: str) -> tuple[str, float]:
    """How one prints a unit of the package, and the factor on its numbers.

    Examples
    --------
    >>> printed_unit("kN s^2/mm"), printed_unit("mm")
    (('t', 1000.0), ('mm', 1.0))
    """
    return PRINTED.get(unit, (unit, 1.0))


def identity_rows(
    version: str, went_in: str, again: str, what: str = "case.resolved.toml"
) -> dict[str, str]:
    """Rows of the last table of a document.

    Parameters
    ----------
    version : of thermobearing.
    went_in : text whose bits make the result: the resolved case.
    again : the command.
    what : the text is.

    Examples
    --------
    >>> identity_rows("0.2.0", "", "thermobearing cyclic case.resolved.toml")["Version"]
    'thermobearing 0.2.0'
    """
    digest = hashlib.sha256(went_in.encode("utf-8", "surrogateescape")).hexdigest()
    return {
        "Version": f"thermobearing {version}",
        f"Input (SHA-256 of {what})": digest,
        "Command": again,
    }
