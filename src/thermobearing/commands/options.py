"""Messages name a value as the user gave it: a keyword in Python, an option of a command here."""

import re
from contextvars import ContextVar
from typing import Any

FEW_LETTERS = {"dt"}  # no word of a sentence, like those with an underscore

# Options of the command that runs, and whether each was given.
RUNNING: ContextVar[dict[str, bool] | None] = ContextVar("running", default=None)


def options_of(context: Any) -> dict[str, bool]:
    """The long options of a command, and whether the command line gives them.

    Parameters
    ----------
    context : of typer.

    Returns
    -------
    dict
    """
    found: dict[str, bool] = {}
    for parameter in context.command.params:
        source = context.get_parameter_source(parameter.name)
        given = source is not None and source.name == "COMMANDLINE"
        words = [word for word in parameter.opts if word.startswith("--")]
        found |= {word: given for word in words[:1]}
    return found


def as_options(text: str) -> str:
    """A message of the library with the options of the command that runs.

    A key that a value is said of ("test.dt = ...", "ambient[0] = ...") becomes the option that gave
    it, if one did; a keyword in what is to be tried ("a larger dt", "say so with trust_unit") the
    option of that name, if the command has it.

    Parameters
    ----------
    text : as raised; unchanged outside a command.

    Returns
    -------
    str

    Examples
    --------
    >>> before = RUNNING.set({"--dt": True, "--keep-every": False})
    >>> as_options("command line: test.dt = '9 s': must be at most 1 s")
    "command line: --dt = '9 s': must be at most 1 s"
    >>> as_options("case.toml: keep_every = 0: must be at least 1; or a larger dt, keep_every")
    'case.toml: keep_every = 0: must be at least 1; or a larger --dt, --keep-every'
    >>> RUNNING.reset(before)
    """
    options = RUNNING.get() or {}
    for flag, given in options.items():
        key = flag[2:].replace("-", "_")
        if given:  # alone or of a table, one or a list of them
            plural = "" if f"{flag}s" in options else "s?"
            said_of = rf"(?<![\w./-])(?:\w+(?:\[\d+\])?\.)?{key}{plural}(?:\[\d+\])?(?= = |: )"
            text = re.sub(said_of, flag, text)
        if "_" in key or key in FEW_LETTERS:
            text = re.sub(rf"(?<![\w.\"/=-]){key}(?![\w\"/=]| = |: |\.\w)", flag, text)
    return text
