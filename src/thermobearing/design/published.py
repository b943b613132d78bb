"""Temperature factors of other sources, and what codes ask, beside the model's own."""

from functools import cache
from typing import Annotated, Protocol

import numpy as np
import pandas as pd
from pydantic import Field

from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml

FOOTNOTE = "*: from memory or chosen, no source read"


class Cited(Protocol):
    """Anything that says whether its source was read."""

    @property
    def unverified(self) -> bool:
        """Whether no printed source was read."""


def marked(item: Cited) -> str:
    """Return the mark of the footnote where no source was read, else nothing.

    Parameters
    ----------
    item : a limit, rule, table or code.

    Examples
    --------
    >>> [marked(code) for code in published_codes()]
    ['*', '*', '*']
    """
    return "*" if item.unverified else ""


class PublishedTable(Strict):
    """Factors from elsewhere; `unverified` ones are from memory."""

    name: str
    quantity: str
    reference_temperature: float
    temperatures: Annotated[list[float], Field(min_length=2)]
    factors: Annotated[list[float], Field(min_length=2)]
    source: str
    unverified: bool

    @property
    def label(self) -> str:
        """Name for a legend, with the mark of `FOOTNOTE`."""
        return f"{self.name}{marked(self)}"


class PublishedCode(Strict):
    """What a code asks about temperature; `unverified`: its text was not read."""

    code: str
    says: str
    source: str
    unverified: bool


class Published(Strict):
    """What data/factors/published.toml says."""

    tables: list[PublishedTable]
    codes: list[PublishedCode]


@cache
def published_tables() -> list[PublishedTable]:
    """Factors of other sources, for comparison.

    Returns
    -------
    list of PublishedTable

    Examples
    --------
    >>> any(table.unverified for table in published_tables())
    True
    """
    return _published().tables


@cache
def published_codes() -> list[PublishedCode]:
    """What codes ask about temperature, with the source and whether it was read.

    Returns
    -------
    list of PublishedCode

    Examples
    --------
    >>> [item.code.split(",")[0] for item in published_codes()]
    ['AASHTO', 'EN 1998-2 annex JJ and EN 15129 annex J', 'JRA']
    """
    return _published().codes


@cache
def _published() -> Published:
    path = data_path("factors", "published.toml")
    return validated(Published, read_toml(path), str(path))


def coldest_factors(table: pd.DataFrame, strain: float) -> list[str]:
    """Factors of the coldest temperature and the largest of all, beside published ones, in words.

    Parameters
    ----------
    table : of `temperature_factors`.
    strain : one of its strains.

    Returns
    -------
    list of str : one for each of K_eq, Q_d and K_d.

    Examples
    --------
    >>> rows = [
    ...     {"strain": 1.0, "basis": basis, "quantity": "Q_d", "ambient_degC": -30.0, "factor": f}
    ...     for basis, f in (("first", 2.1), ("heated", 1.7))
    ... ]
    >>> coldest_factors(pd.DataFrame(rows), 1.0)[0][:56]
    'Q_d on the coldest day, -30 degC: first x 2.10, heated x'
    """
    said = []
    for quantity in ("K_eq", "Q_d", "K_d"):
        rows = table[(table["strain"] == strain) & (table["quantity"] == quantity)]
        if rows.empty:
            continue
        coldest = float(rows["ambient_degC"].min())
        cold = rows[rows["ambient_degC"] == coldest]
        mine = ", ".join(
            f"{row['basis']} x {row['factor']:.2f}"
            for row in cold.to_dict("records")
            if row["basis"] != "mean"
        )
        worst = max(rows.to_dict("records"), key=lambda row: row["factor"])
        others = [
            f"{item.label} x {np.interp(coldest, item.temperatures, item.factors):.2f}"
            f"{'' if coldest in item.temperatures else ' (between its values)'}"
            for item in published_tables()
            if item.quantity == quantity
            and item.temperatures[0] <= coldest <= item.temperatures[-1]
        ]
        beside = f"; beside it {', '.join(others)}" if others else ""
        said.append(
            f"{quantity} on the coldest day, {coldest:g} degC: {mine}; largest of all "
            f"x {worst['factor']:.2f} at {worst['ambient_degC']:g} degC{beside}"
        )
    return said
