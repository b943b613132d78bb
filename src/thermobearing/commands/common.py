"""The program, and what all commands share: help, messages, progress, written results.

On a terminal typer draws panels with rich. Elsewhere the same panels are plain sections.
"""

import contextlib
import functools
import io
import os
import re
import shutil
import sys
import time
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

import typer
import typer.core

from thermobearing.border.errors import InputError, OutputError, printable, shortened
from thermobearing.border.keywords import renamed

if TYPE_CHECKING:
    from thermobearing.border.title import TitleBlock

T = TypeVar("T")
Answer = dict[str, Any]  # last line of a command with --json; its exit_status is 0 by default
BAD_INPUT, ENDED_EARLY, POOR_FIT, INTERRUPTED = 2, 3, 4, 130
STATUSES = {
    "completed": 0,
    "poor_fit": POOR_FIT,
    "interrupted": INTERRUPTED,
    "files_left_out": BAD_INPUT,
}
COMPILING = "compiling the kernels: once after installation, ten seconds to a minute"
STEPPING = "core.march.march"  # the kernel that every analysis but those of structures begins with
STRUCTURES = "structure.newmark.newmark_march"
# Panels of --help: of the list of commands, and of the options of one.
ANALYSES, LABORATORY, OFFICE, FILES = (
    "Tests and earthquakes",
    "From laboratory tests",
    "Design",
    "Library and files",
)
INPUT, TEST, MODEL, SEARCH, RESULT = ("Input", "Test", "Model", "Search", "Result")
REPORT = "Report"

TABLES = {"exposure"}  # keys whose option gives one entry of a table
FEW_LETTERS = {"dt"}  # no word of a sentence, like those with an underscore
# Keys of cases that options of the command that runs give, their options, whether each was given.
RUNNING: ContextVar[dict[str, tuple[str, bool]] | None] = ContextVar("running", default=None)


def _as_options(text: str) -> str:
    """Return a message of the library with the options of the command that runs.

    A key with a value ("test.dt = ...", "ambient[0] = ...") becomes the option that gave it, if one
    did, and an entry of a table ("exposure.stiffness = ...") the option with that entry; a keyword
    in advice ("a larger dt", "give trust_unit") becomes the option of that name, if the command has
    it. The name of a function is omitted. Outside a command the text is unchanged.

    >>> before = RUNNING.set({"dt": ("--dt", True), "keep_every": ("--keep-every", False)})
    >>> _as_options("command line: test.dt = '9 s': must be at most 1 s")
    "command line: --dt = '9 s': must be at most 1 s"
    >>> _as_options("case.toml: keep_every = 0: must be at least 1; or a larger dt, keep_every")
    'case.toml: keep_every = 0: must be at least 1; or a larger --dt, --keep-every'
    >>> RUNNING.reset(before)
    """
    options = RUNNING.get()
    if options is None:
        return text
    # "load_result(): ..." names a function, which a reader of a command does not call.
    text = re.sub(r"^\w+\(\): ", "", text)
    for key, (flag, is_given) in options.items():
        if is_given:  # alone or of a table, one or a list of them
            # A repeated option has the plural as its key (strains), a message the singular or an
            # index.
            singular = key if key.removesuffix("s") in options else key.removesuffix("s")
            plural = "" if f"{key}s" in options else "s?"
            reference = rf"(?<![\w./-])(?:\w+(?:\[\d+\])?\.)?{singular}"
            if key in TABLES:
                text = re.sub(rf"{reference}\.(?=\w+(?: = |: |\"))", f"{flag} ", text)
            text = re.sub(rf"{reference}{plural}(?:\[\d+\])?(?= = |: )", flag, text)
        # Within a sentence only names that are no English words are replaced: not "test" or "plan".
        if "_" in key or key in FEW_LETTERS:
            text = re.sub(rf"(?<![\w.\"/=-]){key}(?![\w\"/=]| = |: |\.\w)", flag, text)
    return re.sub(r"\b\w+\[\d+\]: (?=--)", "", text)


def _fail(message: str, status: int, outcome: str, as_json: bool) -> typer.Exit:
    """Report a failure once, on stderr, and as JSON on request."""
    typer.echo(f"thermobearing: {message}", err=True)
    if as_json:
        _echo_json({"outcome": outcome, "exit_status": status, "message": message})
    return typer.Exit(status)


