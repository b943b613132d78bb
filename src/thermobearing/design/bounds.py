"""Bilinear models of a bearing and the bounds analysis with them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.sources import is_never_tested
from thermobearing.bearing.state import in_state, opposite, states_table
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, printable
from thermobearing.border.lazy import pd
from thermobearing.border.toml import to_table
from thermobearing.border.units import number_list
from thermobearing.cyclic.equivalent import (
    DESIGN_STRAIN,
    backbone,
    bilinear_parameters,
    post_yield_ratio,
)
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.earlier import BilinearParameters
from thermobearing.motions.library import list_motions
from thermobearing.quantities.governing import order_from_least, place_of_largest, place_of_least
from thermobearing.results.metrics import THIRD_CYCLE

DEMANDS = {  # column of the study's table: title of the panel
    "bearing_strain_max": "bearing strain",
    "bearing_force_max_kN": "bearing force [kN]",
    "pier_displacement_max_mm": "pier displacement [mm]",
    "deck_acceleration_max_m_s2": "deck acceleration [m/s²]",
}
PARTS = {  # demand: table of a study with several lines or piers, who, column
    "bearing_strain_max": ("lines", "line", "strain_max"),
    "bearing_force_max_kN": ("lines", "line", "force_max_kN"),
    "pier_displacement_max_mm": ("piers", "pier", "displacement_max_mm"),
}
BEARINGS = ("shen-hdr-bridge", "shen-lhdr-bridge")
FIRST = 1  # cycle that bounds the force of virgin rubber
AMBIENT = (23.0, 0.0, -20.0)  # at which the coupled model runs [degC]
UNSAFE, WASTEFUL = 0.95, 1.3  # envelope of the bounds over the coupled model; chosen


def first_motions() -> list[str]:
    """Return names of the first built-in motion of each type and ground."""
    return [name for name in list_motions() if name.split("-")[2] == "i"]


def _bound(
    bearing: Bearing, name: str, temperature: float, strain: float, cycle: int = THIRD_CYCLE
) -> BilinearBearing:
    """Return the bilinear model of a bearing soaked at a temperature, without heating."""
    model = bilinear_parameters(bearing, strain=strain, temperature=temperature, cycle=cycle)
    ordinal = "third" if cycle == THIRD_CYCLE else "first"
    return BilinearBearing(
        name=name,
        description=f"{bearing.name} at {temperature:g} degC and {strain:.0%}, {ordinal} cycle",
        total_rubber_thickness=bearing.total_rubber_thickness,
        strength=model.strength,
        initial_stiffness=model.initial,
        post_yield_stiffness=model.post_yield,
        tested_range=bearing.tested_range,
    )


@checked
def bounds_study(
    bearing: Bearing | str | Path,
    motion: Any,
    ambient: Sequence[float] = AMBIENT,
    *,
    strain: float = DESIGN_STRAIN,
    **options: Any,
) -> "pd.DataFrame":
    """Compare a bounding analysis with the coupled model, for one bearing on the pier of a bridge.

    The bounds are bilinear models of the bearing soaked at the warmest and at the coldest
    temperature (equal peak force and loop area in the third cycle at the design strain, as with the
    property modification factors of a code, but from the model). A third one is of rubber in the
    other state: virgin, in the first cycle at the coldest temperature, which bounds the force; or
    tested at the warmest, which bounds the displacement, if the analysis is of virgin rubber. The
    coupled model runs with rubber in both states.

    Parameters
    ----------
    bearing : a layered Bearing, a library name, or a TOML file.
    motion : one or several names, files or tables as in an earthquake case.
    ambient : temperatures at which the coupled model runs [degC]; at least two.
    strain : shear strain at which the bilinear models are equivalent.
    options : further keys of an earthquake case and its analysis.

    Returns
    -------
    DataFrame : one row per motion and demand, and where the structure has several bearing lines or
        piers for each of them (column `part`): lower, upper, envelope of the two; largest of the
        coupled model and the temperature where it occurs; envelope over coupled; verdict
        ("unsafe" below 0.95, "wasteful" above 1.3); quantities beyond the tested range. Then of the
        other state of the rubber (`other_state`): its bound, the largest of the coupled model and
        where, and ratio and verdict of all bounds over the coupled model in both states. `attrs`
        hold the excursions of the coupled model, and the outcomes of failed runs.

    Examples
    --------
    >>> table = bounds_study("shen-hdr-bridge", "jra-ii-i-1", [23.0, -20.0])
    >>> len(table), bool((table["envelope_over_coupled"] > 0.5).all())
    (4, True)
    """
    bearing = as_bearing(bearing)
    temperatures = number_list(ambient, "ambient").tolist()
    cold, warm = min(temperatures), max(temperatures)
    common: dict[str, Any] = {"motions": motion, **options}
    coupled_case = make_earthquake_case(
        {"command": "bridge"}, "bounds", bearings=[bearing], ambient=list(ambient), **common
    )
    state, other_state = coupled_case.analysis.state, opposite(coupled_case.analysis.state, bearing)
    rubber = in_state(bearing, state)
    bounds = [_bound(rubber, "lower", warm, strain), _bound(rubber, "upper", cold, strain)]
    # The first cycle of virgin rubber in the cold is the stiffest, the third one of tested rubber
    # at the warmest temperature the softest.
    conditions = (cold, strain, FIRST) if other_state.share else (warm, strain, THIRD_CYCLE)
    bounds.append(_bound(in_state(bearing, other_state), other_state.rubber, *conditions))
    # The bilinear models run at one temperature: they do not depend on it.
    bilinear_case = make_earthquake_case(
        {"command": "bridge"}, "bounds", bearings=bounds, ambient=[warm], **common
    )
    # The same coupled model in both states, so that either can govern a demand.
    cases = bilinear_case, coupled_case, coupled_case.with_state(other_state)
    studies = [run_earthquake(case) for case in cases]
    coupled = studies[1].table
    # Of all runs of a motion together, since a row compares runs at several temperatures.
    beyond_tested = {
        motion: " ".join(dict.fromkeys(" ".join(texts).split()))
        for motion, texts in coupled.groupby("motion")["beyond_tested"]
    }
    bound_demands, coupled_demands, other_demands = (_demands_of_parts(study) for study in studies)
    table = pd.DataFrame(_compare_demands(bound_demands, coupled_demands, ambient, beyond_tested))
    table = _with_other_state(table, bound_demands, other_demands, other_state.rubber)
    table.attrs["tested_range"] = studies[1].tested_range.to_dict("records")
    table.attrs["structure"] = coupled_case.structure.name
    table.attrs["ended"] = [study.outcome for study in studies if study.outcome != "completed"]
    table.attrs["sentences"] = [study.sentence for study in studies if study.outcome != "completed"]
    states = {
        bearing.name: (bearing, state),
        f"{bearing.name} ({other_state.rubber})": (bearing, other_state),
    }
    table.attrs["rubber_state"] = states_table(states)
    table.attrs["ranges"] = calibration_ranges(bearing), is_never_tested(bearing.sources)
    resolved = to_table(coupled_case)
    table.attrs["inputs"] = {
        "structure": resolved["structure"],
        "motions": resolved["motions"],
        "ambient": resolved["ambient"],
        "analysis": resolved["analysis"],
        "strain": strain,
        "bearing": to_table(bearing),
        "sources": bearing.sources,
        "bounds": [to_table(model) for model in bounds],
    }
    return table


def _compare_demands(
    bounded: "pd.DataFrame",
    coupled: "pd.DataFrame",
    ambient: Sequence[float],
    beyond_tested: dict[Any, str],
) -> list[dict[str, Any]]:
    """Return a row for each motion, demand and part: the bounds and the coupled model."""
    key_columns = ["motion", "demand", "part"]
    bound_values = bounded.set_index([*key_columns, "bearing"])["value"]
    rows = []
    for key, group in coupled.groupby(key_columns, sort=False):
        motion, column, part = (str(name) for name in key)
        lower, upper = (
            float(bound_values[motion, column, part, name]) for name in ("lower", "upper")
        )
        values: pd.Series = group.set_index("ambient_degC")["value"]
        # Which bound is larger depends on the demand: the soft one for displacements, the stiff
        # one for forces.
        ratio = max(lower, upper) / float(values.max())
        rows.append(
            {
                "motion": motion,
                "demand": column,
                **({"part": part} if len(set(coupled["part"])) > 1 else {}),
                "lower_bound": lower,
                "upper_bound": upper,
                "coupled_max": float(values.max()),
                "coupled_at_degC": float(values.index[place_of_largest(values)]),
                "envelope_over_coupled": ratio,
                "verdict": _verdict(ratio),
                **{f"coupled_{t:g}_degC": float(values[t]) for t in ambient},
                "beyond_tested": beyond_tested[motion],
            }
        )
    return rows


def _with_other_state(
    table: "pd.DataFrame", bounded: "pd.DataFrame", coupled: "pd.DataFrame", state: str
) -> "pd.DataFrame":
    """Add bound and coupled model of rubber in another state, and ratio and verdict of all."""
    key_columns = ["motion", "demand", "part"]
    bound_values = bounded[bounded["bearing"] == state].set_index(key_columns)["value"]
    rows = []
    for (key, group), row in zip(
        coupled.groupby(key_columns, sort=False), table.to_dict("records"), strict=True
    ):
        motion, column, part = (str(name) for name in key)
        values: pd.Series = group.set_index("ambient_degC")["value"]
        bound, largest = float(bound_values[motion, column, part]), float(values.max())
        envelope = max(row["lower_bound"], row["upper_bound"], bound)
        ratio = envelope / max(largest, row["coupled_max"])
        rows.append(
            {
                "other_state": state,
                "other_bound": bound,
                "other_coupled_max": largest,
                "other_coupled_at_degC": float(values.index[place_of_largest(values)]),
                "envelope_over_both": ratio,
                "verdict_of_both": _verdict(ratio),
            }
        )
    return table.join(pd.DataFrame(rows, index=table.index))


def _demands_of_parts(study: EarthquakeResult) -> "pd.DataFrame":
    """Return demands of every run, of each line and pier where there are several: a row each."""
    keys, tables = ["bearing", "motion", "ambient_degC"], []
    for motion in dict.fromkeys(study.table["motion"]):
        for column in DEMANDS:
            table_name, part_column, value_column = PARTS.get(column, ("", "", ""))
            parts = getattr(study, table_name) if table_name else study.table
            if not table_name or parts.empty:
                parts, part_column, value_column = study.table.assign(part=""), "part", column
            selected = parts[parts["motion"] == motion].rename(
                columns={part_column: "part", value_column: "value"}
            )
            tables.append(selected[[*keys, "part", "value"]].assign(demand=column))
    rows: pd.DataFrame = pd.concat(tables, ignore_index=True)
    return rows


def least_safe(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return of several lines or piers the one whose envelope is lowest over the coupled model."""
    order = order_from_least(table["envelope_over_coupled"])
    lowest = table.iloc[order].drop_duplicates(["motion", "demand"])
    kept: pd.DataFrame = lowest.sort_index()
    kept.attrs = dict(table.attrs)
    return kept


