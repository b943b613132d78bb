"""Bilinear models of a bearing and the bounds analysis with them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.border.errors import InputError, printable
from thermobearing.border.lazy import pd
from thermobearing.border.toml import to_table
from thermobearing.cyclic.equivalent import DESIGN_STRAIN, backbone, bilinear_parameters
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake
from thermobearing.motions.library import list_motions
from thermobearing.quantities.governing import order_from_least, place_of_largest, place_of_least

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
AIR = (23.0, 0.0, -20.0)  # at which the coupled model runs [degC]
UNSAFE, WASTEFUL = 0.95, 1.3  # envelope of the bounds over the coupled model; chosen


def first_motions() -> list[str]:
    """Return names of the first built-in motion of each type and ground."""
    return [name for name in list_motions() if name.split("-")[2] == "i"]


def _bound(bearing: Bearing, name: str, temperature: float, strain: float) -> BilinearBearing:
    """Return the bilinear model of a bearing soaked at a temperature, without heating."""
    model = bilinear_parameters(bearing, strain=strain, temperature=temperature)
    return BilinearBearing(
        name=name,
        description=f"{bearing.name} at {temperature:g} degC and {strain:.0%}, third cycle",
        total_rubber_thickness=bearing.total_rubber_thickness,
        strength=model.strength,
        initial_stiffness=model.initial,
        post_yield_stiffness=model.post_yield,
        tested_range=bearing.tested_range,
    )


def bounds_study(
    bearing: Bearing | str | Path,
    motion: Any,
    ambient: Sequence[float] = AIR,
    *,
    strain: float = DESIGN_STRAIN,
    **options: Any,
) -> "pd.DataFrame":
    """Compare a bounding analysis with the coupled model, for one bearing on the pier of a bridge.

    The bounds are bilinear models of the bearing soaked at the warmest and at the coldest
    temperature (equal peak force and loop area in the third cycle at the design strain, as with the
    property modification factors of a code, but from the model).

    Parameters
    ----------
    bearing : a layered Bearing, a library name, or a TOML file.
    motion : one or several names, files or tables as in an earthquake case.
    ambient : temperatures at which the coupled model runs [degC]; at least two.
    strain : of the bilinear models.
    options : further keys of an earthquake case and its analysis.

    Returns
    -------
    DataFrame : one row per motion and demand, and where the structure has several bearing lines or
        piers for each of them (column `part`): lower, upper, envelope of the two; largest of the
        coupled model and the temperature where it occurs; envelope over coupled; verdict
        ("unsafe" below 0.95, "wasteful" above 1.3); quantities beyond the tested range. Its `attrs`
        hold the excursions of the coupled model, and the outcomes of failed runs.

    Examples
    --------
    >>> table = bounds_study("shen-hdr-bridge", "jra-ii-i-1", [23.0, -20.0])
    >>> len(table), bool((table["envelope_over_coupled"] > 0.5).all())
    (4, True)
    """
    bearing = as_bearing(bearing)
    cold, warm = min(ambient), max(ambient)
    bounds = [_bound(bearing, "lower", warm, strain), _bound(bearing, "upper", cold, strain)]
    common: dict[str, Any] = {"motions": motion, **options}
    simple = make_earthquake_case(
        {"command": "bridge"}, "bounds", bearings=bounds, ambient=[warm], **common
    )
    full = make_earthquake_case(
        {"command": "bridge"}, "bounds", bearings=[bearing], ambient=list(ambient), **common
    )
    studies = run_earthquake(simple), run_earthquake(full)
    coupled = studies[1].table
    left = {
        motion: " ".join(dict.fromkeys(" ".join(texts).split()))
        for motion, texts in coupled.groupby("motion")["beyond_tested"]
    }
    bounded, many = (_demanded(study) for study in studies)
    found = pd.DataFrame(_compared(bounded, many, ambient, left))
    found.attrs["tested_range"] = studies[1].tested_range.to_dict("records")
    found.attrs["structure"] = full.structure.name
    found.attrs["ended"] = [study.outcome for study in studies if study.outcome != "completed"]
    found.attrs["sentences"] = [study.sentence for study in studies if study.outcome != "completed"]
    found.attrs["ranges"] = calibration_ranges(bearing)
    resolved = to_table(full)
    found.attrs["inputs"] = {
        **{name: resolved[name] for name in ("structure", "motions", "ambient", "analysis")},
        **{"strain": strain, "bearing": to_table(bearing), "sources": bearing.sources},
        "bounds": [to_table(model) for model in bounds],
    }
    return found


def _compared(
    bounded: "pd.DataFrame", many: "pd.DataFrame", ambient: Sequence[float], left: dict[Any, str]
) -> list[dict[str, Any]]:
    """Return a row for each motion, demand and part: the bounds and the coupled model."""
    whose = ["motion", "demand", "part"]
    ends = bounded.set_index([*whose, "bearing"])["value"]
    rows = []
    for key, mine in many.groupby(whose, sort=False):
        motion, column, part = (str(name) for name in key)
        lower, upper = (float(ends[motion, column, part, name]) for name in ("lower", "upper"))
        values: pd.Series = mine.set_index("ambient_degC")["value"]
        ratio = max(lower, upper) / float(values.max())
        rows.append(
            {
                "motion": motion,
                "demand": column,
                **({"part": part} if len(set(many["part"])) > 1 else {}),
                "lower_bound": lower,
                "upper_bound": upper,
                "coupled_max": float(values.max()),
                "coupled_at_degC": float(values.index[place_of_largest(values)]),
                "envelope_over_coupled": ratio,
                "verdict": _verdict(ratio),
                **{f"coupled_{t:g}_degC": float(values[t]) for t in ambient},
                "beyond_tested": left[motion],
            }
        )
    return rows


def _demanded(study: EarthquakeResult) -> "pd.DataFrame":
    """Return demands of every run, of each line and pier where there are several: a row each."""
    keys, found = ["bearing", "motion", "ambient_degC"], []
    for motion in dict.fromkeys(study.table["motion"]):
        for column in DEMANDS:
            name, who, value = PARTS.get(column, ("", "", ""))
            parts = getattr(study, name) if name else study.table
            if not name or parts.empty:
                parts, who, value = study.table.assign(part=""), "part", column
            mine = parts[parts["motion"] == motion].rename(columns={who: "part", value: "value"})
            found.append(mine[[*keys, "part", "value"]].assign(demand=column))
    rows: pd.DataFrame = pd.concat(found, ignore_index=True)
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
    "Each bound is a bilinear loop with the stated K_2/K_1, and with the peak force and the area "
    "of its cycle. Its force at zero displacement, Q_d, therefore differs from that of the cycle, "
    "which the factors use"
)


def bound_models(
    table: "pd.DataFrame", strain: float, total_rubber_thickness: float, kind: str = "LRB"
) -> "pd.DataFrame":
    """Return the softest and the stiffest cycle of a table of factors as bilinear models.

    By K_eq over all temperatures, first and heated cycles; of one bearing [kN], [kN/mm].
    """
    rows = table[(table["strain"] == strain) & table["basis"].isin(["first", "heated"])]
    if rows.empty:
        known = ", ".join(f"{value:g}" for value in sorted(set(table["strain"])))
        raise InputError(f"strain = {strain:g}: the table has {known}")
    wide = rows.pivot_table(index=["basis", "ambient_degC"], columns="quantity", values="value")
    cycles = wide.reset_index().to_dict("records")
    stiffness = [float(cycle["K_eq"]) for cycle in cycles]
    softest, stiffest = place_of_least(stiffness), place_of_largest(stiffness)
    found = []
    for name, row in (("lower", cycles[softest]), ("upper", cycles[stiffest])):
        amplitude = strain * total_rubber_thickness
        p = backbone(float(row["K_eq"]), float(row["energy"]), amplitude, kind)
        found.append(
            {
                "bound": name,
                "strain": strain,
                "basis": str(row["basis"]),
                "ambient_degC": float(row["ambient_degC"]),
                "Q_d_kN": p.strength,
                "K_1_kN_mm": p.initial,
                "K_2_kN_mm": p.post_yield,
                "Q_y_kN": p.strength * p.initial / (p.initial - p.post_yield),
            }
        )
    return pd.DataFrame(found)


def opensees_text(models: "pd.DataFrame", name: str, language: str) -> str:
    """Return materials for a zeroLength element of OpenSees, in Tcl or Python."""
    shown = " ".join(printable(name).split("\n"))  # a second line would be carried out
    lines = [
        f"# {shown}: bilinear bounds of ONE bearing, units kN, mm, s.",
        "# Use one of the materials in a zeroLength element, direction 1, per bearing.",
        f"# {BOUNDS_NOTE}.",
    ]
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
