"""Tables of a fit, and findings about tests, on the terminal."""

from collections.abc import Sequence

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from thermobearing.identify.checks import CheckReport
from thermobearing.identify.result import Identification
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
    print_warnings(console, [*found.warnings, *more])


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
