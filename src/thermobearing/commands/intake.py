"""Import the files of a laboratory and measure their cycles."""

import dataclasses
import re
from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import InputError, printable
from thermobearing.commands.common import LABORATORY, Answer, Printed, app, echo_written
from thermobearing.commands.options import command, option


@command(
    app,
    "intake",
    examples="intake cold.xlsx warm.csv --bearing mine.toml -o imported\n"
    "intake --template test.xlsx --bearing mine.toml",
    panel=LABORATORY,
)
def _intake(
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="Tables of samples (CSV, text, .xlsx), or TOML sidecars."),
    ],
    bearing: Annotated[
        str | None,
        option(
            help="Bearing (name or file) whose plan area and rubber thickness are used to check "
            "strains and stresses.",
            metavar="NAME/FILE",
        ),
    ],
    write_sidecars: Annotated[
        bool,
        option(
            "--write-sidecars",
            help="Also write each sidecar next to its data file; existing ones are never replaced.",
        ),
    ],
    template: Annotated[
        Path | None,
        option(
            "--template",
            help="Write an Excel workbook for a laboratory to fill in, and import nothing.",
            metavar="FILE.xlsx",
        ),
    ],
    end: Printed,
) -> Answer:
    """Import laboratory files: detect columns, units, blocks, pauses, spikes and drift.

    For each file a figure and a TOML sidecar are written. Correct the sidecar where necessary;
    identify, validate, measure and recorded steps of cyclic cases read it. Unreadable files are
    reported and skipped (exit status 2).
    """
    from thermobearing.intake.run import inspect_files, write_template

    if template is not None:
        if files:
            raise InputError("give files to import, or --template, not both")
        write_template(template, bearing, overwrite=end.overwrite)
        if not end.quiet:
            echo_written(template)
        return {"outcome": "completed", "exit_status": 0, "output": str(template)}
    if not files:
        raise InputError("give one or more files, or --template FILE.xlsx")
    stem = re.sub(r"[^\w.+-]+", "-", files[0].stem)[:80] or "file"
    target = end.target(f"intake-{stem}")
    result = inspect_files(files, bearing)
    return end.save(
        result, target, sentence="\n".join(result.problems), write_sidecars=write_sidecars
    )


@command(app, "measure", examples="measure test.csv --bearing shen-hdr-specimen", panel=LABORATORY)
def _measure(
    file: Annotated[
        Path,
        typer.Argument(help="Displacement and force: CSV, text or .xlsx file, or TOML sidecar."),
    ],
    bearing: Annotated[
        str,
        option(
            "--bearing",
            help="Bearing (name or file) that provides plan area and rubber thickness.",
            metavar="NAME/FILE",
        ),
    ],
    end: Printed,
) -> Answer:
    """Measure the equivalent modulus, the damping and the energy of each cycle of a test.

    Units are read from the titles of the columns or from the sidecar; docs/theory.md defines the
    measures. With `-o DIR` the table and a figure of the loops are written.
    """
    from thermobearing.bearing.library import load_bearing
    from thermobearing.cyclic.tables import measured_table
    from thermobearing.identify.records.measured import measure_cycles
    from thermobearing.results.screen import show_table

    end.check()
    specimen = load_bearing(bearing)
    measured = measure_cycles(file, specimen)
    last: Answer = {
        "cycles": [
            dataclasses.asdict(cycle) | {"ends": ends}
            for cycle, ends in zip(measured.measures, measured.ends, strict=True)
        ],
        "notes": measured.notes,
    }
    if end.output is not None:
        measured.save(end.output, overwrite=end.overwrite, figures=end.figures)
        last["output"] = str(end.output)
    if not end.quiet:
        show_table(measured_table(measured.measures, measured.ends, measured.strains))
        for note in measured.notes:
            typer.echo(printable(note))
        if end.output is not None:
            echo_written(end.output)
    return last
