"""What the console says of designs, bounds and factors."""

from pathlib import PurePath

import pandas as pd

from thermobearing.cyclic.equivalent import post_yield_ratio
from thermobearing.design.bounds import BOUNDS_NOTE, bounds_table
from thermobearing.design.case import DesignCase, bearing_weight, make_design_case
from thermobearing.design.factors import FOOTNOTE, marked, published_codes
from thermobearing.design.peaks import coldest_sentences, of_group, peak_rule
from thermobearing.design.result import BoundsReport, Design, FactorReport, source_design
from thermobearing.design.sizing import Round
from thermobearing.results.screen import print_table, print_warnings, say

COLUMNS = {  # of the rounds: head, width
    "round": 5,
    "u_B mm": 6,
    "bearing": 10,
    "K_B kN/mm": 9,
    "h_B": 6,
    "Q_d kN": 6,
    "found mm": 8,
    "differ": 6,
    "ductility": 9,
}


def print_head(case: DesignCase) -> None:
    """Print what is designed, and the heads of the rounds."""
    names = ", ".join(PurePath(motion.name).name for motion in case.motions)
    rubber = f"{case.structure.name}, {case.compound_kind} {case.compound}, "
    loads = [f"{bearing_weight(case, group):.0f} kN a bearing" for group in case.groups]
    pairs = zip(case.line_groups or [], loads, strict=False)
    groups = "; ".join(f"group {group.name}: {load}" for group, load in pairs)
    say(f"{rubber}{groups or loads[0]}, motions {names}")
    say(_line(tuple(COLUMNS)), "bold")


def print_round(turn: Round) -> None:
    """Print a round in a line."""
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
    say(" ".join([_line(cells), turn.group]).rstrip())


def _line(cells: tuple[str, ...]) -> str:
    widths = COLUMNS.values()
    return " ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=True))


def print_design(design: Design) -> None:
    """Print verdict, checks, the published design, layered bearings of equal stiffness."""
    say(design.sentence)
    rule = peak_rule(design.case.peaks)
    say(f"Peaks are {rule.says}; {rule.source}{marked(rule)}.")
    if design.first_within is not None:
        say(f"Round {design.first_within} was the first within the 10 % of the printed loop.")
    _print_checks(design)
    if _is_of_the_source(design.case):
        say(f"\n{_source()}")
    for item in design.equal:
        name = of_group(item.bearing.name, item.group)
        say(
            f"equal K_B: {name}, K_eq {item.stiffness:.3f} kN/mm, "
            f"h_eq {item.damping:.3f} at 23 degC without heating"
        )
    for sentence in coldest_sentences(design.temperatures):
        say(sentence)
    if rule.unverified or any(check.unverified for check in design.checks):
        say(FOOTNOTE)
    print_warnings(design.warnings)


def _print_checks(design: Design) -> None:
    """Print the calculation sheet."""
    rows, several = [], any(check.part for check in design.checks)
    for check in design.checks:
        unit = "" if check.unit == "1" else f" {check.unit}"
        value = f"{check.value:.3g}{unit}"
        limit = f"{'>=' if check.least else '<='} {check.limit:g}{unit}"
        source = check.source + marked(check)
        of = (check.part,) if several else ()
        rows.append((check.what, *of, value, limit, check.verdict, source))
    styles = ["" if check.passed else "bold red" for check in design.checks]
    of = ("of",) if several else ()
    heads = ("checks", *of, "value", "limit", "verdict", "source of the limit")
    print_table(heads, rows, title=" ", styles=styles)


def _is_of_the_source(case: DesignCase) -> bool:
    """Return whether it is the bridge of Shen (2023), not one of the user's own."""
    printed = make_design_case({}, "default")
    keys = {"structure", "compound", "compound_kind", "weight"}
    return case.model_dump(include=keys) == printed.model_dump(include=keys)


