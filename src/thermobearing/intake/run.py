"""The story of an intake: a file -> its table -> what its columns are -> a test -> its sidecar.

Nothing is fitted and nothing is taken away; what was guessed stands in the sidecar, to be
corrected.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, is_file
from thermobearing.border.layout import Layout, Table, table_of
from thermobearing.border.schema import validated
from thermobearing.border.sheets import SEPARATORS, Sheet, Told, read_sheets
from thermobearing.border.sidecar import BlockFile, Readings, Sidecar, readings_of
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.identify.checks import check_test
from thermobearing.identify.record import TestRecord, record_of
from thermobearing.intake.guess import ColumnGuess, guessed_columns
from thermobearing.intake.result import Intake, Intakes

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
    file, given = _given(path)
    said = validated(Sidecar, given, str(path))
    told = said.told
    if said.blocks and said.blocks[0].sheet:
        told = Told(told.separator, told.decimal, told.encoding, said.blocks[0].sheet)
    layout = Layout(said.lines_before, said.lines_after, told=told)
    sheets = read_sheets(file, told)
    sheet, table, columns = _table(sheets, layout, said, file)
    keys = _guessed(file, sheets, sheet, table, columns)
    for name in TABLES:
        keys[name] = {**keys.get(name, {}), **given.get(name, {})}
    if {"ambient"} & given.keys():
        keys["columns"].pop("ambient", None)
    if "blocks" in given:
        keys.pop("file", None)
    elif "file" in given:
        keys.pop("blocks", None)
    keys |= {key: value for key, value in given.items() if key not in TABLES}
    keys = {key: value for key, value in keys.items() if value not in ({}, None)}
    readings = _read(file, keys)
    parts = int(readings.block[-1]) + 1
    if parts > 1 and "blocks" not in keys and _restarted(readings):
        keys.pop("file", None)
        keys["blocks"] = [
            {"file": file.name, "part": part} | ({"rest_before": "0 s"} if part > 1 else {})
            for part in range(1, parts + 1)
        ]
    record = record_of(readings)
    if "flip_force" not in given and _against(record):
        keys["flip_force"] = True
        record = record_of(_read(file, keys))
    if "ambient" not in keys and "ambient" not in keys.get("columns", {}):
        keys["ambient"] = f"{record.ambient:g} degC"
    return Intake(
        file=file,
        sheet=sheet.name,
        separator="" if sheet.name else SEPARATORS.get(sheet.separator, sheet.separator),
        decimal=sheet.decimal,
        rows=len(record.time),
        blocks=parts,
        columns=columns,
        record=record,
        report=check_test(record, bearing),
        sidecar=keys,
        kept=sorted(given),
        ambient=readings.values.get("ambient"),
    )


def _against(record: TestRecord) -> bool:
    """Whether the force goes against the displacement."""
    way, force = record.displacement, record.force
    return bool(np.sum((way - way.mean()) * (force - force.mean())) < 0.0)


def _given(path: Path) -> tuple[Path, dict[str, Any]]:
    """The table to look at, and what a sidecar says of it already."""
    beside = path if path.suffix.lower() == ".toml" else path.with_suffix(".toml")
    if path.suffix.lower() != ".toml" and not is_file(beside):
        return path, {}
    table = read_toml(beside)
    if path != beside and isinstance(table.get("geometry"), dict):
        return path, {}
    given = split_sources(table)[0]
    said = validated(Sidecar, given, str(beside))
    if path != beside:
        return path, given
    name = said.blocks[0].file if said.blocks else said.file or path.with_suffix(".csv").name
    return path.parent / name, given


def _table(
    sheets: list[Sheet], layout: Layout, said: Sidecar, file: Path
) -> tuple[Sheet, Table, list[ColumnGuess]]:
    """The first sheet that holds a test."""
    problems: list[str] = []
    for sheet in sheets:
        table = table_of(sheet, layout)
        name = f'sheet "{sheet.name}" ' if sheet.name else ""
        if table is None:
            problems.append(f"{name}is empty")
            continue
        if len(table.rows) < FEWEST:
            held = len(table.rows)
            problems.append(f"{name}has {held} rows of numbers; at least {FEWEST} are needed")
            continue
        try:
            return sheet, table, guessed_columns(table, said)
        except InputError as error:
            problems += error.problems
    raise InputError(problems[:5] or ["is empty"], str(file))


def _guessed(
    file: Path, sheets: list[Sheet], sheet: Sheet, table: Table, columns: list[ColumnGuess]
) -> dict[str, Any]:
    """The keys of a sidecar for what was guessed."""
    keys: dict[str, Any] = {"file": file.name}
    alike = [
        one.name
        for one in sheets
        if sheet.name and (other := table_of(one)) is not None and other.titles == table.titles
    ]
    if len(alike) > 1:
        keys = {
            "blocks": [
                {"file": file.name, "sheet": name} | ({"rest_before": "0 s"} if k else {})
                for k, name in enumerate(alike)
            ]
        }
    elif sheet.name:
        keys["sheet"] = sheet.name
    for quantity in ("time", "displacement", "force", "ambient"):
        for column in columns:
            if column.holds == quantity:
                keys.setdefault("columns", {})[quantity] = column.title
                if column.assumed:
                    keys.setdefault("units", {})[quantity] = column.assumed
    for column in columns:
        if column.holds == "temperature" and column.place:
            keys.setdefault("thermocouples", {})[column.title] = column.place
            if column.assumed:
                keys.setdefault("units", {})[column.title] = column.assumed
    return keys


def _read(file: Path, keys: dict[str, Any]) -> Readings:
    """The file as its sidecar would have it read."""
    sidecar = validated(Sidecar, keys, str(file))
    blocks = sidecar.blocks or [BlockFile(file=file.name)]
    return readings_of(sidecar, blocks, file)


def _restarted(readings: Readings) -> bool:
    return any("starts anew" in text for text in readings.assumptions)
