"""A design on the terminal: each round as it comes, then the calculation sheet."""

from rich.console import Console
from rich.table import Table

from thermobearing.design.case import DesignCase
from thermobearing.design.equal import EqualBearing
from thermobearing.design.run import Design, Round, bearing_weight

HEADS = ("round", "u_B mm", "bearing", "K_B kN/mm", "h_B", "Q_d kN", "found mm", "differ",
         "ductility")  # fmt: skip
WIDTHS = (5, 6, 10, 9, 6, 6, 8, 6, 9)


def print_head(case: DesignCase) -> None:
    """What is designed."""
    console = Console(highlight=False)
    names = ", ".join(motion.name for motion in case.motions)
    console.print(f"[bold]{case.structure.name}[/bold], {case.compound_kind} {case.compound}, "
                  f"{bearing_weight(case):.0f} kN a bearing, motions {names}")  # fmt: skip
    console.print(_line(HEADS), style="bold")


def print_round(turn: Round) -> None:
    """One line."""
    size = turn.size
    cells = (
        f"{turn.number}",
        f"{turn.assumed:.0f}",
        f"{size.side:g}, {size.layers}x{size.layer_thickness:g}",
        f"{turn.stiffness:.3f}",
        f"{turn.damping:.3f}",
        f"{turn.strength:.1f}",
        f"{turn.found:.0f}",
        f"{turn.difference:+.1%}",
        f"{turn.ductility:.2f}",
    )
    Console(highlight=False).print(_line(cells))


def _line(cells: tuple[str, ...]) -> str:
    return " ".join(cell.rjust(width) for cell, width in zip(cells, WIDTHS, strict=True))


def print_design(design: Design, equal: list[EqualBearing]) -> None:
    """Verdict, checks, layered bearings of equal stiffness."""
    console = Console(highlight=False)
    console.print(design.sentence)
    if design.first_within is not None:
        console.print(f"The source's 10 % was met in round {design.first_within}.")
    table = Table(box=None, pad_edge=False, title="\nchecks", title_justify="left")
    for head in ("", "value", "limit", "", "source of the limit"):
        table.add_column(head, justify="right" if head in ("value", "limit") else "left")
    for check in design.checks:
        sign = ">=" if check.least else "<="
        unit = "" if check.unit == "1" else f" {check.unit}"
        style = None if check.passed else "bold red"
        limit = f"{sign} {check.limit:g}{unit}"
        table.add_row(
            check.what, f"{check.value:.3g}{unit}", limit, check.verdict, check.source, style=style
        )
    console.print(table)
    console.print(
        "\nsource (Tables 6.1, 6.3): u_B 178 mm, 600 mm, 8x14, K_B 2.615 kN/mm, Q_d 125.4 kN; "
        "equal HDR and LHDR bearings 480 mm, 6x17, K_B 2.633 and 2.543 kN/mm. Its motions are not "
        "free to ship, so the displacement differs."
    )
    for item in equal:
        console.print(
            f"equal K_B: {item.bearing.name}, K_eq {item.stiffness:.3f} kN/mm, "
            f"h_eq {item.damping:.3f} at 23 degC without heating"
        )
