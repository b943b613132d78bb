"""Directory and console tables of a calibration."""

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

import thermobearing
from thermobearing.bearing.library import bearing_from_table
from thermobearing.bearing.model import TemperatureLaw
from thermobearing.bearing.scaling import compound_of
from thermobearing.border.errors import printable
from thermobearing.border.toml import sourced_toml, to_table, with_sources
from thermobearing.identify.fit.parameters import M_T, N_T
from thermobearing.identify.records.checks import CheckReport, checks_summary
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.thermocouples import COLUMNS, thermocouple_cells
from thermobearing.identify.result import Identification
from thermobearing.identify.uncertainty.covariance import Estimate
from thermobearing.identify.uncertainty.posterior import Forecast, Samples
from thermobearing.results.directory import (
    COMPOUND,
    FIGURES,
    FIT_TABLE,
    IDENTIFIED,
    SAMPLES,
    THERMOCOUPLES,
    write_directory,
)
from thermobearing.results.directory import VALIDATED_CYCLES as CYCLES
from thermobearing.results.screen import print_table, print_warnings
from thermobearing.results.writing import without_formulas, write_csv, write_summary


def save_checks(
    reports: list[CheckReport], directory: Path, *, overwrite: bool = False, figures: bool = True
) -> Path:
    """Write summary.json and a figure per record.

    Parameters
    ----------
    reports : from `check_test`, one per record.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.
    figures : draw the figures too.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.

    Examples
    --------
    >>> import tempfile
    >>> import thermobearing as tb
    >>> t = np.linspace(0.0, 10.0, 500)
    >>> report = tb.check_test(tb.record_from_arrays(t, 0.0 * t, np.sin(t), 23.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = save_checks([report], Path(folder) / "check", figures=False)
    ...     print([path.name for path in written.iterdir()])
    ['summary.json']
    """

    def fill(folder: Path) -> None:
        write_summary(folder, checks_summary(reports))
        if figures:
            _draw_checks(reports, folder / FIGURES)

    return write_directory(directory, fill, overwrite=overwrite)


def _draw_checks(reports: list[CheckReport], folder: Path) -> None:
    from thermobearing.identify.figures import check_figure
    from thermobearing.results.drawing import save_figures

    figures = {}
    for number, report in enumerate(reports, start=1):
        name = re.sub(r"[^\w.+-]+", "-", report.record.name)
        figures[f"check_{number}_{name}"] = partial(check_figure, report)
    save_figures(figures, folder)


def save_identification(
    found: Identification,
    directory: Path,
    *,
    overwrite: bool = False,
    figures: bool = True,
    forecast: Forecast | None = None,
) -> Path:
    """Write summary.json, bearing.toml, compound.toml, fit.csv, cycles.csv, thermocouples.csv,
    posterior.csv and figures.

    Parameters
    ----------
    found : what to write.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.
    figures : draw the figures too.
    forecast : samples of the posterior and bands at other temperatures, from `forecast`.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.

    Examples
    --------
    >>> import tempfile
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = save_identification(found, Path(folder) / "fit", figures=False)
    ...     print(sorted(path.name for path in written.iterdir()))
    ['bearing.toml', 'compound.toml', 'cycles.csv', 'fit.csv', 'summary.json']
    """

    def fill(folder: Path) -> None:
        fill_identification(folder, found, found.summary(), forecast, figures=figures)

    return write_directory(directory, fill, overwrite=overwrite)


def fill_identification(
    folder: Path,
    found: Identification,
    summary: dict[str, Any],
    forecast: Forecast | None,
    *,
    figures: bool,
) -> None:
    """Write the files of a fit into a folder; `summary` may tell more than the fit's own."""
    if forecast is not None:
        summary = summary | {"posterior": forecast.summary()}
        text = _samples_text(found, forecast.samples)
        (folder / SAMPLES).write_text(text, encoding="utf-8")
    write_summary(folder, summary)
    text = tomli_w.dumps(bearing_table(found))
    (folder / IDENTIFIED).write_text(text, encoding="utf-8")
    if found.outcome != "poor_fit":  # nobody should make bearings of it
        (folder / COMPOUND).write_text(_compound_text(found), encoding="utf-8")
    (folder / FIT_TABLE).write_text(_fit_text(found), encoding="utf-8")
    if len(found.cycles):
        write_csv(folder / CYCLES, found.cycles)
    rows = found.thermocouples
    if rows:
        without_formulas(pd.DataFrame(rows)).to_csv(folder / THERMOCOUPLES, index=False)
    if figures:
        found.plot.save_all(folder / FIGURES, bands=forecast.bands if forecast else ())


