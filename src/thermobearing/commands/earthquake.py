"""Analyse structures on bearings in earthquakes."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.border.opener import is_file
from thermobearing.commands.common import (
    ANALYSES,
    FILES,
    INPUT,
    MODEL,
    STRUCTURES,
    Answer,
    Ending,
    Group,
    Printed,
    app,
    echo_written,
    with_progress,
)
from thermobearing.commands.options import (
    EXPOSURE,
    MODEL_OPTIONS,
    Fields,
    Overwrite,
    command,
    exposure_table,
    fields,
    option,
    pairs,
)

if TYPE_CHECKING:
    from thermobearing.opensees.case import ServedCase
    from thermobearing.opensees.recording import Served

LABORATORY = "Laboratory"
CaseFile = Annotated[
    Path | None, typer.Argument(help="Case file; without one, the default analysis is run.")
]
VERTICAL = Annotated[
    int | None,
    option(
        "--vertical", help="Vertical degree of freedom (1, 2 or 3) of nodes with six.", panel=INPUT
    ),
]
FIXED_BASE = Annotated[
    bool, option("--fixed-base", help="Omit the foundation springs.", panel=INPUT)
]
ACROSS = Annotated[
    list[str] | None,
    option(
        "--across",
        help="Second record of a pair, perpendicular to that of --motion; one for each motion, in "
        "order.",
        metavar="NAME/FILE",
        panel=INPUT,
    ),
]
ANGLE = Annotated[
    list[str] | None,
    option(
        "--angle",
        help='Angle from the axis of the bridge to the first record, with its unit: "30 deg". May '
        "be repeated.",
        panel=INPUT,
    ),
]
COMPONENTS = Annotated[
    list[int] | None,
    option(
        "--components",
        help="Number of horizontal components of the ground motion that act together on a "
        "structure in plan, 1 or 2 (default). Give both to compare them.",
        panel=INPUT,
    ),
]
INPUTS = fields(
    "earthquake.case:EarthquakeCase",
    "bearings motions ambient weather structure duration rig axial_force",
    INPUT,
    bearings="--bearing|Bearing: library name or TOML file.",
    motions="--motion|Ground motion: library name or file.",
)
FURTHER = fields("earthquake.case:FurtherAnalyses", "compare bands", MODEL)
PAIRS = fields("earthquake.motions:Motion", "resample", INPUT)
ANALYSIS = fields(
    "earthquake.case:EarthquakeAnalysis",
    "method mass damping dt model state keep_every",
    MODEL,
)


def _with_pairs(
    options: dict[str, Any],
    across: Sequence[str] | None,
    angles: Sequence[str] | None,
    case: Path | None,
) -> list[Any] | None:
    """Return the motions of the command line, as tables where they are pairs or have angles."""
    motions, resample = options.get("motions"), bool(options.pop("resample", False))
    if not across and not angles and not resample:
        return list(motions) if motions else None
    if not motions:
        raise InputError(
            "--across, --angle, --resample: give the first record of each pair with --motion"
            + (f", or write these keys in the motions that {case} states" if case else "")
        )
    if across and len(across) != len(motions):
        raise InputError(
            f"--across: {len(across)} records for {len(motions)} motions; give one for each"
        )
    tables: list[dict[str, Any]] = [{"name": name} for name in motions]
    for table, second in zip(tables, across or (), strict=False):
        table["across"] = second
    settings = ({"angle": list(angles)} if angles else {}) | (
        {"resample": True} if resample else {}
    )
    return [table | settings for table in tables]


def _add(name: str, purpose: str, *groups: Fields, examples: str) -> None:
    """Add the command of an analysis, with its specific options and those of both."""

    def _analyse(
        case: CaseFile,
        options: dict[str, Any],
        across: ACROSS,
        angle: ANGLE,
        components: COMPONENTS,
        fixed_base: FIXED_BASE,
        exposure: EXPOSURE,
        end: Ending,
    ) -> Answer:
        from thermobearing.border.schema import overridden
        from thermobearing.earthquake import analysis
        from thermobearing.earthquake.case import (
            Laboratory,
            load_earthquake_case,
            make_earthquake_case,
        )

        laboratory = {key: options.pop(key) for key in Laboratory.model_fields if key in options}
        options["laboratory"] = overridden({}, laboratory, Laboratory) or None
        options["motions"] = _with_pairs(options, across, angle, case)
        options |= analysis.one_or_both(components)
        options |= {"fixed_base": fixed_base or None, "exposure": exposure_table(exposure)}
        if case is None:
            loaded = make_earthquake_case({"command": name}, "command line", **options)
        else:
            loaded = load_earthquake_case(case, command=name, **options)
        target = end.target(f"{loaded.command}-{loaded.structure.name}")
        predicted = loaded.analysis.method == "predictor-corrector"
        result = with_progress(
            lambda show: analysis.analyse(loaded, progress=show),
            "runs",
            end.quiet,
            "structure.predictor.predictor_march" if predicted else STRUCTURES,
        )
        if loaded.checked_codes is not None:
            from thermobearing.design.provisions import check_bearings

            result = check_bearings(result, loaded.checked_codes)
        return end.save(result, target)

    _analyse.__doc__ = purpose
    groups_of_options = (*groups, INPUTS, PAIRS, ANALYSIS, MODEL_OPTIONS, FURTHER)
    command(app, name, *groups_of_options, examples=examples, panel=ANALYSES, laws=True)(_analyse)


_add(
    "bridge",
    "Analyse a structure on isolation bearings in earthquakes, at several temperatures.",
    fields(
        "earthquake.case:EarthquakeCase",
        "codes rotation zone limits",
        "Checks",
        limits="||FILE",
    ),
    examples="bridge --motion jra-ii-i-1 --ambient -20 -o pier\n"
    "bridge --axial-force 800 --codes jra --codes aashto -o checked\n"
    "bridge --axial-force 800 --limits limits.toml -o checked",
)
_add(
    "hybrid",
    "Simulate a hybrid test: a bearing specimen coupled to a calculated pier.",
    fields("earthquake.case:Laboratory", "mode specimen", LABORATORY),
    pairs(
        "--laboratory",
        "earthquake.case:Laboratory",
        "speed delay force_noise seed compensation time_out force_limit displacement_limit",
        LABORATORY,
        'Option of the laboratory, such as delay=0.01 or "delay=10 ms"',
    ),
    examples="hybrid --mode rt --mode pd --ambient -20 -o hybrid",
)


def _show_message(text: str) -> None:
    typer.echo(f"thermobearing: {text}", err=True)


def _save_after_kill(
    case: "ServedCase", target: Path, end: Ending, histories: "list[Served]"
) -> None:
    """Write the result of a server that was killed, which its keeper calls."""
    from thermobearing.opensees.result import ServedResult

    if histories:
        result = ServedResult.of(case, histories, ["the server was killed"])
        result.save(target, overwrite=end.overwrite, figures=end.figures)
        _show_message(f"the server was killed; its histories until then are in {target}")


@command(
    app,
    "serve",
    fields(
        "opensees.case:ServedCase",
        "ambient initial count units axial joint dowel_length rate",
        INPUT,
    ),
    fields("model.options:ModelOptions", "model state", MODEL),
    MODEL_OPTIONS,
    examples="serve shen-hdr-bridge --ambient -20 --port 4711 --units kN-m -o served",
    panel=ANALYSES,
    laws=True,
)
def _serve(
    bearing: Annotated[
        str,
        typer.Argument(
            help="Bearing (library name or TOML file), or case file.", metavar="NAME/FILE"
        ),
    ],
    options: dict[str, Any],
    port: Annotated[
        int, option("--port", help="TCP port to listen on; 0 selects a free one.", panel=INPUT)
    ],
    address: Annotated[
        str | None,
        option("--address", help="IP address to listen on; 127.0.0.1 by default.", panel=INPUT),
    ],
    direction: Annotated[
        list[int] | None,
        option(
            "--direction",
            help="Degree of freedom in which the bearing shears: 1 (default), 2 or 3. May be "
            "repeated.",
            panel=INPUT,
        ),
    ],
    vertical: VERTICAL,
    pairs: Annotated[
        int | None,
        option("--pairs", help="Pairs of nodes in each element; 1 by default.", panel=INPUT),
    ],
    once: Annotated[
        bool, option("--once", help="Stop when the last element has disconnected.", panel=INPUT)
    ],
    end: Ending,
) -> Answer:
    """Serve a bearing to OpenSees (Tcl, or on another machine) as genericClient elements."""
    from thermobearing.border.toml import read_toml
    from thermobearing.opensees.case import Layout, load_served_case, make_served_case
    from thermobearing.opensees.result import ServedResult
    from thermobearing.opensees.server import LOOPBACK, serve_until

    file = Path(bearing)
    if file.suffix == ".toml" and is_file(file) and read_toml(file).get("command") == "serve":
        case = load_served_case(file, **options)
    else:
        case = make_served_case({}, "command line", bearing=bearing, **options)
    directions = tuple(direction or (1,))
    layout = Layout.of(1 if pairs is None else pairs, directions, vertical, "command line")
    case.check_layout(layout, "command line")
    target = end.target(f"serve-{case.bearing.name}")

    save = partial(_save_after_kill, case, target, end)
    at = address or LOOPBACK
    server = serve_until(case, layout, at, port, once=once, show=_show_message, save=save)
    if not (histories := server.histories()):
        raise InputError("no element was connected; nothing is written", "serve")
    served = ServedResult.of(case, histories, server.problems, server.notes)
    return end.save(served, target)


limits = typer.Typer(
    cls=Group,
    help="Write files of the limits of checks, for your office to confirm.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
)
app.add_typer(limits, name="limits", rich_help_panel=FILES)


@command(limits, "new", examples="limits new --code aashto -o limits.toml")
def _new_limits(
    code: Annotated[
        list[str] | None,
        option(
            "--code", help="Code: jra or aashto; both by default. May be repeated.", metavar="NAME"
        ),
    ],
    output: Annotated[
        Path | None,
        option("-o", "--output", help="File to write; limits.toml by default.", metavar="FILE"),
    ],
    overwrite: Overwrite,
) -> Answer:
    """Write the limits of codes as comments, for your office to confirm and un-comment."""
    from thermobearing.border.text_file import write_file
    from thermobearing.design.provisions import limits_text

    target = output or Path("limits.toml")
    write_file(target, limits_text(code or ["jra", "aashto"]), overwrite=overwrite)
    echo_written(target)
    return {"outcome": "completed", "exit_status": 0, "output": str(target)}


HELP = "List, examine, import and export structures."
structures = typer.Typer(cls=Group, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")
app.add_typer(structures, name="structures", rich_help_panel=FILES)


@command(structures, "list", examples="structures list")
def _list() -> Answer:
    """List the built-in structures."""
    from thermobearing.structure.model import list_structures, load_structure

    names = list_structures()
    width = max(map(len, names)) + 2
    for name in names:
        print(f"{name:{width}}{load_structure(name).description}", flush=True)
    return {"structures": names}


@command(
    structures,
    "show",
    fields(
        "structure.result:examine_structure",
        "mass damping",
    ),
    examples="structures show pier-p1 -o pier",
)
def _show(
    structure: Annotated[
        str, typer.Argument(help="Library name or TOML file.", metavar="NAME/FILE")
    ],
    options: dict[str, Any],
    fixed_base: FIXED_BASE,
    end: Printed,
) -> Answer:
    """Show parts, periods, damping and mode shapes of a structure; with -o also draw it."""
    from thermobearing.structure.result import examine_structure

    end.check()
    result = examine_structure(structure, fixed=fixed_base, **options)
    return end.save_if_asked(result)


@command(
    structures,
    "import",
    examples="structures import pier.csv -o pier",
)
def _import(
    file: Annotated[Path, typer.Argument(help="Table of nodes and members (CSV, .xlsx).")],
    end: Printed,
) -> Answer:
    """Import a plane frame of piers and decks as a structure, and compare the periods of both."""
    from thermobearing.structure.frame_files import import_frame

    end.check()
    return end.save_if_asked(import_frame(file))


@command(
    structures,
    "export",
    fields(
        "opensees.script:write_structure",
        "bearing ambient motion",
        INPUT,
        bearing="|Bearing of all lines: bilinear, or layered, with its bilinear model; by default "
        "springs of the equivalent stiffness.|NAME/FILE",
        ambient="|Temperature of the bilinear model of a layered bearing [degC].",
        motion="|Ground motion that the script analyses: library name or file.|NAME/FILE",
    ),
    examples="structures export pier-p1 --bearing shen-bilinear-bridge -o pier.tcl",
)
def _export(
    structure: Annotated[
        str, typer.Argument(help="Library name or TOML file.", metavar="NAME/FILE")
    ],
    options: dict[str, Any],
    output: Annotated[Path, option("-o", "--output", help="Script, .py or .tcl.", metavar="FILE")],
    overwrite: Overwrite,
) -> Answer:
    """Write a structure on linear or bilinear bearings as an OpenSees script."""
    from thermobearing.opensees.script import write_structure

    remarks = write_structure(structure, output, overwrite=overwrite, **options)
    for remark in remarks:
        typer.echo(f"{remark}.")
    echo_written(output)
    return {"exit_status": 0, "output": str(output), "remarks": remarks}
