"""`thermobearing new`: a bearing made from a compound and the sizes of a drawing."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import echo_json
from thermobearing.commands.options import AsJson, Overwrite, command, fields, option

if TYPE_CHECKING:
    from thermobearing.bearing.model import Bearing

NOT_MEASURED = {"assumed", "borrowed", "chosen"}  # words in sources
WORD = re.compile(r"[a-z]+")
MEASURED = re.compile(r"(?<!not )\bmeasured\b")


@command(
    fields(
        "bearing.new:new_bearing",
        "compound layers shim plan diameter end_plate sealing_plate lead cores confined "
        "end_spreading",
    )
)
def new(
    name: Annotated[str, typer.Argument(help="Name of the new bearing; its file is NAME.toml.")],
    given: dict[str, Any],
    output: Annotated[
        Path | None, option("-o", "--output", help="File to write; NAME.toml by default.")
    ],
    overwrite: Overwrite,
    as_json: AsJson,
    quiet: Annotated[bool, option("-q", "--quiet", help="Print nothing.")],
) -> int:
    """Make a bearing from a compound and its sizes, and write it as a TOML file."""
    from thermobearing.bearing.library import save_bearing
    from thermobearing.bearing.new import new_bearing
    from thermobearing.bearing.plausible import implausible
    from thermobearing.commands.check import bearing_facts
    from thermobearing.results.screen import print_facts, print_warnings

    made = new_bearing(name, **given)
    target = output or Path(f"{name}.toml")
    save_bearing(made, target, overwrite=overwrite)
    if not quiet:
        facts = bearing_facts(made)
        if "end_plate" not in given:
            facts["end plates"] += ", assumed: give --end-plate"
        facts |= _shown(_not_measured(made))
        print_facts(f"{target}: a new bearing", facts)
        print_warnings(implausible(made))
        typer.echo(f"written: {printable(str(target))}")
    if as_json:
        last = {"outcome": "completed", "exit_status": 0, "output": str(target)}
        echo_json(last | {"not_measured": _not_measured(made)})
    return 0


def _not_measured(made: "Bearing") -> dict[str, str]:
    """Numbers that nobody measured on this rubber, by dotted key, and where they come from.

    Those that were chosen, assumed or borrowed, and the thermal constants that the compound's
    record says nothing of having been measured: a fit of a specimen leaves them as they were.
    """
    found = {}
    for key, text in made.sources.items():
        thermal = key.startswith("materials.") and not MEASURED.search(text)
        if thermal or NOT_MEASURED & set(WORD.findall(text)):
            found[key] = text
    return found


def _shown(unmeasured: dict[str, str]) -> dict[str, str]:
    """The same for the screen: a row for each place that numbers come from."""
    by_source: dict[str, list[str]] = {}
    for key, text in unmeasured.items():
        by_source.setdefault(text, []).append(key)
    rows = [f"{_listed(keys)}: {text}" for text, keys in by_source.items()]
    return {"not measured": "\n".join(rows)} if rows else {}


def _listed(keys: list[str]) -> str:
    """Keys, what they begin with said once: "materials.rubber.density, specific_heat"."""
    shown, before = [], ""
    for key in keys:
        table, _, name = key.rpartition(".")
        shown.append(name if table == before else key)
        before = table
    return ", ".join(shown)
