"""The directory of a study: plan, shards, histories and log.

    study.toml         the study, names resolved and defaults filled in
    manifest.json      number of runs, size of a shard, digest of the input, versions
    motions.npz        those that were made to fit a spectrum
    plan.parquet       all runs with what goes into each
    shards/00000.parquet  some of them with what came out; done is what has its file
    histories/         those that were asked for, netCDF
    study.log          what happened when

Nothing in it but the log says when, so that a study that is done again has the same bytes.
"""

import hashlib
import json
import platform
import time
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

import thermobearing
from thermobearing.border.errors import InputError, OutputError, read_bytes, shortened
from thermobearing.border.text_file import replacing, write_whole
from thermobearing.border.toml import flat
from thermobearing.core.compile import kernels_digest
from thermobearing.earthquake.dataset import padded
from thermobearing.earthquake.measures import HISTORIES
from thermobearing.quantities.register import quantity
from thermobearing.results.directory import write_directory
from thermobearing.results.writing import write_dataset
from thermobearing.studies.definition.columns import AMBIENT, HOUR, SAMPLE, THINGS, list_targets
from thermobearing.studies.definition.designs import in_lockstep
from thermobearing.studies.definition.factors import COLUMNS
from thermobearing.studies.definition.record import Study
from thermobearing.studies.inputs.motions import MADE, is_matched, kept_motions_digest
from thermobearing.studies.run.demand_parameters import RESULT_COLUMNS
from thermobearing.studies.run.shard import Done, Kept
from thermobearing.studies.store.parquet import (
    About,
    about_columns,
    parquet_bytes,
    read_notes,
    read_parquet,
    the_parquet,
    write_parquet,
)


def _histories_dataset(kept: Sequence[Kept]) -> xr.Dataset:
    """All that is kept of some runs; `run` and `id` say which, shorter ones end with NaN."""
    length = max((len(one.traces["time"]) for one in kept), default=0)
    data: dict[str, tuple[tuple[str, ...], Any, dict[str, str]]] = {}
    for name in ("time", *HISTORIES):
        rows = padded([one.traces[name] for one in kept], (length,))
        data[name] = (("run", "step"), rows, quantity(name).attributes)
    name = "rubber_temperature"
    layers = max((one.traces[name].shape[1] for one in kept), default=0)
    rows = padded([one.traces[name] for one in kept], (length, layers))
    data[name] = (("run", "step", "layer"), rows, quantity(name).attributes)
    coords = {
        "run": np.array([one.run for one in kept], dtype=np.int64),
        "id": ("run", np.array([one.id for one in kept], dtype=str)),
    }
    return xr.Dataset(data, coords=coords)


def _write_histories(path: Path, kept: Sequence[Kept]) -> None:
    """Write the file whole; OSError where the disk is full, and nothing of it is there."""
    path.parent.mkdir(exist_ok=True)
    with replacing(path) as part:
        write_dataset(_histories_dataset(kept), part)


KNOWN = {
    "run": About("1", "number of the run, its row in the plan"),
    "id": About("", "digest of all that goes into the run"),
    "seed": About("1", "of what the run draws by lot"),
    "sample": About("1", "number of the draw"),
    "matrix": About("", "where it belongs in Saltelli's arrangement"),
    "structure": About("", "name of the structure"),
    "bearing": About("", "name of the bearing"),
    SAMPLE: About("1", "number of the sample of a posterior, -1 of a bearing without"),
    "motion": About("", "name of the ground motion"),
    "scale": About("1", "what multiplies the ground motion"),
    COLUMNS["PGA"]: About("m/s2", "peak acceleration of the scaled motion"),
    COLUMNS["PGV"]: About("m/s", "peak velocity of the scaled motion"),
    COLUMNS["Sa"]: About("m/s2", "spectral acceleration of the scaled motion"),
    AMBIENT: About("degC", "temperature of the air"),
    HOUR: About("1", "hour of the weather when the earthquake comes"),
}


