"""The directory of a study: plan, shards, histories and log.

    study.toml            the study with names resolved and defaults filled in
    manifest.json         number of runs, size of a shard, digest of the input, versions
    motions.npz           matched motions
    plan.parquet          all runs with their factors
    shards/00000.parquet  some runs with their results; a shard is complete when its file exists
    histories/            selected histories, netCDF
    study.log             progress, with times

Only the log has times, so that a repeated study has the same bytes. The notes of a Parquet file
contain the SHA-256 of the file, computed with zeros in its place: Parquet itself checks nothing,
and a changed bit is often read as another number.
"""

import hashlib
import json
import platform
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing
from thermobearing.border.errors import InputError, OutputError, short_repr, shortened
from thermobearing.border.lazy import pd
from thermobearing.border.opener import (
    LARGEST_STORE,
    append_text,
    is_file,
    opened,
    read_bytes,
    read_json,
)
from thermobearing.border.text_file import replacing, write_file, write_whole
from thermobearing.border.toml import flat
from thermobearing.core.compiled.sources import kernels_digest
from thermobearing.earthquake.axial import AXIAL_COLUMNS
from thermobearing.earthquake.dataset import padded
from thermobearing.earthquake.measures import HISTORIES
from thermobearing.quantities.register import quantity
from thermobearing.results.directory import check_seal, seal, write_directory
from thermobearing.results.writing import (
    clear_rounding,
    labelled_dataset,
    without_formulas,
    write_dataset,
)
from thermobearing.studies.definition.case import load_study
from thermobearing.studies.definition.designs import NAMED_FACTORS, Plan
from thermobearing.studies.definition.motions import MOTIONS_FILE, matched_motions_bytes
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.shard import RESULT_COLUMNS, KeptHistory, ShardResult
from thermobearing.studies.statistics.demand import STATISTICS

EXTRA = 'needs pyarrow: pip install "thermobearing[study]"'
UNIT, MEANING, NOTES = b"unit", b"meaning", b"thermobearing"
DIGEST, EMPTY = b'"sha256": "', b"0" * 64
LEVEL = 3  # of compression
KINDS = {"i": "int64", "u": "int64", "f": "float64", "b": "bool_"}  # others are text
Labels = Mapping[str, tuple[str, str]]  # unit ("1" if dimensionless) and meaning by column


def _load_pyarrow() -> Any:
    """Return the modules pyarrow and pyarrow.parquet, an optional dependency."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError(f"the table of a study {EXTRA}") from None
    return pyarrow, pyarrow.parquet


def _parquet_bytes(table: "pd.DataFrame", labels: Labels, notes: Mapping[str, Any]) -> bytes:
    """Return a table as bytes of a file; equal tables have equal bytes, and NaN is null."""
    arrow, parquet = _load_pyarrow()
    fields, arrays = [], []
    for name, column in table.items():
        kind = getattr(arrow, KINDS.get(column.dtype.kind, "string"))()
        unit, meaning = labels.get(str(name), ("", ""))
        marks = {UNIT: unit.encode(), MEANING: meaning.encode()}
        fields.append(arrow.field(str(name), kind, metadata=marks))
        values = column if kind != arrow.string() else [str(value) for value in column]
        # A missing number is null, since NaN would make means NaN in other programs.
        arrays.append(arrow.array(values, type=kind, from_pandas=kind == arrow.float64()))
    # Zeros of the length of a digest first; its digits then replace them without moving a byte.
    sealed = json.dumps({**notes, "sha256": EMPTY.decode()}).encode()
    stream = arrow.BufferOutputStream()
    sealed_table = arrow.Table.from_arrays(
        arrays, schema=arrow.schema(fields, metadata={NOTES: sealed})
    )
    parquet.write_table(sealed_table, stream, compression="zstd", compression_level=LEVEL)
    before, _, after = _around_digest(bytes(stream.getvalue()))
    return before + _digest(before, after) + after


def _around_digest(content: bytes) -> tuple[bytes, bytes, bytes]:
    """Split a file into the parts before, of, and after its digest."""
    place = content.rfind(DIGEST) + len(DIGEST)
    return content[:place], content[place : place + len(EMPTY)], content[place + len(EMPTY) :]


def _digest(before: bytes, after: bytes) -> bytes:
    return hashlib.sha256(before + EMPTY + after).hexdigest().encode()


def _read_parquet(paths: Sequence[Path], columns: Sequence[str] | None = None) -> "pd.DataFrame":
    """Return the concatenated tables of files; InputError for an unreadable one."""
    arrow, parquet = _load_pyarrow()
    names = None if columns is None else list(columns)
    tables = []
    for path in paths:
        try:
            with opened(path, LARGEST_STORE) as file:
                tables.append(parquet.ParquetFile(file).read(columns=names))
        except arrow.ArrowException as error:
            raise InputError(f"cannot be read: {error}", str(path)) from None
    without_metadata = [table.replace_schema_metadata(None) for table in tables]
    # Shards of an earlier version may lack a column.
    joined = arrow.concat_tables(without_metadata, promote_options="default")
    del tables, without_metadata
    # Of millions of runs a second copy takes a gigabyte: each column is freed when it is converted.
    return pd.DataFrame(joined.to_pandas(split_blocks=True, self_destruct=True))


def _read_labels(path: Path) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of the columns of a file."""
    with opened(path, LARGEST_STORE) as file:
        schema = _load_pyarrow()[1].read_schema(file)
    marks = {field.name: field.metadata or {} for field in schema}
    return {
        name: (m.get(UNIT, b"").decode(), m.get(MEANING, b"").decode()) for name, m in marks.items()
    }


