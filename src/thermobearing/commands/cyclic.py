"""Run displacement-controlled tests and sequences of tests."""

import contextlib
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    INPUT,
    MODEL,
    NO_DOCUMENTS,
    RESULT,
    TEST,
    AsJson,
    Compare,
    Documents,
    EarlierModel,
    Exposed,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    RigName,
    SmallLoops,
    exposure_given,
    megabytes,
    reported,
    with_progress,
    written,
)

if TYPE_CHECKING:
    from thermobearing.cyclic.case import Case
    from thermobearing.cyclic.protocol import CyclicTest
    from thermobearing.cyclic.result import Result

WORTH_TELLING = 20e6  # size of a result that is announced before it is computed [bytes]
CaseFile = Annotated[
    Path | None, typer.Argument(help="Case file; without one, Table 3.4 on the HDR specimen.")
]
Bearing = Annotated[
    str | None,
    typer.Option(help="Library name or TOML file.", metavar="NAME/FILE", rich_help_panel=INPUT),
]
Ambient = Annotated[
    list[float] | None,
    typer.Option(help="Ambient temperature [degC]; may be repeated.", rich_help_panel=INPUT),
]
Strain = Annotated[
    list[float] | None,
    typer.Option(help="Shear strain of the cycles; may be repeated.", rich_help_panel=TEST),
]
Cycles = Annotated[int | None, typer.Option(help="Cycles at each strain.", rich_help_panel=TEST)]
Wave = Annotated[str | None, typer.Option(help="triangular or sine.", rich_help_panel=TEST)]
Frequency = Annotated[float | None, typer.Option(help="Of the cycles [Hz].", rich_help_panel=TEST)]
Period = Annotated[float | None, typer.Option(help="Of the cycles [s].", rich_help_panel=TEST)]
Speed = Annotated[
    float | None, typer.Option(help="Mean speed of the cycles [mm/s].", rich_help_panel=TEST)
]
Pause = Annotated[
    float | None, typer.Option(help="Pause between strains [s].", rich_help_panel=TEST)
]
Step = Annotated[
    float | None, typer.Option(help="Largest time step in motion [s].", rich_help_panel=TEST)
]
Scheme = Annotated[
    str | None, typer.Option(help="conservative or published.", rich_help_panel=MODEL)
]
Integrator = Annotated[str | None, typer.Option(help="exact or euler.", rich_help_panel=MODEL)]
Hardening = Annotated[str | None, typer.Option(help="printed or monotone.", rich_help_panel=MODEL)]
HeatSource = Annotated[str | None, typer.Option(help="work or dissipation.", rich_help_panel=MODEL)]
LeadEnds = Annotated[
    str | None, typer.Option(help="finite-plate or half-space.", rich_help_panel=MODEL)
]
Clock = Annotated[
    str | None, typer.Option(help="Of a half-space: lead or steel.", rich_help_panel=MODEL)
]
KeepEvery = Annotated[
    int | None, typer.Option(help="Keep every n-th step.", rich_help_panel=RESULT)
]
CompleteHistories = Annotated[
    bool,
    typer.Option(
        "--complete-histories",
        help="Write every kept step, not turning points and 200 points a cycle.",
        rich_help_panel=RESULT,
    ),
]


