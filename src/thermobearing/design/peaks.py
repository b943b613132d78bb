"""Peaks under several motions, and peaks of layered bearings by temperature."""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field

from thermobearing.border.lazy import pd, xr
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats
from thermobearing.earthquake.motions import Motion
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.checks import Check
from thermobearing.quantities.governing import place_of_largest

if TYPE_CHECKING:
    from thermobearing.design.case import LineGroup

PeakRule = Literal["largest", "mean", "mean of seven"]
PARTS = {  # in a study with several lines or piers: the variable with a column for each
    "bearing_displacement_max": "line_displacement_max",
    "bearing_strain_max": "line_strain_max",
    "bearing_force_max": "line_force_max",
    "pier_displacement_max": "pier_part_displacement_max",
    "pier_ductility": "pier_part_ductility",
}
OF_LINES = ("bearing_displacement_max", "bearing_strain_max", "bearing_force_max")
COLLECTED = {  # column of a study: column of temperatures.csv
    "bearing_displacement_max": "displacement_mm",
    "bearing_strain_max": "strain",
    "bearing_force_max": "force_kN",
    "pier_displacement_max": "pier_displacement_mm",
    "pier_ductility": "ductility",
    "deck_acceleration_max": "deck_acceleration_m_s2",
}


class Rule(Strict):
    """A rule for the peaks of several motions; `unverified`: its source was not read."""

    name: PeakRule
    says: str
    source: str
    unverified: bool
    least: Annotated[int, Field(ge=1)] = 1
    note: str = ""


class Rules(Strict):
    """Content of data/design/peaks.toml."""

    rules: list[Rule]


def peak_rule(name: PeakRule) -> Rule:
    """Return a rule with its source."""
    rules = read_data(Rules, "design", "peaks.toml").rules
    return next(rule for rule in rules if rule.name == name)


def mean_group(motion: Motion) -> str:
    """Return what a mean is taken over with: its group, or the standard spectrum of a built-in
    motion.
    """
    built_in = re.fullmatch(r"(jra-i{1,2}-i{1,3})-\d+", motion.name)
    return motion.group or (built_in[1] if built_in else "motions")


def _combined(values: Sequence[float], motions: Sequence[Motion], rule: PeakRule) -> float:
    """Return the peak of several motions by a rule."""
    found = np.asarray(values, dtype=float)
    if rule == "largest":
        return float(found.max())
    groups = np.array([mean_group(motion) for motion in motions])
    each = [found[groups == group] for group in dict.fromkeys(groups)]
    least = peak_rule(rule).least
    return float(np.max([one.mean() if len(one) >= least else one.max() for one in each]))


def few_motions(motions: Sequence[Motion], rule: PeakRule) -> list[str]:
    """Return a sentence on the groups that have fewer motions than the rule takes a mean of."""
    least = peak_rule(rule).least
    groups = [mean_group(motion) for motion in motions]
    counts = {group: groups.count(group) for group in groups}
    few = [f"{group} has {count}" for group, count in counts.items() if count < least]
    needs = f"the largest peaks are used, since means need at least {least} motions of a group"
    return [f"{needs}: {', '.join(few)}"] if few else []


def counted(
    data: "xr.Dataset",
    name: str,
    motions: Sequence[Motion],
    rule: PeakRule,
    runs: Any = slice(None),
) -> Floats:
    """Return the peak of each bearing line or pier by a rule."""
    own = PARTS.get(name, name)
    values = np.asarray(data[own if own in data else name])[runs].reshape(len(motions), -1)
    return np.array([_combined(column.tolist(), motions, rule) for column in values.T])


def collect_peaks(
    study: EarthquakeResult,
    motions: Sequence[Motion],
    rule: PeakRule,
    limits: Sequence[Check],
    groups: Sequence["LineGroup"] = (),
) -> "pd.DataFrame":
    """Return peaks of every bearing at every temperature, and which limits they pass."""
    most = {check.what: check.limit for check in limits}
    kept = {"strain": most.get("shear strain"), "ductility": most.get("pier ductility")}
    data, rows = study.dataset, []
    for (bearing, ambient), mine in study.table.groupby(["bearing", "ambient_degC"], sort=False):
        runs = mine.index.to_numpy()
        peaks = {c: counted(data, n, motions, rule, runs) for n, c in COLLECTED.items()}
        for group in groups or (None,):
            row: dict[str, Any] = {"bearing": bearing, "ambient_degC": ambient}
            places: Any = slice(None)
            if group is not None:
                lines = data["line"].values.tolist()
                places = [lines.index(line) for line in group.lines]
                own = str(data["line_bearing"].values[runs[0], places[0]])
                row = {"bearing": own, "group": group.name, "ambient_degC": ambient}
            for name, column in COLLECTED.items():
                values = peaks[column][places if name in OF_LINES else slice(None)]
                row[column] = float(np.fmax.reduce(values))
            if group is not None:
                governing = place_of_largest(peaks["ductility"])
                row["pier"] = str(data["pier_part"].values[governing])
            fails = [k for k, limit in kept.items() if limit is not None and row[k] > limit]
            fails += [str(v) for v in dict.fromkeys(mine["outcome"]) if v != "completed"]
            row |= {"verdict": "NG" if fails else "OK", "fails": " ".join(fails)}
            rows.append(row)
    found = pd.DataFrame(rows)
    found.attrs["tested_range"] = study.tested_range.to_dict("records")
    return found


def of_group(name: str, group: str = "") -> str:
    """Return the name of a bearing with its group of lines, where there are several."""
    return f"{name} ({group})" if group else name


def _whose(table: "pd.DataFrame") -> list[str]:
    """Return the key columns of `collect_peaks` except the temperature."""
    return [name for name in ("bearing", "group") if name in table]


def envelope(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return the largest of every peak over the temperatures, and where it occurs."""
    rows = []
    for key, mine in table.groupby(_whose(table), sort=False) if len(table) else ():
        airs = mine["ambient_degC"].tolist()
        for column in (name for name in COLLECTED.values() if name in mine):
            values = mine[column].to_numpy(dtype=float)
            if np.isfinite(values).any():
                worst = place_of_largest(values)
                row = dict(zip(_whose(table), key, strict=True)) | {"peak": column}
                rows.append(row | {"largest": float(values[worst]), "at_degC": airs[worst]})
    return pd.DataFrame(rows)


def coldest_sentences(table: "pd.DataFrame") -> list[str]:
    """Return the verdict of the coldest day, and the envelope, in words."""
    said = []
    for key, mine in table.groupby(_whose(table), sort=False) if len(table) else ():
        rows = mine.to_dict("records")
        cold = min(rows, key=lambda row: row["ambient_degC"])
        far, force = (
            rows[place_of_largest(mine[name])] for name in ("displacement_mm", "force_kN")
        )
        fails = f" ({cold['fails']})" if cold["fails"] else ""
        pier = f" of {cold['pier']}" if "pier" in cold else ""
        said.append(
            f"{of_group(*map(str, key))}: {cold['verdict']} on the coldest day, "
            f"{cold['ambient_degC']:g} degC{fails}: strain {cold['strain']:.0%}, force "
            f"{cold['force_kN']:.0f} kN, ductility {cold['ductility']:.2f}{pier}; over all "
            f"temperatures at most {far['displacement_mm']:.0f} mm (at {far['ambient_degC']:g} "
            f"degC) and {force['force_kN']:.0f} kN (at {force['ambient_degC']:g} degC)"
        )
    return said