def about_plan(study: Study, runs: pd.DataFrame) -> dict[str, About]:
    """What each column of the plan of a study is.

    Parameters
    ----------
    study, runs : and its plan.
    """
    found = {}
    units = {target.name: target.unit for target in list_targets(study)}
    for name in map(str, runs.columns):
        factor = study.factors.numbers.get(name)
        if factor is None:
            found[name] = KNOWN.get(name, About())
        elif factor.of == "factor":
            found[name] = About("1", f"what multiplies {name}")
        else:
            found[name] = About(units[name] or "1", name)
    return found


class Log:
    """Lines with the time, appended to a file.

    Parameters
    ----------
    path : of the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def say(self, text: str) -> None:
        """Append a line."""
        stamp = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
        try:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(f"{stamp} {text}\n")
        except OSError:
            return


class Pace:
    """How quickly runs are done, and how long the rest will take.

    Parameters
    ----------
    done, total : runs at the start, and all.
    """

    def __init__(self, done: int, total: int) -> None:
        self.done, self.total = done, total
        self._first, self._began = done, time.monotonic()

    def told(self) -> str:
        """Such as "192 of 256 runs, 61.2 a second, 1 s left"."""
        passed = time.monotonic() - self._began
        told = f"{self.done} of {self.total} runs"
        if self.done == self._first or passed <= 0.0:
            return told
        rate = (self.done - self._first) / passed
        return f"{told}, {rate:.3g} a second, {duration((self.total - self.done) / rate)} left"


def duration(seconds: float) -> str:
    """A time as one would say it.

    Examples
    --------
    >>> duration(42), duration(200), duration(39_999)
    ('42 s', '3 min 20 s', '11 h 6 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


STUDY, MANIFEST, PLAN, LOG = "study.toml", "manifest.json", "plan.parquet", "study.log"
SHARDS, HISTORIES_FOLDER, WORST = "shards", "histories", "worst.nc"
FORMAT = 2  # of the directory; in those of format 1 no file has a digest
LARGEST_FILE = 100_000_000  # bytes of a manifest or a study
FEWEST, MOST = 16, 1008  # runs of a shard: whole companies of a lockstep
SHARES = 100  # shards of a study, unless that makes them too small or too large
CHANGES_TOLD = 3
SAME = ("thermobearing", "kernels")  # versions that must not change half-way
LIBRARIES = ("numpy", "scipy", "numba", "pandas", "pyarrow")


def shard_size(runs: int, lockstep: bool = False) -> int:
    """Runs of a shard: so many that a process is not begun for nothing, and little is lost.

    A multiple of 16, so that runs of one shape fill their lockstep; in lockstep, where they take a
    quarter of the time, four times as many.

    Examples
    --------
    >>> shard_size(200), shard_size(10_000), shard_size(10_000, lockstep=True)
    (16, 112, 400)
    """
    share = -(-runs * (4 if lockstep else 1) // SHARES)
    return min(-(-max(1, share) // FEWEST) * FEWEST, MOST)


class Store:
    """A study on the disk.

    Attributes
    ----------
    directory : where it is.
    manifest : what manifest.json says.
    log : its log.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.manifest = _read_manifest(directory)
        self.log = Log(directory / LOG)

    @property
    def runs(self) -> int:
        """Number of runs of the whole study."""
        return int(self.manifest["runs"])

    @property
    def shards(self) -> int:
        """Number of shards of the whole study."""
        return -(-self.runs // int(self.manifest["shard_size"]))

    def place(self, shard: int) -> slice:
        """Which rows of the plan a shard has."""
        size = int(self.manifest["shard_size"])
        return slice(shard * size, min((shard + 1) * size, self.runs))

    def file(self, shard: int) -> Path:
        """Where the table of a shard is, or will be."""
        return self.directory / SHARDS / f"{shard:05d}.parquet"

    def is_done(self, shard: int) -> bool:
        """Return whether its file is there, of this study, and as it was written."""
        sealed = int(self.manifest["format"]) > 1
        place, found = self.place(shard), read_notes(self.file(shard), sealed=sealed)
        expected = self._notes(shard), place.stop - place.start
        return found == expected

    def done(self) -> list[int]:
        """All shards that are done."""
        return [shard for shard in range(self.shards) if self.is_done(shard)]

    def write(self, shard: int, done: Done) -> None:
        """Keep what came of a shard; its table comes last, and says that all is there.

        Raises
        ------
        OutputError : the disk is full or not writable; nothing of it is kept.
        """
        about = about_columns(self.directory / PLAN) | _ABOUT
        with self.writing():
            if done.histories:
                _write_histories(
                    self.directory / HISTORIES_FOLDER / f"{shard:05d}.nc", done.histories
                )
            write_parquet(self.file(shard), done.table, about, self._notes(shard))

    def write_worst(self, kept: Sequence[Kept]) -> None:
        """Keep histories of the worst runs; likewise."""
        with self.writing():
            _write_histories(self.directory / HISTORIES_FOLDER / WORST, kept)

    @property
    def has_worst(self) -> bool:
        """Whether histories of the worst runs are there."""
        return (self.directory / HISTORIES_FOLDER / WORST).exists()

    def table(
        self, columns: Sequence[str] | None = None, done: Sequence[int] | None = None
    ) -> pd.DataFrame:
        """All runs that are done, in the order of the plan.

        Parameters
        ----------
        columns : some of them; all by default.
        done : shards, as `done` has told; it is asked by default.
        """
        files = [self.file(shard) for shard in (self.done() if done is None else done)]
        if not files:
            empty = read_parquet([self.directory / PLAN]).head(0)
            empty = empty.assign(**{column.name: [] for column in RESULT_COLUMNS})
            return empty if columns is None else empty[list(columns)]
        return read_parquet(files, columns)

    @contextmanager
    def writing(self) -> Iterator[None]:
        """A disk that is full becomes one message.

        Raises
        ------
        OutputError : the system refused to write.
        """
        try:
            yield
        except (OSError, RuntimeError) as error:  # netCDF tells a failing disk as either
            told = getattr(error, "strerror", None) or error
            self.log.say(f"cannot be written: {told}")
            raise OutputError(
                f"{self.directory}: cannot be written: {told}; what is done is kept: start again "
                "when that is mended"
            ) from error

    def clean(self, shards: Sequence[int]) -> None:
        """Take away what killed writers of some shards left half written."""
        mine = {f".{shard:05d}." for shard in shards}
        for folder in (self.directory / SHARDS, self.directory / HISTORIES_FOLDER):
            for path in folder.glob(".*") if folder.exists() else []:
                if path.name[:7] in mine or path.name.startswith(f".{WORST}"):
                    path.unlink(missing_ok=True)

    def _notes(self, shard: int) -> dict[str, Any]:
        """What a file of a shard says of itself."""
        return {
            "shard": shard,
            "input": self.manifest["input"],
            "thermobearing": self.manifest["versions"]["thermobearing"],
        }


_ABOUT = {column.name: About(column.unit, column.meaning) for column in RESULT_COLUMNS}


def open_or_make(directory: Path, study: Study, runs: pd.DataFrame, size: int | None) -> Store:
    """The directory of a study: a new one, or the one that was begun.

    Parameters
    ----------
    directory : new, empty, or of the same study.
    study, runs : and its plan.
    size : of a shard, for a new one; None for what `shard_size` says.

    Raises
    ------
    OutputError : it holds something else, or cannot be written.
    InputError : it was begun with another study, or with another version.
    """
    the_parquet()
    digest = _input_digest(study, runs)
    size = size or shard_size(len(runs), in_lockstep(study))
    planned = parquet_bytes(runs, about_plan(study, runs), {"input": digest})
    if not (directory / MANIFEST).exists():
        whole = {
            STUDY: study.to_toml().encode(),
            PLAN: planned,
            MANIFEST: _manifest(study, runs, digest, size),
        }
        if is_matched(study):
            whole[MADE] = kept_motions_digest(study)

        def fill(folder: Path) -> None:
            (folder / SHARDS).mkdir()
            for name, content in whole.items():
                (folder / name).write_bytes(content)

        try:
            write_directory(directory, fill)
        except OutputError:
            if not (directory / MANIFEST).exists():  # else another part of it was quicker
                raise
    store = Store(directory)
    _refuse_others(store, study, digest)
    if read_notes(directory / PLAN) is None:  # damaged
        with store.writing():
            write_whole(directory / PLAN, planned)
    return store


def _input_digest(study: Study, runs: pd.DataFrame) -> str:
    """Of all that goes into a study: every run's input, what it is called, and what is kept."""
    found = hashlib.sha256("\n".join(runs["id"]).encode())
    for name in THINGS:
        found.update("\n".join(map(str, runs[name].unique())).encode())
    analysis = study.case.analysis
    found.update(repr((study.keep.histories, analysis.keep, analysis.keep_every)).encode())
    return found.hexdigest()


def versions() -> dict[str, str]:
    """Of this program, its kernels, Python and the libraries that numbers depend on."""
    found = {
        "thermobearing": thermobearing.__version__,
        "kernels": kernels_digest(),
        "python": platform.python_version(),
    }
    for name in LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "unknown"
    return found


def _manifest(study: Study, runs: pd.DataFrame, digest: str, size: int) -> bytes:
    content = {
        "kind": "study",
        "format": FORMAT,
        "name": study.name,
        "runs": len(runs),
        "shard_size": size,
        "histories": study.keep.histories,
        "input": digest,
        "versions": versions(),
    }
    return (json.dumps(content, indent=2) + "\n").encode()


def _read_manifest(directory: Path) -> dict[str, Any]:
    path = directory / MANIFEST
    if not path.exists():
        raise InputError(f"is not the directory of a study: no {MANIFEST} there", str(directory))
    try:
        found = json.loads(read_bytes(path, LARGEST_FILE))
        whole = found["kind"] == "study" and found["format"] in (1, FORMAT)
        numbers = [int(found[name]) for name in ("runs", "shard_size")]
        whole = whole and min(numbers) > 0 and isinstance(found["versions"], dict)
        whole = whole and isinstance(found["input"], str)
    except (ValueError, TypeError, KeyError):
        whole = False
    if not whole:
        raise InputError("is damaged, or of another version; do the study again", str(path))
    return dict(found)


def _refuse_others(store: Store, study: Study, digest: str) -> None:
    """InputError for a directory that was begun with another study, or another version."""
    name = str(store.directory)
    if digest != store.manifest["input"]:
        raise InputError(
            f"was begun with another study: {_changes(store, study)}. Choose another directory, or "
            f"undo the change; {STUDY} there is what was begun, and nothing is lost",
            name,
        )
    now, then = versions(), store.manifest["versions"]
    other = [key for key in SAME if now[key] != then.get(key)]
    if other:
        told = ", ".join(f"{key} {then.get(key)}, now {now[key]}" for key in other)
        raise InputError(
            f"was begun with another version ({told}): its runs would not go together. Choose "
            "another directory, or go on with that version",
            name,
        )


def _changes(store: Store, study: Study) -> str:
    """What differs, in words."""
    try:
        was = flat(tomllib.loads(read_bytes(store.directory / STUDY, LARGEST_FILE).decode()))
    except (InputError, ValueError):
        return f"{STUDY} cannot be read"
    now = flat(tomllib.loads(study.to_toml()))
    keys = [key for key in now | was if now.get(key) != was.get(key)]
    if not keys:
        return "a file that it names (motion, bearing, weather) has changed"
    told = [
        f"{key} = {shortened(repr(now.get(key)))}, was {shortened(repr(was.get(key)))}"
        for key in keys[:CHANGES_TOLD]
    ]
    more = f" and {len(keys) - CHANGES_TOLD} more" if len(keys) > CHANGES_TOLD else ""
    return "; ".join(told) + more
