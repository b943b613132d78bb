"""Run displacement-controlled tests and sequences of tests."""

from pathlib import Path
from typing import Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    ANALYSES,
    INPUT,
    MODEL,
    RESULT,
    TEST,
    Answer,
    Ending,
    app,
    megabytes,
    with_progress,
)
from thermobearing.commands.options import (
    EXPOSURE,
    MODEL_OPTIONS,
    command,
    exposure_table,
    fields,
    option,
)

WORTH_TELLING = 20e6  # size of a result that is announced before it is computed [bytes]
SHORT = "strain cycles wave path ratio speed frequency period rest"  # of a test in a few words


@command(
    app,
    "cyclic",
    fields(
        "cyclic.case:Case",
        "bearing ambient initial rig axial_force",
        INPUT,
        bearing="|Bearing: library name or TOML file.",
    ),
    fields("tables.conditioning:Conditioning", "conditioned before", INPUT),
    fields("cyclic.protocol:cyclic_test", SHORT, TEST),
    fields("cyclic.protocol:CyclicTest", "dt", TEST),
    fields("model.options:ModelOptions", "model state", MODEL),
    MODEL_OPTIONS,
    fields("cyclic.case:Analysis", "axial axial_factor", MODEL),
    fields("cyclic.case:Case", "compare", MODEL),
    fields("cyclic.case:Analysis", "keep_every", RESULT),
    examples="cyclic --bearing shen-lhdr-specimen --ambient -20 --ambient 23 -o my-run\n"
    "cyclic --strain 1.75 --wave sine --frequency 0.5 --cycles 11\n"
    "cyclic --strain 1.75 --path circle --frequency 0.5 --cycles 3",
    panel=ANALYSES,
    laws=True,
)
def _cyclic(
    case: Annotated[
        Path | None,
        typer.Argument(help="Case file; by default the test of Table 3.4 on the HDR specimen."),
    ],
    options: dict[str, Any],
    exposure: EXPOSURE,
    complete: Annotated[
        bool,
        option(
            "--complete-histories",
            help="Write every kept step, instead of turning points and 200 points per cycle.",
            panel=RESULT,
        ),
    ],
    table: Annotated[
        bool,
        option("--table", help="Print the measures of every cycle of a long test.", panel=RESULT),
    ],
    end: Ending,
) -> Answer:
    """Run a displacement-controlled cyclic test of a bearing."""
    from thermobearing.cyclic.case import load_case, make_case
    from thermobearing.cyclic.comparison import compare_models
    from thermobearing.cyclic.dataset import expected_size
    from thermobearing.cyclic.protocol import cyclic_test
    from thermobearing.cyclic.run import run_case

    words = {name: options.pop(name) for name in SHORT.split() if name in options}
    if words and "strain" not in words:
        raise InputError(f"--{next(iter(words))} requires --strain")
    if {"wave", "path"} <= set(words):
        raise InputError("--wave applies to cycles on a line, not to --path")
    options["test"] = cyclic_test(**words) if words else None
    options |= {"exposure": exposure_table(exposure), "histories": "complete" if complete else None}
    loaded = load_case(case, **options) if case else make_case({}, "command line", **options)
    target = end.target(f"cyclic-{loaded.bearing.name}")
    size = expected_size(loaded)
    if size > WORTH_TELLING and not end.quiet:
        typer.echo(f"histories: up to {megabytes(size)} before compression", err=True)
    result = with_progress(lambda show: run_case(loaded, progress=show), "stepping", end.quiet)
    if loaded.compare and result.outcome == "completed":
        if len(result.cycles) == 0:
            raise InputError("--compare needs a test with cycles")
        result.compared = compare_models(loaded)
    return end.save(result, target, show=None if table else result.show_briefly)


@command(
    app,
    "sequence",
    fields("sequences.case:SequenceCase", "bearing ambient rig"),
    examples="sequence case.toml -o sequence",
    panel=ANALYSES,
    laws=True,
)
def _sequence(
    case: Annotated[Path, typer.Argument(help="Case file with the parts of the sequence.")],
    options: dict[str, Any],
    end: Ending,
) -> Answer:
    """Run hybrid tests, cyclic tests and rests in sequence on one specimen."""
    from thermobearing.sequences.case import load_sequence_case
    from thermobearing.sequences.run import run_sequence

    complete = load_sequence_case(case, **options)
    target = end.target(f"sequence-{case.stem}")
    result = with_progress(lambda show: run_sequence(complete, progress=show), "parts", end.quiet)
    return end.save(result, target)
