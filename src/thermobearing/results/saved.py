"""Read saved results."""

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from thermobearing.border.errors import LONGEST_NAME, InputError, is_file, shortened
from thermobearing.border.lazy import pd, xr
from thermobearing.results.directory import DATASET, FIGURES, IDENTIFIED, SUMMARY, check_seal
from thermobearing.results.screen import table_html
from thermobearing.results.writing import NETCDF, OTHERS

NEEDED = {"command", "outcome"}  # keys of every summary.json


@dataclass(frozen=True)
class SavedResult:
    """A result directory of `identify`, `validate`, `design`, `lambda`, `bounds` or `motions`."""

    path: Path
    summary: dict[str, Any]  # content of summary.json
    tables: "dict[str, pd.DataFrame]"  # CSV files, by name without ".csv"
    figures: list[Path]
    bearings: dict[str, Any] = field(default_factory=dict)  # identified or designed, by name

    def __getitem__(self, name: str) -> "pd.DataFrame":
        """Return a table by name."""
        if name not in self.tables:
            raise InputError(f'no table "{name}"; there are {sorted(self.tables)}', str(self.path))
        return self.tables[name]

    @property
    def command(self) -> str:
        """The command that wrote it, such as "identify"."""
        return str(self.summary["command"])

    @property
    def outcome(self) -> str:
        """The outcome."""
        return str(self.summary["outcome"])

    @property
    def warnings(self) -> list[str]:
        """Warnings about the validity of the result."""
        return [str(text) for text in self.summary.get("warnings", [])]

    def __repr__(self) -> str:
        held = ", ".join([*sorted(self.tables), *sorted(self.bearings)])
        return f"<SavedResult of {self.command}: {self.outcome}; holds {held or 'no tables'}>"

    def _repr_html_(self) -> str:
        first = next(iter(self.tables), None)
        table = pd.DataFrame() if first is None else self.tables[first]
        return table_html(f"{self.command}: {self.outcome}", table, self.warnings)


def is_saved(path: str | Path) -> bool:
    """Return whether there is a result directory with a summary at a path."""
    return is_file(Path(path) / SUMMARY)


def read_saved(path: str | Path) -> SavedResult:
    """Return the summary and the tables of a result directory."""
    folder = Path(path)
    where = shortened(str(folder), LONGEST_NAME)
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"summary.json cannot be read: {error}", where) from None
    if not isinstance(summary, dict) or not set(summary) >= NEEDED:
        raise InputError(f"is not a result of thermobearing: {SUMMARY} has no command", where)
    tables = {}
    for file in sorted(folder.glob("*.csv")):
        try:
            tables[file.stem] = pd.read_csv(file)
        except (OSError, ValueError) as error:
            raise InputError(f"{file.name} cannot be read: {error}", where) from None
    return SavedResult(folder, summary, tables, sorted((folder / FIGURES).glob("*.png")))


def read_dataset(path: str | Path, attributes: Iterable[str]) -> "xr.Dataset":
    """Return the dataset of a result directory, or of the result.nc in it.

    Refuse a damaged file, and one without some of the `attributes`.
    """
    path = Path(path)
    file = next((item for item in (path / DATASET, path) if is_file(item)), None)
    if file is None:
        fitted = "; read its bearing with load_bearing" if is_file(path / IDENTIFIED) else ""
        raise InputError(f"contains no result.nc{fitted}", shortened(str(path), LONGEST_NAME))
    check_seal(file)
    try:
        with NETCDF:
            dataset = xr.load_dataset(file, engine="netcdf4")
        dataset.attrs |= json.loads(dataset.attrs.pop(OTHERS, "{}"))
    except (
        Exception
    ) as error:  # HDF5 raises many types for a file that was changed and sealed again
        about = shortened(str(error) or type(error).__name__)
        raise InputError(f"cannot be read: {about}", str(file)) from None
    missing = set(attributes) - set(dataset.attrs)
    if missing:
        raise InputError(f"is not a result of thermobearing: no {sorted(missing)}", str(file))
    return dataset
