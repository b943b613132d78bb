"""Files of a design and of a bounds study."""

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

import thermobearing
from thermobearing.cyclic.case import to_table
from thermobearing.cyclic.files import without_nan
from thermobearing.cyclic.protocol import cyclic_test
from thermobearing.cyclic.run import run
from thermobearing.design.bounds_study import DEMANDS, paragraph
from thermobearing.design.case import DesignCase, resolved_design_toml
from thermobearing.design.equal import EqualBearing
from thermobearing.design.figures import draw_bounds, draw_equal, draw_rounds
from thermobearing.design.run import Design, Round
from thermobearing.results.directory import (
    BEARINGS,
    CHECKS,
    FIGURES,
    RESOLVED,
    ROUNDS,
    SUMMARY,
    TABLE,
    write_directory,
)

DPI = 150
SOURCE = {"u_B_mm": 178.0, "side_mm": 600.0, "layers": 8, "K_B_kN_mm": 2.6153, "Q_d_kN": 125.4,
          "K_1_kN_mm": 9.51, "K_2_kN_mm": 1.81}  # fmt: skip


def round_row(turn: Round) -> dict[str, Any]:
    """One round as people read it."""
    return {
        "round": turn.number,
        "u_B_assumed_mm": turn.assumed,
        "side_mm": turn.size.side,
        "layers": turn.size.layers,
        "layer_thickness_mm": turn.size.layer_thickness,
        "K_B_kN_mm": turn.stiffness,
        "h_B": turn.damping,
        "Q_d_kN": turn.strength,
        "K_1_kN_mm": turn.initial,
        "K_2_kN_mm": turn.post_yield,
        "u_found_mm": turn.found,
        "difference": turn.difference,
        "pier_ductility": turn.ductility,
    }


def design_summary(design: Design, equal: list[EqualBearing]) -> dict[str, Any]:
    """What summary.json says."""
    return {
        "command": "design",
        "version": thermobearing.__version__,
        "outcome": design.outcome,
        "sentence": design.sentence,
        "first_within_10_percent": design.first_within,
        "rounds": [round_row(turn) for turn in design.rounds],
        "checks": [asdict(check) | {"verdict": check.verdict} for check in design.checks],
        "equal": [
            {"name": item.bearing.name, "K_eq_kN_mm": item.stiffness, "h_eq": item.damping}
            for item in equal
        ],
        "source": {"citation": "Tables 6.1 and 6.3", **SOURCE},
    }


def save_design(
    case: DesignCase,
    design: Design,
    equal: list[EqualBearing],
    directory: Path,
    *,
    force: bool = False,
    figures: bool = True,
) -> Path:
    """Write rounds, checks, bearings (TOML, ready for `bridge`), summary and figures."""

    def fill(folder: Path) -> None:
        write_json(folder / SUMMARY, design_summary(design, equal))
        (folder / RESOLVED).write_text(resolved_design_toml(case), encoding="utf-8")
        rounds = pd.DataFrame([round_row(turn) for turn in design.rounds])
        rounds.to_csv(folder / ROUNDS, index=False, float_format="%.7g")
        sheet = [asdict(check) | {"verdict": check.verdict} for check in design.checks]
        pd.DataFrame(sheet).to_csv(folder / CHECKS, index=False, float_format="%.7g")
        (folder / BEARINGS).mkdir()
        for bearing in [design.bearing, *(item.bearing for item in equal)]:
            if bearing is not None:
                text = tomli_w.dumps(to_table(bearing))
                (folder / BEARINGS / f"{bearing.name}.toml").write_text(text, encoding="utf-8")
        if figures:
            (folder / FIGURES).mkdir()
            for name, make in design_figures(design, equal).items():
                make().savefig(folder / FIGURES / f"{name}.png", dpi=DPI)

    return write_directory(directory, fill, force=force)


def design_figures(design: Design, equal: list[EqualBearing]) -> dict[str, Callable[[], Any]]:
    """Figures by name."""
    rounds = design.rounds
    return {
        "rounds": lambda: draw_rounds(
            [r.assumed for r in rounds], [r.found for r in rounds], "Design loop"
        ),
        "equal": lambda: draw_equal(_loops(design, equal), "Bearings of equal stiffness, 23 degC"),
    }


def _loops(design: Design, equal: list[EqualBearing]) -> dict[str, tuple[Any, Any]]:
    """A closed loop at the design displacement of each bearing."""
    turn = design.last
    u, q, k1, k2 = turn.assumed, turn.strength, turn.initial, turn.post_yield
    knee = u - 2.0 * q / (k1 - k2)
    corners = [(u, q + k2 * u), (knee, k2 * knee - q), (-u, -q - k2 * u), (-knee, q - k2 * knee)]
    loop = np.array([*corners, corners[0]])
    loops = {
        f"{design.bearing.name if design.bearing else ''} (bilinear)": (loop[:, 0], loop[:, 1])
    }
    for item in equal:
        bearing = item.bearing
        test = cyclic_test(
            strain=[u / bearing.total_rubber_thickness], cycles=3, closing_strain=None
        )
        result = run(bearing, test, bearing.hysteresis.reference_temperature)
        last = np.flatnonzero(result["cycle"].values[0] == 3)
        x, force = (result[name].values[0, last] for name in ("displacement", "force"))
        loops[bearing.name] = (x, force)
    return loops


def save_bounds(
    tables: dict[str, pd.DataFrame], directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write table.csv, summary.json with a paragraph for each bearing, and a figure for each."""

    def fill(folder: Path) -> None:
        parts = [table.assign(bearing=name) for name, table in tables.items()]
        pd.concat(parts).to_csv(folder / TABLE, index=False, float_format="%.7g")
        told = {name: paragraph(table, name) for name, table in tables.items()}
        rows = {name: table.to_dict("records") for name, table in tables.items()}
        summary = {
            "command": "bounds",
            "version": thermobearing.__version__,
            "outcome": "completed",
            "paragraphs": told,
            "rows": rows,
        }
        write_json(folder / SUMMARY, summary)
        if figures:
            (folder / FIGURES).mkdir()
            for name, table in tables.items():
                title = f"{name}: bilinear bounds (bars) and coupled model (dots)"
                figure = draw_bounds(table, DEMANDS, title)
                figure.savefig(folder / FIGURES / f"bounds-{name}.png", dpi=DPI)

    return write_directory(directory, fill, force=force)


def write_json(path: Path, value: dict[str, Any]) -> None:
    """Strict JSON, NaN as null."""
    text = json.dumps(without_nan(value), indent=2, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")
