"""Import the files of a laboratory and measure their cycles."""

import re
from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import (
    AsJson,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    echo_json,
    reported,
    written,
)


@reported
def intake(
    files: Annotated[
        list[Path],
        typer.Argument(help="Tables of samples (CSV, text, .xlsx), or TOML sidecars."),
    ],
    bearing: Annotated[
        str | None,
        typer.Option(
            help="Plan area [mm2] and rubber thickness [mm], for the plausibility of strains and "
            "stresses.",
            metavar="NAME/FILE",
        ),
    ] = None,
    beside: Annotated[
        bool,
        typer.Option("--beside", help="Put each sidecar beside its file too; never over one."),
    ] = False,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Look at laboratory files: columns, units, blocks, rests, spikes, drift, ambient [degC].

    Writes a picture and a TOML sidecar for each file, to be corrected and kept; identify,
    validate, measure and recorded steps of cyclic cases read it. A file that cannot be read is told
    and left out (exit status 2). For example:
    `thermobearing intake cold.xlsx warm.csv --bearing shen-hdr-specimen -o looked`
    """
    from thermobearing.intake.run import take_in
    from thermobearing.results.directory import check_target

    target = output or Path("intake-" + (re.sub(r"[^\w.+-]+", "-", files[0].stem)[:80] or "file"))
    check_target(target, overwrite=overwrite)
    found = take_in(files, bearing)
    found.save(target, overwrite=overwrite, figures=not no_figures, beside=beside)
    if not quiet:
        found.show()
    told = "\n".join(found.problems)
    return written(found.outcome, told, target, as_json=as_json, quiet=quiet)


@reported
def measure(
    file: Annotated[
        Path, typer.Argument(help="Displacement and force: CSV, text, .xlsx, or a TOML sidecar.")
    ],
    bearing: Annotated[
        str, typer.Option(help="Library name or TOML file: plan area and rubber thickness.")
    ],
    output: Output = None,
    overwrite: Overwrite = False,
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
    from thermobearing.cyclic.tables import measured_table
    from thermobearing.identify.records.measured import measured_cycles
    from thermobearing.results.directory import check_target
    from thermobearing.results.screen import show_table

    if output is not None:
        check_target(output, overwrite=overwrite)
    specimen = load_bearing(bearing)
    found = measured_cycles(file, specimen)
    if output is not None:
        found.save(output, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        rubber = specimen.total_rubber_thickness
        show_table(measured_table(found.measures, found.ends, rubber))
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
