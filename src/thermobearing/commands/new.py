"""`thermobearing new`: a bearing made from a compound and the sizes of a drawing."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import AsJson, echo_json, reported

if TYPE_CHECKING:
    from thermobearing.bearing.model import Bearing

NOT_MEASURED = {"assumed", "borrowed", "chosen"}  # words in sources
WORD = re.compile(r"[a-z]+")
MEASURED = re.compile(r"(?<!not )\bmeasured\b")


Compound = Annotated[
    str,
    typer.Option(
        help='One of "thermobearing list", or the TOML file of a compound or a bearing.',
        metavar="NAME/FILE",
    ),
]
Layers = Annotated[
    str, typer.Option(help="Number and thickness of the rubber layers, such as 20x8mm.")
]
Shim = Annotated[str, typer.Option(help="Thickness of a steel plate between, such as 3mm.")]
Plan = Annotated[
    str | None, typer.Option(help="Length in the direction of motion, and width: 1000x1000mm.")
]
Diameter = Annotated[
    str | None, typer.Option(help="Of a round bearing, such as 700mm, instead of --plan.")
]
EndPlate = Annotated[
    str | None, typer.Option(help="Thickness of an end plate; 30 mm are assumed without it.")
]
Sealing = Annotated[str, typer.Option(help="Thickness of a plate inside each end plate.")]
Lead = Annotated[
    str | None, typer.Option(help="Diameter of a lead core, such as 180mm; none without it.")
]
Confined = Annotated[
    bool, typer.Option("--confined", help="Cores in springs: heat goes to the ends only.")
]
Spreading = Annotated[
    float, typer.Option(help="Of heat into the end plates of confined cores, 0.001 to 1.")
]
File = Annotated[
    Path | None, typer.Option("-o", "--output", help="File to write; NAME.toml by default.")
]


@reported
def new(
    name: Annotated[str, typer.Argument(help="Of the new bearing; its file is NAME.toml.")],
    compound: Compound,
    layers: Layers,
    shim: Shim,
    plan: Plan = None,
    diameter: Diameter = None,
    end_plate: EndPlate = None,
    sealing_plate: Sealing = "0 mm",
    lead: Lead = None,
    cores: Annotated[int, typer.Option(help="Number of lead cores.")] = 1,
    confined: Confined = False,
    end_spreading: Spreading = 1.0,
    output: File = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the file.")] = False,
    as_json: AsJson = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing.")] = False,
) -> int:
    """Make a bearing from a compound and its sizes, and write it as a TOML file."""
    from thermobearing.bearing.library import save_bearing
    from thermobearing.bearing.new import new_bearing
    from thermobearing.bearing.plausible import implausible
    from thermobearing.commands.check import bearing_facts
    from thermobearing.results.screen import print_facts, print_warnings

    made = new_bearing(
        name,
        compound,
        plan=plan,
        diameter=diameter,
        layers=layers,
        shim=shim,
        end_plate=end_plate,
        sealing_plate=sealing_plate,
        lead=lead,
        cores=cores,
        confined=confined,
        end_spreading=end_spreading,
    )
    target = output or Path(f"{name}.toml")
    save_bearing(made, target, overwrite=overwrite)
    if not quiet:
        facts = bearing_facts(made)
        if end_plate is None:
            facts["end plates"] += ", assumed: give --end-plate"
        facts |= _told(not_measured(made))
        print_facts(f"{target}: a new bearing", facts)
        print_warnings(implausible(made))
        typer.echo(f"written: {printable(str(target))}")
    if as_json:
        told = {"outcome": "completed", "exit_status": 0, "output": str(target)}
        echo_json(told | {"not_measured": not_measured(made)})
    return 0


def not_measured(made: "Bearing") -> dict[str, str]:
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


def _told(unmeasured: dict[str, str]) -> dict[str, str]:
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
