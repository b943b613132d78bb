"""Figures, directory and console tables of ground motions."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter

from thermobearing.core.types import Floats
from thermobearing.motions.measures import significant_interval
from thermobearing.motions.record import MM_S2_PER_GAL, GroundMotion
from thermobearing.motions.result import MM_PER_CM, MotionResult, Reference
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.results import drawing
from thermobearing.results.directory import FIGURES, MOTION, SPECTRUM, write_directory
from thermobearing.results.screen import print_facts
from thermobearing.results.writing import write_summary

BINS = 2000
MOTION_COLOUR = "#0077BB"
REFERENCE_LOOKS = (("#CC3311", "--"), ("#EE7733", "-."))
ROWS = (
    ("acceleration [gal]", "largest {:.0f} gal"),
    ("velocity [cm/s]", "largest {:.1f} cm/s"),
    ("displacement [cm]", "largest {:.1f} cm"),
)
BOTH_TYPES = (Reference("I", "I"), Reference("II", "I"))  # beside a motion made for neither


def save_figures(result: MotionResult, folder: Path) -> None:
    """Draw a motion and its spectrum into a folder."""
    motion, found = result.motion, result.spectrum
    histories = motion_figure(
        motion.name,
        motion.time,
        motion.acceleration / MM_S2_PER_GAL,
        motion.velocity / MM_PER_CM,
        motion.displacement / MM_PER_CM,
        significant_interval(motion),
    )
    standards = {
        f"standard, Level 2 Type {beside.kind}, ground {beside.ground}, 5 %": (
            beside.at(found.periods) / MM_S2_PER_GAL
        )
        for beside in ([result.reference] if result.reference else BOTH_TYPES)
    }
    spectra = spectrum_figure(
        motion.name,
        found.periods,
        found.acceleration / MM_S2_PER_GAL,
        found.displacement / MM_PER_CM,
        standards,
        found.damping,
    )
    drawn = {"motion": lambda: histories, "spectrum": lambda: spectra}
    drawing.save_figures(drawn, folder, vector=True)


def motion_figure(
    title: str,
    time: Floats,
    acceleration_gal: Floats,
    velocity_cm_s: Floats,
    displacement_cm: Floats,
    strong: tuple[float, float] | None = None,
) -> Figure:
    """Acceleration, velocity and displacement of the ground against time.

    Parameters
    ----------
    title : name of the motion.
    time : [s].
    acceleration_gal, velocity_cm_s, displacement_cm : [gal], [cm/s], [cm].
    strong : beginning and end of the significant duration [s], shaded.
    """
    figure, axes = drawing.panels(3, 1, (9.0, 6.2), title)
    histories = (acceleration_gal, velocity_cm_s, displacement_cm)
    for ax, values, (label, told) in zip(axes, histories, ROWS, strict=True):
        if strong is not None:
            ax.axvspan(*strong, color=drawing.PALE, zorder=0, linewidth=0)
        kept = drawing.thin(values, BINS)
        ax.plot(time[kept], values[kept], color=MOTION_COLOUR, linewidth=0.8)
        peak = int(np.abs(values).argmax())
        ax.plot(time[peak], values[peak], "o", color=drawing.INK, markersize=3.5)
        ax.set_xlim(0.0, time[-1])
        drawing.name_axes(ax, y=label, title=told.format(abs(values[peak])))
    drawing.name_axes(axes[-1], "time [s]")
    if strong is not None:
        patch = Line2D([], [], color="#d5dae2", linewidth=7.0, label="5 to 95 % of Arias intensity")
        drawing.legend_below(figure, [patch])
    return figure


def spectrum_figure(
    title: str,
    periods: Floats,
    acceleration_gal: Floats,
    displacement_cm: Floats,
    references: dict[str, Floats],
    damping: float,
) -> Figure:
    """Response spectra of acceleration and displacement, beside standard ones.

    Parameters
    ----------
    title : name of the motion.
    periods : [s].
    acceleration_gal, displacement_cm : largest absolute acceleration [gal] and relative
        displacement [cm].
    references : standard acceleration spectra at the same periods [gal], by name.
    damping : ratio of critical damping.
    """
    figure, (left, right) = drawing.panels(1, 2, (10.0, 4.6), title)
    handles = []
    for (name, values), (colour, line) in zip(references.items(), REFERENCE_LOOKS, strict=False):
        look: drawing.Look = {"color": colour, "linestyle": line, "linewidth": 1.6}
        left.plot(periods, values, **look)
        implied = values * (periods / (2.0 * np.pi)) ** 2
        right.plot(periods, implied, **look)
        handles.append(Line2D([], [], label=name, **look))
    left.plot(periods, acceleration_gal, color=MOTION_COLOUR, linewidth=1.2)
    right.plot(periods, displacement_cm, color=MOTION_COLOUR, linewidth=1.2)
    handles.insert(0, Line2D([], [], color=MOTION_COLOUR, linewidth=1.2, label="this motion"))
    for ax in (left, right):
        ax.set_xscale("log")
        ax.set_xlim(periods[0], periods[-1])
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        ax.xaxis.set_minor_formatter(NullFormatter())
    left.set_yscale("log")
    left.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    percent = f"{100.0 * damping:g} % damping"
    drawing.name_axes(left, "period [s]", "acceleration [gal]", f"absolute acceleration, {percent}")
    drawing.name_axes(right, "period [s]", "displacement [cm]", f"displacement, {percent}")
    drawing.legend_below(figure, handles)
    return figure


def save_motion(
    result: MotionResult, directory: Path, *, overwrite: bool = False, figures: bool = True
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
            (folder / FIGURES).mkdir()
            save_figures(result, folder / FIGURES)

    return write_directory(directory, fill, overwrite=overwrite)


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


SHOWN = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0)  # periods [s]


def print_names(motions: list[GroundMotion]) -> None:
    """One line for each motion: name, size, length, what it is."""
    for motion in motions:
        size = f"{motion.pga / MM_S2_PER_GAL:5.0f} gal {motion.duration:6.1f} s"
        _print(f"{motion.name:15}{size}  {motion.description}")


def print_motion(result: MotionResult) -> None:
    """Size, duration and ends of a motion, and how well it fits."""
    told = result.summary()
    facts = {
        "samples": f"{told['samples']} every {told['dt_s']:g} s",
        "largest acceleration": f"{told['pga_gal']:.1f} gal",
        "largest velocity": f"{told['pgv_cm_s']:.1f} cm/s",
        "largest displacement": f"{told['pgd_cm']:.1f} cm",
        "at the end": f"{told['end_velocity_cm_s']:.3g} cm/s, {told['end_displacement_cm']:.3g} cm",
        "Arias intensity": f"{told['arias_intensity_m_s']:.2f} m/s",
        "duration": f"{told['duration_s']:g} s, of which 5 to 95 %: "
        f"{told['significant_duration_s']:.1f} s",
    }
    reference, misfit = result.reference, result.misfit
    if reference is not None and misfit is not None:
        facts["misfit"] = (
            f"{100 * misfit:.1f} % rms over 0.1 to 3 s against Level 2 "
            f"Type {reference.kind}, ground {reference.ground}"
        )
    facts["description"] = result.motion.description or "-"
    print_facts(result.motion.name, facts)


def print_spectrum(result: MotionResult) -> None:
    """Response spectrum at ten periods, beside the standard one."""
    motion, reference, damping = result.motion, result.reference, result.damping
    found = response_spectrum(motion, SHOWN, damping)
    standard = None if reference is None else reference.at(SHOWN)
    last = f"  Type {reference.kind}, ground {reference.ground} [gal]" if reference else ""
    _print(f"{motion.name}, {100 * damping:g} % damping")
    _print(f"period [s]  acceleration [gal]  velocity [cm/s]  displacement [cm]{last}")
    for i, period in enumerate(SHOWN):
        a = found.acceleration[i] / MM_S2_PER_GAL
        v, d = found.velocity[i] / MM_PER_CM, found.displacement[i] / MM_PER_CM
        end = f"{standard[i] / MM_S2_PER_GAL:20.0f}" if standard is not None else ""
        _print(f"{period:10g}{a:20.1f}{v:17.1f}{d:19.2f}{end}")


def _print(line: str) -> None:
    """A line as it is, too long for the terminal or not; told at once if the reader has gone."""
    print(line, flush=True)
