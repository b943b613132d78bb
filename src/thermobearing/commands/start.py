"""Ask four questions, write a case, and print the commands that lead to a first result."""

import math
import os
import shlex
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import FILES, Answer, app, echo_written
from thermobearing.commands.options import Overwrite, command, option

BEARING, AMBIENT, MOTION = "shen-hdr-bridge", "-20", "jra-ii-i-1"  # where nothing is answered
WARM = 23.0  # the usual temperature of laboratories, with which the cold is compared [degC]
COMMENTS = {  # on the line above a key of the case
    "command": "Other keys: docs/files/bridge.md; `thermobearing check` reads this file.",
    "structure": "A name of `thermobearing list`, or a TOML file of yours.",
    "bearings": "Names of `thermobearing list`, or TOML files of yours.",
    "bearing": "A name of `thermobearing list`, or a TOML file of yours.",
    "motions": "Names of `thermobearing list`, or files of records.",
    "ambient": "A run each: the warmth of a laboratory, and the cold of the site.",
    "[test]": "Other keys: docs/files/case.md; `thermobearing check` reads this file.",
    "steps": "Strain: displacement over the thickness of all rubber. The largest rate of a sine is "
    "2 pi strain times frequency; results warn where it exceeds that of the bearing's tests.",
}
QUESTIONS = {
    "bearing": "Bearing: a name of `thermobearing list`, or your TOML file",
    "tests": "Files of laboratory tests of it, with spaces between; empty: none",
    "bridge": "Bridge: a structure of `thermobearing list`, or your TOML file; empty: none",
    "ambient": "Cold of the site: degC, a climate such as cold-town, or a file of hourly weather",
}


@command(
    app,
    "start",
    examples="start\nstart --bridge pier-p1 --ambient -20 -o winter.toml",
    panel=FILES,
)
def _start(
    bearing: Annotated[
        str | None,
        option(
            "--bearing", help=f"{QUESTIONS['bearing']}. {BEARING} by default.", metavar="NAME/FILE"
        ),
    ],
    tests: Annotated[
        list[str] | None,
        option("--tests", help="File of a laboratory test of it. May be repeated.", metavar="FILE"),
    ],
    bridge: Annotated[
        str | None, option("--bridge", help=f"{QUESTIONS['bridge']}.", metavar="NAME/FILE")
    ],
    ambient: Annotated[
        str | None,
        option("--ambient", help=f"{QUESTIONS['ambient']}. {AMBIENT} by default.", metavar="COLD"),
    ],
    output: Annotated[
        Path | None, option("-o", "--output", help="Case file to write; case.toml by default.")
    ],
    overwrite: Overwrite,
    quiet: Annotated[bool, option("-q", "--quiet", help="Print the next commands only.")],
) -> Answer:
    """Write a first case from four answers, and print the commands to run next.

    Questions whose option is not given are asked at a terminal; elsewhere they have their defaults.
    The case compares the cold of the site with 23 degC.
    """
    from thermobearing.border.text_file import check_file, write_file

    target = output or Path("case.toml")
    check_file(target, overwrite=overwrite)
    bearing = bearing or _answer("bearing", BEARING)
    _check_bearing(bearing)
    records = tests if tests else _split(_answer("tests", ""))
    if missing := [name for name in records if not os.path.isfile(name)]:
        raise InputError(f"tests = {missing[0]}: there is no such file")
    bridge = bridge if bridge is not None else _answer("bridge", "")
    cold = _find_cold(ambient or _answer("ambient", AMBIENT))
    text = _case_text(bearing, bridge, cold, target)
    write_file(target, text, overwrite=overwrite)
    commands = _next_commands(bearing, records, bridge, target)
    if not quiet:
        echo_written(target)
        typer.echo("next:")
    for line in commands:
        typer.echo(line if quiet else f"  {line}")
    return {"outcome": "completed", "output": str(target), "ambient": cold, "next": commands}


def _answer(question: str, default: str) -> str:
    """Return the answer to a question, at a terminal; elsewhere its default."""
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        return default
    try:
        return str(typer.prompt(QUESTIONS[question], default=default, show_default=bool(default)))
    except typer.Abort:  # Ctrl-C, or the end of the input
        raise KeyboardInterrupt from None