def _echo_json(last: Answer) -> None:
    from thermobearing.results.writing import json_line

    typer.echo(json_line(last))


def is_out_of_memory(error: BaseException) -> bool:
    """Return whether an error is one of those that a lack of memory causes.

    An import that finds no memory ends in several ways.
    """
    if isinstance(error, MemoryError):
        return True
    marks = (
        *("without exception set", "without setting an exception"),
        *("failed to map segment", "allocate memory"),
    )
    return any(mark in str(error) for mark in marks)


def reported(command: Callable[..., Answer]) -> Callable[..., None]:
    """Convert the result or error of a command to one message, a line of JSON and a status."""

    @functools.wraps(command)
    def _wrapper(*, as_json: bool, **words: Any) -> None:
        try:
            last = command(**words)
        except InputError as error:
            raise _fail(_as_options(str(error)), BAD_INPUT, "bad_input", as_json) from None
        except OutputError as error:
            raise _fail(str(error), BAD_INPUT, "not_written", as_json) from None
        except (MemoryError, SystemError, ImportError, OSError) as error:
            if not is_out_of_memory(error):
                raise
            error.__traceback__ = None  # frees what its frames hold, for the message
            message = "not enough memory; keep fewer histories (keep_every) or use a larger dt"
            raise _fail(_as_options(message), BAD_INPUT, "bad_input", as_json) from None
        except KeyboardInterrupt:
            message = "interrupted; nothing was written"
            raise _fail(message, INTERRUPTED, "interrupted", as_json) from None
        if as_json:
            _echo_json(last)
        if last.get("exit_status"):
            raise typer.Exit(last["exit_status"])

    return _wrapper


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """Options of a command that draws figures: their style, and whether anything is printed."""

    figure_format: str | None = None
    figure_width: str | None = None
    no_titles: bool = False
    quiet: bool = False

    def __post_init__(self) -> None:
        """Raise an error before the run for a style that figures cannot have."""
        if self.figures:
            from thermobearing.results.figure_style import check_style

            check_style(**self.figures)

    @property
    def figures(self) -> dict[str, Any]:
        """The keywords of figures for `save_all`."""
        titles = not self.no_titles
        return {"format": self.figure_format or "png", "width": self.figure_width, "titles": titles}


@dataclass(frozen=True, kw_only=True)
class Printed(Drawn):
    """Options of every command with a result: the output directory, and what is printed."""

    output: Path | None = None
    overwrite: bool = False
    no_figures: bool = False

    @property
    def figures(self) -> dict[str, Any]:
        """The keywords of figures for `save`; empty without figures."""
        return {} if self.no_figures else super().figures

    def target(self, usual: str = "") -> Path:
        """Return the result directory, which is free to be written."""
        from thermobearing.results.directory import check_target

        target = self.output or Path(re.sub(r"[^\w.+-]+", "-", usual))
        check_target(target, overwrite=self.overwrite)
        return target

    def check(self) -> None:
        """Refuse an output directory that cannot be written."""
        if self.output is not None:
            self.target()

    def documents(self, target: Path) -> list[Path]:
        """Write no documents, since the command has no report."""
        return []

    def save(
        self,
        result: Any,
        target: Path,
        outcome: str = "",
        sentence: str = "",
        *,
        show: Callable[[], None] | None = None,
        **options: Any,
    ) -> Answer:
        """Save a result, print it, write its documents, and print where they are.

        `show` prints the result in place of its own method, and the figure to open is named.
        """
        result.save(target, overwrite=self.overwrite, figures=self.figures, **options)
        if not self.quiet:
            with contextlib.suppress(KeyboardInterrupt):  # the result is safe by now
                (show or result.show)()
        documents = self.documents(target)
        outcome = outcome or getattr(result, "outcome", "completed")  # a structure has none
        # Any other outcome names a failure mode of the run, such as instability.
        status = STATUSES.get(outcome, ENDED_EARLY)
        if status:
            typer.echo(f"thermobearing: {outcome}: {sentence or result.sentence}", err=True)
        files = [file for file in target.rglob("*") if file.is_file()]
        if not self.quiet:
            size = megabytes(sum(file.stat().st_size for file in files))
            names = "; " + ", ".join(file.name for file in documents) if documents else ""
            echo_written(target, f" ({size}){names}")
            if show and (loops := target / "figures" / "loops.png").is_file():
                typer.echo(f"open {loops}")
        last = {"outcome": outcome, "exit_status": status, "output": str(target)}
        return last | {"files": sorted(str(file.relative_to(target)) for file in files)}

    def save_if_asked(self, result: Any) -> Answer:
        """Print a result, and save it where an output directory is given."""
        if self.output is not None:
            return self.save(result, self.output)
        if not self.quiet:
            result.show()
        return {"exit_status": 0, **result.summary()}


