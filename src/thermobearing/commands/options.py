"""Commands made of functions: options from the fields of records and the arguments of functions.

A name, a type, a unit and a sentence are written once, where the record or the function is defined;
`fields` names them, and help shows them. Records are imported when a command is used, not before,
so that `thermobearing --help` is quick.
"""

import functools
import inspect
import re
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin, get_type_hints

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    MODEL,
    REPORT,
    RESULT,
    Answer,
    Command,
    Drawn,
    Ending,
    reported,
    values_by_name,
)


def option(*words: str, help: str, panel: str | None = None, **more: Any) -> Any:
    """Return what typer needs to know of an option that is written by hand."""
    return typer.Option(*words, help=help, rich_help_panel=panel, **more)


AsJson = Annotated[
    bool, option("--json", help="Print a summary as JSON on the last line.", panel=RESULT)
]
Quiet = Annotated[
    bool, option("-q", "--quiet", help="Print neither progress nor tables.", panel=RESULT)
]
Overwrite = Annotated[bool, option("--overwrite", help="Replace existing results.", panel=RESULT)]
Title = Annotated[
    list[str] | None,
    option(
        "--title",
        help="Entry of the title block of the report: project, structure, client, author, number, "
        "date, revision or logo (an image file). May be repeated.",
        metavar="KEY=VALUE",
        panel=REPORT,
    ),
]
Template = Annotated[
    Path | None,
    option(
        "--template",
        help="Markdown template that sets the order of the report.",
        metavar="FILE",
        panel=REPORT,
    ),
]
Workbook = Annotated[bool, option("--xlsx", help="Write report.xlsx.", panel=REPORT)]
NoLive = Annotated[
    bool,
    option(
        "--no-live",
        help="Omit the live section, which computes in the browser, from report.html.",
        panel=REPORT,
    ),
]
FIGURE_OPTIONS = {
    "figure_format": Annotated[
        str | None,
        option(
            "--figure-format",
            help="Format of the figures: png (default); also pdf or svg, with editable text.",
            metavar="KIND",
            panel=RESULT,
        ),
    ],
    "figure_width": Annotated[
        str | None,
        option(
            "--figure-width",
            help="Width of the figures in print: single-column (90 mm), double-column (190 mm) or "
            "a length.",
            metavar="WIDTH",
            panel=RESULT,
        ),
    ],
    "no_titles": Annotated[
        bool, option("--no-titles", help="Draw figures without titles.", panel=RESULT)
    ],
}
# Fields of `Drawn` and `Printed`, and additional ones of `Ending`.
RESULT_OPTIONS = {
    "output": Annotated[
        Path | None, option("-o", "--output", help="Directory for the results.", panel=RESULT)
    ],
    "overwrite": Overwrite,
    "no_figures": Annotated[bool, option("--no-figures", help="Draw no figures.", panel=RESULT)],
    **FIGURE_OPTIONS,
    "quiet": Quiet,
}
REPORT_OPTIONS = {
    "report": Annotated[
        bool, option("--report", help="Write report.html and report.pdf.", panel=REPORT)
    ],
    "workbook": Workbook,
    "title": Title,
    "template": Template,
    "no_live": NoLive,
}
COMPARE = Annotated[
    bool,
    option(
        "--compare",
        help="Compare the result with earlier models; for a path, with a test on a line.",
        panel=MODEL,
    ),
]
LAW = Annotated[
    list[str] | None,
    option(
        "--law",
        help="Law for all bearings: a name of `thermobearing list`, or a Python file that "
        "registers your own law, for bearings that name none; it is executed. May be repeated.",
        metavar="NAME/FILE.py",
        panel=MODEL,
    ),
]
EXPOSURE = Annotated[
    list[str] | None,
    option(
        "--exposure",
        help="Factor for long exposure to cold and for ageing: stiffness=1.3, strength=1.2 or "
        "source=TEXT, one option for each.",
        metavar="KEY=VALUE",
        panel=MODEL,
    ),
]


def exposure_given(words: Sequence[str] | None) -> dict[str, Any] | None:
    """Return the table `exposure` from the words of its option; None without."""
    form = "each key once, with a number, such as stiffness=1.3"
    names = [word.partition("=")[0].strip() for word in words or ()]
    for word, name in zip(words or (), names, strict=True):
        if "=" not in word or names.count(name) > 1:
            raise InputError(f'--exposure "{word}": give {form}')
    return values_by_name(words, "--exposure", form, texts=["source"]) or None


