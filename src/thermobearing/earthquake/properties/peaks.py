"""Peaks of bearing lines and their piers, and how far they depend on the time step.

The energy balance closes at any step, so that it does not show whether a step is small enough. An
abrupt change of stiffness, as of bilinear bearings, excites high modes of piers: the moment of a
pier can need a smaller step than displacement and force of its bearings.
"""

import tomllib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.units import parse_quantity
from thermobearing.earthquake.case import (
    EarthquakeCase,
    list_bearing_tables,
    make_earthquake_case,
)
from thermobearing.earthquake.measures import DIRECTION
from thermobearing.earthquake.properties.lines import (
    STILL,
    design_peak,
    load_device,
    moved_lines,
)
from thermobearing.earthquake.run import run_earthquake
from thermobearing.quantities.words import counted, joined, percent

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

TOLERANCE = 0.01  # of a peak, by which half the step may move it
IN_A_ROW = 2  # halvings that move no peak by more: one alone may do so by chance
MOST_HALVINGS = 5  # of the step of an analysis
MOST_STEPS = 4e6  # of all lines in an analysis at a smaller step, which takes some ten seconds
MOST_STEPS_OF_LINKS = 8e6  # likewise of bilinear bearings, which have no heat
COARSE = 0.02  # of a peak: error of the time step that is a warning
SMALLEST_STEP = 1e-6  # s, as of `dt`
GROUND = "ground"
MOMENT: Final = "pier_moment_max_kN_m"
# Column of a table of peaks: name and unit of the peak.
PEAKS: Final = {
    "displacement_max_mm": ("displacement", "mm"),
    "force_max_kN": ("force", "kN"),
    MOMENT: ("pier_moment", "kN_m"),
}
PLACE: Final = ["bearing", "ambient_degC", "line"]  # of a design peak
PeaksOf = Callable[["EarthquakeResult"], "pd.DataFrame"]


class Settled(NamedTuple):
    """An analysis at its own step and at the smallest step at which it was repeated."""

    first: "EarthquakeResult"
    result: "EarthquakeResult"  # at the smallest step
    step: float  # of it [s]
    change: float  # of a peak by either of the last two halvings at most, relative; NaN without
    halvings: int
    differences: Mapping[str, float]  # of `first` from `result` at most, relative, by peak
    runs: int  # besides those of `first`

    @property
    def has_settled(self) -> bool:
        """Whether two halvings in a row moved no peak by more than the tolerance."""
        return is_settled(self.halvings, self.change)


def is_settled(halvings: int, change: float) -> bool:
    """Return whether enough halvings in a row moved no peak by more than the tolerance."""
    return halvings >= IN_A_ROW and change <= TOLERANCE