@dataclass(frozen=True, kw_only=True)
class Ending(Printed):
    """The options of a command that writes a report too."""

    report: bool = False
    workbook: bool = False
    title: Sequence[str] | None = None
    template: Path | None = None
    no_live: bool = False
    case: Path | None = None  # the file of the command, which may have a title block

    def __post_init__(self) -> None:
        """Raise an error before the run for what could not be written after it."""
        super().__post_init__()
        if (self.title or self.template) and not self.with_report:
            raise InputError("--title and --template require --report or --xlsx")
        # A title block or a logo that cannot be read is refused before the run, not after it.
        self._block().logo_bytes()
        # Imported where they are needed: drawing alone takes as long to import as a small run.
        if self.template is not None:
            from thermobearing.tables.text import read_text

            read_text(self.template)
        if self.report:
            from thermobearing.report.pdf import the_compiler

            the_compiler()
        if self.workbook:
            from thermobearing.report.workbook import the_writer

            the_writer()

    @property
    def with_report(self) -> bool:
        """Whether any document is to be written."""
        return self.report or self.workbook

    def check(self) -> None:
        """Refuse an output directory that cannot be written, and a report without one."""
        super().check()
        if self.output is None and self.with_report:
            raise InputError("a report is written into a result directory: give it with -o")

    def _block(self) -> "TitleBlock":
        """Return the title block: of the options, and below them of the case file."""
        from thermobearing.border.title import read_title, title_given

        return title_given(self.title or ()).over(read_title(self.case))

    def documents(self, target: Path) -> list[Path]:
        """Write report and workbook into a result directory; the title block of a case at least."""
        from thermobearing.border.title import TitleBlock

        title = self._block()
        if not self.with_report and title == TitleBlock():
            return []
        from thermobearing.reporting import keep_title, make_report

        try:
            if not self.with_report:
                keep_title(target, title)
                return []
            kinds: dict[str, Any] = {
                "html": self.report,
                "workbook": self.workbook,
                "live": not self.no_live,
            }
            return make_report(target, title=title, template=self.template, **kinds)
        except (InputError, OutputError) as error:
            message = f"the result is in {target}, but its report could not be written: {error}"
            raise type(error)(message) from None


def echo_written(target: Path, remark: str = "") -> None:
    """Print which file or directory was written."""
    typer.echo(f"written: {printable(str(target))}{remark}")


def megabytes(size: float) -> str:
    """Return a size in bytes as text in megabytes."""
    return f"{size / 1e6:.1f} MB" if size < 1e7 else f"{size / 1e6:.0f} MB"


def values_by_name(
    words: Sequence[str] | None, option: str, form: str, texts: Sequence[str] = ()
) -> dict[str, Any]:
    """Return numbers by name from words such as "sigma_Y=0.1"; those in `texts` stay text."""
    values: dict[str, Any] = {}
    for word in words or ():
        name, _, value = (part.strip() for part in word.partition("="))
        try:
            values[name] = value if name in texts else float(value)
        except ValueError:
            raise InputError(f'{option} "{word}": give {form}') from None
    return values


def announce_compiling(quiet: bool, kernel: str = STEPPING) -> None:
    """Announce on stderr that a kernel is compiled first, if its machine code is not cached."""
    from thermobearing.core.compiled.runners import is_compiled

    if not quiet and not is_compiled(kernel):
        typer.echo(COMPILING, err=True)


# Tests switch the lines off: whether one is due depends on how fast the machine is.
PROGRESS_LINES_PRINTED = True


