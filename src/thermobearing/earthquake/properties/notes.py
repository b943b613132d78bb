"""Notes on equivalent properties of bearing lines: what they rest on, in words."""

import math
from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any

from pydantic import Field

from thermobearing.bearing.library import BEARINGS
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.sources import (
    COEFFICIENTS,
    EXTRAPOLATED,
    LEAD_EXTRAPOLATED,
    UNTESTED_VALUES,
    VIRGIN_EXCESS,
    assumed_clause,
)
from thermobearing.border.lazy import pd
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, in_unit
from thermobearing.cyclic.equivalent import (
    post_yield_ratio,
)
from thermobearing.earthquake.case import list_bearing_tables
from thermobearing.model.outcomes import assumption_texts
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.words import joined

RATIO_SLACK = 1.0 + 1e-9  # by which rounding may exceed a ratio
RUN_SLACK = 1.005  # a run is as stiff as a link within half a percent
TEMPERATURE_NOTE = (
    "Effects of temperature rest on coefficients m_T and n_T that were not measured on the rubber: "
    "{phrases}. Compare them with factors of the maker or of a code (thermobearing lambda)."
)
SCRAGGED = "scragged"
HEATED_COLUMNS = ("K_eff_heated_kN_mm", "h_eff_heated", "Q_d_heated_kN")  # with lead of the runs
FIRST = 1  # the cycle in which virgin rubber is stiffest
KILO = 1e3  # mm in a metre
OTHER_DISPLACEMENTS = (
    "K_eff and damping also depend on the design displacement, which differs between temperatures: "
    "their ratio is not that of one loop at two temperatures."
)


Stress = Annotated[float, in_unit("MPa"), Field(gt=0)]


class LeadStrength(Strict):
    """Content of data/materials/lead-strength.toml; `unverified`: its source was not read."""

    lowest: Stress
    highest: Stress
    rate: Annotated[float, Field(ge=0)]
    source: str
    unverified: bool


lead_strength = partial(read_data, LeadStrength, "materials", "lead-strength.toml")


def bearing_sources(case: Mapping[str, Any], table: Mapping[str, Any]) -> dict[str, str]:
    """Return the sources of a bearing of a resolved case, by dotted key."""
    stated = case.get("sources", {}).get(str(table["name"]), {})
    return BEARINGS.sources(Bearing, table) | dict(stated)


def temperature_note(case: Mapping[str, Any]) -> str:
    """Return which temperature coefficients of a case were not measured, and what to do about it.

    Empty where those of all bearings were.
    """
    phrases = []
    for table in list_bearing_tables(case):
        sources = bearing_sources(case, table)
        clauses = dict.fromkeys(assumed_clause(sources.get(key, "")) for key in COEFFICIENTS)
        if origins := [clause for clause in clauses if clause]:
            phrases.append(f"of {table['name']} {joined(origins)}")
    return TEMPERATURE_NOTE.format(phrases=joined(phrases)) if phrases else ""


def left_out_note(lines: "pd.DataFrame") -> str:
    """Return what upper values of lines leave out, as a sentence; empty without an upper value."""
    rows = with_bounds(lines).to_dict("records") if len(lines) else []
    upper = [row for row in rows if is_upper(row) and row["rubber"]]
    if not upper:
        return ""
    texts = assumption_texts()["left_out"]
    phrases = [texts["rubber"]]
    if any(row["has_lead"] for row in upper):
        rate = lead_strength()
        star = texts["unverified"] * rate.unverified
        phrases.append(texts["lead"].format(rate=f"{100.0 * rate.rate:.0f}", unverified=star))
    return str(texts["sentence"].format(effects=joined(phrases)))


def initial_stiffness_note(lines: "pd.DataFrame", *, with_numbers: bool = True) -> str:
    """Return which K_1/K_d is assumed, with its source and where a fat loop needs more of it.

    `with_numbers`: what K_1 and K_0 are, and both of each line, too.
    """
    kinds = dict.fromkeys(kind for kind in lines["kind"] if kind)
    if not kinds:
        return ""
    ratios = [f"{1.0 / post_yield_ratio(kind).K_2_over_K_1:.3g} ({kind})" for kind in kinds]
    sources = dict.fromkeys(post_yield_ratio(kind).source for kind in kinds)
    star = "*" if any(post_yield_ratio(kind).unverified for kind in kinds) else ""
    larger = dict.fromkeys(
        f"{row['line_bearing']}: {row['K_1_kN_mm'] / row['K_d_kN_mm']:.3g}"
        for row in lines.to_dict("records")
        if row["kind"]
        and row["K_1_kN_mm"] / row["K_d_kN_mm"]
        > RATIO_SLACK / post_yield_ratio(row["kind"]).K_2_over_K_1
    )
    text = (
        f"K_1 is assumed{star} where the loop of a bearing is not bilinear: K_1/K_d = "
        f"{joined(ratios, 'and')}, {'; '.join(sources)}"
    )
    if larger:
        text += (
            ". A loop with more damping than a bilinear one of this ratio can have needs a larger "
            f"ratio ({'; '.join(larger)})"
        )
    numbers = dict.fromkeys(
        f"{name}: K_1 {row['K_1_kN_mm']:.2f}, K_0 {row['K_0_kN_mm']:.2f} kN/mm"
        for name, row in zip(place_names(lines, "degC"), lines.to_dict("records"), strict=True)
        if row["kind"]
    )
    if with_numbers:
        text += (
            ". This K_1, the first branch of the bilinear loop, is not the initial stiffness K_0 "
            f"of the model, the tangent of its curved loop at rest ({'; '.join(numbers)})"
        )
    if with_numbers and not lines["rubber"].isin(["", SCRAGGED]).all():
        text += (
            "; K_0 of virgin rubber has its excess, which is largest before the first displacement "
            "and of no use in a link"
        )
    return f"{text}. *: not checked against the published text." if star else f"{text}."


