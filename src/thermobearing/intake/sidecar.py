"""The sidecar of a file as TOML: what was found, and beside it what may be corrected."""

import os
from pathlib import Path
from typing import Any

import tomli_w

from thermobearing.border.errors import printable
from thermobearing.intake.result import Intake


def sidecar_text(found: Intake, folder: Path) -> str:
    """TOML that `load_test` reads, with comments on what to look at.

    Parameters
    ----------
    found : from `take_in`.
    folder : where it will stand; files are named as seen from there.

    Returns
    -------
    str
    """
    keys = {key: value for key, value in found.sidecar.items() if not isinstance(value, dict)}
    tables = {key: value for key, value in found.sidecar.items() if isinstance(value, dict)}
    if "file" in keys:
        keys["file"] = _seen_from(folder, found.folder / keys["file"])
    if "blocks" in keys:
        keys["blocks"] = [
            block | {"file": _seen_from(folder, found.folder / block["file"])}
            for block in keys["blocks"]
        ]
    lines = [f"# {found.file.name}, as thermobearing intake found it; correct it and keep it."]
    lines += [f"# {finding.level}: {finding.sentence}" for finding in found.report.findings]
    lines += [tomli_w.dumps(keys).strip(), *_suggested(found)]
    for name, table in tables.items():
        lines += ["", *_comments(name, found), tomli_w.dumps({name: table}).strip()]
    lines += _places(found, "thermocouples" in tables)
    return "\n".join(printable(line) if line.startswith("#") else line for line in lines) + "\n"


def _seen_from(folder: Path, file: Path) -> str:
    """A file as seen from a folder; its whole path where they share none (another drive)."""
    try:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    except ValueError:
        return file.resolve().as_posix()


def _suggested(found: Intake) -> list[str]:
    """Keys that may be wanted, as comments."""
    lines = []
    if "bearing" not in found.sidecar:
        lines.append(
            '# bearing = "..."  # geometry and materials: a name, or a file beside this one'
        )
    if "blocks" in found.sidecar:
        lines.append("# rest_before: how long the bearing rested before each block")
    if "ambient" in found.sidecar and "ambient" not in found.kept:
        lines.append("# ambient: no column tells it; correct it")
    treatment = found.treatment
    if treatment is not None and any(flags.any() for flags in treatment.spikes.values()):
        lines.append("# despike = true  # take the spikes out")
    drifting = list(treatment.drifts) if treatment is not None else []
    if drifting:
        which = drifting[0] if len(drifting) == 1 else "both"
        lines.append(f'# detrend = "{which}"  # take the drift out')
    return lines


def _comments(table: str, found: Intake) -> list[str]:
    if table != "units":
        return []
    assumed = [column.title for column in found.columns if column.assumed]
    return [f"# assumed, the file does not say: {', '.join(assumed)}"] if assumed else []


def _places(found: Intake, begun: bool) -> list[str]:
    """Thermocouples whose place no title tells, as comments."""
    open_ones = [c.title for c in found.columns if c.holds == "temperature" and not c.place]
    if not open_ones:
        return []
    lines = [] if begun else ["", "# [thermocouples]  # rubber 1 is the outer layer; or lead"]
    return lines + [f'# {_key(title)} = "rubber 1"' for title in open_ones]


def _key(title: str) -> str:
    entry: dict[str, Any] = {title: 0}
    return tomli_w.dumps(entry).rsplit(" = ", 1)[0]