class ProgressLines:
    """Progress of a long command in lines of a log: the first after 10 s, then one a minute."""

    FIRST, EVERY = 10.0, 60.0  # seconds
    # A rest is estimated from so large a share of all, or after so many seconds: the first ones of
    # parallel processes end together, and a few of them say nothing about the speed.
    SHARE, LONG = 0.05, 60.0

    def __init__(
        self,
        task: str,
        clock: Callable[[], float] = time.monotonic,
        *,
        resumes: bool = False,
    ) -> None:
        self._what, self._clock = task, clock
        # What an earlier start did, which the first call reports; it says nothing about the speed.
        self._before: int | None = None if resumes else 0
        self._start = clock()
        self._next = self._start + self.FIRST
        self._first: tuple[float, int] | None = None  # time and count when the first were done

    def show(self, done: int, total: int) -> None:
        """Print how much is done, and about how long the rest takes, where a line is due."""
        seconds = self._clock()
        if self._before is None:
            self._before = done
        if done > self._before and self._first is None:
            self._first = seconds, done
        if seconds < self._next or self._first is None or not 0 < done < total:
            return
        self._next = seconds + self.EVERY
        # Compiling and the start of processes precede the first ones and do not come again.
        began, before = self._first
        rest = ""
        enough = done - before >= self.SHARE * total or seconds - began >= self.LONG
        if done > before and enough:
            remaining = (seconds - began) * (total - done) / (done - before)
            size = f"{remaining:.0f} s" if remaining < 120.0 else f"{remaining / 60.0:.0f} minutes"
            rest = f", about {size} left"
        typer.echo(f"{self._what}: {done} of {total}{rest}", err=True)


def with_progress(
    call: Callable[[Callable[[int, int], None] | None], T],
    description: str,
    quiet: bool,
    kernel: str = STEPPING,
    *,
    resumes: bool = False,
) -> T:
    """Return what `call` returns, with a progress bar on stderr; lines where it is no terminal.

    `call` takes a function to report (done, all) to. A kernel that is compiled first is announced.
    With `resumes` the first report is of what an earlier start did.
    """
    announce_compiling(quiet, kernel)
    terminal = sys.stderr.isatty()
    if quiet or not (terminal or PROGRESS_LINES_PRINTED):
        return call(None)
    if not terminal:
        return call(ProgressLines(description, resumes=resumes).show)
    from rich.console import Console

    from thermobearing.commands.progress import progress_bar

    with progress_bar(Console(stderr=True)) as bar:
        task = bar.add_task(description, total=None)
        return call(
            lambda done, total: bar.update(
                task, description=description, completed=done, total=total
            )
        )


WIDTH, MOST = 100, 200  # letters of a line where COLUMNS does not say, and at most


class _WithHelp:
    """Help in panels on a terminal, and in plain sections elsewhere."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write usage, help, a section for each panel, the examples."""
        if sys.stdout.isatty():
            super().format_help(ctx, formatter)  # type: ignore[misc]
            return
        command: Any = self
        formatter.width = min(shutil.get_terminal_size((WIDTH, 24)).columns, MOST)
        command.format_usage(ctx, formatter)
        command.format_help_text(ctx, formatter)
        sections: dict[str, list[tuple[str, str]]] = {}
        for parameter in command.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None:
                default_panel = (
                    "Arguments" if parameter.param_type_name == "argument" else "Options"
                )
                panel = getattr(parameter, "rich_help_panel", None) or default_panel
                sections.setdefault(panel, []).append(record)
        for name, item in getattr(command, "commands", {}).items():
            panel = getattr(item, "rich_help_panel", None) or "Commands"
            sections.setdefault(panel, []).append((name, item.get_short_help_str(limit=200)))
        for panel, rows in sections.items():
            with formatter.section(panel):
                formatter.write_dl(rows, col_max=48)
        if command.epilog:
            formatter.write_paragraph()
            formatter.write_text(command.epilog)


USAGE_ERROR: Any = typer.BadParameter.__base__  # of click, or of the parser of a later typer
UNIT = re.compile(r"\[([^\[\]\d-][^\[\],]*)\]")  # in the help of an option


