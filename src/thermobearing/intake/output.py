"""Settings files, figures and console tables of imported records."""

import math
import os
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from thermobearing.border.errors import OutputError, printable
from thermobearing.border.text_file import file_names
from thermobearing.identify.fit.forward import PAUSE
from thermobearing.identify.output import MARKS
from thermobearing.intake.result import Intake, Intakes
from thermobearing.results import drawing
from thermobearing.results.directory import FIGURES, SIDECARS, check_target, write_directory
from thermobearing.results.screen import print_table
from thermobearing.results.time_axis import DrawnAxis, Stretch
from thermobearing.results.writing import write_summary

Floats = NDArray[np.float64]
BINS = 3000
FEW_TICKS = 14  # of a panel that is half as wide as the page
REST, SPIKE, BLOCK, DRIFT = "#dfe7f5", "#CC3311", "#009988", "#EE7733"
UNITS = {"displacement": "mm", "force": "kN"}


def intake_figure(found: Intake) -> Figure:
    """Histories, loops and temperatures, with what was found marked.

    Parameters
    ----------
    found : from `take_in`.

    Returns
    -------
    Figure
    """
    record, axis = found.record, time_axis(found)
    title = f"{printable(found.file.name)}: {found.rows} rows, {found.blocks} block(s)"
    figure, (way, force, loops, warm) = drawing.panels(2, 2, (drawing.WIDEST, 5.6), title)
    for ax, name in ((way, "displacement"), (force, "force")):
        _draw_history(ax, found, axis, name)
    x, f = record.displacement, record.force
    spans = max(float(np.ptp(x)), 1e-9), max(float(np.ptp(f)), 1e-9)
    kept = drawing.thin_loops(x, f, *spans)
    loops.plot(x[kept], f[kept], color=drawing.INK, linewidth=0.6)
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", "loops as recorded")
    _draw_temperatures(warm, found, axis)
    return figure


def time_axis(found: Intake) -> DrawnAxis:
    """Loadings to scale, rests shortened: those that were logged, and those that were not.

    Parameters
    ----------
    found : from `take_in`.

    Returns
    -------
    DrawnAxis : of stretches whose ends are samples.
    """
    time, treatment = found.record.time, found.treatment
    gaps = np.flatnonzero(np.diff(time) > PAUSE).tolist()
    rests = sorted({*(treatment.rests if treatment else []), *((k, k + 1) for k in gaps)})
    ends: list[tuple[int, int, bool]] = []
    before = 0
    for first, last in [*rests, (len(time) - 1, len(time) - 1)]:
        if first > before:
            ends.append((before, first, False))
        if last > max(first, before):
            ends.append((max(first, before), last, True))
        before = max(before, last)
    lasting = [(a, b, rest, float(time[b] - time[a])) for a, b, rest in ends]
    return DrawnAxis([Stretch(a, b, rest, span, span) for a, b, rest, span in lasting])


def _places(axis: DrawnAxis, time: Floats) -> Floats:
    """Where each sample is drawn."""
    x = np.empty(len(time))
    for s in axis.stretches:
        rows = slice(s.first, s.last + 1)
        x[rows] = s.place(time[rows] - time[s.first])
    return x


def _kept(axis: DrawnAxis, values: Floats) -> NDArray[np.int64]:
    """Samples to draw: as many of a stretch as it has room, so that rests do not take them all."""
    parts = []
    for s in axis.stretches:
        bins = math.ceil(BINS * s.width / axis.end)
        parts.append(s.first + drawing.thin(values[s.first : s.last + 1], bins))
    return np.concatenate(parts)


def _name_time(ax: Axes, axis: DrawnAxis) -> None:
    axis.set_ticks(ax, in_rests=False, most=FEW_TICKS)
    ax.set_xlabel(axis.caption().replace("; ", ";\n"), fontsize=drawing.NORMAL)