def _read_notes(path: Path, *, sealed: bool = True) -> tuple[dict[str, Any], int] | None:
    """Return notes and number of rows of a file; None if it is missing or damaged."""
    arrow, parquet = _load_pyarrow()
    try:
        content = read_bytes(path, LARGEST_STORE)
        before, stated_digest, after = _around_digest(content)
        if sealed and stated_digest != _digest(before, after):
            return None
        with parquet.ParquetFile(arrow.BufferReader(content)) as file:
            notes = json.loads((file.schema_arrow.metadata or {})[NOTES])
            notes.pop("sha256", None)
            return notes, int(file.metadata.num_rows)
    except (OSError, arrow.ArrowException, KeyError, ValueError):
        return None


MOST_ROWS = 1_048_575  # of a sheet of a workbook, without the head


def write_table(table: "pd.DataFrame", path: Path, *, overwrite: bool = False) -> None:
    """Write a table of runs as .csv or .xlsx."""
    if path.suffix == ".csv":
        write_file(
            path, without_formulas(clear_rounding(table)).to_csv(index=False), overwrite=overwrite
        )
        return
    if path.suffix != ".xlsx":
        raise InputError(f'"{path}": must end in .csv or .xlsx')
    if len(table) > MOST_ROWS:
        raise InputError(
            f"a sheet has at most {MOST_ROWS} rows, and there are {len(table)} runs: write .csv"
        )
    from thermobearing.report.workbook import the_writer

    the_writer()
    book = BytesIO()
    table.to_excel(book, index=False, sheet_name="runs", engine="openpyxl")
    write_file(path, book.getvalue(), overwrite=overwrite)


def _label(name: str) -> tuple[str, str]:
    attributes = quantity(name).attributes
    return attributes["units"], attributes["long_name"]


