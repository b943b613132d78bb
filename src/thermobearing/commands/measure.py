"""`thermobearing measure`: what each cycle of a measured history says."""

from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import AsJson, echo_json, reported


@reported
def measure(
    file: Annotated[
        Path, typer.Argument(help="Displacement and force: CSV, text, .xlsx, or a TOML sidecar.")
    ],
    bearing: Annotated[
        str, typer.Option(help="Library name or TOML file: plan area and rubber thickness.")
    ],
    as_json: AsJson = False,
) -> int:
    """Equivalent modulus, damping and energy of each cycle of a measured history.

    For example: `thermobearing measure test.csv --bearing shen-hdr-specimen`. Units come from the
    titles of the columns or from the sidecar; what each measure is stands in docs/theory.md.
    """
    import dataclasses

    from thermobearing.bearing.library import load_bearing
    from thermobearing.cyclic.screen import print_measures
    from thermobearing.identify.measured import measured_cycles

    specimen = load_bearing(bearing)
    found = measured_cycles(file, specimen)
    print_measures(found.measures, found.ends, specimen.total_rubber_thickness)
    for note in found.notes:
        typer.echo(printable(note))
    if as_json:
        cycles = [
            dataclasses.asdict(cycle) | {"ends": ends}
            for cycle, ends in zip(found.measures, found.ends, strict=True)
        ]
        echo_json({"cycles": cycles, "notes": found.notes})
    return 0
