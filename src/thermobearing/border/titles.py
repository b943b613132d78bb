"""Titles of columns: the name and the unit in them, and what they are called elsewhere."""

import re
import unicodedata
from collections.abc import Mapping
from functools import cache

from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.border.units import conversion

LONGEST_TITLE = 200  # characters that are looked at
# What a unit of a column may measure, by the unit of this package.
MEASURED = ("mm", "kN", "s", "degC", "mm/s^2", "mm/s", "Hz", "MPa", "percent", "degree", "V")
_BRACKET = re.compile(r"^(?P<name>[^\[(（]*)[\[(（](?P<unit>[^\])）]*)[\])）]?$")
_JOINED = re.compile(r"^(?P<name>.*[^\s_])_(?P<unit>[^_\d][^_]*)$")
_APART = re.compile(r"^(?P<name>.*\S)(?:\s*[,:/]\s*|\s+)(?P<unit>\S+)$")


@cache
def words(table: str) -> Mapping[str, tuple[str, ...]]:
    """One table of data/tables/words.toml: names, within or units."""
    content = read_toml(data_path("tables", "words.toml"))
    return {name: tuple(some) for name, some in content[table].items()}


def plain_title(text: str) -> str:
    """A title in small letters, with single blanks between its words.

    Examples
    --------
    >>> plain_title(" Temp_Ambient "), plain_title("Ｔ－ａｍｂ")
    ('temp ambient', 't-amb')
    """
    flat = unicodedata.normalize("NFKC", text[:LONGEST_TITLE]).lower()
    return " ".join(re.split(r"[\s_]+", flat.strip(" _\t")))


def plain_unit(text: str) -> str:
    """A unit as pint spells it, where laboratories have other ways ("sec", "℃", "tf").

    Examples
    --------
    >>> plain_unit("℃"), plain_unit("sec"), plain_unit("kN/mm")
    ('degC', 's', 'kN/mm')
    """
    flat = unicodedata.normalize("NFKC", text).strip()
    for unit, spellings in words("units").items():
        if flat.lower() in spellings:
            return unit
    return flat


@cache
def measured_in(unit: str) -> str | None:
    """The unit of this package that one of a column can be converted to, if there is any.

    Examples
    --------
    >>> measured_in("tf"), measured_in("cm"), measured_in("no")
    ('kN', 'mm', None)
    """
    for target in MEASURED:
        try:
            conversion(plain_unit(unit), target)
        except InputError:
            continue
        return target
    return None


def name_and_unit(title: str) -> tuple[str, str]:
    """The two parts of "time_s", "Force [kN]", "Weg, mm"; no unit is "".

    Examples
    --------
    >>> name_and_unit("temp_ambient_C"), name_and_unit("Force [kN]"), name_and_unit("Shear disp")
    (('temp_ambient', 'C'), ('Force', 'kN'), ('Shear disp', ''))
    """
    text = title.strip()
    if len(text) > LONGEST_TITLE:
        return text[:LONGEST_TITLE], ""
    bracket = _BRACKET.match(text)
    if bracket and bracket["name"].strip(" _"):
        return bracket["name"].strip(" _"), bracket["unit"].strip()
    joined = _JOINED.match(text)
    if joined:
        whole = plain_title(text)
        if any(whole in some for some in words("names").values()) and not _known(joined["unit"]):
            return text, ""
        return joined["name"].strip(), joined["unit"].strip()
    apart = _APART.match(text)
    if apart and _known(apart["unit"]):
        return apart["name"].rstrip(" ,:/"), apart["unit"].strip()
    return text, ""


def _known(unit: str) -> bool:
    return not unit[0].isdigit() and measured_in(unit) is not None


def is_called(name: str, quantity: str) -> bool:
    """Whether a column of this name holds a quantity ("disp" is a displacement).

    Examples
    --------
    >>> is_called("Temp_Ambient", "ambient"), is_called("変位", "displacement")
    (True, True)
    """
    flat = plain_title(name)
    return flat == quantity or flat in words("names").get(quantity, ())


def holds_word(name: str, quantity: str) -> bool:
    """Whether one of the words of a title speaks of a quantity; for guesses.

    Examples
    --------
    >>> holds_word("Chamber air T3", "ambient"), holds_word("repair", "ambient")
    (True, False)
    """
    flat = plain_title(name)
    tokens = {re.sub(r"[\d.]+$", "", token) for token in re.split(r"[^\w]+|_", flat)}
    for word in words("within")[quantity]:
        if (
            word in tokens
            or (not word.isascii() and word in flat)
            or (" " in word and word in flat)
        ):
            return True
    return False
