"""Run the inspection of laboratory files: file -> test -> sidecar.

Nothing is calibrated or removed; assumptions are listed in the sidecar, to be corrected.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, OutputError, printable
from thermobearing.border.lazy import pd
from thermobearing.border.text_file import file_names, write_file
from thermobearing.core.records import Floats
from thermobearing.identify.records.checks import CheckReport, check_test, reading_at_zero
from thermobearing.identify.records.record import TestRecord, build_record
from thermobearing.identify.records.treatment import UNITS
from thermobearing.model.options import ModelOptions
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table
from thermobearing.report.workbook import sheets_bytes
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import SIDECARS, check_target
from thermobearing.results.figure_style import Wanted
from thermobearing.results.screen import say, show_table
from thermobearing.tables.columns import holds_word
from thermobearing.tables.guess import AXIAL, ColumnGuess
from thermobearing.tables.laboratory import COLUMNS, KEY, Readings, description, read_laboratory
from thermobearing.tables.text import SEPARATORS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermobearing.identify.records.figures import RecordFigures

FEWEST_LAYERS = 2  # of a template without a bearing
FEWEST = 10  # smallest number of rows of a test
TABLES = ("columns", "units", "thermocouples")
USED = (*COLUMNS, AXIAL, "strain")
HEADS = [Quantity(head) for head in ("column", "unit", "used as", "reason")]


@dataclass(frozen=True)
class Intake:
    """The findings in one file."""

    file: Path
    sheet: str  # of a workbook, "" for text
    separator: str
    decimal: str
    rows: int  # of numbers
    blocks: int  # that the file or its clock is cut into
    columns: list[ColumnGuess]
    record: TestRecord  # as the sidecar reads it
    report: CheckReport
    sidecar: dict[str, Any]  # its keys, including those of an existing sidecar
    folder: Path  # that the files named in `sidecar` are seen from
    kept: list[str] = field(default_factory=list)  # keys that came from the sidecar
    ambient: Floats | None = None  # samples of the column [degC], where there is one
    assumed_ambient: bool = False  # neither the sidecar nor the file states it
    layers: int = 0  # of rubber in the bearing; 0 where none is named

    def plot(self) -> "Figure":
        """Return the figure: histories with findings, loops, temperatures."""
        from thermobearing.identify.records.figures import draw_record

        return draw_record(self.report, self.ambient, assumed=self.assumed_ambient)

    def table(self) -> Table:
        """Return the recognised quantity of each column, with a caption about the file."""
        form = f'sheet "{self.sheet}"' if self.sheet else f"separated by {self.separator}"
        comma = "decimal comma, " if self.decimal == "," else ""
        blocks = "1 block" if self.blocks == 1 else f"{self.blocks} blocks"
        length = float(self.record.time[-1] - self.record.time[0])
        caption = (
            f"{self.file.name}: {form}, {comma}{self.rows} rows in {blocks}, {length:.4g} s, "
            f"ambient {'not known' if self.record.unclear else f'{self.record.ambient:.4g} degC'}"
        )
        rows = []
        for column in self.columns:
            unit = f"{column.assumed} (assumed)" if column.assumed else column.unit
            use, reason = column.holds if column.holds in USED else "not used", column.why
            if column.holds == "temperature":
                use = column.place or use
                reason = reason if column.place else "temperature inside? state its place to use it"
            rows.append([printable(text) for text in (column.title, unit, use, reason)])
        return Table(printable(caption), HEADS, rows, keys=len(HEADS))

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the file."""
        treatment = self.report.treatment
        return {
            "file": str(self.file),
            **{k: getattr(self, k) for k in ("sheet", "separator", "decimal", "rows", "blocks")},
            "ambient_degC": None if self.record.unclear else self.record.ambient,
            "columns": [vars(column) for column in self.columns],
            "unused_columns": list(self.record.unused),
            "findings": [vars(finding) for finding in self.report.findings],
            "treatment": treatment.summary() if treatment else None,
            "sidecar": self.sidecar,
        }

    def _sidecar_text(self, folder: Path) -> str:
        """Return TOML that `load_test` reads, with file names relative to its folder."""
        keys = {key: value for key, value in self.sidecar.items() if not isinstance(value, dict)}
        if "file" in keys:
            keys["file"] = _seen_from(folder, self.folder / keys["file"])
        if "blocks" in keys:
            keys["blocks"] = [
                block | {"file": _seen_from(folder, self.folder / block["file"])}
                for block in keys["blocks"]
            ]
        lines = [f"# {self.file.name}, generated by thermobearing intake; check and correct it."]
        lines += [f"# {finding.level}: {finding.sentence}" for finding in self.report.findings]
        lines += [tomli_w.dumps(keys).strip(), *self._suggestions()]
        assumed = [column.title for column in self.columns if column.assumed]
        for name, table in self.sidecar.items():
            if isinstance(table, dict):
                lines.append("")
                if name == "units" and assumed:
                    lines.append(f"# assumed, not stated in the file: {', '.join(assumed)}")
                lines.append(tomli_w.dumps({name: table}).strip())
        placeless = [c.title for c in self.columns if c.holds == "temperature" and not c.place]
        if placeless and "thermocouples" not in self.sidecar:
            lines += ["", "# [thermocouples]  # rubber 1 is the outer layer; or lead"]
        lines += [
            f"# {tomli_w.dumps({title: place}).strip()}  # an example: state its place"
            for title, place in _example_places(placeless, self.layers).items()
        ]
        # TOML escapes what cannot be printed; comments do not.
        marked = [printable(line) if line.startswith("#") else line for line in lines]
        return "\n".join(marked) + "\n"

    def _suggestions(self) -> list[str]:
        """Optional keys, as comments."""
        treatment = self.report.treatment
        spikes = treatment is not None and any(s.any() for s in treatment.spikes.values())
        drifting = list(treatment.drifts) if treatment is not None else []
        drifting_quantity = drifting[0] if len(drifting) == 1 else "both"
        offsets = {
            f'# {offset.name}_offset = "{reading_at_zero(self.record, offset.name, offset.size)} '
            f'{UNITS[offset.name]}"  # take the offset out': offset.warned
            for offset in self.report.offsets
        }
        suggestions = {
            '# bearing = "..."  # geometry and materials: a name, or a file in this folder': (
                "bearing" not in self.sidecar
            ),
            "# rest_before: pause before each block": ("blocks" in self.sidecar),
            f'# ambient = "{self.record.ambient:g} degC"  # assumed; confirm or correct it': (
                self.assumed_ambient
            ),
            '# ambient = "... degC"  # or name its column in [columns]': bool(self.record.unclear),
            "# despike = true  # remove the spikes": spikes,
            f'# detrend = "{drifting_quantity}"  # take the drift out': bool(drifting),
            **offsets,
        }
        return [line for line, applies in suggestions.items() if applies]


