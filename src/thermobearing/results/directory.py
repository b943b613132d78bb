"""A result directory: checked before anything is computed, written whole or not at all.

Everything is written into a hidden sibling directory that takes its place at the end
(results/swap.py), so a full disk, an interruption or a crash leaves either the complete result
or the earlier one.
"""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

from thermobearing.border.errors import OutputError
from thermobearing.results.seal import seal
from thermobearing.results.swap import new_sibling, put_in_place

FORCE = "--force (in Python force=True)"
SUMMARY, DATASET, HISTORY = "summary.json", "result.nc", "history.csv"
RESOLVED, FIGURES, COMPARISON = "case.resolved.toml", "figures", "comparison.csv"
TABLE, MODES, RIG, PARTS = "table.csv", "modes.csv", "rig.csv", "parts"
LINES, PIERS = "lines.csv", "piers.csv"
STRUCTURE_PARTS, PERIODS = "parts.csv", "periods.csv"
TESTED_RANGE = "tested_range.csv"
IDENTIFIED, FIT_TABLE, SAMPLES = "bearing.toml", "fit.csv", "posterior.csv"
COMPOUND = "compound.toml"
# Everything that any command writes into a result directory; nothing else is ever deleted.
RESULT_NAMES = {SUMMARY, DATASET, HISTORY, RESOLVED, FIGURES, COMPARISON, TABLE, ".DS_Store"}
RESULT_NAMES |= {RIG, TESTED_RANGE, PARTS, LINES, PIERS, STRUCTURE_PARTS, PERIODS}
MOTION, SPECTRUM = "motion.csv", "spectrum.csv"
RESULT_NAMES |= {MOTION, SPECTRUM, MODES}
FACTORS, SCALE, BOUNDS = "factors.csv", "scale.csv", "bounds.csv"
BOUNDS_TCL, BOUNDS_PYTHON = "bounds.tcl", "bounds.py"
RESULT_NAMES |= {FACTORS, SCALE, BOUNDS, BOUNDS_TCL, BOUNDS_PYTHON}
ROUNDS, CHECKS, BEARINGS = "rounds.csv", "checks.csv", "bearings"
TEMPERATURES = "temperatures.csv"
RESULT_NAMES |= {ROUNDS, CHECKS, BEARINGS, TEMPERATURES}
VALIDATED_CYCLES, FOLDS, THERMOCOUPLES = "cycles.csv", "folds.csv", "thermocouples.csv"
SIDECARS = "sidecars"
RESULT_NAMES |= {VALIDATED_CYCLES, FOLDS, THERMOCOUPLES, SIDECARS}
RESULT_NAMES |= {IDENTIFIED, COMPOUND, FIT_TABLE, SAMPLES}
REPORT_HTML, REPORT_PDF, WORKBOOK = "report.html", "report.pdf", "report.xlsx"
TITLE, LOGO = "report.toml", "report-logo"
LEDGER, LEDGER_JSON, INDEX, TABLES = "ledger.csv", "ledger.json", "index.md", "tables"
RESULT_NAMES |= {LEDGER, LEDGER_JSON, INDEX, TABLES}
RESULT_NAMES |= {REPORT_HTML, REPORT_PDF, WORKBOOK, TITLE, LOGO}


def check_target(directory: Path, *, force: bool) -> None:
    """Refuse a target that a run may not write to, before anything is computed.

    Raises
    ------
    OutputError : it exists and `force` is False, it is not a result directory or holds
        anything else, or it cannot be made.
    """
    choose = "choose another directory"
    try:
        final = directory.resolve()
        if not final.exists():
            above = next(path for path in final.parents if path.exists())
            if not above.is_dir():
                raise OutputError(f"{directory}: cannot be made, {above} is a file; {choose}")
            if not os.access(above, os.W_OK | os.X_OK):
                raise OutputError(f"{directory}: {above} is not writable; {choose}")
            return
        if not final.is_dir():
            raise OutputError(f"{directory}: is a file; {choose}")
        names = {path.name for path in final.iterdir()}
    except (OSError, ValueError, RuntimeError) as error:  # too long, a null byte, a loop of links
        raise OutputError(f"{directory}: cannot be used: {error}; {choose}") from None
    if final in (Path.cwd(), *Path.cwd().parents):
        raise OutputError(f"{directory}: is the directory you are in, or holds it; {choose}")
    if not names:
        return
    foreign = sorted(names - RESULT_NAMES)
    if SUMMARY not in names or foreign:
        held = f" (it holds {', '.join(foreign[:3])})" if foreign else ""
        raise OutputError(f"{directory}: exists and is not a result directory{held}; {choose}")
    if not force:
        raise OutputError(f"{directory}: exists; give {FORCE} to replace it, or {choose}")


def write_directory(directory: Path, fill: Callable[[Path], None], *, force: bool = False) -> Path:
    """Let `fill` write its files into a new directory, and put it in place when it is complete.

    Raises
    ------
    OutputError : see `check_target`, which is asked again when the files are complete, since
        another run may have written there meanwhile; or the disk is full or not writable.
        Nothing is left.
    """
    check_target(directory, force=force)
    final = directory.resolve()
    above = [path for path in final.parents if not path.exists()]
    try:
        final.parent.mkdir(parents=True, exist_ok=True)
        with new_sibling(final) as partial:
            try:
                fill(partial)
                if (partial / DATASET).exists():
                    seal(partial / DATASET)
                put_in_place(partial, final, lambda: check_target(directory, force=force))
            finally:  # half written, or the result that was replaced
                shutil.rmtree(partial, ignore_errors=True)
    except (OSError, RuntimeError) as error:  # netCDF tells a failing disk as either
        told = getattr(error, "strerror", None) or error
        raise OutputError(f"{directory}: cannot be written: {told}") from error
    finally:
        if not final.exists():
            _remove_empty(above)
    return directory


def _remove_empty(directories: list[Path]) -> None:
    """Take away the parents that were made for nothing, innermost first."""
    for path in directories:
        try:
            path.rmdir()
        except OSError:
            return
