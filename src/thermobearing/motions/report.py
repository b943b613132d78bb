"""What the document of a ground motion says, from a result as it is loaded again."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.motions.matching import LARGEST_MISFIT
from thermobearing.report.content import (
    saved_figures,
    with_plot,
)
from thermobearing.report.figures import history, rounded
from thermobearing.report.pieces import (
    EXCEEDED,
    PASSED,
    Check,
    Column,
    Pieces,
    Plot,
    ReportFigure,
    ReportTable,
    Trace,
)
from thermobearing.report.words import identity_rows, tidy
from thermobearing.results.directory import MOTION
from thermobearing.results.saved import SavedResult
from thermobearing.tables.text import read_text

CAPTIONS = {
    "motion": "Acceleration, velocity and displacement of the ground.",
    "spectrum": "Response spectrum of the motion beside the standard one.",
}
MEASURES = {  # of the summary: words, unit, digits
    "dt_s": ("Step of time", "s", ".4g"),
    "samples": ("Samples", "", "d"),
    "duration_s": ("Length", "s", ".1f"),
    "pga_gal": ("Peak ground acceleration", "gal", ".0f"),
    "pgv_cm_s": ("Peak ground velocity", "cm/s", ".1f"),
    "pgd_cm": ("Peak ground displacement", "cm", ".1f"),
    "arias_intensity_m_s": ("Arias intensity", "m/s", ".2f"),
    "significant_duration_s": ("Significant duration (5 to 95 % of Arias)", "s", ".1f"),
    "bracketed_duration_s": ("Bracketed duration", "s", ".1f"),
    "cumulative_absolute_velocity_m_s": ("Cumulative absolute velocity", "m/s", ".1f"),
    "end_velocity_cm_s": ("Velocity at the end", "cm/s", ".1e"),
    "end_displacement_cm": ("Displacement at the end", "cm", ".1e"),
}
PERIODS = (0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0)  # quoted of a spectrum [s]


def build_pieces(saved: SavedResult) -> Pieces:
    """Everything that the document of a ground motion says.

    Parameters
    ----------
    saved : of `motions show`, `make` or `spectrum`, as `load_result` gives it.
    """
    summary = saved.summary
    name = str(summary["motion"])
    standard = summary.get("standard_spectrum")
    beside = f" beside the standard spectrum of {_standard(standard)}" if standard else ""
    about = tidy(str(summary.get("description") or name))
    motion = read_text(saved.path / MOTION)
    return Pieces(
        command="motions",
        title=f"Ground motion {name}",
        question=f"How strong is the ground motion {name}, how long does it last, and what does "
        f"its response spectrum look like{beside}? {about}",
        answer=_answer(summary),
        inputs={"origin": _origin(summary)},
        tables=_tables(saved),
        figures=_figures(saved),
        checks=_checks(summary),
        validity_unknown="Of a ground motion nothing was identified, so nothing can be left.",
        assumptions=[
            f"Response spectra are of linear oscillators with a damping of "
            f"{100.0 * float(summary['damping']):g} %, solved exactly between samples.",
        ],
        warnings=[tidy(text) for text in saved.warnings],
        identity=identity_rows(
            str(summary.get("version", "unknown")),
            motion,
            str(summary.get("command_line") or "thermobearing.motions in Python"),
            MOTION,
        ),
    )


def _standard(told: Mapping[str, Any]) -> str:
    zone = float(told["zone_factor"])
    return f"Level 2 Type {told['type']}, ground {told['ground']}, c_z = {zone:g}"


def _answer(summary: Mapping[str, Any]) -> list[str]:
    """Peaks, how long it is strong, how it fits its spectrum."""
    found = [
        f"The peak acceleration is {summary['pga_gal']:.0f} gal, the peak velocity "
        f"{summary['pgv_cm_s']:.1f} cm/s and the peak displacement {summary['pgd_cm']:.1f} cm.",
        f"Of its {summary['duration_s']:.1f} s, {summary['significant_duration_s']:.1f} s hold 5 "
        f"to 95 % of the Arias intensity of {summary['arias_intensity_m_s']:.2f} m/s.",
    ]
    standard = summary.get("standard_spectrum")
    if standard and standard["misfit_rms"] is not None:
        found.append(
            f"Its spectrum is {100.0 * standard['misfit_rms']:.1f} % rms off that of "
            f"{_standard(standard)}, over 0.1 to 3 s."
        )
    else:
        found.append("It was compared with no standard spectrum.")
    if summary["outcome"] != "completed":
        found.insert(0, f"The motion does not fit its spectrum ({summary['outcome']}).")
    return found


def _origin(summary: Mapping[str, Any]) -> ReportTable:
    columns = (Column("What"), Column("Value"))
    rows = [
        (words, str(summary[key]))
        for key, words in (("motion", "Name"), ("description", "Description"))
        if summary.get(key)
    ]
    rows += [("Source", str(summary["citation"]))] if summary.get("citation") else []
    return ReportTable("The motion", columns, rows)


def _tables(saved: SavedResult) -> dict[str, ReportTable]:
    """Measures, and the spectrum at periods that one quotes."""
    summary = saved.summary
    rows = [
        (words, Column("", form=form).text(summary[key]), unit)
        for key, (words, unit, form) in MEASURES.items()
        if summary.get(key) is not None
    ]
    columns = [Column("Measure"), Column("Value"), Column("Unit")]
    found = {"measures": ReportTable("Measures of the motion", columns, rows)}
    if "spectrum" in saved.tables:
        table = saved["spectrum"]
        heads = {"acceleration_gal": "S_a", "velocity_cm_s": "S_v", "displacement_cm": "S_d"}
        heads |= {"standard_gal": "Standard S_a (5 %)"}
        units = {"acceleration_gal": "gal", "velocity_cm_s": "cm/s", "displacement_cm": "cm"}
        told = [name for name in heads if name in table]
        periods = table["period_s"].to_numpy(dtype=float)
        chosen = [t for t in PERIODS if periods[0] <= t <= periods[-1] * 1.0001]
        columns = [Column("Period", "s", "g")]
        columns += [Column(heads[name], units.get(name, "gal"), ".4g") for name in told]
        values = [np.interp(chosen, periods, table[name].to_numpy(dtype=float)) for name in told]
        cells = [[t, *(float(v[k]) for v in values)] for k, t in enumerate(chosen)]
        caption = f"Response spectrum, damping {100.0 * float(summary['damping']):g} %"
        note = "Between the periods of spectrum.csv, which has 200."
        found["spectrum"] = ReportTable(caption, columns, cells, note=note)
    return found


def _figures(saved: SavedResult) -> dict[str, ReportFigure]:
    """Drawn figures, with the acceleration and the spectrum as plots."""
    found = saved_figures(saved, CAPTIONS)
    if "motion" in saved.tables:
        table = saved["motion"]
        trace = Trace(
            str(saved.summary["motion"]),
            *history(table["t_s"].to_numpy(float), table["acc_gal"].to_numpy(float), 3000),
            "#0077BB",
        )
        plot = Plot("time [s]", "acceleration [gal]", {"all": [trace]})
        found = with_plot(found, "motion", plot, CAPTIONS)
    if "spectrum" in saved.tables:
        table = saved["spectrum"]
        x = rounded(table["period_s"].to_numpy(float))
        looks = [("acceleration_gal", "motion", "#0077BB", "line")]
        looks += (
            [("standard_gal", "standard", "#CC3311", "dashed")] if "standard_gal" in table else []
        )
        traces = [
            Trace(words, x, rounded(table[name].to_numpy(float)), colour, look)
            for name, words, colour, look in looks
        ]
        plot = Plot("period [s]", "response acceleration [gal]", {"all": traces})
        found = with_plot(found, "spectrum", plot, CAPTIONS)
    return found


def _checks(summary: Mapping[str, Any]) -> list[Check]:
    """The misfit to the standard spectrum, of a motion that was made for it."""
    standard = summary.get("standard_spectrum")
    if not standard or standard["misfit_rms"] is None:
        return []
    misfit = 100.0 * float(standard["misfit_rms"])
    limit = 100.0 * LARGEST_MISFIT
    what = "misfit to the standard spectrum, rms over 0.1 to 3 s"
    source = "limit of motions that are made"
    return [Check(what, misfit, limit, "%", source, PASSED if misfit <= limit else EXCEEDED)]
