"""`thermobearing validate`: bearings as they are, beside tests."""

import re
from pathlib import Path
from typing import Annotated

import typer

from thermobearing.commands.common import (
    NO_DOCUMENTS,
    AsJson,
    Documents,
    Force,
    Limit,
    NoFigures,
    Output,
    Quiet,
    announce_compiling,
    limit_numbers,
    reported,
    written,
)


@reported
def validate(
    bearing: Annotated[str, typer.Argument(help="Bearing: a name or a TOML file.")],
    tests: Annotated[list[Path], typer.Argument(help="Tests: CSV files or their TOML sidecars.")],
    beside: Annotated[
        list[str] | None,
        typer.Option(help="Another bearing beside it; may be repeated.", metavar="NAME/FILE"),
    ] = None,
    model: Annotated[
        list[str] | None,
        typer.Option(help="multi-layer (default) or an earlier model; may be repeated."),
    ] = None,
    limit: Limit = None,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Judge a bearing by tests it was not fitted to; nothing is fitted."""
    from thermobearing.results.directory import check_target
    from thermobearing.validate.case import make_validate_case
    from thermobearing.validate.run import run_validate
    from thermobearing.validate.screen import print_validation

    case = make_validate_case(
        [bearing, *(beside or [])],
        tests,
        models=model or ["multi-layer"],  # type: ignore[arg-type]
        limits=limit_numbers(limit),
    )
    target = output or Path("validate-" + re.sub(r"[^\w.+-]+", "-", case.bearings[0].name))
    check_target(target, force=force)
    announce_compiling(quiet)
    found = run_validate(case)
    found.save(target, force=force, figures=not no_figures)
    if not quiet:
        print_validation(found)
    return written(found.outcome, found.sentence, target, documents, as_json=as_json, quiet=quiet)
