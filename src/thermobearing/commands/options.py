"""Commands made of functions: options from the fields of records and the arguments of functions.

A name, a type, a unit and a sentence are written once, where the record or the function is defined;
`fields` names them, and help shows them. So that help is quick, it reads them from `options.json`,
which `descriptions.py` generates and a test compares.
"""

import contextlib
import functools
import inspect
import json
import types
from collections.abc import Callable, Iterator, Sequence
from functools import cache, cached_property
from pathlib import Path
from typing import Annotated, Any, NamedTuple, get_args

import typer

from thermobearing.border.errors import InputError, nearest
from thermobearing.commands.common import (
    MODEL,
    REPORT,
    RESULT,
    RUNNING,
    UNIT,
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
        help="Entry of the title block of the report: project, structure, client, author, checked, "
        "approved, number, date, revision or logo (an image file). May be repeated.",
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


def exposure_table(words: Sequence[str] | None) -> dict[str, Any] | None:
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
    shared: str = ""  # the option that takes all of them, each as KEY=VALUE


COMMAND_FIELDS: list[Fields] = []  # of all commands, for the descriptions


def fields(place: str, names: str, panel: str | None = None, **flags: str) -> Fields:
    """Return options of a record or a function, such as "cyclic.case:Case", "ambient rig".

    `place`: module and name in the package; `names`: of fields or arguments, with spaces; `panel`:
    heading in the help; `flags`: words, help and metavar of an option where they differ, with lines
    between: `temperatures="--temperature|Ambient temperature [degC]."`; each may be left out.
    """
    return Fields(place, names, panel, flags)


def pairs(shared: str, place: str, names: str, panel: str | None = None, help: str = "") -> Fields:
    """Return one option that takes fields of a record, each as KEY=VALUE, and may be repeated.

    `help` says what they are; the keys with their choices follow it.
    """
    return Fields(place, names, panel, {"help": help}, shared)


MODEL_OPTIONS = pairs(
    "--model-option",
    "model.options:ModelOptions",
    "scheme integrator hardening small_loops heat_source lead_ends clock stack upper_face "
    "lower_face side",
    MODEL,
    "Option of the model, such as scheme=published",
)


def command(
    app: typer.Typer,
    name: str,
    *groups: Fields,
    examples: str = "",
    panel: str | None = None,
    laws: bool = False,
    twin: str = "",
) -> Callable[[Callable[..., Answer]], Callable[..., Answer]]:
    """Add a function to a program as a command, with examples (one a line) at the end of its help.

    Its argument `options` takes the values of the options of `groups` that were given, by name; an
    argument of the type `Ending` those of where the result goes, of `Printed` without a report, of
    `Drawn` those of figures alone.
    The others are options written by hand. `laws` adds the option --law; `twin` is another name of
    the command. What the function returns
    is printed with --json; its "exit_status" is that of the command.
    """
    COMMAND_FIELDS.extend(groups)

    def _decorate(function: Callable[..., Answer]) -> Callable[..., Answer]:
        def _light() -> None:
            """Stand in until the command is used."""

        _light.__doc__ = function.__doc__
        _light.__dict__["make"] = lambda: _with_options(function, groups, laws=laws)
        for word in (name, twin) if twin else (name,):
            lines = [line.replace(name, word, 1) for line in examples.splitlines()]
            app.command(
                word,
                cls=_Lazy,
                help=None if word == name else f"The same command as `{name}`.",
                rich_help_panel=panel,
                epilog="\n\n".join(f"Example: thermobearing {line}" for line in lines),
            )(_light)
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


def _with_options(
    function: Callable[..., Answer], groups: Sequence[Fields], *, laws: bool
) -> Callable[..., None]:
    """Return the function with all options as its arguments."""
    options = {name: kind for group in groups for name, kind in _options_from(group)}
    parameters = inspect.signature(function).parameters
    kinds: dict[str, Any] = {}
    ends: dict[str, tuple[type[Drawn], list[str]]] = {}
    for name, parameter in parameters.items():
        kind = parameter.annotation
        if name == "options":
            kinds |= options
        elif isinstance(kind, type) and issubclass(kind, Drawn):
            all_options = RESULT_OPTIONS | REPORT_OPTIONS
            end_options = {key: all_options[key] for key in all_options if hasattr(kind, key)}
            ends[name] = (kind, list(end_options))
            kinds |= end_options
        else:
            kinds[name] = kind
    kinds |= {"law": LAW} if laws else {}
    kinds["as_json"] = AsJson

    @reported
    @functools.wraps(function)
    def _call(**words: Any) -> Answer:
        values = {name: words.pop(name) for name in options}
        if "options" in parameters:
            words["options"] = _values_of_options(values, options, groups)
        for name, (kind, keys) in ends.items():
            end_options = {key: words.pop(key) for key in keys}
            if kind is Ending:
                end_options["case"] = words.get("case")
            words[name] = kind(**end_options)
        files = words.pop("law", None)
        if not files:
            return function(**words)
        from thermobearing.laws import applied

        with applied(files):
            return function(**words)

    def _default_value(name: str) -> Any:
        """Return the default of the function, else that of the type of the option."""
        default = parameters[name].default if name in parameters else inspect.Parameter.empty
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


def _values_of_options(
    values: dict[str, Any], options: dict[str, Any], groups: Sequence[Fields]
) -> dict[str, Any]:
    """Return the values of the options that were given, those of shared options by field."""
    chosen = {
        name: value
        for name, value in values.items()
        if value is not None and value != [] and (value is not False or _two(options[name]))
    }
    for group in groups:
        if group.shared:
            chosen |= _values_of_pairs(group, chosen.pop(_argument(group.shared), None))
    return chosen


def _usual(kind: Any) -> Any:
    """Return the value of an option that is not given: none, false, or no value, if it must be."""
    if get_args(kind)[0] is bool:
        return False
    return None if _two(kind) else inspect.Parameter.empty


def _two(kind: Any) -> bool:
    """Return whether an option may have no value; of a switch, whether it can be switched off."""
    return types.NoneType in get_args(get_args(kind)[0])


def _options_from(group: Fields) -> Iterator[tuple[str, Any]]:
    """Yield the options of a record or a function as annotations for typer."""
    if group.shared:
        yield _argument(group.shared), _shared_option(group)
        return
    for key in group.names.split():
        described = _described(group.place, key)
        kind = KINDS[described["kind"]]
        flag = "--" + key.replace("_", "-")
        words, text, metavar_text, *_ = (*group.flags.get(key, "").split("|"), "", "")
        flags = words.split() or [flag]
        value: Any = kind if described.get("required") else kind | None
        if described.get("switched_on"):
            flags = [f"{flag}/--no-{flag[2:]}"]
        elif kind is bool:
            value = bool
        text = text or described["text"]
        if described.get("several"):
            value = list[kind] | None  # type: ignore[valid-type]
            text = f"{text} May be repeated."
        metavar = metavar_text or ("NAME/FILE" if described.get("named") else None)
        yield key, Annotated[value, option(*flags, help=text, panel=group.panel, metavar=metavar)]


def _argument(flag: str) -> str:
    """Return the name of the argument of an option."""
    return flag.removeprefix("--").replace("-", "_")


def _shared_option(group: Fields) -> Any:
    """Return the option that takes several fields as KEY=VALUE, as an annotation for typer."""
    keys = []
    for name in group.names.split():
        described = _described(group.place, name)
        if "entries" in described:
            keys += [f"{name}.{entry}" for entry in described["entries"]]
        elif "choices" in described:
            keys.append(f"{name}={'|'.join(described['choices'])}")
        else:
            unit = UNIT.search(described["text"])
            keys.append(f"{name} {unit[0]}" if unit else name)
    text = f"{group.flags['help']}: {', '.join(keys)}. May be repeated."
    return Annotated[
        list[str] | None, option(group.shared, help=text, panel=group.panel, metavar="KEY=VALUE")
    ]


def _values_of_pairs(group: Fields, words: Sequence[str] | None) -> dict[str, Any]:
    """Return the values of a shared option by field, those of entries ("side.film") as tables.

    A number is converted; any other text is for the record, which takes "10 ms" too.
    """
    values: dict[str, Any] = {}
    keys: set[str] = set()
    for word in words or ():
        key, mark, text = (part.strip() for part in word.partition("="))
        name, _, entry = key.partition(".")
        if name not in group.names.split():
            unknown = f'{group.shared} "{word}": unknown key "{name}"'
            raise InputError(f"{unknown}{nearest(name, group.names.split())}")
        described = _described(group.place, name)
        if not mark or key in keys or bool(entry) != ("entries" in described):
            entries = described.get("entries")
            form = f"{name}.{entries[0]}=VALUE" if entries else f"{name}=VALUE"
            raise InputError(f'{group.shared} "{word}": give each key once, as {form}')
        keys.add(key)
        kind = float if entry else KINDS[described["kind"]]
        value: Any = text
        with contextlib.suppress(ValueError):
            value = kind(text)
        if entry:
            values.setdefault(name, {})[entry] = value
        else:
            values[name] = value
    running = RUNNING.get()
    if running is not None:  # messages name the option with the key
        running |= {name: (f"{group.shared} {name}", name in keys) for name in group.names.split()}
        running |= {key: (f"{group.shared} {key}", True) for key in keys}
    return values


KINDS: dict[str, Any] = {kind.__name__: kind for kind in (str, int, float, bool)}
# What `descriptions.py` makes of the records and functions. Importing these for a help text would
# take several times as long as printing it.
DESCRIPTIONS = Path(__file__).with_name("options.json")


@cache
def _stored_descriptions() -> dict[str, dict[str, Any]]:
    """Return the generated descriptions of all options, by place and name."""
    stored: dict[str, dict[str, Any]] = json.loads(DESCRIPTIONS.read_text(encoding="utf-8"))
    return stored


def _described(place: str, key: str) -> Any:
    """Return the description of an option; of one that is not stored yet, from its definition."""
    stored = _stored_descriptions().get(place, {})
    if key in stored:
        return stored[key]
    from thermobearing.commands.descriptions import describe

    return describe(place, key)