def _verdict(ratio: float) -> str:
    """Return what a ratio of the envelope to the coupled model means."""
    if ratio < UNSAFE:
        return "unsafe"
    return "wasteful" if ratio > WASTEFUL else "good"


BOUNDS_NOTE = (
    "Each bound is a bilinear loop that matches peak force and energy of its cycle; its Q_d is "
    "therefore larger than that of the real loop, which the factors use"
)
INITIAL_NOTE = (
    "K_1 follows from K_2 by the usual ratio of its kind. Of a lead rubber bearing the report and "
    "links.txt of a bridge state a larger K_1, the initial stiffness of its model"
)
VIRGIN_BOUND = (
    "The lower and the upper bound are of tested rubber. As a rule, that of virgin rubber "
    "governs forces and the lower one displacements"
)


def bound_models(
    table: "pd.DataFrame", strain: float, total_rubber_thickness: float, kind: str = "LRB"
) -> "pd.DataFrame":
    """Return the softest and the stiffest cycle of a table of factors as bilinear models.

    By K_eq over all temperatures, first and heated cycles; of one bearing [kN], [kN/mm]. `Q_d_kN`,
    `K_1_kN_mm` and `K_2_kN_mm` have peak force and energy of the cycle. `cycle_Q_d_kN` is the force
    of the cycle at zero displacement, which temperature factors multiply; the bilinear loop with it
    and the peak force of the cycle has `cycle_K_2_kN_mm` and `cycle_energy_ratio` times the energy
    of the cycle.
    """
    rows = table[(table["strain"] == strain) & table["basis"].isin(["first", "heated"])]
    if rows.empty:
        strains = ", ".join(f"{value:g}" for value in sorted(set(table["strain"])))
        raise InputError(f"strain = {strain:g}: the table has {strains}")
    by_cycle = rows.pivot_table(index=["basis", "ambient_degC"], columns="quantity", values="value")
    cycles = by_cycle.reset_index().to_dict("records")
    stiffness = [float(cycle["K_eq"]) for cycle in cycles]
    softest, stiffest = place_of_least(stiffness), place_of_largest(stiffness)
    bounds = []
    for name, row in (("lower", cycles[softest]), ("upper", cycles[stiffest])):
        amplitude = strain * total_rubber_thickness
        parameters = backbone(float(row["K_eq"]), float(row["energy"]), amplitude, kind)
        bounds.append(
            {
                "bound": name,
                "strain": strain,
                "basis": str(row["basis"]),
                "ambient_degC": float(row["ambient_degC"]),
                "Q_d_kN": parameters.strength,
                "K_1_kN_mm": parameters.initial,
                "K_2_kN_mm": parameters.post_yield,
                "Q_y_kN": parameters.yield_force,
                **_loop_with_own_strength(row, amplitude, kind),
            }
        )
    return pd.DataFrame(bounds)


