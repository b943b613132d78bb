"""What all commands share: options, how they end, the last line of JSON."""

import functools
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from thermobearing.border.errors import InputError, OutputError, printable
from thermobearing.commands.options import as_options

T = TypeVar("T")
BAD_INPUT, ENDED_EARLY, POOR_FIT, INTERRUPTED = 2, 3, 4, 130

# Panels of --help: of the list of commands, and of the options of one.
ANALYSES, LABORATORY, OFFICE, FILES = (
    "Tests and earthquakes",
    "From laboratory tests",
    "Design",
    "Library and files",
)
INPUT, TEST, MODEL, SEARCH, RESULT = ("What", "Test", "Model", "Search", "Result")

Output = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="Result directory.", rich_help_panel=RESULT),
]
Force = Annotated[
    bool,
    typer.Option("--force", help="Replace an earlier result directory.", rich_help_panel=RESULT),
]
NoFigures = Annotated[
    bool, typer.Option("--no-figures", help="Draw no figures.", rich_help_panel=RESULT)
]
AsJson = Annotated[
    bool, typer.Option("--json", help="Last line of output is JSON.", rich_help_panel=RESULT)
]
Quiet = Annotated[
    bool,
    typer.Option("-q", "--quiet", help="No progress bar, no tables.", rich_help_panel=RESULT),
]
Exposed = Annotated[
    list[str] | None,
    typer.Option(
        "--exposure",
        help="Factor for long cold and age: stiffness=1.3, strength=1.2 and source=WORDS, each an "
        "option of its own.",
        metavar="KEY=VALUE",
        rich_help_panel=MODEL,
    ),
]
RigName = Annotated[
    str | None,
    typer.Option(
        "--rig",
        help="Rig that is to do it: name or file.",
        metavar="NAME/FILE",
        rich_help_panel=INPUT,
    ),
]
FixedBase = Annotated[
    bool, typer.Option("--fixed-base", help="Leave out the springs of the foundation.")
]
EarlierModel = Annotated[
    str | None,
    typer.Option("--model", help="An earlier model, see docs/theory.md.", rich_help_panel=MODEL),
]
Compare = Annotated[
    bool, typer.Option("--compare", help="Earlier models beside it.", rich_help_panel=MODEL)
]
Limit = Annotated[
    list[str] | None,
    typer.Option(
        help="Largest relative error of K_eq, h_eq (0.15 each), energy, force, temperature or "
        "NRMSE, of tests that are not fitted; may be repeated.",
        metavar="QUANTITY=NUMBER",
    ),
]


def _fail(message: str, status: int, outcome: str, as_json: bool) -> typer.Exit:
    """Report a failure once, on stderr, and as JSON if asked for."""
    typer.echo(f"thermobearing: {message}", err=True)
    if as_json:
        echo_json({"outcome": outcome, "exit_status": status, "message": message})
    return typer.Exit(status)


def echo_json(last: dict[str, Any]) -> None:
    """The last line of a command with --json."""
    from thermobearing.results.writing import json_line

    typer.echo(json_line(last))


def reported(command: Callable[..., int]) -> Callable[..., None]:
    """Turn what a command raises or returns into one message and an exit status."""

    @functools.wraps(command)
    def wrapper(*args: Any, **kwargs: Any) -> None:
        as_json = bool(kwargs.get("as_json"))
        try:
            status = command(*args, **kwargs)
        except InputError as error:
            raise _fail(as_options(str(error)), BAD_INPUT, "bad_input", as_json) from None
        except OutputError as error:
            raise _fail(str(error), BAD_INPUT, "not_written", as_json) from None
        except MemoryError:
            message = "not enough memory; keep fewer histories (keep_every) or a larger dt"
            raise _fail(as_options(message), BAD_INPUT, "bad_input", as_json) from None
        except KeyboardInterrupt:
            message = "interrupted; nothing was written"
            raise _fail(message, INTERRUPTED, "interrupted", as_json) from None
        if status:
            raise typer.Exit(status)

    return wrapper


def written(outcome: str, sentence: str, target: Path, *, as_json: bool, quiet: bool) -> int:
    """Say where the result is and how it ended; the exit status."""
    statuses = {"completed": 0, "poor_fit": POOR_FIT, "interrupted": INTERRUPTED}
    statuses["files_left_out"] = BAD_INPUT
    status = statuses.get(outcome, ENDED_EARLY)
    if status:
        typer.echo(f"thermobearing: {outcome}: {as_options(sentence)}", err=True)
    if not quiet:
        size = sum(p.stat().st_size for p in target.rglob("*") if p.is_file())
        typer.echo(f"written: {printable(str(target))} ({megabytes(size)})")
    if as_json:
        files = sorted(str(p.relative_to(target)) for p in target.rglob("*") if p.is_file())
        last = {"outcome": outcome, "exit_status": status, "output": str(target), "files": files}
        echo_json(last)
    return status


def megabytes(size: float) -> str:
    """A size in bytes as one would say it."""
    return f"{size / 1e6:.1f} MB" if size < 1e7 else f"{size / 1e6:.0f} MB"


def numbers_by_name(given: Sequence[str], option: str, form: str) -> dict[str, float]:
    """Numbers from words of an option such as "sigma_Y=0.1"; `form` says what to give."""
    found = {}
    for text in given:
        name, _, number = text.partition("=")
        try:
            found[name.strip()] = float(number)
        except ValueError:
            raise InputError(f'{option} "{text}": give {form}') from None
    return found


def exposure_given(words: Sequence[str] | None) -> dict[str, Any] | None:
    """The table `exposure` from words such as "stiffness=1.3" and "source=..."; None without."""
    if not words:
        return None
    table: dict[str, Any] = {}
    for word in words:
        name, equals, value = word.partition("=")
        name = name.strip()
        if not equals or name in table:
            raise InputError(f'--exposure "{word}": give each key once, such as stiffness=1.3')
        try:
            table[name] = value.strip() if name == "source" else float(value)
        except ValueError:
            raise InputError(f'--exposure "{word}": must be a number, such as 1.3') from None
    return table


def limit_numbers(given: Sequence[str] | None) -> dict[str, float]:
    """Those of `Limit`."""
    return numbers_by_name(given or [], "--limit", "QUANTITY=NUMBER, such as K_eq=0.1")


COMPILING = "compiling: once after installing, for ten seconds to a minute"
STEPPING = "march.march"  # the kernel that every analysis but those of structures begins with
STRUCTURES = "newmark.newmark_march"


def announce_compiling(quiet: bool, kernel: str = STEPPING) -> None:
    """Say that a run compiles first, on stderr, if the machine code of a kernel is not kept yet."""
    from thermobearing.core.compile import is_compiled

    if not quiet and not is_compiled(kernel):
        typer.echo(COMPILING, err=True)


def with_progress(
    call: Callable[[Callable[[int, int], None] | None], T],
    what: str,
    quiet: bool,
    kernel: str = STEPPING,
) -> T:
    """`call` with a progress bar (on stderr, only on a terminal); it reports (done, all).

    Says first that it compiles, if the machine code of the named kernel is not there yet.
    """
    announce_compiling(quiet, kernel)
    if quiet or not sys.stderr.isatty():
        return call(None)
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)
        return call(
            lambda done, total: bar.update(task, description=what, completed=done, total=total)
        )
