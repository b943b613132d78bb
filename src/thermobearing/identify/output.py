"""Files of a calibration and of checked tests."""

import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
import tomli_w

import thermobearing
from thermobearing.bearing.library import bearing_from_table
from thermobearing.bearing.model import TemperatureLaw
from thermobearing.bearing.scaling import compound_of
from thermobearing.border.toml import sourced_toml, to_table, with_sources
from thermobearing.identify.fit.parameters import M_T, N_T
from thermobearing.identify.records.checks import CheckReport, checks_summary
from thermobearing.results.directory import (
    COMPOUND,
    FIGURES,
    FIT_TABLE,
    IDENTIFIED,
    SAMPLES,
    THERMOCOUPLES,
    VALIDATED_CYCLES,
    write_directory,
)
from thermobearing.results.writing import without_formulas, write_csv, write_summary

if TYPE_CHECKING:
    from thermobearing.identify.result import Identification

MARKS = {"refused": "REFUSED", "warning": "warning", "note": "note"}


def print_checks(reports: list[CheckReport]) -> None:
    """Print the outcome of each record, and a line for each finding."""
    for report in reports:
        print(f"{report.record.name}: {report.outcome}")
        for finding in report.findings:
            print(f"  {MARKS[finding.level]:8} {finding.check}: {finding.sentence}")


def save_checks(
    reports: list[CheckReport], directory: Path, *, overwrite: bool = False, figures: bool = True
) -> Path:
    """Write summary.json and a figure per record; return the directory."""

    def _fill(folder: Path) -> None:
        write_summary(folder, checks_summary(reports))
        if not figures:
            return
        from thermobearing.identify.figures import check_figure
        from thermobearing.results.drawing import save_figures

        names = [re.sub(r"[^\w.+-]+", "-", report.record.name) for report in reports]
        drawn = {
            f"check_{number}_{name}": partial(check_figure, report)
            for number, (name, report) in enumerate(zip(names, reports, strict=True), start=1)
        }
        save_figures(drawn, folder / FIGURES)

    return write_directory(directory, _fill, overwrite=overwrite)


def write_identification(found: "Identification", folder: Path) -> None:
    """Write the files of a fit but summary.json and figures."""
    if found.forecast is not None:
        tied = [p for p in found.pset.parameters if p.tie is not None]
        symbols = {p.kind.key: p.kind.symbol for p in (*found.pset.free, *tied)}
        rows = [found.pset.values(place) for place in found.forecast.samples.cube]
        samples = pd.DataFrame(rows)[list(symbols)].rename(columns=symbols)
        samples.to_csv(folder / SAMPLES, index=False, float_format="%.6g", lineterminator="\n")
    table = _bearing_table(found)
    (folder / IDENTIFIED).write_text(tomli_w.dumps(table), encoding="utf-8")
    if found.outcome != "poor_fit":  # nobody should make bearings of it
        compound = compound_of(bearing_from_table(table, "fit"), f"{found.bearing.name}-compound")
        text = sourced_toml(compound, compound.sources)
        (folder / COMPOUND).write_text(text, encoding="utf-8")
    fit = without_formulas(_fit_table(found))
    fit.to_csv(folder / FIT_TABLE, index=False, float_format="%.9g", lineterminator="\n")
    if len(found.cycles):
        write_csv(folder / VALIDATED_CYCLES, found.cycles)
    if rows := found.thermocouples:
        without_formulas(pd.DataFrame(rows)).to_csv(folder / THERMOCOUPLES, index=False)


def _bearing_table(found: "Identification") -> dict[str, Any]:
    """Return the fitted bearing as the table of a library file, each number with its source."""
    bearing, tested = found.bearing, found.bearing.tested_range
    tests = ", ".join(record.name for record in found.records)
    fitted = "; ".join(f"{fit.record.name}: R2 = {fit.R2:.4f}" for fit in found.fits)
    changes: dict[str, Any] = {
        "name": f"{bearing.name}-identified",
        "description": f"{bearing.description} (identified from tests)".strip(),
        "citation": f"thermobearing {thermobearing.__version__} identify, {found.method}; {fitted}",
        "temperature_law": _range_of_law(found),
    }
    if found.outcome == "poor_fit":
        changes["poor_fit"] = "; ".join(found.poor)
    sources = _sources(found, tests)
    for name in tested.ranges() if tested else ():
        sources[f"tested_range.{name}"] = (
            f"the fitted model in {tests}" if name == "lead_temperature" else f"tests {tests}"
        )
    if changes["temperature_law"] is not bearing.temperature_law:
        keys = ("temperature_law.coldest", "temperature_law.warmest")
        sources |= dict.fromkeys(keys, "air of the tests; the rubber itself was warmer")
    return with_sources(to_table(bearing.model_copy(update=changes)), sources)


def _range_of_law(found: "Identification") -> TemperatureLaw | None:
    """Return the temperature law with the air of the tests as its range, if m_T or n_T were free.

    Tests at one temperature fix no range; the rubber was warmer, but no test says how much.
    """
    law = found.bearing.temperature_law
    if not {M_T, N_T} & set(found.uncertainty.estimates):
        return law
    ambients = [record.ambient for record in found.records]
    low, high = (min(ambients), max(ambients)) if len(set(ambients)) > 1 else (None, None)
    if law is None or law.temperatures is None:
        return TemperatureLaw(coldest=low, warmest=high) if low is not None else None
    return law.model_copy(update={"coldest": low, "warmest": high})


def _sources(found: "Identification", tests: str) -> dict[str, str]:
    estimates, sources = found.uncertainty.estimates, found.bearing.sources
    for key, item in estimates.items():
        said = f"standard error {item.stderr:.2g} {item.parameter.kind.unit}".rstrip()
        said += f" ({abs(item.stderr / item.value):.1%})" if item.value else ""
        said = said if item.determined else f"not determined, {item.where}"
        sources[key] = f"identified from {tests}; {said}"
    for p in found.pset.parameters:
        if p.tie is not None:
            sources[p.kind.key] = f"tied to {p.tie[1]:g} x {p.tie[0]}"
        elif p.kind.key not in estimates:
            sources.setdefault(p.kind.key, "held at the value of the starting bearing")
    return sources


def _fit_table(found: "Identification") -> pd.DataFrame:
    """Return tests and model sample by sample: number of the record, s, mm, kN, degC."""
    frames = []
    for number, (record, prediction) in enumerate(
        zip(found.records, found.predictions, strict=True)
    ):
        columns: dict[str, Any] = {
            "record": number,
            "time_s": record.time,
            "displacement_mm": record.displacement,
            "force_kN": record.force,
            "model_force_kN": prediction.force,
        }
        for title, values in record.temperatures.items():
            columns[title] = values
            columns[f"model_{title}"] = prediction.temperatures[title]
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames)