def _draw_history(ax: Axes, found: Intake, axis: DrawnAxis, name: str) -> None:
    """One signal in time: rests shaded, spikes crossed, begins of blocks, the line of its drift."""
    record, treatment = found.record, found.treatment
    time, values = _places(axis, record.time), getattr(record, name)
    kept = _kept(axis, values)
    ax.plot(time[kept], values[kept], color=drawing.INK, linewidth=0.7)
    told = []
    for k in np.flatnonzero(np.diff(record.block)).tolist():
        ax.axvline(time[k + 1], color=BLOCK, linewidth=0.9, linestyle=":")
    if record.block[-1]:
        told.append("dotted: blocks")
    if treatment is not None:
        for first, last in treatment.rests:
            ax.axvspan(time[first], time[last], color=REST, linewidth=0.0, zorder=0)
        if treatment.rests:
            told.append(f"shaded: {len(treatment.rests)} rests")
        spikes = treatment.spikes[name]
        if spikes.any():
            ax.plot(time[spikes], values[spikes], "x", color=SPIKE, markersize=5)
            told.append(f"crosses: {int(spikes.sum())} samples of spikes")
        if name in treatment.drifts:
            drift = treatment.drifts[name]
            middle = float(np.median(drift.middles - drift.slope * drift.times))
            line = middle + drift.slope * record.time[kept]
            ax.plot(time[kept], line, color=DRIFT, linewidth=1.4)
            told.append(f"line: drift of {drift.total:.3g} {UNITS[name]}")
    title = ", ".join(told) or "nothing out of the way"
    _name_time(ax, axis)
    drawing.name_axes(ax, "", f"{name} [{UNITS[name]}]", title)


def _draw_temperatures(ax: Axes, found: Intake, axis: DrawnAxis) -> None:
    """Thermocouples, and the ambient as one line."""
    record = found.record
    time = _places(axis, record.time)
    colours = drawing.ordered_colours(max(len(record.temperatures), 1), "turbo")
    for (title, values), colour in zip(record.temperatures.items(), colours, strict=False):
        label = f"{title} ({record.places[title]})"
        kept = _kept(axis, values)
        ax.plot(time[kept], values[kept], color=colour, linewidth=0.9, label=label)
    assumed = "ambient" in found.sidecar and "ambient" not in found.kept
    label = f"ambient {drawing.degrees(round(record.ambient, 2))}" + (
        " (assumed)" if assumed else ""
    )
    if found.ambient is not None:
        kept = _kept(axis, found.ambient)
        ax.plot(time[kept], found.ambient[kept], color=REST, linewidth=0.5, zorder=0)
    ax.axhline(record.ambient, color=drawing.GREY, linewidth=1.2, linestyle="--", label=label)
    _name_time(ax, axis)
    drawing.name_axes(ax, "", "temperature [degC]", "temperatures")
    ax.legend(fontsize=drawing.SMALL, frameon=False)


USED = ("time", "displacement", "force", "ambient", "strain")


def print_intakes(found: Intakes) -> None:
    """Columns and findings of each file.

    Parameters
    ----------
    found : from `take_in`.
    """
    for item in found.files:
        print(printable(_headline(item)))
        _print_columns(item)
        for finding in item.report.findings:
            print(printable(f"  {MARKS[finding.level]:8} {finding.check}: {finding.sentence}"))


def _headline(item: Intake) -> str:
    form = f'sheet "{item.sheet}"' if item.sheet else f"separated by {item.separator}"
    comma = "decimal comma, " if item.decimal == "," else ""
    blocks = "1 block" if item.blocks == 1 else f"{item.blocks} blocks"
    length = float(item.record.time[-1] - item.record.time[0])
    return (
        f"{item.file.name}: {form}, {comma}{item.rows} rows in {blocks}, {length:.4g} s, "
        f"ambient {item.record.ambient:.3g} degC"
    )


def _print_columns(item: Intake) -> None:
    rows = []
    for column in item.columns:
        unit = f"{column.assumed} (assumed)" if column.assumed else column.unit
        taken = column.holds if column.holds in USED else "not used"
        why = column.why
        if column.holds == "temperature":
            taken = column.place or taken
            why = column.why if column.place else "a thermocouple? say where it sits"
        elif column.holds in ("numbers", "words", "nothing"):
            why = column.why
        rows.append([printable(text) for text in (column.title, unit, taken, why)])
    print_table(("column", "unit", "taken as", "because of"), rows, keys=4)


def _sidecar_text(found: Intake, folder: Path) -> str:
    """TOML that `load_test` reads, with comments on what to look at.

    Parameters
    ----------
    found : from `take_in`.
    folder : where it will stand; files are named as seen from there.

    Returns
    -------
    str
    """
    keys = {key: value for key, value in found.sidecar.items() if not isinstance(value, dict)}
    tables = {key: value for key, value in found.sidecar.items() if isinstance(value, dict)}
    if "file" in keys:
        keys["file"] = _seen_from(folder, found.folder / keys["file"])
    if "blocks" in keys:
        keys["blocks"] = [
            block | {"file": _seen_from(folder, found.folder / block["file"])}
            for block in keys["blocks"]
        ]
    lines = [f"# {found.file.name}, as thermobearing intake found it; correct it and keep it."]
    lines += [f"# {finding.level}: {finding.sentence}" for finding in found.report.findings]
    lines += [tomli_w.dumps(keys).strip(), *_suggested(found)]
    for name, table in tables.items():
        lines += ["", *_comments(name, found), tomli_w.dumps({name: table}).strip()]
    lines += _place_lines(found, "thermocouples" in tables)
    return "\n".join(printable(line) if line.startswith("#") else line for line in lines) + "\n"


