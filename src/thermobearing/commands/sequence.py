"""`thermobearing sequence`: tests one after the other on one specimen."""

import contextlib
from pathlib import Path
from typing import Annotated

import typer

from thermobearing.commands.common import (
    NO_DOCUMENTS,
    AsJson,
    Documents,
    Force,
    NoFigures,
    Output,
    Quiet,
    RigName,
    reported,
    with_progress,
    written,
)


@reported
def sequence(
    case: Annotated[Path, typer.Argument(help="Case file, see docs/files.md.")],
    bearing: Annotated[
        str | None, typer.Option(help="Library name or TOML file.", metavar="NAME/FILE")
    ] = None,
    ambient: Annotated[float | None, typer.Option(help="Ambient temperature [degC].")] = None,
    rig: RigName = None,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Hybrid and cyclic tests and rests, one after the other on one specimen."""
    from thermobearing.results.directory import check_target
    from thermobearing.sequences.case import load_sequence_case
    from thermobearing.sequences.run import run_sequence
    from thermobearing.sequences.screen import print_sequence

    complete = load_sequence_case(case, bearing=bearing, ambient=ambient, rig=rig)
    target = output or Path(f"sequence-{case.stem}")
    check_target(target, force=force)
    result = with_progress(lambda show: run_sequence(complete, progress=show), "parts", quiet)
    result.save(target, force=force, figures=not no_figures)
    if not quiet:
        with contextlib.suppress(KeyboardInterrupt):  # the result is safe by now
            print_sequence(result)
    return written(result.outcome, result.sentence, target, documents, as_json=as_json, quiet=quiet)
