"""`thermobearing intake`: what is in a laboratory's files, and the sidecars that say so."""

import re
from pathlib import Path
from typing import Annotated

import typer

from thermobearing.commands.common import AsJson, Force, NoFigures, Output, Quiet, reported, written


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
    force: Force = False,
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
    from thermobearing.intake.screen import print_intakes
    from thermobearing.results.directory import check_target

    target = output or Path("intake-" + (re.sub(r"[^\w.+-]+", "-", files[0].stem)[:80] or "file"))
    check_target(target, force=force)
    found = take_in(files, bearing)
    found.save(target, force=force, figures=not no_figures, beside=beside)
    if not quiet:
        print_intakes(found)
    told = "\n".join(found.problems)
    return written(found.outcome, told, target, as_json=as_json, quiet=quiet)