def label_plan(plan: Plan, names: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of columns of the plan of a study."""
    units = {target.name: target.unit for target in plan.targets}
    labels = {}
    for name in names:
        factor = plan.study.factors.numbers.get(name)
        if factor is None:
            labels[name] = _label(name)
        elif factor.of == "factor":
            labels[name] = "1", f"factor of {name}"
        else:
            labels[name] = units[name] or "1", name
    return labels


LAYERS = "rubber_temperature"


def _write_histories(path: Path, histories: Sequence[KeptHistory]) -> None:
    length = max((len(history.traces["time"]) for history in histories), default=0)
    layers = max((history.traces[LAYERS].shape[1] for history in histories), default=0)
    data: dict[str, tuple[tuple[str, ...], Any, dict[str, str]]] = {}
    for name in ("time", *HISTORIES, LAYERS):
        extra = (layers,) if name == LAYERS else ()
        rows = padded([history.traces[name] for history in histories], (length, *extra))
        axes = ("run", "step", "layer")[: 2 + len(extra)]
        data[name] = axes, rows, quantity(name).attributes
    coords = {
        "run": np.array([history.run for history in histories], dtype=np.int64),
        "id": ("run", np.array([history.id for history in histories], dtype=str)),
    }
    path.parent.mkdir(exist_ok=True)
    with replacing(path) as part:
        write_dataset(labelled_dataset(data, coords), part)
        seal(part)


STUDY, MANIFEST, PLAN, LOG = "study.toml", "manifest.json", "plan.parquet", "study.log"
SHARDS, HISTORIES_FOLDER, WORST = "shards", "histories", "worst.nc"
# Of the directory; format 1 has no digests of files, format 2 none of manifest and histories.
FORMAT = 3
LARGEST_FILE = 100_000_000  # bytes of a manifest or a study
FEWEST, MOST = 16, 1008  # runs of a shard: multiples of the lanes in lockstep
SHARES = 100  # shards of a study, within these limits
CHANGES_NAMED = 3
SAME = ("thermobearing", "kernels")  # versions that must not change within a study
LIBRARIES = ("numpy", "scipy", "numba", "pandas", "pyarrow")


def _shard_size(runs: int, lockstep: bool = False) -> int:
    """Return the number of runs of a shard, a multiple of 16 that fills the lanes in lockstep."""
    share = -(-runs * (4 if lockstep else 1) // SHARES)
    return min(-(-max(1, share) // FEWEST) * FEWEST, MOST)


def is_study(path: str | Path) -> bool:
    """Return whether a directory is that of a study."""
    return is_file(Path(path) / MANIFEST) and is_file(Path(path) / STUDY)


def _history_file(shard: int) -> str:
    """Return the name of the file with the histories of a shard."""
    return f"{shard:05d}.nc"


class Store:
    """The directory of a study, with the content of manifest.json."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.manifest = _read_manifest(directory)
        self.runs = int(self.manifest["runs"])
        self.shards = -(-self.runs // int(self.manifest["shard_size"]))

    def study(self) -> Study:
        """Return the study of the directory; InputError where its file was edited since."""
        path = self.directory / STUDY
        stated = self.manifest.get("study")  # directories of earlier versions have none
        text = read_bytes(path, LARGEST_FILE)
        if stated is not None and text != str(stated).encode():
            raise InputError(
                f"was edited after the study began: {_changes(str(stated).encode(), text)}. Undo "
                "the change, or start the changed study in a new directory",
                str(path),
            )
        return load_study(path)

    def changed_versions(self) -> list[str]:
        """Return the versions that must not change within a study, and have."""
        current, stored = _versions(), self.manifest["versions"]
        return [
            f"{key} {stored.get(key)}, now {current[key]}"
            for key in SAME
            if current[key] != stored.get(key)
        ]

    def check_runs(self, study: Study, runs: "pd.DataFrame") -> None:
        """Reject a plan whose files (motions, bearings, weather) are not those of the study.

        Another version of the package may number its runs differently and is not compared.
        """
        if not self.changed_versions() and _input_digest(study, runs) != self.manifest["input"]:
            raise InputError(
                "a file that the study refers to (motion, bearing, weather) has changed since it "
                "began: undo the change, or start the study in a new directory",
                str(self.directory),
            )

    def log(self, text: str) -> None:
        """Append a line with the time to the log, if it can be written."""
        stamp = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
        with suppress(OSError):
            append_text(self.directory / LOG, f"{stamp} {text}\n")

    def place(self, shard: int) -> slice:
        """Return the rows of a shard in the plan."""
        size = int(self.manifest["shard_size"])
        return slice(shard * size, min((shard + 1) * size, self.runs))

    def checked_shards(self) -> list[int]:
        """Return all complete shards; InputError for files that are not as they were written.

        Histories, which may be gigabytes and concern no table, are not read: `check_history` reads
        those of a run, and a resumed study all.
        """
        done = self.done()
        names = [
            f"{SHARDS}/{self._file(shard).name}"
            for shard in sorted(set(range(self.shards)) - set(done))
            if self._file(shard).exists()
        ]
        notes = _read_notes(self.directory / PLAN)
        if self.manifest["format"] > 1 and notes != ({"input": self.manifest["input"]}, self.runs):
            names.append(PLAN)
        self._refuse_changed(names)
        return done

    def check_history(self, run: int) -> None:
        """Reject the file with the kept history of a run if it is not as it was written."""
        file = _history_file(run // int(self.manifest["shard_size"]))
        self._refuse_changed(
            [f"{HISTORIES_FOLDER}/{path.name}" for path in self._changed_histories(file)]
        )

    def _refuse_changed(self, names: Sequence[str]) -> None:
        if names:
            raise InputError(
                [
                    f"{name} is damaged, or was changed or replaced after the study wrote it; "
                    f"thermobearing study {STUDY} -o {self.directory} --resume writes it again"
                    for name in names
                ],
                str(self.directory),
            )

    def _changed_histories(self, pattern: str = "[!.]*.nc") -> list[Path]:
        """Return the files of histories that are not as they were written."""
        changed: list[Path] = []
        folder = self.directory / HISTORIES_FOLDER
        for path in sorted(folder.glob(pattern)) if self.manifest["format"] > 2 else []:
            try:
                check_seal(path)
            except InputError:
                changed.append(path)
        return changed

    def remove_changed_histories(self) -> None:
        """Remove histories that are not as they were written, with the shards they belong to."""
        with self._writing():
            for path in self._changed_histories():
                path.unlink(missing_ok=True)
                if path.stem.isdecimal():
                    self._file(int(path.stem)).unlink(missing_ok=True)
                self.log(f"{path.name} was changed; its runs are computed again")

    def count(self, shards: Sequence[int]) -> int:
        """Return the number of runs of some shards."""
        return sum(self.place(k).stop - self.place(k).start for k in shards)

    def _file(self, shard: int) -> Path:
        return self.directory / SHARDS / f"{shard:05d}.parquet"

    def _is_done(self, shard: int) -> bool:
        """Return whether the file of a shard exists, is undamaged, and belongs to this study."""
        path, sealed = self._file(shard), int(self.manifest["format"]) > 1
        if not path.exists():  # opening it would look for similar names, for each of thousands
            return False
        notes_and_rows = _read_notes(path, sealed=sealed)
        return notes_and_rows == (self._notes(shard), self.count([shard]))

    def done(self) -> list[int]:
        """Return all complete shards."""
        return [shard for shard in range(self.shards) if self._is_done(shard)]

    def write(self, shard: int, result: ShardResult) -> None:
        """Write the results of a shard; its table comes last and marks it as complete."""
        if result.histories:
            self.write_histories(_history_file(shard), result.histories)
        labels = _read_labels(self.directory / PLAN) | {
            name: _label(name) for name in (*RESULT_COLUMNS, *AXIAL_COLUMNS) if name in result.table
        }
        with self._writing():
            write_whole(self._file(shard), _parquet_bytes(result.table, labels, self._notes(shard)))

    def write_histories(self, name: str, histories: Sequence[KeptHistory]) -> None:
        """Write histories of runs into a file."""
        with self._writing():
            _write_histories(self.directory / HISTORIES_FOLDER / name, histories)

    def table(
        self, columns: Sequence[str] | None = None, shards: Sequence[int] | None = None
    ) -> "pd.DataFrame":
        """Return all completed runs (or those of some shards), in the order of the plan."""
        files = [self._file(shard) for shard in (self.done() if shards is None else shards)]
        if not files:
            empty = _read_parquet([self.directory / PLAN]).head(0)
            empty = empty.assign(**{name: [] for name in RESULT_COLUMNS})
            return empty if columns is None else empty[list(columns)]
        return _read_parquet(files, columns)

    def checked_table(self, demands: Sequence[str] | None = None) -> "pd.DataFrame":
        """Return all completed runs by their numbers.

        With `demands` the columns are those that their statistics need, since all columns of a
        million runs are a gigabyte. If one of the demands does not exist, all columns are read, so
        that an error can name similar ones.
        """
        shards = self.checked_shards()
        if not shards:
            raise InputError("no run is complete yet", str(self.directory))
        columns = None
        if demands is not None:
            existing = _read_labels(self._file(shards[0]))
            if all(name in existing for name in demands):
                factors = [name for name in _read_labels(self.directory / PLAN) if name != "id"]
                needed = dict.fromkeys([*factors, *STATISTICS, *demands])
                columns = [name for name in needed if name in existing]
        table = self.table(columns, shards)
        if table["run"].is_monotonic_increasing:
            return table
        return table.sort_values("run", kind="stable").reset_index(drop=True)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Raise OutputError if the system refuses to write."""
        try:
            yield
        except (OSError, RuntimeError) as error:  # netCDF reports a failing disk as either
            reason = getattr(error, "strerror", None) or error
            self.log(f"cannot be written: {reason}")
            raise OutputError(
                f"{self.directory}: cannot be written: {reason}; completed shards are kept, run "
                "the same command again"
            ) from error

    def clean(self, shards: Sequence[int]) -> None:
        """Remove the partial files of killed writers of some shards."""
        prefixes = {f".{shard:05d}." for shard in shards}
        for folder in (self.directory / SHARDS, self.directory / HISTORIES_FOLDER):
            for path in folder.glob(".*") if folder.exists() else []:
                if path.name[:7] in prefixes or path.name.startswith(f".{WORST}"):
                    path.unlink(missing_ok=True)

    def _notes(self, shard: int) -> dict[str, Any]:
        return {
            "shard": shard,
            "input": self.manifest["input"],
            "thermobearing": self.manifest["versions"]["thermobearing"],
        }


def open_or_make(directory: Path, plan: Plan, size: int | None) -> Store:
    """Return the directory of a study, created (with shards of `size` runs) or resumed."""
    _load_pyarrow()
    study, runs = plan.study, plan.runs
    digest = _input_digest(study, runs)
    plan_bytes = _parquet_bytes(runs, label_plan(plan, list(map(str, runs))), {"input": digest})
    if not (directory / MANIFEST).exists():
        manifest: dict[str, Any] = {
            "kind": "study",
            "format": FORMAT,
            "name": study.name,
            "runs": len(runs),
            "shard_size": size or _shard_size(len(runs), plan.lockstep),
            "histories": study.keep.histories,
            "input": digest,
            "versions": _versions(),
            # The text again: a study.toml that is edited later would belong to no run.
            "study": study.to_toml(),
        }
        files = {
            STUDY: manifest["study"].encode(),
            PLAN: plan_bytes,
            MANIFEST: (json.dumps(_sealed(manifest), indent=2) + "\n").encode(),
        }
        if study.factors.motion.matched is not None:
            files[MOTIONS_FILE] = matched_motions_bytes(study)

        def _fill(folder: Path) -> None:
            (folder / SHARDS).mkdir()
            for name, content in files.items():
                (folder / name).write_bytes(content)

        try:
            write_directory(directory, _fill)
        except OutputError:
            if not (directory / MANIFEST).exists():  # else another process was quicker
                raise
    store = Store(directory)
    _refuse_others(store, study, digest)
    if _read_notes(directory / PLAN) != ({"input": digest}, len(runs)):  # damaged, or replaced
        with store._writing():
            write_whole(directory / PLAN, plan_bytes)
    return store


def _input_digest(study: Study, runs: "pd.DataFrame") -> str:
    digest = hashlib.sha256("\n".join(runs["id"]).encode())
    for name in NAMED_FACTORS:
        digest.update("\n".join(map(str, runs[name].unique())).encode())
    analysis = study.case.analysis
    digest.update(repr((study.keep.histories, analysis.keep, analysis.keep_every)).encode())
    return digest.hexdigest()


def _versions() -> dict[str, str]:
    versions = {"thermobearing": thermobearing.__version__, "kernels": kernels_digest()}
    versions |= {"python": platform.python_version()} | dict.fromkeys(LIBRARIES, "unknown")
    for name in LIBRARIES:
        with suppress(PackageNotFoundError):
            versions[name] = version(name)
    return versions


def _read_manifest(directory: Path) -> dict[str, Any]:
    path = directory / MANIFEST
    if not path.exists():
        raise InputError(f"is not the directory of a study: it has no {MANIFEST}", str(directory))
    manifest = read_json(path, LARGEST_FILE)
    try:
        valid = manifest["kind"] == "study" and manifest["format"] in range(1, FORMAT + 1)
        numbers = [int(manifest[name]) for name in ("runs", "shard_size")]
        valid = valid and min(numbers) > 0 and isinstance(manifest["versions"], dict)
        valid = valid and isinstance(manifest["input"], str)
        valid = valid and isinstance(manifest["versions"]["thermobearing"], str)
    except (ValueError, TypeError, KeyError):
        valid = False
    if not valid:
        raise InputError(
            "is damaged or of another version; start the study in a new directory", str(path)
        )
    if manifest["format"] > 2 and manifest != _sealed(manifest):
        raise InputError(
            f"was edited after the study began: {_changed_keys(directory, manifest)}. Undo the "
            "change, or start the study in a new directory",
            str(path),
        )
    return dict(manifest)


def _sealed(manifest: Mapping[str, Any]) -> dict[str, Any]:
    """Return a manifest with the digest of its other keys."""
    content = {key: value for key, value in manifest.items() if key != "sha256"}
    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    return content | {"sha256": digest}


def _changed_keys(directory: Path, manifest: Mapping[str, Any]) -> str:
    """Return how an edited manifest differs from what the plan and the study state too."""
    stated: dict[str, Any] = {}
    with suppress(ValueError, KeyError):  # neither may be readable
        stated = {"study": read_bytes(directory / STUDY, LARGEST_FILE).decode()}
        stated["name"] = tomllib.loads(stated["study"])["name"]
    if notes_and_rows := _read_notes(directory / PLAN):
        stated |= {"input": notes_and_rows[0].get("input"), "runs": notes_and_rows[1]}
    changed = [
        f"{key} = {shortened(repr(manifest.get(key)))}, was {shortened(repr(value))}"
        for key, value in stated.items()
        if manifest.get(key) != value
    ]
    return "; ".join(changed) or "its digest is another one"


def _refuse_others(store: Store, study: Study, digest: str) -> None:
    """Raise InputError for the directory of another study or another version."""
    name = str(store.directory)
    if digest != store.manifest["input"]:
        stored_text = read_bytes(store.directory / STUDY, LARGEST_FILE)
        difference = _changes(stored_text, study.to_toml().encode())
        raise InputError(
            f"contains another study: {difference}. Choose another directory, or undo the change; "
            f"{STUDY} in the directory is the other study",
            name,
        )
    if changes := store.changed_versions():
        raise InputError(
            f"was started with another version ({', '.join(changes)}). Choose another directory, "
            "or resume it with that version",
            name,
        )


def _changes(before: bytes, after: bytes) -> str:
    """Return how the file of a study differs from an earlier one."""
    try:
        stored, current = (flat(tomllib.loads(text.decode())) for text in (before, after))
    except ValueError:
        return f"{STUDY} cannot be read"
    keys = [key for key in current | stored if current.get(key) != stored.get(key)]
    laws = [key for key in keys if key.endswith("_law.law")]
    if laws:
        keys = laws  # other keys follow from it
    if not keys:
        return "a file that it refers to (motion, bearing, weather) has changed"
    descriptions = [
        f"{key} = {short_repr(current.get(key))}, was {short_repr(stored.get(key))}"
        for key in keys[:CHANGES_NAMED]
    ]
    remainder = f" and {len(keys) - CHANGES_NAMED} more" if len(keys) > CHANGES_NAMED else ""
    return "; ".join(descriptions) + remainder + (" (give the same file by --law)" if laws else "")
