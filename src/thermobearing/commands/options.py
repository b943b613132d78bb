"""Commands made of functions: options from the fields of records and the arguments of functions.

A name, a type, a unit and a sentence are said once, where the record or the function is defined;
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

from thermobearing.commands.common import (
    MODEL,
    REPORT,
    RESULT,
    Command,
    Documents,
    Ending,
    Printed,
    reported,
)


def option(*words: str, help: str, panel: str | None = None, **more: Any) -> Any:
    """Return what typer needs to know of an option that is written by hand."""
    return typer.Option(*words, help=help, rich_help_panel=panel, **more)


AsJson = Annotated[bool, option("--json", help="Last line of output is JSON.", panel=RESULT)]
Quiet = Annotated[bool, option("-q", "--quiet", help="No progress bar, no tables.", panel=RESULT)]
Overwrite = Annotated[
    bool, option("--overwrite", help="Replace an earlier result directory.", panel=RESULT)
]
RESULT_OPTIONS = {
    "output": Annotated[
        Path | None, option("-o", "--output", help="Result directory.", panel=RESULT)
    ],
    "overwrite": Overwrite,
    "no_figures": Annotated[bool, option("--no-figures", help="Draw no figures.", panel=RESULT)],
    "as_json": AsJson,
    "quiet": Quiet,
}
Title = Annotated[
    list[str] | None,
    option(
        "--title",
        help="Title block of the report: project, structure, client, author, number, date, "
        "revision or logo (a file); may be repeated.",
        metavar="KEY=VALUE",
        panel=REPORT,
    ),
]
Template = Annotated[
    Path | None,
    option("--template", help="Markdown that orders the report.", metavar="FILE", panel=REPORT),
]
Workbook = Annotated[bool, option("--xlsx", help="Write report.xlsx.", panel=REPORT)]
REPORT_OPTIONS = {
    "report": Annotated[bool, option("--report", help="Write report.html and .pdf.", panel=REPORT)],
    "workbook": Workbook,
    "title": Title,
    "template": Template,
}


COMPARE = Annotated[bool, option("--compare", help="Compare with earlier models.", panel=MODEL)]
EXPOSURE = Annotated[
    list[str] | None,
    option(
        "--exposure",
        help="Factor for long cold and age: stiffness=1.3, strength=1.2 and source=WORDS, each an "
        "option of its own.",
        metavar="KEY=VALUE",
        panel=MODEL,
    ),
]
LIMITS = Annotated[
    list[str] | None,
    option(
        "--limit",
        help="Largest relative error of K_eq, h_eq (0.15 each), energy, force, temperature or "
        "NRMSE, of tests that are not fitted; may be repeated.",
        metavar="QUANTITY=NUMBER",
    ),
]


class Fields(NamedTuple):
    """Options to be made: where they are defined, their names there, the panel of the help."""

    place: str
    names: Sequence[str]
    panel: str | None
    flags: dict[str, str]


def fields(place: str, names: str, panel: str | None = None, **flags: str) -> Fields:
    """Return options of a record or a function, such as "cyclic.case:Case", "ambient rig".

    Parameters
    ----------
    place : module and name in the package.
    names : of fields or arguments, with spaces.
    panel : heading in the help.
    flags : words, help and metavar of an option where they are others, with lines between:
        `kind="--type|I or II."`; each may be left out.
    """
    return Fields(place, names.split(), panel, flags)


def command(*made: Fields) -> Callable[[Callable[..., int]], Callable[[], None]]:
    """Make a function a command, for `Lazy`.

    Its argument `given` takes the values of the options of `made` that were given, by name; an
    argument of the type `Ending` those of where the result goes, of `Printed` without a report.
    The others are options written by hand.
    """

    def decorate(function: Callable[..., int]) -> Callable[[], None]:
        def light() -> None:
            """Stand in until the command is used."""

        light.__name__, light.__doc__ = function.__name__, function.__doc__
        light.__dict__["whole"] = lambda: _whole(function, made)
        return light

    return decorate


def add(
    app: typer.Typer, name: str, *examples: str, panel: str | None = None
) -> Callable[[Callable[[], None]], Callable[[], None]]:
    """Add a command to a program, with examples at the end of its help."""
    epilog = "\n\n".join(f"Example: thermobearing {line}" for line in examples)
    return app.command(name, cls=Lazy, rich_help_panel=panel, epilog=epilog)


class Lazy(Command):
    """A command whose options are made when it is used."""

    @cached_property
    def whole(self) -> Any:
        """The command with its options."""
        app = typer.Typer(
            add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False
        )
        whole = self.callback.whole()  # type: ignore[union-attr]
        app.command(self.name, cls=Command, epilog=self.epilog)(whole)
        return typer.main.get_command(app)

    def make_context(self, info_name: Any, args: Any, parent: Any = None, **extra: Any) -> Any:
        """Parse the words of the whole command."""
        return self.whole.make_context(info_name, args, parent, **extra)


def _whole(function: Callable[..., int], made: Sequence[Fields]) -> Callable[..., None]:
    """Return the function with all options as its arguments."""
    options = {name: kind for each in made for name, kind in _made(each)}
    own = inspect.signature(function).parameters
    ends = {name: one.annotation for name, one in own.items() if _is_ending(one.annotation)}
    kinds: dict[str, Any] = {}
    defaults: dict[str, Any] = {}
    for name, one in own.items():
        if name == "given":
            kinds |= options
        elif name in ends:
            kinds |= RESULT_OPTIONS | (REPORT_OPTIONS if ends[name] is Ending else {})
        else:
            kinds[name] = one.annotation
            if one.default is not inspect.Parameter.empty:
                defaults[name] = one.default

    @reported
    @functools.wraps(function)
    def call(**words: Any) -> int:
        given = {name: words.pop(name) for name in options}
        if "given" in own:
            words["given"] = {
                name: value
                for name, value in given.items()
                if value is not None and value != [] and (value is not False or _two(options[name]))
            }
        for name, kind in ends.items():
            asked = {key: words.pop(key) for key in RESULT_OPTIONS}
            if kind is Ending:
                report = {key: words.pop(key) for key in REPORT_OPTIONS}
                asked["documents"] = Documents(
                    **{key: value for key, value in report.items() if value},
                    case=words.get("case"),
                )
                asked["documents"].check()
            words[name] = kind(**asked)
        return function(**words)

    call.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                annotation=kind,
                default=defaults[name] if name in defaults else _usual(kind),
            )
            for name, kind in kinds.items()
        ]
    )
    call.__annotations__ = dict(kinds)
    del call.__wrapped__  # type: ignore[attr-defined]
    return call


def _is_ending(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, Printed)


def _usual(kind: Any) -> Any:
    """Return the value of an option that is not given: none, false, or no value, if it must be."""
    if get_args(kind)[0] is bool:
        return False
    return None if _two(kind) else inspect.Parameter.empty


def _two(kind: Any) -> bool:
    """Whether an option may have no value; of a switch, whether it can be switched off."""
    return types.NoneType in get_args(get_args(kind)[0])


def _made(each: Fields) -> Iterator[tuple[str, Any]]:
    """Yield the options of a record or a function as annotations for typer."""
    module, _, name = each.place.partition(":")
    item = getattr(import_module(f"thermobearing.{module}"), name)
    hints = get_type_hints(item, include_extras=True)
    for key in each.names:
        kind, several, choices, named = _type_of(hints[key])
        flag = "--" + key.replace("_", "-")
        words, said, called, *_ = (*each.flags.get(key, "").split("|"), "", "")
        flags = words.split() or [flag]
        default = _default(item, key)
        value: Any = kind if default is inspect.Parameter.empty else kind | None
        if kind is bool and default is True:
            flags = [f"{flag}/--no-{flag[2:]}"]
        elif kind is bool:
            value = bool
        text = said or _help_of(item, key, choices, default)
        if several:
            value = list[kind] | None  # type: ignore[valid-type]
            text = text if said else f"{text} May be repeated."
        metavar = called or ("NAME/FILE" if named and not choices else None)
        yield key, Annotated[value, option(*flags, help=text, panel=each.panel, metavar=metavar)]


PLAIN = {str, int, float, bool, types.NoneType}


def _type_of(hint: Any) -> tuple[Any, bool, list[str], bool]:
    """Return type of one value, whether there may be several, choices, whether it is a name."""
    leaves: set[Any] = set()
    choices: list[str] = []
    several = False

    def walk(part: Any) -> None:
        nonlocal several
        origin = get_origin(part)
        if origin is Literal:
            choices.extend(str(value) for value in get_args(part))
        elif origin is Annotated:
            walk(get_args(part)[0])
        elif origin is not None:
            several = several or (
                isinstance(origin, type) and issubclass(origin, Sequence | Mapping)
            )
            for inner in get_args(part):
                walk(inner)
        elif isinstance(part, type):
            leaves.add(part)

    walk(hint)
    text = str in leaves or bool(choices)
    kind = next((one for one in (float, int, bool) if one in leaves and not text), str)
    return kind, several, choices, kind is str and bool(leaves - PLAIN)


def _default(item: Any, name: str) -> Any:
    """Return the default of a field or an argument; empty for an argument without one."""
    if hasattr(item, "model_fields"):
        return (
            item.model_fields[name].get_default()
            if not item.model_fields[name].is_required()
            else None
        )
    return inspect.signature(item).parameters[name].default


ENTRY = r"^ *(?:[\w, *]+, )?{}(?:, [\w, *]+)? :(.*(?:\n(?!(?: *[\w, *]+ :| *\n)).*)*)"


TYPE = re.compile(r" (str|int|float|bool|mapping|sequence|list|dict|Path|array|[A-Z]\w+)\b[^.;]*$")


def _help_of(item: Any, name: str, choices: Sequence[str] = (), default: Any = None) -> str:
    """Return what the docstring of a record or a function says of a field or an argument.

    Choices, unit and default are added where the sentence does not have them.

    Examples
    --------
    >>> from thermobearing.cyclic.protocol import CyclicTest
    >>> _help_of(CyclicTest, "dt", default=0.005)
    'Largest time step while the bearing moves [s], in [1e-6, 10]; 0.005 by default.'
    """
    texts = (inspect.getdoc(one) or "" for one in getattr(item, "__mro__", [item]))
    found = next(
        filter(None, (re.search(ENTRY.format(name), t, re.MULTILINE) for t in texts)), None
    )
    first, _, rest = found[1].partition("\n") if found else (name.replace("_", " "), "", "")
    said = rest if rest and TYPE.match(first) else f"{first} {rest}"
    text = " ".join(said.split()).rstrip(".")
    unit = None
    if hasattr(item, "model_fields"):
        from thermobearing.border.schema import find_unit

        unit = find_unit(item, name)
    if unit and "[" not in text:
        text += f" [{unit}]"
    if choices and not all(f'"{choice}"' in text for choice in choices):
        text += f": {', '.join(choices[:-1])} or {choices[-1]}"
    usual = isinstance(default, int | float | str) and not isinstance(default, bool)
    if usual and default != "" and "default" not in text:
        text += f"; {default} by default"
    return text[:1].upper() + text[1:] + "."
