"""Read saved results."""

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import Any

from thermobearing.border.errors import LONGEST_NAME, InputError, shortened
from thermobearing.border.lazy import pd, xr
from thermobearing.border.opener import LARGEST_MEMBER, is_file, opened, read_json
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
        names = ", ".join([*sorted(self.tables), *sorted(self.bearings)])
        return f"<SavedResult of {self.command}: {self.outcome}; holds {names or 'no tables'}>"

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
        summary = read_json(folder / SUMMARY)
    except InputError as error:
        raise InputError(f"{SUMMARY} {error.problems[0]}", where) from None
    if not isinstance(summary, dict) or not set(summary) >= NEEDED:
        raise InputError(f"is not a result of thermobearing: {SUMMARY} has no command", where)
    tables = {}
    for file in sorted(folder.glob("*.csv")):
        try:
            tables[file.stem] = read_csv(file)
        except InputError as error:
            raise InputError(f"{file.name} {error.problems[0]}", where) from None
    return SavedResult(folder, summary, tables, sorted((folder / FIGURES).glob("*.png")))


def read_csv(file: Path) -> "pd.DataFrame":
    """Return a table of a result directory; InputError if it cannot be read."""
    try:
        with opened(file, LARGEST_MEMBER) as content:
            # Tables of motions begin with comments on their record.
            comments = sum(1 for _ in takewhile(lambda line: line.startswith(b"#"), content))
            content.seek(0)
            return pd.read_csv(content, skiprows=comments)
    except InputError:
        raise
    except ValueError as error:  # no table, or no text
        raise InputError(f"is not a table of a result: {error}", str(file)) from None


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
        error_text = shortened(str(error) or type(error).__name__)
        raise InputError(f"cannot be read: {error_text}", str(file)) from None
    missing = set(attributes) - set(dataset.attrs)
    if missing:
        raise InputError(f"is not a result of thermobearing: no {sorted(missing)}", str(file))
    return dataset