@reported
def cyclic(
    case: CaseFile = None,
    bearing: Bearing = None,
    ambient: Ambient = None,
    strain: Strain = None,
    cycles: Cycles = None,
    wave: Wave = None,
    frequency: Frequency = None,
    period: Period = None,
    speed: Speed = None,
    rest: Pause = None,
    dt: Step = None,
    scheme: Scheme = None,
    integrator: Integrator = None,
    hardening: Hardening = None,
    small_loops: SmallLoops = None,
    heat_source: HeatSource = None,
    lead_ends: LeadEnds = None,
    clock: Clock = None,
    model: EarlierModel = None,
    exposure: Exposed = None,
    compare: Compare = False,
    keep_every: KeepEvery = None,
    complete: CompleteHistories = False,
    rig: RigName = None,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Displacement-controlled cyclic test of a bearing, heat and hysteresis coupled."""
    from thermobearing.cyclic.case import load_case, make_case

    words = {"cycles": cycles, "wave": wave, "frequency": frequency, "period": period}
    words |= {"speed": speed, "rest": rest}
    overrides = {
        "test": _short_test(strain, words),
        "histories": "complete" if complete else None,
        "bearing": bearing,
        "ambient": ambient or None,
        "dt": dt,
        "scheme": scheme,
        "integrator": integrator,
        "hardening": hardening,
        "small_loops": small_loops,
        "heat_source": heat_source,
        "lead_ends": lead_ends,
        "clock": clock,
        "model": model,
        "exposure": exposure_given(exposure),
        "keep_every": keep_every,
        "rig": rig,
    }
    if case is None:
        whole = make_case({}, "command line", **overrides)
    else:
        whole = load_case(case, **overrides)
    return _carry_out(whole, output, overwrite, no_figures, as_json, quiet, compare, documents)


def _carry_out(
    whole: "Case",
    output: Path | None,
    overwrite: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
    compare: bool,
    documents: Documents,
) -> int:
    """Check the target, run, write, tell."""
    from thermobearing.cyclic.run import run_case
    from thermobearing.results.directory import check_target

    target = output or Path("cyclic-" + re.sub(r"[^\w.+-]+", "-", whole.bearing.name))
    check_target(target, overwrite=overwrite)
    _announce_size(whole, quiet)
    result = with_progress(lambda show: run_case(whole, progress=show), "stepping", quiet)
    if compare and result.outcome == "completed":
        result.compared = _others(whole, result)
    result.save(target, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        with contextlib.suppress(KeyboardInterrupt):  # the result is safe by now
            result.show()
    return written(result.outcome, result.sentence, target, documents, as_json=as_json, quiet=quiet)


def _short_test(strain: list[float] | None, words: dict[str, Any]) -> "CyclicTest | None":
    """The test that options describe; None if they describe none."""
    from thermobearing.cyclic.protocol import cyclic_test

    given = {key: value for key, value in words.items() if value is not None}
    if not strain:
        if given:
            raise InputError(f"--{next(iter(given))} describes a test: give its --strain too")
        return None
    return cyclic_test(strain=strain, **given)


def _announce_size(case: "Case", quiet: bool) -> None:
    """Before a run: how large its result can get."""
    from thermobearing.cyclic.dataset import expected_size

    size = expected_size(case)
    if size > WORTH_TELLING and not quiet:
        typer.echo(f"histories: up to {megabytes(size)} before compression", err=True)


def _others(case: "Case", result: "Result") -> "dict[str, Result]":
    """The result and those of the earlier models, by name; InputError without cycles."""
    from thermobearing.cyclic.comparison import compare_models

    if len(result.cycles) == 0:
        raise InputError("--compare needs a test with cycles")
    return compare_models(case)


@reported
def sequence(
    case: Annotated[Path, typer.Argument(help="Case file, see docs/files.md.")],
    bearing: Annotated[
        str | None, typer.Option(help="Library name or TOML file.", metavar="NAME/FILE")
    ] = None,
    ambient: Annotated[float | None, typer.Option(help="Ambient temperature [degC].")] = None,
    rig: RigName = None,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Hybrid and cyclic tests and rests, one after the other on one specimen."""
    from thermobearing.results.directory import check_target
    from thermobearing.sequences.case import load_sequence_case
    from thermobearing.sequences.run import run_sequence

    complete = load_sequence_case(case, bearing=bearing, ambient=ambient, rig=rig)
    target = output or Path(f"sequence-{case.stem}")
    check_target(target, overwrite=overwrite)
    result = with_progress(lambda show: run_sequence(complete, progress=show), "parts", quiet)
    result.save(target, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        with contextlib.suppress(KeyboardInterrupt):  # the result is safe by now
            result.show()
    return written(result.outcome, result.sentence, target, documents, as_json=as_json, quiet=quiet)
