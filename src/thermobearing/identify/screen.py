"""Tables of a fit, and findings about tests, on the terminal."""

from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from thermobearing.border.errors import printable
from thermobearing.identify.checks import CheckReport
from thermobearing.identify.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.thermocouples import COLUMNS, thermocouple_cells
from thermobearing.results.screen import print_warnings

MARKS = {"refused": "REFUSED", "warning": "warning", "note": "note"}
HEADS = ("parameter", "value", "standard error", "95 % interval", "unit")
MEASURES = ("record", "ambient", "R²", "NRMSE", "G_e", "h_eq", "energy", "peak force")
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
    console = Console()
    console.print(_parameters(found))
    console.print(_measures(found))
    print_thermocouples(console, found.thermocouples, "thermocouples, model beside test")
    print_unused(found.records)
    print_warnings(console, [*found.warnings, *more])


def print_unused(records: list[TestRecord]) -> None:
    """Columns of each test that nothing was made of.

    Parameters
    ----------
    records : tests; each is named once.
    """
    for name, unused in dict.fromkeys((record.name, record.unused) for record in records):
        if unused:
            print(printable(f"{name}: columns not used: {', '.join(unused)}"))


def print_thermocouples(console: Console, rows: list[dict[str, Any]], title: str) -> None:
    """A table of thermocouples, if there are any.

    Parameters
    ----------
    console : to print on.
    rows : from `thermocouple_rows`, with the name of the test.
    title : of the table.
    """
    if not rows:
        return
    table = Table(title=escape(title), title_justify="left", box=None, pad_edge=False)
    for head in ("test", *COLUMNS.values()):
        left = head in ("test", "thermocouple", "place")
        table.add_column(head, justify="left" if left else "right")
    for row in rows:
        table.add_row(escape(str(row["test"])), *map(escape, thermocouple_cells(row)))
    console.print(table)


def _parameters(found: Identification) -> Table:
    name = escape(found.bearing.name)
    table = Table(title=f"{name}: {found.method}, {found.seconds:.1f} s")
    for head in HEADS:
        table.add_column(head, justify="left" if head in ("parameter", "unit") else "right")
    for item in found.uncertainty.estimates.values():
        error = "at its bound" if item.at_bound else f"{item.stderr:.2g}"
        interval = f"{item.lower:.4g} to {item.upper:.4g}"
        kind = item.parameter.kind
        table.add_row(kind.symbol, f"{item.value:.4g}", error, interval, kind.unit)
    return table


def _measures(found: Identification) -> Table:
    table = Table(title="model against test, errors over the cycles")
    for head in MEASURES:
        table.add_column(head, justify="left" if head == "record" else "right")
    for fit in found.fits:
        name, ambient = escape(fit.record.name), f"{fit.record.ambient:g} °C"
        cells = [name, ambient, f"{fit.R2:.4f}", f"{fit.NRMSE:.2%}"]
        for name in ERRORS:
            values = [100.0 * getattr(cycle, name) for cycle in fit.cycles]
            cells.append(f"{min(values):+.1f} to {max(values):+.1f} %")
        table.add_row(*cells)
    return table
