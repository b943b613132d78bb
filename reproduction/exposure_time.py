"""Compare K_d and Q_d of a bearing after hours in the cold with measured values in a table.

The table is a TOML file such as data/yasar-2023.toml: bearing, test, and a row for each number of
hours, temperature of the chamber and frequency. A cell is a value, or a factor on the value at the
reference temperature. Nothing is calibrated.
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

CELLS = {  # cell of a row: quantity and column of `temperature_factors`, and unit
    "K_d": ("K_d", "value", "kN/mm"),
    "Q_d": ("Q_d", "value", "kN"),
    "K_d_factor": ("K_d", "factor", "1"),
    "Q_d_factor": ("Q_d", "factor", "1"),
}


def _none_if_empty(value: object) -> object:
    """Return None for a cell that was not filled in."""
    return None if isinstance(value, str) and not value.strip() else value


EMPTY = BeforeValidator(_none_if_empty)
Strain = Annotated[float, Field(ge=0.1, le=3)]
Frequency = Annotated[float, in_unit("Hz"), Field(ge=0.001, le=5)]
Factor = Annotated[float, Field(gt=0, le=100)]


class ExposureTest(Strict):
    """Sine cycles of a test; K_d and Q_d are those of one cycle."""

    strain: Strain
    cycle: Annotated[int, Field(ge=1, le=100)]


class ExposureRow(Strict):
    """Measured values after some hours in a chamber; None where the cell is empty.

    `strain` is that of the test if it is None.
    """

    ambient: Annotated[float, in_unit("degC"), Field(ge=-60, le=60)]
    conditioned: Annotated[float, in_unit("h"), Field(gt=0, le=10_000)]
    frequency: Frequency
    strain: Strain | None = None
    K_d: Annotated[Annotated[float, in_unit("kN/mm"), Field(gt=0)] | None, EMPTY] = None
    Q_d: Annotated[Annotated[float, in_unit("kN"), Field(gt=0)] | None, EMPTY] = None
    K_d_factor: Factor | None = None
    Q_d_factor: Factor | None = None

    def place(self) -> str:
        """Return what distinguishes the row."""
        strain = "" if self.strain is None else f", {self.strain:.0%}"
        return f"{self.ambient:g} degC, {self.conditioned:g} h, {self.frequency:g} Hz{strain}"


class ExposureTable(Strict):
    """A table of measured values, with bearing and test."""

    citation: Name
    bearing: Name
    reference: Temperature
    before: Temperature
    chamber_film: Annotated[float, in_unit("W/(m^2 K)"), Field(gt=0, le=1000)] | None = None
    test: ExposureTest
    rows: Annotated[list[ExposureRow], Field(min_length=1, max_length=1000)]


class ExposureComparison(NamedTuple):
    """Predicted and measured values, and a sentence for each row without one."""

    citation: str
    table: pd.DataFrame  # ambient_degC, conditioned_h, ..., predicted, measured, ratio
    skipped: list[str]


def compare_exposure_time(path: str | Path) -> ExposureComparison:
    """Return the ratio predicted/measured of each filled cell of a table.

    Raises
    ------
    InputError : the file cannot be read, or is no table of this kind.
    """
    path = Path(path)
    stated = validated(ExposureTable, read_toml(path), str(path))
    rows: list[dict[str, Any]] = []
    skipped = []
    for row in stated.rows:
        cells = {name: getattr(row, name) for name in CELLS if getattr(row, name) is not None}
        if not cells:
            skipped.append(f"{row.place()}: no measured value in the table; skipped.")
            continue
        factors = _predicted(stated, row, path.parent)
        for name, measured in cells.items():
            quantity, column, unit = CELLS[name]
            predicted = float(factors[column][quantity])
            rows.append(
                {
                    "ambient_degC": row.ambient,
                    "conditioned_h": row.conditioned,
                    "frequency_Hz": row.frequency,
                    "strain": stated.test.strain if row.strain is None else row.strain,
                    "quantity": name,
                    "unit": unit,
                    "predicted": predicted,
                    "measured": measured,
                    "ratio": predicted / measured,
                }
            )
    return ExposureComparison(stated.citation, pd.DataFrame(rows), skipped)


def _predicted(stated: ExposureTable, row: ExposureRow, folder: Path) -> pd.DataFrame:
    """Return value and factor of each quantity in the conditions of a row.

    The reference has the same hours in a chamber at the reference temperature.
    """
    beside = stated.bearing.endswith(".toml")
    factors = temperature_factors(
        load_bearing(folder / stated.bearing if beside else stated.bearing),
        reference_temperature=stated.reference,
        temperatures=[row.ambient],
        strains=[stated.test.strain if row.strain is None else row.strain],
        period=1.0 / row.frequency,
        cycles=[stated.test.cycle],
        initial=InitialState(
            conditioning={
                "conditioned": row.conditioned,
                "before": stated.before,
                "chamber_film": stated.chamber_film,
            }
        ),
    )
    chosen = (factors["basis"] == "mean") & (factors["ambient_degC"] == row.ambient)
    return factors[chosen].set_index("quantity")


def show_exposure_time(comparison: ExposureComparison) -> None:
    """Print the comparison."""
    print(comparison.citation)
    if len(comparison.table):
        print(comparison.table.to_string(index=False, float_format="{:.3f}".format))
    for sentence in comparison.skipped:
        print(sentence)