LOWER, UPPER = "lower", "upper"
BOUNDED = (
    "Upper and lower values bound K_eff, the peak force over the design displacement, each at its "
    "own design displacement. Damping, Q_d, K_d and K_1 belong to the same loop and are not bounds "
    "one by one"
)
BOUNDED_COLUMNS = (  # column, unit and digits
    ("K_eff_kN_mm", "kN/mm", 3),
    ("Q_d_kN", "kN", 1),
    ("K_d_kN_mm", "kN/mm", 3),
    ("K_1_kN_mm", "kN/mm", 2),
)
BOUND_SLACK = 1.005  # by which a value may exceed an upper one that is as large
NO_BOUND = "no bound, but the properties at this temperature in this state of the rubber"
EXTREMES = (
    "Coldest and warmest are those of the ambient temperatures of this analysis, not of the site."
)


def with_bounds(lines: "pd.DataFrame") -> "pd.DataFrame":
    """Return lines with a column `bound`, which bound of an analysis with links each row is.

    "lower" at the warmest temperature in the softest state of the rubber of the bearing, "upper" at
    the coldest in the stiffest, both in words where these are one, and else "". States other than
    scragged are stiffer.
    """
    ambients = lines["ambient_degC"]
    states_of = {name: set(group) for name, group in lines.groupby("bearing")["state"]}
    bounds = []
    for name, ambient, state in zip(lines["bearing"], ambients, lines["state"], strict=True):
        states = states_of[name]
        softest = state == SCRAGGED or SCRAGGED not in states
        stiffest = state != SCRAGGED or states == {SCRAGGED}
        names = [LOWER] * bool(ambient == ambients.max() and softest)
        names += [UPPER] * bool(ambient == ambients.min() and stiffest)
        bounds.append(joined(names))
    return lines.assign(bound=bounds)


def bounded_note(lines: "pd.DataFrame", degree: str = "degC") -> str:
    """Return what upper and lower values bound, and which upper values others exceed, as sentences.

    `lines` are those of `with_bounds`; empty where lines have one row each.
    """
    phrases: dict[str, None] = {}
    bounded = [row for row in lines.to_dict("records") if is_upper(row)]
    names = dict(zip(lines.index, place_names(lines, degree), strict=True))
    for row in bounded:
        same = lines[
            (lines["line"] == row["line"]) & (lines["line_bearing"] == row["line_bearing"])
        ]
        for column, unit, digits in BOUNDED_COLUMNS:
            values = same[column].fillna(0.0)
            if values.max() > BOUND_SLACK * row[column]:
                symbol = column.removesuffix(f"_{unit.replace('/', '_')}")
                other = names[values.index[place_of_largest(values)]]
                phrases[
                    f"{symbol} of {row['line_bearing']} {row[column]:.{digits}f} {unit}, but "
                    f"{values.max():.{digits}f} {unit} of {other}"
                ] = None
    if not bounded or not lines.duplicated(["bearing", "line"]).any():
        return ""
    exceeded = f" (upper values that others exceed: {'; '.join(phrases)})" if phrases else ""
    return f"{BOUNDED}{exceeded}."


def is_lower(row: Mapping[Any, Any]) -> bool:
    """Return whether a row of `with_bounds` has lower values."""
    return LOWER in row["bound"]


def is_upper(row: Mapping[Any, Any]) -> bool:
    """Return whether a row of `with_bounds` has upper values."""
    return UPPER in row["bound"]


def bound_note(row: Mapping[Any, Any], lines: "pd.DataFrame", *, heated: bool = False) -> str:
    """Return which values a row of some lines has, such as "lower values (warmest)"."""
    words = [f"{row['rubber']} rubber"] if row["rubber"] else []
    words += ["first loading"] * (row["cycle"] == FIRST)
    ambients = lines["ambient_degC"]
    if ambients.nunique() > 1:
        words += ["warmest"] * bool(row["ambient_degC"] == ambients.max())
        words += ["coldest"] * bool(row["ambient_degC"] == ambients.min())
    words += ["lead heated"] * heated
    text = ", ".join(words)
    kind = values_note(row)
    # With one state of the rubber and one temperature there is nothing to bound.
    if not kind and text:
        return f"{NO_BOUND} ({text})"
    return f"{kind} ({text})" if kind and text else kind or text


