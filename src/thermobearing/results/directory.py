"""A result directory: checked before anything is computed, written completely or not at all.

Everything is written into a hidden sibling directory, locked while its process runs, that takes
the place of the final one at the end: a full disk, an interruption or a crash leaves either the
complete result or the earlier one, and the next run removes what a killed process left.

HDF5 does not check the content of a file: a few changed bytes can keep it busy for ever, in a
call that no signal interrupts. Therefore the digest of the content is appended to the file;
netCDF readers ignore it.
"""

import ctypes
import hashlib
import os
import secrets
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.opener import LARGEST_STORE, opened

try:
    import fcntl
except ImportError:  # Windows: two runs with the same target are not distinguished
    fcntl = None  # type: ignore[assignment]
# Writers of results lock a folder for milliseconds, a study while it runs.
PATIENCE, POLL = 2.0, 0.05  # [s]
RESERVE = 4 << 20  # bytes that removing files takes at most: four arenas of Python's allocator
AT_FDCWD, RENAME_EXCHANGE = -100, 2  # of renameat2(2)


def _hidden_prefixes(final: Path) -> tuple[str, str]:
    """Return the prefixes of hidden siblings: of one being written, of one being replaced."""
    short = hashlib.sha256(os.fsencode(final.name)).hexdigest()[:12]  # a name may be long
    return f".thermobearing-writing-{short}-", f".thermobearing-old-{short}-"


@contextmanager
def locked(path: Path, *, wait: bool = True, shared: bool = False) -> Iterator[bool | None]:
    """Lock a file or directory; yield whether that was possible, None where there are no locks.

    `wait` for at most `PATIENCE`; a `shared` lock is held with others that share it too.
    """
    with ExitStack() as stack:
        acquired: bool | None = True
        try:
            handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
            stack.callback(os.close, handle)
            operation = fcntl.LOCK_SH if shared else fcntl.LOCK_EX
            until = time.monotonic() + (PATIENCE if wait else 0.0)
            while not (acquired := _try_lock(handle, operation)) and time.monotonic() < until:
                time.sleep(POLL)
        except (OSError, AttributeError):  # not readable; no locks there, or none at all
            acquired = None
        yield acquired


def _try_lock(handle: int, operation: int) -> bool:
    try:
        fcntl.flock(handle, operation | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


@contextmanager
def new_sibling(final: Path) -> Iterator[Path]:
    """Yield an empty hidden directory next to `final`; remove it afterwards, unless it was moved.

    What killed runs left there is removed too. A folder that another process keeps to itself (a
    running study) is written into as well, so that no result is lost; nothing is then removed.
    """
    partial = final.parent / f"{_hidden_prefixes(final)[0]}{secrets.token_hex(4)}"
    with ExitStack() as locks:
        # Locked before the parent is free again: else another run would take it for a leftover.
        with locked(final.parent) as acquired:
            if acquired:
                _clean(final)
            partial.mkdir()
            locks.enter_context(locked(partial))
        reserve = bytearray(RESERVE)
        try:
            yield partial
        finally:  # incomplete, or what was replaced
            # Removing files needs some memory, and its absence may be why they are removed.
            del reserve
            shutil.rmtree(partial, ignore_errors=True)


def _clean(final: Path) -> None:
    """Remove leftovers of killed runs, and restore a result that one of them was replacing."""
    writing, old = _hidden_prefixes(final)
    for path in list(final.parent.iterdir()):
        if path.name.startswith(old) and not final.exists():
            path.rename(final)
        elif path.name.startswith(old):
            shutil.rmtree(path, ignore_errors=True)
        elif path.name.startswith(writing):
            with locked(path, wait=False) as abandoned:
                if abandoned:
                    shutil.rmtree(path, ignore_errors=True)


def _put_in_place(partial: Path, final: Path, check: Callable[[], None]) -> None:
    """Move a finished directory into place, or restore the earlier one; `check` may raise."""
    with locked(final.parent):
        check()
        if not final.exists():
            partial.rename(final)
        elif not _exchange(partial, final):
            _replace(partial, final)


def _exchange(first: Path, second: Path) -> bool:
    """Swap two directories in one step; False where the system cannot."""
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError, TypeError):  # not Linux
        return False
    names = os.fsencode(first), os.fsencode(second)
    return bool(renameat2(AT_FDCWD, names[0], AT_FDCWD, names[1], RENAME_EXCHANGE) == 0)


