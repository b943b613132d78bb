"""`thermobearing measure`: what each cycle of a measured history says."""

from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import (
    AsJson,
    Force,
    NoFigures,
    Output,
    Quiet,
    echo_json,
    reported,
)


@reported
def measure(
    file: Annotated[
        Path, typer.Argument(help="Displacement and force: CSV, text, .xlsx, or a TOML sidecar.")
    ],
    bearing: Annotated[
        str, typer.Option(help="Library name or TOML file: plan area and rubber thickness.")
    ],
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Equivalent modulus, damping and energy of each cycle of a measured history.

    For example: `thermobearing measure test.csv --bearing shen-hdr-specimen`. Units come from the
    titles of the columns or from the sidecar; what each measure is stands in docs/theory.md. With
    `-o DIR` the table and a picture of the loops are written.
    """
    import dataclasses

    from thermobearing.bearing.library import load_bearing
    from thermobearing.cyclic.screen import print_measures
    from thermobearing.identify.measured import measured_cycles
    from thermobearing.results.directory import check_target

    if output is not None:
        check_target(output, force=force)
    specimen = load_bearing(bearing)
    found = measured_cycles(file, specimen)
    if output is not None:
        found.save(output, force=force, figures=not no_figures)
    if not quiet:
        print_measures(found.measures, found.ends, specimen.total_rubber_thickness)
        for note in found.notes:
            typer.echo(printable(note))
        if output is not None:
            typer.echo(f"written: {printable(str(output))}")
    if as_json:
        cycles = [
            dataclasses.asdict(cycle) | {"ends": ends}
            for cycle, ends in zip(found.measures, found.ends, strict=True)
        ]
        told = {"cycles": cycles, "notes": found.notes}
        echo_json(told if output is None else told | {"output": str(output)})
    return 0
