"""Run all benchmarks, print one table, and write it as JSON if requested."""

import argparse
import json
import time
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks.machine import machine
from benchmarks.rows import Row, failed

ITEMS = {
    "operations": "Operations",
    "releases": "Releases",
    "coupled_step": "Speed",
    "whole_test": "Speed",
    "scalar_c": "Speed",
    "numpy_stepper": "Speed",
    "opensees": "Speed",
    "structure": "Speed",
    "axial_forces": "Speed",
    "whole_bridge": "Speed",
    "study": "Studies",
    "lockstep": "Speed",
    "bearing_lines": "Waiting",
    "startup": "Waiting",
    "first_run": "Waiting",
    "live_page": "Waiting",
    "integrator": "Accuracy",
    "step_halving": "Accuracy",
    "softening": "Accuracy",
    "finite_elements": "One dimension",
    "energy": "Energy balance",
    "memory": "Memory",
    "identification": "Identification",
    "coverage": "Coverage",
}
MARKS = {True: "[green]yes[/]", False: "[bold red]NO[/]", None: ""}


def measured(item: str, **options: int) -> list[Row]:
    """Return the rows of one benchmark; one that fails becomes a row with its error."""
    try:
        rows: list[Row] = import_module(f"benchmarks.{item}").rows(**options)
    except Exception as error:
        return [failed(item, f"{type(error).__name__}: {error}", target="runs")]
    return rows


def table(result: dict[str, list[Row]], about: dict[str, str]) -> Table:
    """Return a table with one section for each benchmark."""
    caption = ", ".join(f"{key} {value}" for key, value in about.items())
    out = Table(title="thermobearing: measured values and targets", caption=caption)
    for head in ("", "what", "measured", "target", "met", "note"):
        out.add_column(head, justify="right" if head in ("measured", "target") else "left")
    for item, rows in result.items():
        for row in rows:
            out.add_row(ITEMS[item], row.what, row.measured, row.target, MARKS[row.met], row.note)
        out.add_section()
    return out


def main() -> None:
    """Run the benchmarks; the status is 0 even if targets are not met."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the same as JSON")
    parser.add_argument("--only", metavar="ITEM", nargs="+", choices=ITEMS, default=list(ITEMS))
    parser.add_argument("--fits", metavar="N", type=int, help="of each cell of `coverage`; 60")
    options = parser.parse_args()
    begin, console = time.perf_counter(), Console(width=170)
    measured_rows: dict[str, list[Row]] = {}
    about = machine()
    for item in options.only:
        console.print(f"measuring {item} ...", style="dim")
        fits = {"fits": options.fits} if item == "coverage" and options.fits else {}
        measured_rows[item] = measured(item, **fits)
        if options.json:  # now, for benchmarks that are interrupted
            listed = {name: [asdict(row) for row in rows] for name, rows in measured_rows.items()}
            report = {"machine": about, "rows": listed, "seconds": time.perf_counter() - begin}
            options.json.write_text(json.dumps(report, indent=1) + "\n")
    console.print(table(measured_rows, about))
    judged = [row.met for rows in measured_rows.values() for row in rows if row.met is not None]
    elapsed = time.perf_counter() - begin
    console.print(f"{sum(judged)} of {len(judged)} targets met; {elapsed:.0f} s")


if __name__ == "__main__":
    main()
