"""The story of an intake: a file, read as every command reads it -> a test -> its sidecar.

Nothing is fitted and nothing is removed; what was guessed stands in the sidecar, to be corrected.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.record import build_record
from thermobearing.intake.result import Intake, Intakes
from thermobearing.tables.guess import ColumnGuess
from thermobearing.tables.laboratory import COLUMNS, Readings, read_laboratory
from thermobearing.tables.text import SEPARATORS

FEWEST = 10  # rows of numbers that make a test
TABLES = ("columns", "units", "thermocouples")


def take_in(
    files: Sequence[str | Path] | str | Path, bearing: Bearing | str | Path | None = None
) -> Intakes:
    r"""Look at a laboratory's files: columns, units, blocks, rests, spikes, drift, ambient.

    Parameters
    ----------
    files : tables (text or `.xlsx`), or sidecars, whose keys then win over what is guessed.
    bearing : plan area and rubber thickness, for the plausibility of strains and stresses.

    Returns
    -------
    Intakes : of the files that could be read; `problems` says why others could not.

    Raises
    ------
    InputError : no file can be read, or nothing in them looks like a test.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> t = np.linspace(0.0, 4.0, 401)
    >>> x = 30.0 * np.sin(2.0 * np.pi * t)
    >>> rows = "".join(f"{a};{b};{2.0 * b}\n" for a, b in zip(t, x)).replace(".", ",")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "t.csv"
    ...     _ = file.write_text("Zeit [s];Weg;Load cell [kN]\n" + rows)
    ...     (found,) = take_in(file).files
    >>> found.sidecar["columns"]
    {'time': 'Zeit [s]', 'displacement': 'Weg', 'force': 'Load cell [kN]'}
    >>> found.sidecar["units"], found.decimal
    ({'displacement': 'mm'}, ',')
    """
    some = [files] if isinstance(files, str | Path) else list(files)
    if not some:
        raise InputError("give at least one file")
    found, problems = [], []
    for file in some:
        try:
            found.append(_one(Path(file), bearing))
        except InputError as error:
            problems += (
                error.lines() if error.where else [f"{file}: {one}" for one in error.problems]
            )
    if not found:
        raise InputError(problems)
    return Intakes(found, problems)


def _one(path: Path, bearing: Bearing | str | Path | None) -> Intake:
    readings = read_laboratory(path)
    found, given = readings.recognised, readings.given
    if len(readings.values["time"]) < FEWEST:
        rows = len(readings.values["time"])
        raise InputError(f"has {rows} rows of numbers; at least {FEWEST} are needed", str(path))
    parts = int(readings.block[-1]) + 1
    record = build_record(readings)
    keys = _files(readings, parts) | _tables(found.columns)
    if readings.sidecar.flip_force:
        keys["flip_force"] = True
    for name in TABLES:
        keys[name] = {**keys.get(name, {}), **given.get(name, {})}
    if "ambient" in given:
        keys["columns"].pop("ambient", None)
    elif "ambient" not in keys["columns"]:
        keys["ambient"] = f"{record.ambient:g} degC"
    keys |= {key: value for key, value in given.items() if key not in TABLES}
    sheet = found.sheet
    return Intake(
        file=found.file,
        sheet=sheet.name,
        separator="" if sheet.name else SEPARATORS.get(sheet.separator, sheet.separator),
        decimal=sheet.decimal,
        rows=len(record.time),
        blocks=parts,
        columns=found.columns,
        record=record,
        report=check_test(record, bearing),
        sidecar={key: value for key, value in keys.items() if value not in ({}, None)},
        folder=readings.file.parent,
        kept=sorted(given),
        ambient=readings.values.get("ambient"),
    )


def _files(readings: Readings, parts: int) -> dict[str, Any]:
    """The keys of a sidecar for the file: its name, its sheet, or its blocks."""
    found, given = readings.recognised, readings.given
    if {"file", "blocks"} & given.keys():
        return {}
    name = found.file.name
    if len(found.alike) > 1:
        blocks: list[dict[str, Any]] = [{"file": name, "sheet": sheet} for sheet in found.alike]
    elif parts > 1 and any("starts anew" in text for text in readings.assumptions):
        blocks = [{"file": name, "part": part} for part in range(1, parts + 1)]
    else:
        return {"file": name} | ({"sheet": found.sheet.name} if found.sheet.name else {})
    return {"blocks": [blocks[0], *(block | {"rest_before": "0 s"} for block in blocks[1:])]}


def _tables(columns: list[ColumnGuess]) -> dict[str, Any]:
    """The keys of a sidecar for what the columns were taken for."""
    keys: dict[str, dict[str, str]] = {name: {} for name in TABLES}
    for column in columns:
        if column.holds in COLUMNS:
            keys["columns"][column.holds] = column.title
        elif column.place:
            keys["thermocouples"][column.title] = column.place
        else:
            continue
        if column.assumed:
            keys["units"][column.title if column.place else column.holds] = column.assumed
    return {name: table for name, table in keys.items() if table}