def values_note(row: Mapping[Any, Any]) -> str:
    """Return which values a row has, such as "upper values"; empty if it is no bound."""
    return f"{row['bound']} values" if row["bound"] else ""


def place_names(lines: "pd.DataFrame", degree: str) -> list[str]:
    """Return bearing and temperature of each line, with its rubber where there are several."""
    several = lines["state"].nunique() > 1
    return [
        f"{row['line_bearing']} at {row['ambient_degC']:g} {degree}"
        + f", {row['rubber']}" * (several and bool(row["rubber"]))
        for row in lines.to_dict("records")
    ]


def cycle_note(row: Mapping[Any, Any]) -> str:
    """Return the cycle and the state of the rubber that a line stands for; empty if bilinear."""
    if not row["rubber"]:
        return ""
    cycle = "third cycle"
    if row["cycle"] == FIRST:
        cycle = "largest force of the first cycle and energy of the third"
    text = f"{cycle} without heating, {row['rubber']} rubber"
    if row["rubber"] == SCRAGGED:
        return text
    factor = f"{row['over_scragged']:.2f}"
    return f"{text}: effective stiffness {factor} times that of the third cycle, scragged rubber"


def is_elastic(row: Mapping[Any, Any]) -> bool:
    """Return whether a bearing does not yield at its design displacement, or has no yield."""
    return not row["design_displacement_mm"] > row["D_y_mm"]


def loop_name(row: Mapping[Any, Any]) -> str:
    """Return whether the loop of a line yields, in a word or two for a table."""
    if not is_elastic(row):
        return "yields"
    return "no yield found" if math.isnan(row["D_y_mm"]) else "does not yield"


def elastic_note(row: Mapping[Any, Any]) -> str:
    """Return that a bearing does not yield at its design displacement; empty where it does."""
    if not is_elastic(row):
        return ""
    displacement = f"at its design displacement of {row['design_displacement_mm']:.1f} mm"
    if math.isnan(row["D_y_mm"]):
        return (
            f"no yield can be found {displacement}, where the damping ratio is "
            f"{100.0 * row['h_eff']:.1f} %: no K_1, no K_d and no yield strength are given"
        )
    return (
        f"does not yield {displacement}, below the yield displacement of {row['D_y_mm']:.1f} mm: "
        "K_1, K_d and Q_d are those of its loop beyond yield"
    )


def heated_lead_note(row: Mapping[Any, Any]) -> str:
    """Return Q_d with the lead as warm as in the runs; empty where the lead did not warm."""
    if math.isnan(row["lead_degC"]):
        return ""
    return (
        f"Q_d {row['Q_d_heated_kN']:.1f} instead of {row['Q_d_kN']:.1f} kN with the lead at "
        f"{row['lead_degC']:.1f} degC, its highest temperature in the runs"
    )


def cold_lead_note(row: Mapping[Any, Any]) -> str:
    """Return that the strength of cold lead is extrapolated; else empty."""
    return str(row["cold_lead"])


def beyond_note(row: Mapping[Any, Any]) -> str:
    """Return by how much the temperature of a line is outside the law of its rubber; else empty."""
    beyond = float(row["outside_law_K"])
    if beyond == 0.0:
        return ""
    side = "below" if beyond < 0.0 else "above"
    return f"ambient {abs(beyond):.3g} K {side} the temperature law of the rubber, {row['law']}"


def untested_note(row: Mapping[Any, Any]) -> str:
    """Return how the strain or temperature of a line is outside the tests of its bearing."""
    return str(row["beyond_tests"])


def excess_note(row: Mapping[Any, Any]) -> str:
    """Return that the excess stiffness of rubber is that of another compound; else empty."""
    if VIRGIN_EXCESS not in row["assumed"].split():
        return ""
    return f"excess stiffness of {row['rubber']} rubber assumed, from a test of another compound"


def is_extrapolated(row: Mapping[Any, Any]) -> bool:
    """Return whether strain, temperature or state of the rubber of a line are outside its tests."""
    return bool(untested_note(row) or beyond_note(row) or excess_note(row))


def secant_note(row: Mapping[Any, Any]) -> str:
    """Return that a run has a larger stiffness than the effective one; empty where none has."""
    if row["secant_kN_mm"] <= RUN_SLACK * row["K_eff_kN_mm"]:
        return ""
    return (
        f"the effective stiffness is below the {KILO * row['secant_kN_mm']:.5g} kN/m of a run, its "
        f"largest force over its largest displacement ({row['secant_of']}): it is that at the "
        "design displacement"
    )


def assumed_in_file(row: Mapping[Any, Any]) -> list[str]:
    """Return the keys of the bearing file whose numbers a line rests on and were not measured."""
    in_notes = (EXTRAPOLATED, VIRGIN_EXCESS, LEAD_EXTRAPOLATED, *UNTESTED_VALUES.values())
    return [key for key in row["assumed"].split() if key not in in_notes]
