"""Import the files of a laboratory and measure their cycles."""

import dataclasses
import re
from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import LABORATORY, Answer, Printed, app, echo_written
from thermobearing.commands.options import command, option


@command(
    app,
    "intake",
    examples="intake cold.xlsx warm.csv --bearing mine.toml -o looked",
    panel=LABORATORY,
)
def _intake(
    files: Annotated[
        list[Path],
        typer.Argument(help="Tables of samples (CSV, text, .xlsx), or TOML sidecars."),
    ],
    bearing: Annotated[
        str | None,
        option(
            help="Plan area [mm2] and rubber thickness [mm], for the plausibility of strains and "
            "stresses.",
            metavar="NAME/FILE",
        ),
    ],
    beside: Annotated[
        bool,
        option(
            "--beside",
            help="Also write each sidecar next to its file; existing ones are never replaced.",
        ),
    ],
    end: Printed,
) -> Answer:
    """Look at laboratory files: columns, units, blocks, rests, spikes, drift, ambient [degC].

    Writes a picture and a TOML sidecar for each file, to be corrected and kept; identify,
    validate, measure and recorded steps of cyclic cases read it. Unreadable files are reported
    and skipped (exit status 2). For example:
    `thermobearing intake cold.xlsx warm.csv --bearing shen-hdr-specimen -o looked`
    """
    from thermobearing.intake.run import take_in

    stem = re.sub(r"[^\w.+-]+", "-", files[0].stem)[:80] or "file"
    target = end.target(f"intake-{stem}")
    found = take_in(files, bearing)
    return end.save(found, target, sentence="\n".join(found.problems), beside=beside)


@command(app, "measure", examples="measure test.csv --bearing shen-hdr-specimen", panel=LABORATORY)
def _measure(
    file: Annotated[
        Path, typer.Argument(help="Displacement and force: CSV, text, .xlsx, or a TOML sidecar.")
    ],
    bearing: Annotated[
        str,
        option(
            "--bearing",
            help="Library name or TOML file: plan area and rubber thickness.",
            metavar="NAME/FILE",
        ),
    ],
    end: Printed,
) -> Answer:
    """Equivalent modulus, damping and energy of each cycle of a measured history.

    For example: `thermobearing measure test.csv --bearing shen-hdr-specimen`. Units come from the
    titles of the columns or from the sidecar; docs/theory.md defines the measures. With
    `-o DIR` the table and a picture of the loops are written.
    """
    from thermobearing.bearing.library import load_bearing
    from thermobearing.cyclic.tables import measured_table
    from thermobearing.identify.records.measured import measured_cycles
    from thermobearing.results.screen import show_table

    end.check()
    specimen = load_bearing(bearing)
    found = measured_cycles(file, specimen)
    last: Answer = {
        "cycles": [
            dataclasses.asdict(cycle) | {"ends": ends}
            for cycle, ends in zip(found.measures, found.ends, strict=True)
        ],
        "notes": found.notes,
    }
    if end.output is not None:
        found.save(end.output, overwrite=end.overwrite, figures=not end.no_figures)
        last["output"] = str(end.output)
    if not end.quiet:
        show_table(measured_table(found.measures, found.ends, specimen.total_rubber_thickness))
        for note in found.notes:
            typer.echo(printable(note))
        if end.output is not None:
            echo_written(end.output)
    return last
