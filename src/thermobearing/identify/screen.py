"""Tables of a fit, and findings about tests, on the terminal."""

from collections.abc import Sequence
from typing import Any

from thermobearing.border.errors import printable
from thermobearing.identify.checks import CheckReport
from thermobearing.identify.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.thermocouples import COLUMNS, thermocouple_cells
from thermobearing.results.screen import print_table, print_warnings

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
    >>> record = tb.identify.record_from_arrays(t, 0.0 * t, np.sin(t), 23.0)
    >>> print_checks([tb.identify.check_test(record)])
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
    >>> record = tb.identify.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
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