def _word_fault(error: Any, words: Sequence[str], ctx: Any) -> str:
    """Return a sentence on a word that is missing or no value of its option; else nothing."""
    name = getattr(error, "option_name", "")
    # An option of an earlier version is answered with its present name.
    clause = renamed(name, [word for param in ctx.command.params for word in param.opts])
    if clause:
        return f"no such option {name}{clause}"
    parameters = (parameter for parameter in ctx.command.params if name in parameter.opts)
    parameter: Any = getattr(error, "param", None) or next(parameters, None)
    if parameter is None:
        return ""
    help = (getattr(parameter, "help", "") or "").rstrip(".")
    option = next((word for word in parameter.opts if word.startswith("--")), "")
    pairs = zip(words, [*words, ""][1:], strict=False)
    parted = [(*word.partition("="), next_word) for word, next_word in pairs]
    values = [
        value if mark else next_word
        for flag, mark, value, next_word in parted
        if flag in parameter.opts
    ]
    if name:
        return f"{option} requires a value: {help}"
    if not values:
        subject = f"option {option}" if option else f"argument {parameter.name}"
        return f"missing {subject}: {help}".rstrip(" :")
    kind = int if "INT" in parameter.get_help_record(ctx)[0].upper() else float
    for value in values:
        try:
            kind(value)
        except ValueError:
            number = "an integer" if kind is int else "a number"
            unit = UNIT.search(help)
            allowed = f"{number} in {unit[1]}, without its unit" if unit else number
            return f"{option} = {shortened(value)!r}: must be {allowed}"
    return f"{option} = {values[-1]}: {error.message.replace('Input should', 'must')}"


class Command(_WithHelp, typer.core.TyperCommand):
    """A command whose messages may name its options."""

    def parse_args(self, ctx: Any, args: Any) -> Any:
        """Parse the words; a wrong value ends with one sentence."""
        words = list(args)
        try:
            return super().parse_args(ctx, args)
        except USAGE_ERROR as error:
            message = _word_fault(error, words, ctx)
            if not message:
                raise
            raise _fail(message, BAD_INPUT, "bad_input", "--json" in words) from None

    def invoke(self, ctx: Any) -> Any:
        """Run, its options known to `_as_options`."""
        options: dict[str, tuple[str, bool]] = {}
        for parameter in ctx.command.params:
            source = ctx.get_parameter_source(parameter.name)
            is_given = source is not None and source.name == "COMMANDLINE"
            for word in [word for word in parameter.opts if word.startswith("--")][:1]:
                keys = (word[2:].replace("-", "_"), parameter.name)
                options |= dict.fromkeys(keys, (word, is_given))
        token = RUNNING.set(options)
        try:
            return super().invoke(ctx)
        finally:
            RUNNING.reset(token)


class Group(_WithHelp, typer.core.TyperGroup):
    """A group of commands; a fault of usage has a frame on a terminal only."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run; wrong usage too ends with a line of JSON if --json is among the words."""
        words = args[0] if args else kwargs.get("args")
        words = sys.argv[1:] if words is None else words
        markup_mode = self.rich_markup_mode
        if not sys.stderr.isatty():
            self.rich_markup_mode = None
        try:
            return super().main(*args, **kwargs)
        except SystemExit as end:
            usage = getattr(end.__context__, "format_message", None)
            # Errors of usage come from click, before `reported` could write the line of JSON.
            if end.code == BAD_INPUT and usage is not None and "--json" in words:
                _echo_json({"outcome": "bad_input", "exit_status": BAD_INPUT, "message": usage()})
            raise
        finally:
            self.rich_markup_mode = markup_mode


app = typer.Typer(
    name="thermobearing",
    cls=Group,
    help="Rubber isolation bearings at low temperature: heat conduction coupled to hysteresis.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",  # or units in brackets vanish from the help
    context_settings={"help_option_names": ["-h", "--help"]},
)


class GuardedStream:
    """A stream that discards the output after its reader has closed it.

    `thermobearing cyclic | head -1` then ends like without `head`. If the disk of the output is
    full, the results are still written; `lost` is the reason why the output is incomplete.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.lost = ""

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write text; its length."""
        try:
            self._stream.write(text)
        except OSError as error:
            self._discard(error)
        return len(text)

    def flush(self) -> None:
        """Write what is buffered."""
        try:
            self._stream.flush()
        except OSError as error:
            self._discard(error)

    def _discard(self, error: OSError) -> None:
        # A reader that has enough, such as `head`, is no error; a full disk is.
        if not isinstance(error, BrokenPipeError):
            self.lost = error.strerror or str(error)
        # The descriptor itself is replaced, since Python flushes it once more at exit.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)


def guard_streams() -> None:
    """Guard standard output and error, and replace characters that they cannot show."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed before the start
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
            setattr(sys, name, GuardedStream(stream))
