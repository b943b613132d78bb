"""`thermobearing lambda`: temperature factors of a bearing."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    AsJson,
    Force,
    NoFigures,
    Output,
    Quiet,
    reported,
    written,
)

if TYPE_CHECKING:
    import pandas as pd


@reported
def lambda_(
    bearing: Annotated[
        list[str],
        typer.Argument(help="Name or TOML file; several (a posterior) make bands."),
    ],
    reference: Annotated[
        float | None,
        typer.Option(help="Reference temperature [degC]; that of the bearing's rubber by default."),
    ] = None,
    temperature: Annotated[
        list[float] | None, typer.Option(help="May be repeated; -40 to 40 in steps of 10.")
    ] = None,
    strain: Annotated[
        list[float] | None, typer.Option(help="May be repeated; 1 and 1.75 by default.")
    ] = None,
    period: Annotated[float | None, typer.Option(help="Of the sine [s]; 2 by default.")] = None,
    speed: Annotated[
        float | None, typer.Option(help="Mean speed [mm/s] instead of the period.")
    ] = None,
    cycles: Annotated[str, typer.Option(help="3, 1-3, 2-11, all-but-first, or as 2,3,4.")] = "1-3",
    scale: Annotated[bool, typer.Option("--scale", help="Add sizes 1/6 and 1.")] = False,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Temperature factors from the coupled model: K_eq, Q_d, K_d, h_eq, energy; and bounds."""
    from thermobearing.bearing.library import load_bearing
    from thermobearing.design.factor_files import FactorReport, save_factors
    from thermobearing.design.factors import STRAINS, TEMPERATURES, temperature_factors
    from thermobearing.results.directory import check_target

    bearings = [load_bearing(name) for name in bearing]
    first = bearings[0]
    at = first.hysteresis.reference_temperature if reference is None else reference
    target = output or Path(f"lambda-{first.name}")
    check_target(target, force=force)
    strains = strain or list(STRAINS)
    numbers = _cycles(cycles)
    common: dict[str, Any] = {
        "reference_temperature": at,
        "temperatures": temperature or list(TEMPERATURES),
        "cycles": numbers,
    }
    if speed is None:
        table = temperature_factors(bearings, strains=strains, period=period or 2.0, **common)
        motion = f"sine of {period or 2.0:g} s"
    else:
        table = _by_speed(bearings, strains, speed, period, common)
        motion = f"sine at a mean speed of {speed:g} mm/s"
    report = FactorReport(bearings, table, at, motion, cycles, scale=scale)
    save_factors(report, target, force=force, figures=not no_figures)
    if not quiet:
        _print(report)
    return written("completed", "", target, as_json=as_json, quiet=quiet)


def _cycles(text: str) -> str | list[int]:
    """A preset, or numbers between commas."""
    from thermobearing.design.factors import PRESETS

    if text in PRESETS or not all(part.strip().isdigit() for part in text.split(",")):
        return text
    return [int(part) for part in text.split(",")]


def _by_speed(
    bearings: list[Any], strains: list[float], speed: float, period: float | None, common: Any
) -> "pd.DataFrame":
    """The period of each strain from a mean speed, 4 a/speed."""
    import pandas as pd

    from thermobearing.design.factors import temperature_factors

    if period is not None:
        raise InputError("give --period or --speed, not both")
    if not speed > 0.0:
        raise InputError(f"--speed = {speed:g}: must be greater than 0")
    rubber = bearings[0].total_rubber_thickness
    parts = [
        temperature_factors(bearings, strains=[s], period=4.0 * s * rubber / speed, **common)
        for s in strains
    ]
    return pd.concat(parts, ignore_index=True)


def _print(report: Any) -> None:
    """Factors of the largest strain, and the bounds."""
    from rich.console import Console
    from rich.table import Table

    from thermobearing.design.bound_models import bounds_table

    console = Console(highlight=False)
    name = report.bearings[0].name
    console.print(
        f"[bold]{name}[/bold]: {report.motion}, cycles {report.cycles}, "
                  f"reference {report.reference:g} degC, strain {report.strain:.0%}")  # fmt: skip
    rows = report.table[report.table["strain"] == report.strain]
    wide = rows.pivot_table(index=["quantity", "basis"], columns="ambient_degC", values="factor")
    table = Table(box=None, pad_edge=False)
    for head in ("", "", *(f"{value:g}" for value in wide.columns)):
        table.add_column(head, justify="right" if head else "left")
    for key, values in wide.iterrows():
        quantity, basis = key if isinstance(key, tuple) else (key, "")
        table.add_row(str(quantity), str(basis), *(f"{value:.2f}" for value in values))
    console.print(table)
    for row in bounds_table(report.bounds).to_dict("records"):
        console.print(
            f"{row['bound']} bound ({row['basis']} cycle, {row['ambient_degC']:g} degC): Q_d "
            f"{row['Q_d_kN']:.1f} kN, K_1 {row['K_1_kN_mm']:.2f}, K_2 {row['K_2_kN_mm']:.3f} kN/mm"
        )