def _replace(partial: Path, final: Path) -> None:
    """Swap them in two steps; `_clean` of the next run finds the earlier one between these."""
    old = final.parent / f"{_hidden_prefixes(final)[1]}{secrets.token_hex(4)}"
    try:
        final.rename(old)
        partial.rename(final)
    except BaseException:  # Ctrl-C too
        if old.exists() and not final.exists():
            old.rename(final)
        raise
    shutil.rmtree(old, ignore_errors=True)


MARK = b"\nthermobearing sha256 "
DIGEST = 64  # characters
BLOCK = 1 << 20  # bytes read at a time


def _digest(stream: BinaryIO, size: int) -> bytes:
    digest = hashlib.sha256()
    stream.seek(0)
    while size > 0 and (block := stream.read(min(BLOCK, size))):
        digest.update(block)
        size -= len(block)
    return digest.hexdigest().encode()


def seal(file: Path) -> None:
    """Append the digest of what a file holds."""
    with file.open("r+b") as stream:
        digest = _digest(stream, file.stat().st_size)
        stream.seek(0, os.SEEK_END)
        stream.write(MARK + digest)


def check_seal(file: Path) -> None:
    """Reject a file whose digest is missing or wrong."""
    with opened(file, LARGEST_STORE) as stream:
        size = stream.seek(0, os.SEEK_END) - len(MARK) - DIGEST
        stream.seek(max(size, 0))
        end = stream.read()
        complete = end == MARK + _digest(stream, size)
    if not end.startswith(MARK):
        fault = "is not a result file of thermobearing, is truncated, or was written by another "
        raise InputError(f"{fault}program or version; run its case again", str(file))
    if not complete:
        raise InputError("is damaged: its content does not match its digest", str(file))


OVERWRITE = "--overwrite (in Python overwrite=True)"
SUMMARY, DATASET, HISTORY = "summary.json", "result.nc", "history.csv"
RESOLVED, FIGURES, COMPARISON = "case.resolved.toml", "figures", "comparison.csv"
TABLE, MODES, RIG, TESTED_RANGE = "table.csv", "modes.csv", "rig.csv", "tested_range.csv"
PARTS, LINES, PIERS = "parts", "lines.csv", "piers.csv"
DIRECTIONS, COMPONENTS, ROTATION = "directions.csv", "components.csv", "rotation.csv"
BANDS, AXIAL = "bands.csv", "axial.csv"
STRUCTURE_PARTS, PERIODS, FRAME_PERIODS = "parts.csv", "periods.csv", "frame.csv"
IDENTIFIED, COMPOUND = "bearing.toml", "compound.toml"
FIT_TABLE, SAMPLES, SIDECARS = "fit.csv", "posterior.csv", "sidecars"
MOTION, SPECTRUM, FACTORS, SCALE = "motion.csv", "spectrum.csv", "factors.csv", "scale.csv"
BOUNDS, BOUNDS_TCL, BOUNDS_PYTHON = "bounds.csv", "bounds.tcl", "bounds.py"
ROUNDS, CHECKS, BEARINGS = "rounds.csv", "checks.csv", "bearings"
TEMPERATURES, CYCLE_TABLE = "temperatures.csv", "cycles.csv"
STATES, VIRGIN = "states.csv", "virgin.csv"
FOLDS, THERMOCOUPLES = "folds.csv", "thermocouples.csv"
HELD_OUT_SAMPLES = "held_out.csv"  # of tests held out, as those of a fit
PREDICTED = "predicted.csv"  # quantities of each cycle of a predicted test
INPUT_DIGESTS = "inputs.sha256"
REPORT_HTML, REPORT_PDF, WORKBOOK = "report.html", "report.pdf", "report.xlsx"
CERTIFICATE_HTML, CERTIFICATE_PDF = "certificate.html", "certificate.pdf"
TITLE, LOGO, QUOFEM = "report.toml", "report-logo", "quofem"
PROPERTIES, LINKS, MODES_FILE = "properties.csv", "links.txt", "modes.csv"
LINK_TRIALS = "links.csv"
# All files that commands write into a result directory; nothing else is ever deleted.
RESULT_NAMES = {
    AXIAL,
    BANDS,
    BEARINGS,
    BOUNDS,
    BOUNDS_PYTHON,
    BOUNDS_TCL,
    CERTIFICATE_HTML,
    CERTIFICATE_PDF,
    CHECKS,
    COMPARISON,
    COMPONENTS,
    COMPOUND,
    DATASET,
    DIRECTIONS,
    FACTORS,
    FIGURES,
    FIT_TABLE,
    FOLDS,
    FRAME_PERIODS,
    HELD_OUT_SAMPLES,
    HISTORY,
    IDENTIFIED,
    INPUT_DIGESTS,
    LINES,
    LINKS,
    LINK_TRIALS,
    LOGO,
    MODES,
    MOTION,
    PARTS,
    PERIODS,
    PIERS,
    PREDICTED,
    PROPERTIES,
    QUOFEM,
    REPORT_HTML,
    REPORT_PDF,
    RESOLVED,
    RIG,
    ROTATION,
    ROUNDS,
    SAMPLES,
    SCALE,
    SIDECARS,
    SPECTRUM,
    STATES,
    STRUCTURE_PARTS,
    SUMMARY,
    TABLE,
    TEMPERATURES,
    TESTED_RANGE,
    THERMOCOUPLES,
    TITLE,
    CYCLE_TABLE,
    VIRGIN,
    WORKBOOK,
    ".DS_Store",
    MODES_FILE,
}