def _split(text: str) -> list[str]:
    """Return names of files as a shell separates them: those with spaces are quoted."""
    try:
        return shlex.split(text)
    except ValueError as error:
        raise InputError(f"tests = {text}: {error}; quote names with spaces") from None


def _check_bearing(bearing: str) -> None:
    """Refuse a bearing that is neither in the library nor a file, with the way to make one."""
    from thermobearing.bearing.bilinear import load_device
    from thermobearing.bearing.compound import COMPOUNDS

    try:
        load_device(bearing)
    except InputError as error:
        is_compound = bearing in COMPOUNDS.names()
        if not is_compound and (not bearing.endswith(".toml") or os.path.exists(bearing)):
            raise
        name, compound = Path(bearing).stem, "natural-rubber"
        if is_compound:
            name, compound = f"my-{bearing}", bearing
        advice = (
            f"thermobearing new {name} --compound {compound} --plan 1000x1000mm "
            "--layers 20x8mm --shim 3mm"
        )
        raise InputError(f"{error}; derive a bearing with its sizes first: {advice}") from None


def _find_cold(text: str) -> float:
    """Return the cold of a site [degC]: a number, or that of a climate or of hourly weather."""
    from thermobearing.bearing.ambient import check_temperature
    from thermobearing.climate.site import find_cold

    number = text.removesuffix("degC").strip()
    try:
        value = float(number)
    except ValueError:
        return float(math.floor(find_cold(text).design_temperature))
    return check_temperature(value, "ambient")


def _case_text(bearing: str, bridge: str, cold: float, target: Path) -> str:
    """Return the text of a valid case; paths are relative to its folder."""
    import tomli_w

    from thermobearing.cyclic.case import make_case
    from thermobearing.earthquake.case import make_earthquake_case

    folder = target.parent
    ambient = [f"{value:g} degC" for value in dict.fromkeys((WARM, cold))]
    table: dict[str, Any]
    if bridge:
        table = {"command": "bridge", "structure": _from_folder(bridge, folder)}
        table |= {"bearings": [_from_folder(bearing, folder)], "motions": [MOTION]}
        table["ambient"] = ambient
        make_earthquake_case(table, str(target), folder)
    else:
        table = {"bearing": _from_folder(bearing, folder), "ambient": ambient}
        table["test"] = {"name": "first test", "steps": [_first_cycles()]}
        make_case(table, str(target), folder)
    return _with_comments(tomli_w.dumps(table))


def _first_cycles() -> dict[str, Any]:
    """Return the cycles that the live page opens with: inside the rates of the library's tests."""
    from thermobearing.live.page import OPENING

    cycles: dict[str, Any] = {"step": "cycles", "strain": OPENING["strain"], "wave": "sine"}
    return cycles | {"frequency": f"{OPENING['frequency']:g} Hz", "count": OPENING["count"]}


def _with_comments(text: str) -> str:
    """Return the text of a case with a comment above the lines that have one."""
    lines = []
    for line in text.splitlines():
        if comment := COMMENTS.get(line.split(" = ")[0]):
            lines.append(f"# {comment}")
        lines.append(line)
    return "\n".join(lines) + "\n"


def _from_folder(name: str, folder: Path) -> str:
    """Return a name of the library, or the path of a file as seen from a folder."""
    if not os.path.isfile(name):
        return name
    return Path(os.path.relpath(name, folder)).as_posix()


def _next_commands(bearing: str, records: list[str], bridge: str, target: Path) -> list[str]:
    """Return the commands that lead from the answers to a result."""
    program = "thermobearing"
    commands = []
    run = [program, "bridge" if bridge else "cyclic", str(target)]
    if records:
        commands += [
            [
                program,
                "intake",
                *records,
                "--bearing",
                bearing,
                "--write-sidecars",
                "-o",
                "inspected",
            ],
            [program, "identify", *records, "--bearing", bearing, "-o", "fit"],
        ]
        run += ["--bearing", "fit/bearing.toml"]
    commands.append([*run, "-o", "first"])
    if bridge:
        commands.append([program, "report", "first"])
    return [shlex.join(words) for words in commands]
