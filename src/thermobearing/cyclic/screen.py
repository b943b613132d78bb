"""Tables on the terminal."""

from typing import Any

from thermobearing.cyclic.result import Result, run_name
from thermobearing.results.metrics import CycleMeasures
from thermobearing.results.ranges import titles_passed
from thermobearing.results.screen import print_table, print_warnings, say

HEADS = ("strain", "cycle", "G_e MPa", "K_eq kN/mm", "h_eq", "energy kN mm", "Q_d kN", "K_d kN/mm")


def print_result(result: Result, compared: dict[str, Result] | None = None) -> None:
    """Per-cycle table of each run, its energy books, and earlier models beside it."""
    say(f"{result.dataset.attrs['title']} ({result.dataset.attrs['scheme']})", "bold")
    print_warnings(result.warnings)
    cycles, reached = result.cycles, result.tested_range.to_dict("records")
    warm = [str(name) for name in cycles.columns if _is_place(str(name))]
    for run, ambient in enumerate(result["ambient"].values):
        mine = cycles[cycles["ambient_degC"] == ambient] if len(cycles) else cycles
        rows = [
            [*_cycle_cells(row), *(f"{row[name]:.2f}" for name in warm)]
            for row in mine.to_dict("records")
        ]
        untested = titles_passed(reached, run_name(float(ambient)))
        told = f"; not tested: {untested}" if untested else ""
        if rows:
            heads = [*HEADS, *(_place_title(name) for name in warm)]
            print_table(heads, rows, title=f"{ambient:g} degC{told}", keys=2)
        _print_books(result, run)
    if compared:
        print_comparison(compared)


def print_comparison(results: dict[str, Result]) -> None:
    """Errors of the earlier models, one row per ambient temperature and model."""
    from thermobearing.cyclic.comparison import comparison_table

    rows = comparison_table(results, next(iter(results)))
    shown = {
        "ambient_degC": "degC",
        "model": "model",
        "inner layer largest K": "inner K",
        "lead largest K": "lead K",
        "peak force %": "peak f %",
        "last G_e %": "G_e %",
        "last h_eq %": "h_eq %",
        "last energy %": "energy %",
    }
    names = [name for name in shown if name in rows]
    title = "earlier models: largest temperature error, error of the peak force and the last cycle"
    cells = [
        [v if isinstance(v, str) else f"{v:.3g}" for v in row]
        for row in rows[names].itertuples(index=False)
    ]
    print_table([shown[name] for name in names], cells, title=title, keys=2)
    for early in rows[rows["outcome"] != "completed"].to_dict("records"):
        about = (
            f"{early['model']} at {early['ambient_degC']:g} degC ended early: {early['outcome']}"
        )
        say(f"{about}; its errors are those until then", "yellow")


def _is_place(name: str) -> bool:
    """Whether a column of the cycles is a temperature of a layer or of the lead."""
    return name.startswith("rubber") or name == "lead_degC"


def _place_title(name: str) -> str:
    place = name.removesuffix("_degC")
    return f"{place.replace('rubber', 'layer ')} degC"


def _cycle_cells(row: dict[Any, Any]) -> list[str]:
    return [
        f"{row['amplitude_strain']:.0%}",
        f"{row['cycle']:d}",
        f"{row['G_eq_MPa']:.3f}",
        f"{row['K_eq_kN_mm']:.3f}",
        f"{row['h_eq']:.4f}",
        f"{row['energy_kN_mm']:.0f}",
        f"{row['characteristic_strength_kN']:.2f}",
        f"{row['post_yield_stiffness_kN_mm']:.3f}",
    ]


def _print_books(result: Result, run: int) -> None:
    books = result.energy.iloc[run]
    steps = int(result["steps"].values[run])
    softened = int(result["softened_steps"].values[run])
    mismatch = float(result["layer_force_mismatch_max"].values[run])
    lost = books["heat_lost_ends_kN_mm"] + books["heat_lost_sides_kN_mm"]
    say(
        f"{books['ambient_degC']:g} degC: work in {books['work_in_kN_mm']:.0f} kN mm = heat "
        f"{books['heat_released_kN_mm']:.0f} + recoverable {books['recoverable_kN_mm']:.0f}; "
        f"heat = stored {books['heat_stored_kN_mm']:.0f} + lost {lost:.0f}; residuals "
        f"{books['mechanical_residual']:.1e} (mechanical), "
        f"{books['thermal_residual']:.1e} (thermal)"
    )
    if softened:
        say(
            f"  softened layers in {softened} of {steps} steps, layer law at most "
            f"{mismatch:.3g} kN from the force"
        )


def print_measures(
    cycles: list[CycleMeasures], ends: list[str], total_rubber_thickness: float
) -> None:
    """Measures of each cycle of a measured history, and how it ends."""
    heads = ("cycle", "strain", *HEADS[2:], "ends")
    rows = [
        (
            str(number),
            f"{m.amplitude_mm / total_rubber_thickness:.1%}",
            f"{m.G_eq_MPa:.3f}",
            f"{m.stiffness_kN_mm:.3f}",
            f"{m.h_eq:.4f}",
            f"{m.energy_kN_mm:.0f}",
            f"{m.characteristic_strength_kN:.2f}",
            f"{m.post_yield_stiffness_kN_mm:.3f}",
            end,
        )
        for number, (m, end) in enumerate(zip(cycles, ends, strict=True), 1)
    ]
    print_table(heads, rows)