def _seen_from(folder: Path, file: Path) -> str:
    """A file as seen from a folder; its whole path where they share none (another drive)."""
    try:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    except ValueError:
        return file.resolve().as_posix()


def _suggested(found: Intake) -> list[str]:
    """Keys that may be wanted, as comments."""
    lines = []
    if "bearing" not in found.sidecar:
        lines.append(
            '# bearing = "..."  # geometry and materials: a name, or a file beside this one'
        )
    if "blocks" in found.sidecar:
        lines.append("# rest_before: how long the bearing rested before each block")
    if "ambient" in found.sidecar and "ambient" not in found.kept:
        lines.append("# ambient: no column tells it; correct it")
    treatment = found.treatment
    if treatment is not None and any(flags.any() for flags in treatment.spikes.values()):
        lines.append("# despike = true  # take the spikes out")
    drifting = list(treatment.drifts) if treatment is not None else []
    if drifting:
        which = drifting[0] if len(drifting) == 1 else "both"
        lines.append(f'# detrend = "{which}"  # take the drift out')
    return lines


def _comments(table: str, found: Intake) -> list[str]:
    if table != "units":
        return []
    assumed = [column.title for column in found.columns if column.assumed]
    return [f"# assumed, the file does not say: {', '.join(assumed)}"] if assumed else []


def _place_lines(found: Intake, begun: bool) -> list[str]:
    """Thermocouples whose place no title tells, as comments."""
    open_ones = [c.title for c in found.columns if c.holds == "temperature" and not c.place]
    if not open_ones:
        return []
    lines = [] if begun else ["", "# [thermocouples]  # rubber 1 is the outer layer; or lead"]
    return lines + [f'# {_key(title)} = "rubber 1"' for title in open_ones]


def _key(title: str) -> str:
    entry: dict[str, Any] = {title: 0}
    return tomli_w.dumps(entry).rsplit(" = ", 1)[0]


def save_intakes(
    found: Intakes,
    directory: Path,
    *,
    overwrite: bool = False,
    figures: bool = True,
    beside: bool = False,
) -> Path:
    """Write summary.json, a sidecar and a picture for each file.

    Parameters
    ----------
    found : from `take_in`.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory; never a sidecar beside a file.
    figures : draw the pictures too.
    beside : put each sidecar beside its file too, where `load_test` finds it.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; a sidecar that is there already. Nothing is left.
    """
    check_target(directory, overwrite=overwrite)
    names = file_names(item.file.stem for item in found.files)
    targets = [item.file.with_suffix(".toml") for item in found.files] if beside else []
    there = [str(path) for path in targets if path.exists()]
    if there or len(set(targets)) < len(targets):
        told = there[0] if there else str(targets[0])
        raise OutputError(f"{told}: is there already; correct it, or leave out --beside")

    def fill(folder: Path) -> None:
        write_summary(folder, found.summary())
        (folder / SIDECARS).mkdir()
        for item, name in zip(found.files, names, strict=True):
            text = _sidecar_text(item, directory / SIDECARS)
            (folder / SIDECARS / f"{name}.toml").write_text(text, encoding="utf-8")
        if figures:
            from thermobearing.results.drawing import save_figures

            drawn = {
                name: partial(Intake.plot, item)
                for item, name in zip(found.files, names, strict=True)
            }
            save_figures(drawn, folder / FIGURES)

    written = write_directory(directory, fill, overwrite=overwrite)
    for item, path in zip(found.files, targets, strict=False):
        _put(path, _sidecar_text(item, path.parent))
    return written


def _put(path: Path, text: str) -> None:
    """A new file, whole or not at all."""
    partial_file = path.with_name(f".{path.name}.partial")
    try:
        partial_file.write_text(text, encoding="utf-8")
        os.link(partial_file, path)  # unlike a replacement it never covers what is there
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        partial_file.unlink(missing_ok=True)