def _seen_from(folder: Path, file: Path) -> str:
    """Return a path relative to a folder; absolute if they share no root (another drive)."""
    try:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    except ValueError:
        return file.resolve().as_posix()


@dataclass(frozen=True, repr=False)
class Intakes(Result):
    """The findings in several files; `problems` states why others could not be read."""

    title = "Laboratory files"
    _figures = "RecordFigures"

    files: list[Intake]
    problems: list[str] = field(default_factory=list)

    @property
    def outcome(self) -> str:
        """The outcome: "completed" or "files_left_out"."""
        return "files_left_out" if self.problems else COMPLETED

    @property
    def _names(self) -> list[str]:
        """Names of the files of sidecars and figures."""
        return file_names(item.file.stem for item in self.files)

    @property
    def plot(self) -> "RecordFigures":
        """Figures of the files, by name."""
        from thermobearing.identify.records.figures import RecordFigures

        draw = [item.plot for item in self.files]
        return RecordFigures(dict(zip(self._names, draw, strict=True)))

    @property
    def table(self) -> "pd.DataFrame":
        """The recognised quantity of each column of each file."""
        pairs = [(item.file.name, column) for item in self.files for column in item.columns]
        return pd.DataFrame([{"file": name, **vars(column)} for name, column in pairs])

    def show(self) -> None:
        """Print columns and findings of each file."""
        for item in self.files:
            show_table(item.table())
            for finding in item.report.findings:
                level = finding.level.upper() if finding.level == "refused" else finding.level
                say(printable(f"  {level:8} {finding.check}: {finding.sentence}"))

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json: the findings in each file."""
        return {
            "command": "intake",
            "outcome": self.outcome,
            "problems": list(self.problems),
            "files": [item.summary() for item in self.files],
        }

    @checked
    def save(
        self,
        directory: str | Path,
        *,
        overwrite: bool = False,
        figures: Wanted = True,
        write_sidecars: bool = False,
    ) -> Path:
        """Write summary.json, and a sidecar and a figure for each file.

        With `write_sidecars`, each sidecar is also written next to its file for `load_test`;
        an existing one is never replaced. See `Result.save` for the other arguments.
        """
        check_target(Path(directory), overwrite=overwrite)
        files = self.files if write_sidecars else []
        targets = [item.file.with_suffix(".toml") for item in files]
        existing = [str(path) for path in targets if path.exists()]
        if existing or len(set(targets)) < len(targets):
            first = existing[0] if existing else str(targets[0])
            raise OutputError(f"{first}: exists; correct it, or omit --write-sidecars")
        written = super().save(directory, overwrite=overwrite, figures=figures)
        # Without `write_sidecars` there are no targets.
        for item, path in zip(self.files, targets, strict=False):
            write_file(path, item._sidecar_text(path.parent), overwrite=False)
        return written

    def _write(self, folder: Path) -> None:
        (folder / SIDECARS).mkdir()
        for item, name in zip(self.files, self._names, strict=True):
            text = item._sidecar_text(folder / SIDECARS)
            (folder / SIDECARS / f"{name}.toml").write_text(text, encoding="utf-8")


@checked
def inspect_files(
    files: Sequence[str | Path] | str | Path, bearing: Bearing | str | Path | None = None
) -> Intakes:
    r"""Inspect laboratory files: columns, units, blocks, rests, spikes, drift, ambient temperature.

    Parameters
    ----------
    files : tables (text or `.xlsx`), or sidecars, whose keys have priority over recognition.
    bearing : plan area and rubber thickness, for the plausibility of strains and stresses.

    Returns
    -------
    Intakes : of the files that could be read; `problems` states why others could not.

    Raises
    ------
    InputError : no file can be read or recognised as a test.

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
    ...     (found,) = inspect_files(file).files
    >>> found.sidecar["columns"]
    {'time': 'Zeit [s]', 'displacement': 'Weg', 'force': 'Load cell [kN]'}
    >>> found.sidecar["units"], found.decimal
    ({'displacement': 'mm'}, ',')
    """
    paths = [files] if isinstance(files, str | Path) else list(files)
    if not paths:
        raise InputError("give at least one file")
    intakes, problems = [], []
    for file in paths:
        try:
            intakes.append(_inspect_file(Path(file), bearing))
        except InputError as error:
            problems += error.located(file).lines()
    if not intakes:
        raise InputError(problems)
    return Intakes(intakes, problems)


def write_template(
    path: str | Path, bearing: Bearing | str | Path | None = None, *, overwrite: bool = False
) -> Path:
    """Write an Excel workbook for a laboratory to fill in, which `inspect_files` reads as it is.

    Its sheet "Test" has columns of time, displacement, force and temperatures of the lead and the
    rubber layers of a bearing as `history.csv` of a run has them: to the middle of the bearing (two
    layers and lead without a bearing). "Description" has what else is to be known of the test.

    Raises
    ------
    InputError : another ending than .xlsx; no openpyxl (extra `report`).
    OutputError : the file exists, unless `overwrite`.
    """
    path = Path(path)
    if path.suffix.lower() != ".xlsx":
        raise InputError(f'template "{path}": its name must end with .xlsx')
    specimen = None if bearing is None else as_bearing(bearing)
    layers = FEWEST_LAYERS
    if specimen is not None:
        layers = len(ModelOptions().build_stack(specimen).multiplicity)
    places = [f"Rubber {k + 1}" for k in range(layers)]
    places += ["Lead"] if specimen is None or specimen.lead is not None else []
    columns = [replace(quantity("time_s"), form=".6g")]
    columns += [quantity("displacement_mm", form=".6g"), quantity("force_kN", head="Force")]
    columns += [quantity("ambient_degC", head=place) for place in places]
    form = description()
    values = {"bearing": "" if isinstance(bearing, Bearing | None) else Path(bearing).name}
    rows = [
        (row.key, values.get(row.key, ""), row.unit or " or ".join(row.choices), row.meaning)
        for row in form.rows
    ]
    words = (
        "Samples of the test, a row each. Rubber 1 is an outer layer, the last one is next to the "
        "middle; columns may stay empty."
    )
    heads = [Quantity(KEY), *map(Quantity, ("Value", "Unit", "Meaning"))]
    tables = {
        form.samples: Table("Samples of the test", columns, [], 1, note=words),
        form.sheet: Table("Description of the test", heads, rows, 1, note="Fill in the values."),
    }
    write_file(path, sheets_bytes(tables), overwrite=overwrite)
    return path


def _inspect_file(path: Path, bearing: Bearing | str | Path | None) -> Intake:
    readings = read_laboratory(path)
    recognised, sidecar_keys = readings.recognised, readings.given
    if len(readings.block) < FEWEST:
        rows = len(readings.block)
        raise InputError(f"has {rows} rows of numbers; at least {FEWEST} are needed", str(path))
    parts = int(readings.block[-1]) + 1
    record = build_record(readings)
    keys = _file_keys(readings, parts) | _column_keys(recognised.columns)
    if readings.sidecar.flip_force:
        keys["flip_force"] = True
    # What a sidecar states replaces what was recognised.
    for name in TABLES:
        keys[name] = {**keys.get(name, {}), **sidecar_keys.get(name, {})}
    if "ambient" in sidecar_keys:
        keys["columns"].pop("ambient", None)
    elif record.ambient_from and not record.unclear:
        keys["ambient"] = f"{record.ambient:g} degC"
    keys |= {key: value for key, value in sidecar_keys.items() if key not in TABLES}
    name, separator = recognised.sheet.name, recognised.sheet.separator
    return Intake(
        file=recognised.file,
        sheet=name,
        separator="" if name else SEPARATORS.get(separator, separator),
        decimal=recognised.sheet.decimal,
        rows=len(record.time),
        blocks=parts,
        columns=recognised.columns,
        record=record,
        report=check_test(record, bearing),
        sidecar={key: value for key, value in keys.items() if value not in ({}, None)},
        folder=readings.file.parent,
        kept=sorted(sidecar_keys),
        ambient=readings.values.get("ambient"),
        assumed_ambient=not (
            record.unclear
            or record.ambient_from
            or "ambient" in sidecar_keys
            or "ambient" in readings.values
        ),
        layers=0 if bearing is None else as_bearing(bearing).geometry.rubber_layers,
    )


def _example_places(titles: Sequence[str], layers: int) -> dict[str, str]:
    """Return a place for each thermocouple: the middle layer where its title says so."""
    middle = (layers + 1) // 2
    return {
        title: f"rubber {middle if middle and holds_word(title, 'middle') else number}"
        for number, title in enumerate(titles, 1)
    }


def _file_keys(readings: Readings, parts: int) -> dict[str, Any]:
    """Return the keys of a sidecar for the file: its name, its sheet, or its blocks."""
    recognised, sidecar_keys = readings.recognised, readings.given
    if {"file", "blocks"} & sidecar_keys.keys():
        return {}
    name = recognised.file.name
    if len(recognised.same_titles) > 1:
        blocks: list[dict[str, Any]] = [
            {"file": name, "sheet": title} for title in recognised.same_titles
        ]
    elif readings.clock_restarts:
        blocks = [{"file": name, "part": part} for part in range(1, parts + 1)]
    else:
        return {"file": name} | ({"sheet": recognised.sheet.name} if recognised.sheet.name else {})
    return {"blocks": [blocks[0], *(block | {"rest_before": "0 s"} for block in blocks[1:])]}


def _column_keys(columns: list[ColumnGuess]) -> dict[str, Any]:
    """Return the keys of a sidecar for the recognised columns."""
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
