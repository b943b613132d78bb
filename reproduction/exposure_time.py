"""Compare K_d and Q_d of a bearing after hours in the cold with measured values in a table.

The table is a TOML file such as data/yasar-2023.toml: bearing, test, and a row for each number of
hours and temperature of the chamber. Nothing is calibrated.
"""

from pathlib import Path
from typing import Annotated, Any, NamedTuple

import pandas as pd
from pydantic import BeforeValidator, Field

from thermobearing.bearing.library import load_bearing
from thermobearing.border.schema import Name, Strict, in_unit, validated
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.case import InitialState
from thermobearing.design.factors import temperature_factors
from thermobearing.tables.conditioning import Temperature

UNITS = {"K_d": "kN/mm", "Q_d": "kN"}


def _none_if_empty(value: object) -> object:
    """Return None for a cell that was not filled in."""
    return None if isinstance(value, str) and not value.strip() else value


EMPTY = BeforeValidator(_none_if_empty)


class ExposureTest(Strict):
    """Sine cycles of a test; K_d and Q_d are those of one cycle."""

    strain: Annotated[float, Field(ge=0.1, le=3)]
    period: Annotated[float, in_unit("s"), Field(ge=0.2, le=1000)]
    cycle: Annotated[int, Field(ge=1, le=100)]


class ExposureRow(Strict):
    """Measured values after some hours in a chamber; None where the cell is empty."""

    ambient: Annotated[float, in_unit("degC"), Field(ge=-60, le=60)]
    conditioned: Annotated[float, in_unit("h"), Field(gt=0, le=10_000)]
    K_d: Annotated[Annotated[float, in_unit("kN/mm"), Field(gt=0)] | None, EMPTY] = None
    Q_d: Annotated[Annotated[float, in_unit("kN"), Field(gt=0)] | None, EMPTY] = None


class ExposureTable(Strict):
    """A table of measured values, with bearing and test."""

    citation: Name
    bearing: Name
    before: Temperature
    chamber_film: Annotated[float, in_unit("W/(m^2 K)"), Field(gt=0, le=1000)] | None = None
    test: ExposureTest
    rows: Annotated[list[ExposureRow], Field(min_length=1, max_length=1000)]


class ExposureComparison(NamedTuple):
    """Predicted and measured values, and a sentence for each row with empty cells."""

    citation: str
    table: pd.DataFrame  # ambient_degC, conditioned_h, quantity, unit, predicted, measured, ratio
    skipped: list[str]


def compare_exposure_time(path: str | Path) -> ExposureComparison:
    """Return the ratio predicted/measured of each filled cell of a table.

    Raises
    ------
    InputError : the file cannot be read, or is no table of this kind.
    """
    path = Path(path)
    stated = validated(ExposureTable, read_toml(path), str(path))
    beside = stated.bearing.endswith(".toml")
    bearing = load_bearing(path.parent / stated.bearing if beside else stated.bearing)
    rows: list[dict[str, Any]] = []
    skipped = []
    for row in stated.rows:
        empty = [name for name in UNITS if getattr(row, name) is None]
        if empty:
            place = f"{row.ambient:g} degC, {row.conditioned:g} h"
            skipped.append(f"{place}: no measured {' and '.join(empty)} in the table; skipped.")
        if len(empty) == len(UNITS):
            continue
        factors = temperature_factors(
            bearing,
            reference_temperature=row.ambient,
            temperatures=[row.ambient],
            strains=[stated.test.strain],
            period=stated.test.period,
            cycles=[stated.test.cycle],
            initial=InitialState(
                conditioning={
                    "conditioned": row.conditioned,
                    "before": stated.before,
                    "chamber_film": stated.chamber_film,
                }
            ),
        )
        values = factors[factors["basis"] == "mean"].set_index("quantity")["value"]
        for name in [name for name in UNITS if name not in empty]:
            predicted, measured = float(values[name]), getattr(row, name)
            rows.append(
                {
                    "ambient_degC": row.ambient,
                    "conditioned_h": row.conditioned,
                    "quantity": name,
                    "unit": UNITS[name],
                    "predicted": predicted,
                    "measured": measured,
                    "ratio": predicted / measured,
                }
            )
    return ExposureComparison(stated.citation, pd.DataFrame(rows), skipped)


def show_exposure_time(comparison: ExposureComparison) -> None:
    """Print the comparison."""
    print(comparison.citation)
    if len(comparison.table):
        print(comparison.table.to_string(index=False, float_format="{:.3f}".format))
    for sentence in comparison.skipped:
        print(sentence)
