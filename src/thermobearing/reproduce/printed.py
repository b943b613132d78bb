"""Numbers of the print that no bearing or structure has: `data/claims/printed.toml`."""

from functools import cache
from typing import Annotated

from pydantic import Field

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.reproduce.runs import Runs, parameters


class Printed(Strict):
    """A number, its unit, and where it stands."""

    value: Annotated[float, Field(ge=-1e12, le=1e12)]
    unit: str
    source: Annotated[str, Field(min_length=1)]


class _PrintedFile(Strict):
    """The file of them."""

    numbers: dict[str, Printed]


@cache
def printed_numbers() -> dict[str, Printed]:
    """All of them, by symbol."""
    path = data_path("claims", "printed.toml")
    return validated(_PrintedFile, {"numbers": read_toml(path)}, str(path)).numbers


def printed(runs: Runs, symbol: str) -> float:
    """A number of the print, times what `runs` changes it by.

    Parameters
    ----------
    runs : simulations; a parameter of `of = "print"` changes these numbers.
    symbol : in `data/claims/printed.toml`.

    Raises
    ------
    InputError : no such number.

    Examples
    --------
    >>> printed(Runs(), "u_B")
    178.0
    """
    known = printed_numbers()
    if symbol not in known:
        raise InputError(f'no printed number "{symbol}"{nearest(symbol, known)}', "printed()")
    value = known[symbol].value
    for name, factor in runs.change.items():
        parameter = parameters()[name]
        if parameter.of == "print" and parameter.key == symbol:
            value *= factor
    return value