class Fields(NamedTuple):
    """Options to be made: where they are defined, their names there, the panel of the help."""

    place: str
    names: str
    panel: str | None
    flags: dict[str, str]


def fields(place: str, names: str, panel: str | None = None, **flags: str) -> Fields:
    """Return options of a record or a function, such as "cyclic.case:Case", "ambient rig".

    `place`: module and name in the package; `names`: of fields or arguments, with spaces; `panel`:
    heading in the help; `flags`: words, help and metavar of an option where they differ, with lines
    between: `kind="--type|I or II."`; each may be left out.
    """
    return Fields(place, names, panel, flags)


def command(
    app: typer.Typer,
    name: str,
    *made: Fields,
    examples: str = "",
    panel: str | None = None,
    laws: bool = False,
) -> Callable[[Callable[..., Answer]], Callable[..., Answer]]:
    """Add a function to a program as a command, with examples (one a line) at the end of its help.

    Its argument `given` takes the values of the options of `made` that were given, by name; an
    argument of the type `Ending` those of where the result goes, of `Printed` without a report, of
    `Drawn` those of figures alone.
    The others are options written by hand. `laws` adds the option --law. What the function returns
    is printed with --json; its "exit_status" is that of the command.
    """

    def _decorate(function: Callable[..., Answer]) -> Callable[..., Answer]:
        def _light() -> None:
            """Stand in until the command is used."""

        _light.__doc__ = function.__doc__
        _light.__dict__["make"] = lambda: _whole(function, made, laws=laws)
        epilog = "\n\n".join(f"Example: thermobearing {line}" for line in examples.splitlines())
        app.command(name, cls=_Lazy, rich_help_panel=panel, epilog=epilog)(_light)
        return function

    return _decorate


class _Lazy(Command):
    """A command whose options are made when it is used."""

    @cached_property
    def full(self) -> Any:
        """The command with its options."""
        app = typer.Typer(
            add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False
        )
        full = self.callback.make()  # type: ignore[union-attr]
        app.command(self.name, cls=Command, epilog=self.epilog)(full)
        return typer.main.get_command(app)

    def make_context(self, info_name: Any, args: Any, parent: Any = None, **extra: Any) -> Any:
        """Parse the words of the complete command."""
        return self.full.make_context(info_name, args, parent, **extra)


def _whole(
    function: Callable[..., Answer], made: Sequence[Fields], *, laws: bool
) -> Callable[..., None]:
    """Return the function with all options as its arguments."""
    options = {name: kind for each in made for name, kind in _options_from(each)}
    own = inspect.signature(function).parameters
    kinds: dict[str, Any] = {}
    ends: dict[str, tuple[type[Drawn], list[str]]] = {}
    for name, one in own.items():
        kind = one.annotation
        if name == "given":
            kinds |= options
        elif isinstance(kind, type) and issubclass(kind, Drawn):
            every = RESULT_OPTIONS | REPORT_OPTIONS
            taken = {key: every[key] for key in every if hasattr(kind, key)}
            ends[name] = (kind, list(taken))
            kinds |= taken
        else:
            kinds[name] = kind
    kinds |= {"law": LAW} if laws else {}
    kinds["as_json"] = AsJson

    @reported
    @functools.wraps(function)
    def _call(**words: Any) -> Answer:
        given = {name: words.pop(name) for name in options}
        if "given" in own:
            words["given"] = {
                name: value
                for name, value in given.items()
                if value is not None and value != [] and (value is not False or _two(options[name]))
            }
        for name, (kind, keys) in ends.items():
            taken = {key: words.pop(key) for key in keys}
            if kind is Ending:
                taken["case"] = words.get("case")
            words[name] = kind(**taken)
        files = words.pop("law", None)
        if not files:
            return function(**words)
        from thermobearing.laws import applied

        with applied(files):
            return function(**words)

    def _default_value(name: str) -> Any:
        """Return the default of the function, else that of the type of the option."""
        default = own[name].default if name in own else inspect.Parameter.empty
        return _usual(kinds[name]) if default is inspect.Parameter.empty else default

    _call.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [
            inspect.Parameter(
                name, inspect.Parameter.KEYWORD_ONLY, annotation=kind, default=_default_value(name)
            )
            for name, kind in kinds.items()
        ]
    )
    _call.__annotations__ = dict(kinds)
    del _call.__wrapped__  # type: ignore[attr-defined]
    return _call


