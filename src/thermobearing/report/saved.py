"""What documents of results share that are read back as a summary, tables and pictures."""

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from thermobearing.report.identity import identity_of
from thermobearing.report.pieces import Plot, ReportFigure
from thermobearing.report.words import tidy
from thermobearing.results.ranges import NOT_GIVEN, parted
from thermobearing.results.saved import SavedResult


def saved_figures(saved: SavedResult, captions: Mapping[str, str]) -> dict[str, ReportFigure]:
    """Pictures of a result directory with their captions: lines where there is an SVG.

    Parameters
    ----------
    saved : the result.
    captions : by the beginning of the file's name; the longest that fits counts. Those come
        first, in this order.
    """
    names = {path.stem: path for path in saved.figures}

    def beginning(name: str) -> str:
        fitting = [start for start in captions if name.startswith(start)]
        return max(fitting, key=len, default="")

    order = list(captions)
    chosen = sorted(names, key=lambda n: order.index(b) if (b := beginning(n)) else len(order))
    found = {}
    for name in chosen:
        vector = names[name].with_suffix(".svg")
        image = (vector if vector.is_file() else names[name]).read_bytes()
        own = name.replace("_", " ").replace("-", " ")
        caption = captions.get(beginning(name), f"{own[:1].upper()}{own[1:]}.")
        found[name] = ReportFigure(caption, image=image, alt=caption)
    return found


def with_plot(
    found: dict[str, ReportFigure], name: str, plot: Plot, captions: Mapping[str, str]
) -> dict[str, ReportFigure]:
    """Figures with a plot beside one of them; first, and without a picture, where it has none."""
    if name in found:
        return {**found, name: replace(found[name], plot=plot)}
    return {name: ReportFigure(captions[name], alt=captions[name], plot=plot), **found}


def saved_identity(saved: SavedResult, otherwise: str) -> dict[str, str]:
    """Version, hash of what went in, and the command that was typed.

    Parameters
    ----------
    saved : the result.
    otherwise : what made it, where no command was typed.
    """
    summary = saved.summary
    told = summary.get("inputs")
    what = "inputs and tests in summary.json" if told is not None else "summary.json"
    tests = [_content(one) for one in summary.get("records", summary.get("comparisons", []))]
    text = json.dumps([told, tests] if told is not None else summary, sort_keys=True)
    command = str(summary.get("command_line") or otherwise)
    return identity_of(str(summary.get("version", "unknown")), text, command, what)


def _content(record: Mapping[str, Any]) -> str:
    """Hash of a test's samples, where it is known."""
    return str((record.get("conditions") or {}).get("sha256", ""))


def saved_validity(saved: SavedResult) -> tuple[list[str], str, list[str]]:
    """Sentences on validity, why there are none, and the other warnings."""
    told, others = parted(dict.fromkeys(saved.warnings))
    asked = bool(saved.summary.get("tested_range"))
    unknown = [text for text in told if NOT_GIVEN in text] if not asked else []
    validity = [] if unknown else list(map(tidy, told))
    return validity, " ".join(map(tidy, told)) if unknown else "", list(map(tidy, others))
