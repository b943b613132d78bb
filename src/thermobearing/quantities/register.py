"""The one place where a quantity has its words, unit and format.

The rows stand in ``data/quantities/*.toml``, by the name that the quantity has in tables and CSV
files. Labels of datasets, heads of tables on the console and in reports, sheets of workbooks and
labels of axes come from here.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from thermobearing.border.library import data_path

MINUS = "\N{MINUS SIGN}"
FACTORS = {  # from a stored unit to the unit that readers see
    ("1", "%"): 100.0,
    ("kN mm", "kJ"): 1e-3,
    ("kN mm", "kN m"): 1e-3,
    ("kN mm/rad", "kN m/rad"): 1e-3,
    ("kN s^2/mm", "t"): 1e3,
    ("kN mm s^2", "t m²"): 1e-3,
}
TYPESET = {
    **{"1": "", "degC": "°C", "m/s2": "m/s²", "mm2": "mm²", "kg/m^3": "kg/m³"},
    **{"W/(m^2 K)": "W/(m² K)", "kJ/(m^2 K)": "kJ/(m² K)"},
}


@dataclass(frozen=True)
class Quantity:
    """A quantity as readers see it; also a column of a table.

    >>> strain = quantity("bearing_strain_max")
    >>> strain.title, strain.text(strain.shown(2.613)), strain.stored
    ('Strain [%]', '261', '1')
    """

    head: str  # words above a column, without the unit
    unit: str = ""  # that readers see, such as "kN"; "" for words and pure numbers
    form: str = ".3g"  # Python format of a number in `unit`
    name: str = ""  # in tables and CSV files, such as "bearing_force_max_kN"
    stored: str = ""  # unit of the stored number; "1" for pure numbers
    factor: float = 1.0  # from a stored number to one in `unit`
    meaning: str = ""  # long name in datasets, and label of an axis
    symbol: str = ""  # in equations, such as "K_eq"
    variable: str = ""  # name in datasets; `name` where the row does not give another one
    rounding: float = 0.0  # a stored number of less magnitude is rounding: 0 in JSON and CSV

    @property
    def title(self) -> str:
        """Head with the unit in brackets."""
        return f"{self.head} [{self.unit}]" if self.unit else self.head

    @property
    def label(self) -> str:
        """Label of an axis: the meaning, or the head, with the unit in brackets."""
        words = self.meaning or self.head
        return f"{words} [{self.unit}]" if self.unit else words

    @property
    def definition(self) -> str:
        """The meaning, and below what magnitude JSON and CSV files have 0."""
        limit = f"{self.rounding:.0e} {self.stored}".removesuffix(" 1")
        return (
            f"{self.meaning or self.head}; 0 where less than {limit}"
            if self.rounding
            else self.meaning
        )

    def without_rounding(self, value: Any) -> Any:
        """Return a stored number, or an array of them, with 0 for what is rounding only.

        The digits of such a number depend on the processor.

        >>> quantity("thermal_residual").without_rounding(-2.3e-16)
        0.0
        """
        if not self.rounding or value is None or isinstance(value, str):
            return value
        if np.ndim(value) == 0:
            return 0.0 if abs(float(value)) < self.rounding else value
        return np.where(np.abs(value) < self.rounding, 0.0, value)

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of a variable of a dataset: `units` and `long_name`."""
        return {"units": self.stored or "1", "long_name": self.meaning or self.head}

    def shown(self, value: Any) -> Any:
        """Return a stored number in the unit that readers see; words and integers as they are."""
        value = self.without_rounding(value)
        if self.factor == 1.0 or value is None or isinstance(value, str):
            return value
        return self.factor * value

    def text(self, value: Any) -> str:
        """Return a cell with a value in `unit`; nothing for None and NaN, a bound for rounding.

        >>> quantity("thermal_residual").text(0.0)
        '< 1e−12'
        """
        if value is None or (isinstance(value, float | np.floating) and not np.isfinite(value)):
            return ""
        if isinstance(value, bool | np.bool_):
            return "yes" if value else "no"
        if isinstance(value, int | float | np.integer | np.floating):
            limit = self.factor * self.rounding
            if abs(float(value)) < limit:
                return f"< {format_number(limit, '.0e')}"
            return format_number(value, self.form)
        return str(value)


def format_number(value: Any, form: str = ".3g") -> str:
    """Return a number with a true minus sign, and without an exponent from 1e-4 to 1e6."""
    text = format(int(value) if form == "d" else value, form)
    if "e" in text and form.endswith("g") and 1e-4 <= abs(value) < 1e6:
        text = format(value, ".0f" if abs(value) >= 1.0 else ".6f")
        text = text.rstrip("0") if "." in text else text
    text = text.lstrip("-") if float(text) == 0.0 else text
    return text.replace("e-0", "e-").replace("e+0", "e").replace("-", MINUS)


@cache
def registered_quantities() -> Mapping[str, Quantity]:
    """Return all rows of the register by name."""
    quantities: dict[str, Quantity] = {}
    for file in sorted(data_path("quantities").iterdir(), key=lambda path: path.name):
        for name, row in tomllib.loads(file.read_text(encoding="utf-8")).items():
            if name in quantities:
                raise ValueError(f"{file.name}: {name} is registered twice")
            stored = row.pop("unit", "")
            unit = row.pop("shown", TYPESET.get(stored, stored))
            factor = FACTORS.get((stored, unit), 1.0)
            if factor == 1.0 and unit != TYPESET.get(stored, stored):
                raise ValueError(f"{file.name}: {name}: no factor from {stored} to {unit}")
            row.setdefault("variable", name)
            quantities[name] = Quantity(unit=unit, name=name, stored=stored, factor=factor, **row)
    return quantities


def quantity(name: str, /, **changes: Any) -> Quantity:
    """Return a row of the register by its name in tables; `changes` are fields that differ here.

    Raises KeyError if the register has no such quantity.

    >>> quantity("bearing_force_max_kN").title
    'Force of one [kN]'
    >>> quantity("bearing_force_max_kN", head="Peak force", form=".1f").title
    'Peak force [kN]'
    """
    registered = registered_quantities()[name]
    return replace(registered, **changes) if changes else registered