def check_target(directory: Path, *, overwrite: bool) -> None:
    """Reject a target that cannot be written, before anything is computed."""
    choose = "choose another directory"
    try:
        final = directory.resolve()
        if not final.exists():
            parent = next(path for path in final.parents if path.exists())
            if not parent.is_dir():
                raise OutputError(f"{directory}: cannot be created, {parent} is a file; {choose}")
            if not os.access(parent, os.W_OK | os.X_OK):
                raise OutputError(f"{directory}: {parent} is not writable; {choose}")
            return
        if not final.is_dir():
            raise OutputError(f"{directory}: is a file; {choose}")
        names = {path.name for path in final.iterdir()}
    except (OSError, ValueError, RuntimeError) as error:  # too long, a null byte, a loop of links
        raise OutputError(f"{directory}: cannot be used: {error}; {choose}") from None
    if final in (Path.cwd(), *Path.cwd().parents):
        raise OutputError(f"{directory}: is the current directory or one of its parents; {choose}")
    if not names:
        return
    foreign = sorted(names - RESULT_NAMES)
    if SUMMARY not in names or foreign:
        content = f" (it contains {', '.join(foreign[:3])})" if foreign else ""
        raise OutputError(f"{directory}: exists and is not a result directory{content}; {choose}")
    if not overwrite:
        raise OutputError(f"{directory}: exists; give {OVERWRITE} to replace it, or {choose}")


def write_directory(
    directory: Path, fill: Callable[[Path], None], *, overwrite: bool = False
) -> Path:
    """Let `fill` write into a new directory, and put it in place when it is complete.

    The target is checked again when the files are complete, since another run may have written
    there meanwhile. If the disk is full or not writable, no files remain.
    """
    check_target(directory, overwrite=overwrite)
    final = directory.resolve()
    missing_parents = [path for path in final.parents if not path.exists()]
    try:
        final.parent.mkdir(parents=True, exist_ok=True)
        with new_sibling(final) as partial:
            fill(partial)
            if (partial / DATASET).exists():
                seal(partial / DATASET)
            _put_in_place(partial, final, lambda: check_target(directory, overwrite=overwrite))
    except (OSError, RuntimeError) as error:  # netCDF raises either for a failing disk
        cause = getattr(error, "strerror", None) or error
        raise OutputError(f"{directory}: cannot be written: {cause}") from error
    finally:
        with suppress(OSError):
            for path in [] if final.exists() else missing_parents:
                path.rmdir()
    return directory