def bearing_table(found: Identification) -> dict[str, Any]:
    """The fitted bearing as a library file: every number with where it comes from.

    Parameters
    ----------
    found : from `identify_bearing`.

    Returns
    -------
    dict : nested tables, numbers as text with their units; as TOML it is ready for
        `load_bearing`.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> bearing_table(found)["hysteresis"]["layer_stiffness"]["source"].split(";")[0]
    'identified from synthetic at 23 degC'
    """
    sources = _sources(found)
    fitted = "; ".join(f"{fit.record.name}: R2 = {fit.R2:.4f}" for fit in found.fits)
    named = {
        "name": f"{found.bearing.name}-identified",
        "description": f"{found.bearing.description} (identified from tests)".strip(),
        "citation": f"thermobearing {thermobearing.__version__} identify, {found.method}; {fitted}",
    }
    if found.outcome == "poor_fit":
        named["poor_fit"] = "; ".join(found.poor)
    law, tested = _range_of_law(found), found.tested_range
    sources |= {f"tested_range.{name}": _tested_source(found, name) for name in tested.ranges()}
    if law is not found.bearing.temperature_law:
        keys = ("temperature_law.coldest", "temperature_law.warmest")
        sources |= dict.fromkeys(keys, "air of the tests; the rubber itself was warmer")
    table = to_table(
        found.bearing.model_copy(update=named | {"temperature_law": law, "tested_range": tested})
    )
    return with_sources(table, sources)


def _compound_text(found: Identification) -> str:
    """The rubber and lead of the fitted specimen, its size divided out, as a library file.

    Parameters
    ----------
    found : from `identify_bearing`.

    Returns
    -------
    str : TOML, ready for `load_compound` and `thermobearing new --compound`.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> _compound_text(found).splitlines()[1]
    'name = "shen-hdr-specimen-compound"'
    """
    fitted = bearing_from_table(bearing_table(found), "fit")
    compound = compound_of(fitted, f"{found.bearing.name}-compound")
    return sourced_toml(compound, compound.sources)


def _tested_source(found: Identification, name: str) -> str:
    """Where an end of the tested range comes from."""
    tests = ", ".join(record.name for record in found.records)
    return f"the fitted model in {tests}" if name == "lead_temperature" else f"tests {tests}"


def _range_of_law(found: Identification) -> TemperatureLaw | None:
    """Where the fitted temperature law is known: the air of the tests, where m_T or n_T were free.

    Tests at one temperature fix none; the rubber was warmer, but no test says how much.
    """
    law = found.bearing.temperature_law
    if not {M_T, N_T} & set(found.uncertainty.estimates):
        return law
    ambients = [record.ambient for record in found.records]
    low, high = min(ambients), max(ambients)
    known = {"coldest": low, "warmest": high} if high > low else {"coldest": None, "warmest": None}
    if law is None or law.temperatures is None:
        return TemperatureLaw(**known) if high > low else None
    return law.model_copy(update=known)


def _sources(found: Identification) -> dict[str, str]:
    """Where each number of the fitted bearing comes from, by dotted key."""
    estimates = found.uncertainty.estimates
    tests = ", ".join(record.name for record in found.records)
    sources = found.bearing.sources
    for key, item in estimates.items():
        sources[key] = f"identified from {tests}; {_error_share(item)}"
    for p in found.pset.parameters:
        if p.tie is not None:
            sources[p.kind.key] = f"tied to {p.tie[1]:g} x {p.tie[0]}"
        elif p.kind.key not in estimates:
            sources.setdefault(p.kind.key, "held at the value of the starting bearing")
    return sources


def _error_share(item: Estimate) -> str:
    """Standard error of a parameter of the specimen, with the part of it that has no size."""
    if not item.determined:
        return f"not determined, {item.where}"
    said = f"standard error {item.stderr:.2g} {item.parameter.kind.unit}".rstrip()
    return f"{said} ({abs(item.stderr / item.value):.1%})" if item.value else said


def _fit_text(found: Identification) -> str:
    """CSV of tests and model, sample by sample.

    Parameters
    ----------
    found : from `identify_bearing`.

    Returns
    -------
    str : one row per sample: record, time [s], displacement [mm], force and model force [kN], and
        each thermocouple with the model at its place [degC].

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> _fit_text(found).splitlines()[0]
    'record,time_s,displacement_mm,force_kN,model_force_kN'
    """
    frames = []
    for number, (record, prediction) in enumerate(
        zip(found.records, found.predictions, strict=True)
    ):
        columns: dict[str, Any] = {
            "record": np.full(len(record.time), number),
            "time_s": record.time,
            "displacement_mm": record.displacement,
            "force_kN": record.force,
            "model_force_kN": prediction.force,
        }
        for title, values in record.temperatures.items():
            columns[title] = values
            columns[f"model_{title}"] = prediction.temperatures[title]
        frames.append(pd.DataFrame(columns))
    table = without_formulas(pd.concat(frames))
    return str(table.to_csv(index=False, float_format="%.9g", lineterminator="\n"))