def _source() -> str:
    """Return what Shen (2023) came to."""
    bearing, more = (source_design()[name] for name in ("bearing", "more"))
    hdr, lhdr = more["equal_K_B_kN_mm"]
    return (
        f"source (Tables 6.1, 6.3): u_B {bearing['u_B_mm']:g} mm, {bearing['side_mm']:g} mm, "
        f"{bearing['layers']}x{more['layer_thickness_mm']:g}, "
        f"K_B {bearing['K_B_kN_mm']:.3f} kN/mm, "
        f"Q_d {bearing['Q_d_kN']:g} kN; equal HDR and LHDR bearings {more['equal_side_mm']:g} mm, "
        f"{more['equal_layers']}x{more['equal_layer_thickness_mm']:g}, K_B {hdr:g} and {lhdr:g} "
        "kN/mm. Its motions are not free to ship, so the displacement differs."
    )


def print_bounds(report: BoundsReport) -> None:
    """Print a paragraph for each bearing."""
    for text in report.paragraphs.values():
        say(text + "\n")
    print_warnings(report.warnings)


def print_factors(report: FactorReport) -> None:
    """Print factors of the largest strain, and the bounds."""
    others = len(report.bearings) - 1
    band = f" (values; figure and factors.csv have the band of it and {others} more)"
    say(
        f"{report.name}{band if others else ''}: {report.motion}, cycles {report.cycles}, "
        f"reference {report.reference:g} degC, strain {report.strain:.0%}"
    )
    _print_factors(report)
    for row in bounds_table(report.bounds).to_dict("records"):
        say(
            f"{row['bound']} bound ({row['basis']} cycle, {row['ambient_degC']:g} degC): Q_d "
            f"{row['Q_d_kN']:.1f} kN, K_1 {row['K_1_kN_mm']:.2f}, K_2 {row['K_2_kN_mm']:.3f} kN/mm"
        )
    ratio = post_yield_ratio(report.bearings[0].kind)
    say(f"K_2/K_1 {ratio.K_2_over_K_1:.3g}: {ratio.source}{marked(ratio)}")
    say(BOUNDS_NOTE)
    for sentence in report.coldest:
        say(sentence)
    for code in published_codes():
        say(f"{code.code}: {code.says}{marked(code)}")
    say("values of other sources: figure, and `published` in summary.json")
    say(FOOTNOTE)
    print_warnings(report.warnings)


def _print_factors(report: FactorReport) -> None:
    """Print factors at the largest strain, their band, and what they are made of."""
    rows = report.table[report.table["strain"] == report.strain]
    last, mean = (rows.loc[rows["basis"] == basis, "value"] for basis in ("heated", "mean"))
    if last.tolist() == mean.tolist():  # of one cycle: the same twice
        rows = rows[rows["basis"] != "mean"]
    _print_by_temperature(rows, "factor", [f"{value:.2f}" for value in rows["factor"]])
    if len(report.bearings) > 1:
        pairs = zip(rows["factor_low"], rows["factor_high"], strict=True)
        shown = [f"{low:.2f} to {high:.2f}" for low, high in pairs]
        _print_by_temperature(rows, f"5 to 95 % of {len(report.bearings)} bearings", shown)
    names = [
        quantity if unit == "1" else f"{quantity} {unit}"
        for quantity, unit in zip(rows["quantity"], rows["unit"], strict=True)
    ]
    shown = [f"{value:.4g}" for value in rows["value"]]
    _print_by_temperature(rows.assign(quantity=names), "value", shown)


def _print_by_temperature(rows: pd.DataFrame, head: str, shown: list[str]) -> None:
    """Print a table: a row for each quantity and basis, a column for each temperature."""
    wide = rows.assign(shown=shown).pivot_table(
        index=["quantity", "basis"], columns="ambient_degC", values="shown", aggfunc="first"
    )
    cells = []
    for key, values in wide.iterrows():
        quantity, basis = key if isinstance(key, tuple) else (key, "")
        cells.append((str(quantity), str(basis), *(str(value) for value in values)))
    print_table((head, "cycles", *(f"{value:g} degC" for value in wide.columns)), cells, keys=2)