def _loop_with_own_strength(row: dict[Any, Any], amplitude: float, kind: str) -> dict[str, float]:
    """Return Q_d of a cycle, K_2 of the bilinear loop of its peak force, and the energy ratio."""
    strength, stiffness = float(row["Q_d"]), float(row["K_eq"])
    # K_eq D = Q_d + K_2 D: the loop has the peak force of the cycle at the amplitude D.
    post_yield = stiffness - strength / amplitude
    loop = BilinearParameters(
        strength, post_yield, post_yield / post_yield_ratio(kind).K_2_over_K_1
    )
    return {
        "cycle_Q_d_kN": strength,
        "cycle_K_2_kN_mm": post_yield,
        "cycle_energy_ratio": loop.energy(amplitude) / float(row["energy"]),
    }


def virgin_bound(
    table: "pd.DataFrame", strain: float, total_rubber_thickness: float, kind: str = "LRB"
) -> "pd.DataFrame":
    """Return the stiffest cycle of a table of factors of virgin rubber, as `bound_models` does."""
    models = bound_models(table, strain, total_rubber_thickness, kind)
    return models[models["bound"] == "upper"].assign(bound="virgin")


def opensees_text(models: "pd.DataFrame", name: str, language: str) -> str:
    """Return materials for a zeroLength element of OpenSees, in Tcl or Python."""
    bearing_name = " ".join(printable(name).split("\n"))  # a second line would be carried out
    lines = [
        f"# {bearing_name}: bilinear bounds of ONE bearing, units kN, mm, s.",
        "# Use one of the materials in a zeroLength element, direction 1, per bearing.",
        f"# {BOUNDS_NOTE}.",
        f"# {INITIAL_NOTE}.",
    ]
    if "virgin" in set(models["bound"]):
        lines.append(f"# {VIRGIN_BOUND}.")
    if language == "python":
        lines.append("import openseespy.opensees as ops")
    for tag, row in enumerate(models.to_dict("records"), 1):
        initial, post_yield = row["K_1_kN_mm"], row["K_2_kN_mm"]
        lines.append(
            f"# {row['bound']} bound: {row['basis']} cycle at {row['ambient_degC']:g} degC, "
            f"{row['strain']:.0%} strain; Q_d {row['Q_d_kN']:.6g} kN, "
            f"K_1 {initial:.6g}, K_2 {post_yield:.6g} kN/mm"
        )
        numbers = [repr(value) for value in (row["Q_y_kN"], initial, post_yield / initial)]
        if language == "python":
            lines.append(f'ops.uniaxialMaterial("Steel01", {tag}, {", ".join(numbers)})')
        else:
            lines.append(f"uniaxialMaterial Steel01 {tag} {' '.join(numbers)}")
    return "\n".join(lines) + "\n"