def _samples_text(found: Identification, samples: Samples) -> str:
    """CSV of draws, a column for each free parameter, then those tied to them."""
    tied = [p for p in found.pset.parameters if p.tie is not None]
    kinds = [p.kind for p in (*found.pset.free, *tied)]
    lines = [",".join(kind.symbol for kind in kinds)]
    for row in samples.cube:
        values = found.pset.values(row)
        lines.append(",".join(f"{values[kind.key]:.6g}" for kind in kinds))
    return "\n".join(lines) + "\n"


MARKS = {"refused": "REFUSED", "warning": "warning", "note": "note"}
HEADS = ("parameter", "unit", "value", "standard error", "95 % interval")
MEASURES = ("record", "degC", "R²", "NRMSE", "G_e", "h_eq", "energy", "peak force")
ERRORS = ("G_eq_error", "h_eq_error", "energy_error", "force_max_error")


def print_checks(reports: list[CheckReport]) -> None:
    """What was found in each record, a line for each finding.

    Parameters
    ----------
    reports : from `check_test`, one per record.

    Examples
    --------
    >>> import numpy as np
    >>> import thermobearing as tb
    >>> t = np.linspace(0.0, 10.0, 500)
    >>> record = tb.record_from_arrays(t, 0.0 * t, np.sin(t), 23.0)
    >>> print_checks([tb.check_test(record)])
    test: refused
      REFUSED  displacement: displacement is constant at 0 mm
    """
    for report in reports:
        print(f"{report.record.name}: {report.outcome}")
        for finding in report.findings:
            print(f"  {MARKS[finding.level]:8} {finding.check}: {finding.sentence}")


def print_identification(found: Identification, more: Sequence[str] = ()) -> None:
    """Parameters, measures of each record, warnings.

    Parameters
    ----------
    found : from `identify_bearing`.
    more : further warnings, of a prediction.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> import contextlib, io
    >>> with contextlib.redirect_stdout(io.StringIO()) as shown:
    ...     print_identification(found)
    >>> "K_r" in shown.getvalue()
    True
    """
    _print_parameters(found)
    _print_measures(found)
    print_thermocouples(found.thermocouples, "thermocouples, model beside test")
    print_unused(found.records)
    print_warnings([*found.warnings, *more])


def print_unused(records: list[TestRecord]) -> None:
    """Columns of each test that nothing was made of.

    Parameters
    ----------
    records : tests; each is named once.
    """
    for name, unused in dict.fromkeys((record.name, record.unused) for record in records):
        if unused:
            print(printable(f"{name}: columns not used: {', '.join(unused)}"))


def print_thermocouples(rows: list[dict[str, Any]], title: str) -> None:
    """A table of thermocouples, if there are any.

    Parameters
    ----------
    rows : from `thermocouple_rows`, with the name of the test.
    title : of the table.
    """
    if rows:
        cells = [(str(row["test"]), *thermocouple_cells(row)) for row in rows]
        print_table(("test", *COLUMNS.values()), cells, title=title, keys=3)


def _print_parameters(found: Identification) -> None:
    rows = []
    for item in found.uncertainty.estimates.values():
        error = f"{item.stderr:.2g}" if item.determined else item.where
        interval = f"{item.lower:.4g} to {item.upper:.4g}"
        kind = item.parameter.kind
        rows.append((kind.symbol, kind.unit, f"{item.value:.4g}", error, interval))
    print_table(HEADS, rows, title=f"{found.bearing.name}: {found.method}", keys=2)


def _print_measures(found: Identification) -> None:
    rows = []
    for fit in found.fits:
        ambient = f"{round(fit.record.ambient, 2):g}"
        cells = [fit.record.name, ambient, f"{fit.R2:.4f}", f"{fit.NRMSE:.2%}"]
        for name in ERRORS:
            values = [100.0 * getattr(cycle, name) for cycle in fit.cycles]
            cells.append(f"{min(values):+.1f} to {max(values):+.1f} %")
        rows.append(cells)
    title = "model against test, errors over the cycles"
    print_table(MEASURES, rows, title=title, keys=2)