def _usual(kind: Any) -> Any:
    """Return the value of an option that is not given: none, false, or no value, if it must be."""
    if get_args(kind)[0] is bool:
        return False
    return None if _two(kind) else inspect.Parameter.empty


def _two(kind: Any) -> bool:
    """Return whether an option may have no value; of a switch, whether it can be switched off."""
    return types.NoneType in get_args(get_args(kind)[0])


def _options_from(each: Fields) -> Iterator[tuple[str, Any]]:
    """Yield the options of a record or a function as annotations for typer."""
    module, _, name = each.place.partition(":")
    item = getattr(import_module(f"thermobearing.{module}"), name)
    hints = get_type_hints(item, include_extras=True)
    for key in each.names.split():
        kind, several, choices, named = _read_type(hints[key])
        flag = "--" + key.replace("_", "-")
        words, text, shown, *_ = (*each.flags.get(key, "").split("|"), "", "")
        flags = words.split() or [flag]
        default = _default(item, key)
        value: Any = kind if default is inspect.Parameter.empty else kind | None
        if kind is bool and default is True:
            flags = [f"{flag}/--no-{flag[2:]}"]
        elif kind is bool:
            value = bool
        text = text or _help_text(item, key, choices, default)
        if several:
            value = list[kind] | None  # type: ignore[valid-type]
            text = f"{text} May be repeated."
        metavar = shown or ("NAME/FILE" if named and not choices else None)
        yield key, Annotated[value, option(*flags, help=text, panel=each.panel, metavar=metavar)]


PLAIN = {str, int, float, bool, types.NoneType}


def _read_type(hint: Any) -> tuple[Any, bool, list[str], bool]:
    """Return type of one value, whether there may be several, choices, whether it is a name."""
    leaves: set[Any] = set()
    choices: list[str] = []
    several = False
    left = [hint]
    while left:
        part = left.pop(0)
        origin = get_origin(part)
        if origin is Literal:
            choices += map(str, get_args(part))
        elif origin is Annotated:
            left.insert(0, get_args(part)[0])
        elif origin is not None:
            several |= isinstance(origin, type) and issubclass(origin, Sequence | Mapping)
            left[:0] = get_args(part)
        elif isinstance(part, type):
            leaves.add(part)
    text = str in leaves or bool(choices)
    kind = next((one for one in (float, int, bool) if one in leaves and not text), str)
    return kind, several, choices, kind is str and bool(leaves - PLAIN)


def _default(item: Any, name: str) -> Any:
    """Return the default of a field or an argument; empty for an argument without one."""
    if hasattr(item, "model_fields"):
        field = item.model_fields[name]
        return None if field.is_required() else field.get_default()
    return inspect.signature(item).parameters[name].default


ENTRY = r"^ *(?:[\w, *]+, )?{}(?:, [\w, *]+)? :(.*(?:\n(?!(?: *[\w, *]+ :| *\n)).*)*)"
TYPE = re.compile(r" (str|int|float|bool|mapping|sequence|list|dict|Path|array|[A-Z]\w+)\b[^.;]*$")


def _help_text(item: Any, name: str, choices: Sequence[str] = (), default: Any = None) -> str:
    """Return the description of a field or an argument in the docstring of its record or function.

    Choices, unit and default are added where the sentence does not have them.

    >>> from thermobearing.cyclic.protocol import CyclicTest
    >>> _help_text(CyclicTest, "dt", default=0.005)
    'Largest time step while the bearing moves [s], in [1e-6, 10]; 0.005 by default.'
    """
    texts = (inspect.getdoc(one) or "" for one in getattr(item, "__mro__", [item]))
    matches = (re.search(ENTRY.format(name), text, re.MULTILINE) for text in texts)
    found = next(filter(None, matches), None)
    first, _, rest = found[1].partition("\n") if found else (name.replace("_", " "), "", "")
    sentence = rest if rest and TYPE.match(first) else f"{first} {rest}"
    text = " ".join(sentence.split()).rstrip(".")
    if hasattr(item, "model_fields") and "[" not in text:
        from thermobearing.border.schema import find_unit

        unit = find_unit(item, name)
        text += f" [{unit}]" if unit else ""
    if others := [choice for choice in choices if f'"{choice}"' not in text]:
        text += f": {', '.join(others[:-1])} or {others[-1]}"
    usual = isinstance(default, int | float | str) and not isinstance(default, bool)
    if usual and default != "" and "default" not in text:
        text += f"; {default} by default"
    return text[:1].upper() + text[1:] + "."