def line_peaks(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return the peaks of the lines of completed runs: displacement, force, moment of their pier.

    The moment of a line on the ground, or on a pier without a hinge, is NaN.
    """
    table = tomllib.loads(str(result.dataset.attrs["case"]))
    devices = {str(item["name"]): load_device(item) for item in list_bearing_tables(table)}
    structure = table["structure"]
    lines = moved_lines(result, structure, devices)
    keys = [
        name
        for name in ("bearing", "motion", "ambient_degC", DIRECTION)
        if name in lines and name in result.table
    ]
    pier_by_line = {line["name"]: line.get("base", GROUND) for line in structure["bearings"]}
    if not len(piers := result.piers):
        moments = result.table[[*keys, MOMENT]]
        on_ground = lines["line"].map(pier_by_line) == GROUND
        merged = lines.merge(moments, on=keys)
        return merged.assign(**{MOMENT: merged[MOMENT].mask(on_ground.to_numpy())})
    names = set(piers["pier"])
    below = {body["name"]: body.get("on", GROUND) for body in structure["bodies"]}
    for line, body in pier_by_line.items():
        while body not in names and body != GROUND:
            body = below.get(body, GROUND)
        pier_by_line[line] = body
    moments = piers[[*keys, "pier", "moment_max_kN_m"]].rename(columns={"moment_max_kN_m": MOMENT})
    lines = lines.assign(pier=lines["line"].map(pier_by_line))
    return lines.merge(moments, on=[*keys, "pier"], how="left")


def _design_value(column: "pd.Series[float]") -> float:
    return design_peak(np.asarray(column, dtype=float))


def design_peaks(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return the design value of each peak over the motions, by bearing, temperature and line.

    Lines that do not move are left out.
    """
    peaks = line_peaks(result)
    designed = peaks.groupby(PLACE, sort=False)[list(PEAKS)].agg(_design_value)
    moved = peaks.groupby(PLACE, sort=False)["displacement_max_mm"].max()
    table = tomllib.loads(str(result.dataset.attrs["case"]))
    thickness = min(load_device(item).total_rubber_thickness for item in list_bearing_tables(table))
    return designed[moved > STILL * thickness]


def settle_case(
    case: EarthquakeCase,
    first: "EarthquakeResult",
    peaks_of: PeaksOf = design_peaks,
    most_steps: float = MOST_STEPS,
) -> Settled:
    """Repeat an analysis at half the step again and again, until its peaks do not move.

    That is when two halvings in a row move no design peak by more than 1 %. It ends too after five
    halvings, or before one with more than `most_steps`.

    Parameters
    ----------
    case : of the analysis.
    first : its result.
    peaks_of : design peaks of a result, by place; those of all lines by default.
    most_steps : of all lines together, in an analysis at a smaller step.
    """
    loads = [item.load_pair if case.structure.plan else item.load for item in case.motions]
    counts = [case.count_steps(load()) for load in loads]
    smallest = min(step for _, step in counts)
    line_steps = len(case.structure.bearings) * first.runs * sum(n for n, _ in counts) / len(counts)
    result, peaks, runs, step = first, peaks_of(first), 0, smallest
    first_peaks, changes = peaks, list[float]()
    for halving in range(1, MOST_HALVINGS + 1):
        halved = smallest / 2**halving
        if halved < SMALLEST_STEP or 2**halving * line_steps > most_steps or not len(peaks):
            break
        update: dict[str, Any] = {"dt": halved, "keep": ("rubber",)}
        update["keep_every"] = case.analysis.keep_every * 2**halving
        analysis = case.analysis.model_copy(update=update)
        try:
            finer = run_earthquake(case.model_copy(update={"analysis": analysis}))
        except InputError:  # more steps than one analysis may have
            break
        if finer.runs != first.runs:  # of an interrupted analysis, or of a part of its runs
            break
        finer_peaks = peaks_of(finer)
        changes.append(_largest(_differences(result, finer, peaks, finer_peaks)))
        result, peaks, step = finer, finer_peaks, halved
        runs += finer.runs
        if len(changes) >= IN_A_ROW and max(changes[-IN_A_ROW:]) <= TOLERANCE:
            break
    change = max(changes[-IN_A_ROW:], default=float("nan"))
    differences = _differences(first, result, first_peaks, peaks)
    return Settled(first, result, step, change, len(changes), differences, runs)


def settle_bridge(result: "EarthquakeResult") -> Settled:
    """Repeat the analysis of a bridge at smaller steps (`settle_case`).

    Without its records, which may not be there any more, it stays as it is.
    """
    table = tomllib.loads(str(result.dataset.attrs["case"]))
    case = make_earthquake_case(table, "result")
    try:
        return settle_case(case, result)
    except InputError:
        return Settled(result, result, case.analysis.dt, float("nan"), 0, {}, 0)


def _differences(
    result: "EarthquakeResult",
    finer: "EarthquakeResult",
    peaks: "pd.DataFrame",
    finer_peaks: "pd.DataFrame",
) -> dict[str, float]:
    """Return `largest_differences`; infinite where a run has another outcome.

    Design peaks are over the motions that an analysis completes: those of fewer motions are no
    peaks at a smaller step.
    """
    if np.array_equal(result["outcome"].values, finer["outcome"].values):
        return largest_differences(peaks, finer_peaks)
    return dict.fromkeys(PEAKS, float("inf"))


def largest_differences(peaks: "pd.DataFrame", finer: "pd.DataFrame") -> dict[str, float]:
    """Return by how much peaks differ from those at a smaller step at most, relative to these.

    A peak that only one of both has counts as infinitely far off: a run has another outcome. NaN of
    a peak that neither has, such as the moment of piers without a hinge.
    """
    coarse, fine = peaks.align(finer, join="outer")
    differences = {}
    for column in PEAKS:
        before, after = (table[column].to_numpy(dtype=float) for table in (coarse, fine))
        in_any = ~(np.isnan(before) & np.isnan(after))
        scale = np.maximum(np.abs(after), np.finfo(float).tiny)
        ratios = np.nan_to_num(np.abs(before - after) / scale, nan=np.inf)[in_any]
        differences[column] = float(ratios.max()) if in_any.any() else float("nan")
    return differences


def _largest(differences: Mapping[str, float]) -> float:
    return max((value for value in differences.values() if value == value), default=float("nan"))


def milliseconds(step: float) -> str:
    """Return a time step [s] in words.

    >>> milliseconds(0.00125)
    '1.25 ms'
    """
    return f"{1e3 * step:.4g} ms"


def step_note(settled: Settled, rubber: str = "") -> str:
    """Return how far the peaks of an analysis depend on its time step, as a sentence.

    `rubber` is its state, where not that of the analysis of the report.
    """
    table = tomllib.loads(str(settled.first.dataset.attrs["case"]))
    first = milliseconds(parse_quantity(str(table["analysis"]["dt"]), "s"))
    subject = f"with {rubber} rubber, " * bool(rubber)
    if not settled.runs:
        return (
            f"Error of the time step: {subject}not computed; repeat the analysis with half of its "
            f"step of {first}, and compare displacement, force and pier moment."
        )
    runs = f"{counted(settled.runs, 'more run')} of the analysis"
    if np.isinf(_largest(settled.differences)):
        return (
            f"Error of the time step: {subject}at {milliseconds(settled.step)} a run has another "
            f"outcome than at {first} ({runs})."
        )
    phrases = [
        f"{PEAKS[column][0].replace('_', ' ')} {percent(value, 1)}"
        for column, value in settled.differences.items()
        if value == value
    ]
    return (
        f"Error of the time step: {subject}design peaks at steps of at most {first} differ from "
        f"those at {milliseconds(settled.step)} by at most {joined(phrases)} ({runs}; "
        f"{halving_clause(settled.halvings, settled.change)})."
    )


def halving_clause(halvings: int, change: float) -> str:
    """Return what the last halvings of the step of an analysis moved, as a clause.

    Parameters
    ----------
    halvings, change : as in `Settled`.

    Examples
    --------
    >>> halving_clause(1, 0.002)
    'halved once, which moved no peak by more than 0.2 %'
    """
    if halvings < 1:
        return "not repeated at a smaller step, which would take too many steps"
    if np.isinf(change):
        return "not settled: a halving changes the outcome of a run"
    if change > TOLERANCE:
        return f"not settled: a halving still moves a peak by {percent(change, 1)}"
    halved = "halved once, which" if halvings < IN_A_ROW else "the last two halvings"
    return f"{halved} moved no peak by more than {percent(change, 1)}"


def step_warning(settled: Settled, rubber: str = "") -> str:
    """Return that the step of an analysis is too large for its peaks, as a warning; else empty."""
    if not settled.runs or _largest(settled.differences) <= COARSE:
        return ""
    step = settled.step if settled.change <= TOLERANCE else 0.5 * settled.step
    state = f" --state {rubber}" if rubber else ""
    cure = f"repeat the analysis with --dt {step:.4g}{state}"
    return f"{step_note(settled, rubber).removesuffix('.')}; {cure}"
