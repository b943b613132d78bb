"""Content of the report of a ground motion, from its saved result."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.motions.matching import LARGEST_MISFIT
from thermobearing.motions.run import (
    PAIR_SPECTRA,
    SPECTRA,
    measures_table,
    reference_words,
    spectrum_table,
)
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import identity_rows, tidy
from thermobearing.report.content import saved_figures, with_plot
from thermobearing.report.pieces import EXCEEDED, PASSED, Check, Pieces, Plot, ReportFigure, Trace
from thermobearing.results.directory import MOTION
from thermobearing.results.saved import SavedResult
from thermobearing.tables.text import read_text

ROTATED = (
    "RotD50 and RotD100 are the median and the largest of the largest responses along a horizontal "
    "axis at 180 angles to the records, 1 deg apart, at each period on its own (Boore, Bulletin of "
    "the Seismological Society of America 100, 2010)."
)
RECORDS = (("acc_gal", "across_gal"), ("#0077BB", "#009988"))  # columns and colours
PERIODS = (0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0)  # listed periods of a spectrum [s]


def build_pieces(saved: SavedResult) -> Pieces:
    """Return the content of the report of `motions show`, `make` or `spectrum`."""
    summary = saved.summary
    name = str(summary["motion"])
    standard = summary.get("standard_spectrum")
    compared = f", compared with {reference_words(standard)}" if standard else ""
    description = tidy(str(summary.get("description") or name))
    origin_labels = {"motion": "Name", "description": "Description", "citation": "Source"}
    origin = [(word, str(summary[key])) for key, word in origin_labels.items() if summary.get(key)]
    return Pieces(
        command="motions",
        title=f"Ground motion {name}",
        question=f"This report gives the strength, the duration and the response spectrum of the "
        f"ground motion {name}{compared}. {description}",
        answer=_answer(summary),
        inputs={"origin": Table("The motion", [Quantity("What"), Quantity("Value")], origin)},
        tables={"measures": measures_table(summary), **_spectrum(saved)},
        figures=_figures(saved),
        checks=_checks(standard),
        validity_unknown="A ground motion has no calibration range.",
        assumptions=[
            f"Response spectra are those of linear oscillators with a damping of "
            f"{100.0 * float(summary['damping']):g} %, solved exactly between samples.",
            *([ROTATED] if summary.get("across") else []),
        ],
        warnings=[tidy(text) for text in saved.warnings],
        identity=identity_rows(
            str(summary.get("version", "unknown")),
            read_text(saved.path / MOTION),
            str(summary.get("command_line") or "thermobearing.motions in Python"),
            MOTION,
        ),
    )


def _answer(summary: Mapping[str, Any]) -> list[str]:
    """Return sentences on peaks, duration and the fit to the standard spectrum."""
    sentences = [
        f"The peak acceleration is {summary['pga_gal']:.0f} gal, the peak velocity "
        f"{summary['pgv_cm_s']:.1f} cm/s and the peak displacement {summary['pgd_cm']:.1f} cm.",
        f"Of its {summary['duration_s']:.1f} s, {summary['significant_duration_s']:.1f} s hold 5 "
        f"to 95 % of the Arias intensity of {summary['arias_intensity_m_s']:.2f} m/s.",
    ]
    standard = summary.get("standard_spectrum")
    if standard and standard["misfit_rms"] is not None:
        sentences.append(
            f"Its spectrum is {100.0 * standard['misfit_rms']:.1f} % rms different from "
            f"{reference_words(standard)}, over 0.1 to 3 s."
        )
    elif not standard:
        sentences.append("It was not compared with another spectrum.")
    if across := summary.get("across"):
        first, second = summary["records"]
        sentences.insert(
            0,
            f"The motion is a pair of two horizontal components, {first} and {second}; the numbers "
            f"below are those of {first}. The peak acceleration of {second} is "
            f"{across['pga_gal']:.0f} gal.",
        )
    if summary["outcome"] != "completed":
        sentences.insert(0, f"The motion does not fit its spectrum ({summary['outcome']}).")
    return sentences


def _spectrum(saved: SavedResult) -> dict[str, Table]:
    """Return the spectrum at periods that one quotes, where the result has it."""
    if "spectrum" not in saved.tables:
        return {}
    table = saved["spectrum"].astype(float)
    periods = table["period_s"].to_numpy()
    # 1.0001: the last period of the file is rounded.
    chosen = [t for t in PERIODS if periods[0] <= t <= periods[-1] * 1.0001]
    names = [name for name in dict.fromkeys(SPECTRA + PAIR_SPECTRA) if name in table]
    frame = pd.DataFrame({name: np.interp(chosen, periods, table[name]) for name in names})
    return {"spectrum": spectrum_table(frame.assign(period_s=chosen), saved.summary["damping"])}


def _figures(saved: SavedResult) -> dict[str, ReportFigure]:
    """Return drawn figures, with the acceleration and the spectrum as plots."""
    figures = saved_figures(saved, "motions")
    if "motion" in saved.tables:
        table = saved["motion"].astype(float)
        time = table["t_s"].to_numpy()
        names = saved.summary.get("records") or [str(saved.summary["motion"])]
        traces = [
            Trace(name, time, table[column].to_numpy(), colour)
            for name, column, colour in zip(names, *RECORDS, strict=False)
        ]
        plot = Plot("time [s]", "acceleration [gal]", {"all": traces})
        figures = with_plot(figures, "motion", plot, "motions")
    if "spectrum" in saved.tables:
        table = saved["spectrum"].astype(float)
        x = table["period_s"].to_numpy()
        first, second = saved.summary.get("records") or ("motion", "")
        traces = [
            Trace(words, x, table[name].to_numpy(), colour, look)
            for name, words, colour, look in (
                ("acceleration_gal", first, "#0077BB", "line"),
                ("across_acceleration_gal", second, "#009988", "line"),
                ("rotd50_gal", "RotD50", "#1a1a1a", "line"),
                ("rotd100_gal", "RotD100", "#1a1a1a", "dashed"),
                ("standard_gal", "standard", "#CC3311", "dashed"),
                ("target_gal", "target", "#CC3311", "dashed"),
            )
            if name in table
        ]
        plot = Plot("period [s]", "response acceleration [gal]", {"all": traces})
        figures = with_plot(figures, "spectrum", plot, "motions")
    return figures


def _checks(standard: Mapping[str, Any] | None) -> list[Check]:
    """Return the misfit to the standard spectrum, of a motion that was made for it."""
    if not standard or standard["misfit_rms"] is None:
        return []
    misfit, limit = 100.0 * float(standard["misfit_rms"]), 100.0 * LARGEST_MISFIT
    name = "misfit to the standard spectrum, rms over 0.1 to 3 s"
    source = "limit of generated motions"
    return [Check(name, misfit, limit, "%", source, PASSED if misfit <= limit else EXCEEDED)]
