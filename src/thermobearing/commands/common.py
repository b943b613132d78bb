"""What all commands share: options, how they end, the last line of JSON."""

import functools
import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from thermobearing.border.errors import InputError, OutputError, printable
from thermobearing.commands.options import as_options

if TYPE_CHECKING:
    from thermobearing.report.title import TitleBlock

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
REPORT = "Report"

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
SmallLoops = Annotated[
    str | None,
    typer.Option(
        "--small-loops",
        help="Of the rubber: published (open) or closed; by default as the bearing says.",
        rich_help_panel=MODEL,
    ),
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


Title = Annotated[
    list[str] | None,
    typer.Option(
        "--title",
        help="Of the report: project, structure, client, author, number, date, revision or logo "
        "(a file); may be repeated.",
        metavar="KEY=VALUE",
        rich_help_panel=REPORT,
    ),
]
Template = Annotated[
    Path | None,
    typer.Option(
        "--template",
        help="Markdown that orders the report.",
        metavar="FILE",
        rich_help_panel=REPORT,
    ),
]
Workbook = Annotated[
    bool, typer.Option("--xlsx", help="Write report.xlsx.", rich_help_panel=REPORT)
]
WithReport = Annotated[
    bool, typer.Option("--report", help="Write report.html and .pdf.", rich_help_panel=REPORT)
]


@dataclass(frozen=True)
class Documents:
    """What is to be written of a result besides its files: what four options ask for."""

    report: bool = False
    workbook: bool = False
    title: Sequence[str] = ()
    template: Path | None = None
    case: Path | None = None  # the file of the command, which may have a title block

    def check(self) -> None:
        """Refuse before a run what could not be written after it."""
        if (self.title or self.template) and not (self.report or self.workbook):
            raise InputError("--title and --template belong to a report: give --report too")
        self.block().logo_bytes()
        # Imported where they are needed: drawing alone takes as long to import as a small run.
        if self.template is not None:
            from thermobearing.border.encodings import read_text

            read_text(self.template)
        if self.report:
            from thermobearing.report.pdf import the_compiler

            the_compiler()
        if self.workbook:
            from thermobearing.report.workbook import the_writer

            the_writer()

    def block(self) -> "TitleBlock":
        """The title block: of the options, and below them of the case file."""
        from thermobearing.report.title import read_title, title_given

        return title_given(self.title).over(read_title(self.case))

    def write(self, target: Path) -> list[Path]:
        """Write them into the directory of a result; of a case file its title block at least."""
        from thermobearing.report.title import TitleBlock

        title = self.block()
        wanted = self.report or self.workbook
        if not wanted and title == TitleBlock():
            return []
        from thermobearing.report.files import keep_title
        from thermobearing.reporting import Kinds, make_documents

        try:
            if not wanted:
                keep_title(target, title)
                return []
            kinds = Kinds(html=self.report, pdf=self.report, workbook=self.workbook)
            return make_documents(target, kinds, title=title, template=self.template)
        except (InputError, OutputError) as error:
            told = f"the result is in {target}, but its report is not: {error}"
            raise type(error)(told) from None


NO_DOCUMENTS = Documents()
DOCUMENTS = "documents"  # argument of a command that offers the options of `Documents`
_OPTIONS = {"report": WithReport, "workbook": Workbook, "title": Title, "template": Template}


def _with_options(command: Callable[..., int], wrapper: Callable[..., None]) -> None:
    """In the words of a command, the argument `documents` becomes its four options."""
    whole = inspect.signature(command)
    found = [item for item in whole.parameters.values() if item.name != DOCUMENTS]
    for name, kind in _OPTIONS.items():
        option = inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=kind)
        found.append(option.replace(default=False if kind in (WithReport, Workbook) else None))
    told = {parameter.name: parameter.annotation for parameter in found}
    wrapper.__annotations__ = told | {"return": None}
    wrapper.__signature__ = whole.replace(parameters=found)  # type: ignore[attr-defined]


def _documents(words: dict[str, Any]) -> Documents:
    """What the four options ask for, taken out of the words of a command."""
    given = {name: words.pop(name, None) for name in _OPTIONS}
    made = Documents(**{k: v for k, v in given.items() if v}, case=words.get("case"))
    made.check()
    return made


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
    """Turn what a command raises or returns into one message and an exit status.

    A command with the argument `documents` has the options of `Documents`.
    """
    offers = DOCUMENTS in inspect.signature(command).parameters

    @functools.wraps(command)
    def wrapper(*args: Any, **kwargs: Any) -> None:
        as_json = bool(kwargs.get("as_json"))
        try:
            if offers:
                kwargs[DOCUMENTS] = _documents(kwargs)
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

    if offers:
        _with_options(command, wrapper)
    return wrapper


def written(
    outcome: str,
    sentence: str,
    target: Path,
    documents: Documents = NO_DOCUMENTS,
    *,
    as_json: bool,
    quiet: bool,
) -> int:
    """Write what is asked for, say where all is and how it ended; the exit status."""
    made = documents.write(target)
    statuses = {"completed": 0, "poor_fit": POOR_FIT, "interrupted": INTERRUPTED}
    statuses["files_left_out"] = BAD_INPUT
    status = statuses.get(outcome, ENDED_EARLY)
    if status:
        typer.echo(f"thermobearing: {outcome}: {sentence}", err=True)
    if not quiet:
        size = sum(p.stat().st_size for p in target.rglob("*") if p.is_file())
        names = ", ".join(file.name for file in made)
        typer.echo(
            f"written: {printable(str(target))} ({megabytes(size)})"
            + (f"; {names}" if names else "")
        )
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

    from thermobearing.commands.progress import progress_bar

    with progress_bar(Console(stderr=True)) as bar:
        task = bar.add_task(what, total=None)
        return call(
            lambda done, total: bar.update(task, description=what, completed=done, total=total)
        )
