"""Files of a ground motion."""

from pathlib import Path

import numpy as np

from thermobearing.motions.record import MM_S2_PER_GAL
from thermobearing.motions.result import MM_PER_CM, MotionResult
from thermobearing.results.directory import FIGURES, MOTION, SPECTRUM, write_directory
from thermobearing.results.writing import write_summary


def save_motion(
    result: MotionResult, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, motion.csv, spectrum.csv and figures.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        write_summary(folder, result.summary())
        _write_motion(result, folder / MOTION)
        _write_spectrum(result, folder / SPECTRUM)
        if figures:
            from thermobearing.motions.figures import save_figures

            (folder / FIGURES).mkdir()
            save_figures(result, folder / FIGURES)

    return write_directory(directory, fill, force=force)


def _write_motion(result: MotionResult, path: Path) -> None:
    rows = np.column_stack([result.motion.time, result.motion.acceleration / MM_S2_PER_GAL])
    np.savetxt(path, rows, fmt="%.6f", delimiter=",", header="t_s,acc_gal", comments="")


def _write_spectrum(result: MotionResult, path: Path) -> None:
    found = result.spectrum
    columns = {
        "period_s": found.periods,
        "acceleration_gal": found.acceleration / MM_S2_PER_GAL,
        "pseudo_acceleration_gal": found.pseudo_acceleration / MM_S2_PER_GAL,
        "velocity_cm_s": found.velocity / MM_PER_CM,
        "displacement_cm": found.displacement / MM_PER_CM,
    }
    if result.reference is not None:
        columns["standard_gal"] = result.reference.at(found.periods) / MM_S2_PER_GAL
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, fmt="%.6g", delimiter=",", header=",".join(columns), comments="")
