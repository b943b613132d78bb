"""What counts of the peaks under several motions, and what layered bearings do at every air."""

import re
from collections.abc import Sequence
from functools import cache
from typing import Annotated, Literal

import numpy as np
import pandas as pd
from pydantic import Field

from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.design.sizing import Check
from thermobearing.earthquake.motion import Motion
from thermobearing.earthquake.result import EarthquakeResult

PeakRule = Literal["largest", "mean"]
JUDGED = {  # column of a study: column of temperatures.csv
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
    """What data/design/peaks.toml says."""

    rules: list[Rule]


@cache
def peak_rule(name: str) -> Rule:
    """A rule with its source.

    Parameters
    ----------
    name : "largest" or "mean".

    Returns
    -------
    Rule

    Raises
    ------
    InputError : no such rule.

    Examples
    --------
    >>> peak_rule("mean").least
    3
    """
    path = data_path("design", "peaks.toml")
    for rule in validated(Rules, read_toml(path), str(path)).rules:
        if rule.name == name:
            return rule
    raise InputError(f'peaks = "{name}": must be "largest" or "mean"')


def group_of(motion: Motion) -> str:
    """What a mean is taken over with: its group, or the standard spectrum of a built-in motion.

    Parameters
    ----------
    motion : of a case.

    Returns
    -------
    str

    Examples
    --------
    >>> group_of(Motion(name="jra-ii-i-1")), group_of(Motion(name="mine.csv"))
    ('jra-ii-i', 'motions')
    """
    built_in = re.fullmatch(r"(jra-i{1,2}-i{1,3})-\d+", motion.name)
    return motion.group or (built_in[1] if built_in else "motions")


def combined(values: Sequence[float], motions: Sequence[Motion], rule: PeakRule) -> float:
    """The peak that counts.

    Parameters
    ----------
    values : peaks, one for each motion.
    motions : in the same order.
    rule : "largest", or "mean" over each group, of which the largest.

    Returns
    -------
    float : NaN where a peak is not known.

    Examples
    --------
    >>> motions = [Motion(name=f"jra-{kind}-i-{k}") for kind in ("i", "ii") for k in (1, 2)]
    >>> combined([1.0, 2.0, 3.0, 5.0], motions, "mean")
    4.0
    """
    found = np.asarray(values, dtype=float)
    if rule == "largest":
        return float(found.max())
    groups = [group_of(motion) for motion in motions]
    means = [
        found[[k for k, other in enumerate(groups) if other == group]].mean()
        for group in dict.fromkeys(groups)
    ]
    return float(np.max(means))


def few_motions(motions: Sequence[Motion], rule: PeakRule) -> list[str]:
    """A sentence for each group that has fewer motions than the rule asks for.

    Parameters
    ----------
    motions : of a case.
    rule : "largest" or "mean".

    Returns
    -------
    list of str

    Examples
    --------
    >>> few_motions([Motion(name="jra-ii-i-1")], "mean")[0][:30]
    'peaks = "mean": group jra-ii-i'
    """
    least = peak_rule(rule).least
    groups = [group_of(motion) for motion in motions]
    return [
        f'peaks = "{rule}": group {group} has {groups.count(group)} of at least {least} motions'
        for group in dict.fromkeys(groups)
        if groups.count(group) < least
    ]


def judged(
    study: EarthquakeResult, motions: Sequence[Motion], rule: PeakRule, limits: Sequence[Check]
) -> pd.DataFrame:
    """Peaks of every bearing at every temperature, and which limits they pass.

    Parameters
    ----------
    study : of some bearings at some temperatures under these motions.
    motions : of the study, in order.
    rule : for the peaks of several motions.
    limits : checks whose limits of strain and ductility are kept.

    Returns
    -------
    DataFrame : bearing, ambient [degC], peaks, verdict, what fails. Its `attrs` hold what the runs
        ask of the range that the bearings were tested in.

    Examples
    --------
    >>> import thermobearing as tb
    >>> study = tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", 23, duration=2)
    >>> judged(study, [Motion(name="jra-ii-i-1")], "largest", [])["verdict"].tolist()
    ['OK']
    """
    most = {check.what: check.limit for check in limits}
    kept = {"strain": most.get("shear strain"), "ductility": most.get("pier ductility")}
    table = study.table
    rows = []
    for (bearing, ambient), mine in table.groupby(["bearing", "ambient_degC"], sort=False):
        runs = mine.index.to_numpy()
        row: dict[str, object] = {"bearing": bearing, "ambient_degC": ambient}
        peaks = {
            column: combined(study[name].values[runs].tolist(), motions, rule)
            for name, column in JUDGED.items()
        }
        fails = [k for k, limit in kept.items() if limit is not None and peaks[k] > limit]
        fails += [str(v) for v in dict.fromkeys(mine["outcome"]) if v != "completed"]
        rows.append(row | peaks | {"verdict": "NG" if fails else "OK", "fails": " ".join(fails)})
    found = pd.DataFrame(rows)
    found.attrs["tested_range"] = study.tested_range.to_dict("records")
    return found


def envelope(table: pd.DataFrame) -> pd.DataFrame:
    """The largest of every peak over the temperatures, and where it occurs.

    Parameters
    ----------
    table : of `judged`.

    Returns
    -------
    DataFrame : one row for each bearing and peak.

    Examples
    --------
    >>> rows = [{"bearing": "x", "ambient_degC": t, "strain": s} for t, s in ((23, 2.0), (-20, 1))]
    >>> envelope(pd.DataFrame(rows))[["peak", "largest", "at_degC"]].iloc[0].tolist()
    ['strain', np.float64(2.0), np.int64(23)]
    """
    rows = []
    for bearing, mine in table.groupby("bearing", sort=False) if len(table) else ():
        airs = mine["ambient_degC"].tolist()
        for column in (name for name in JUDGED.values() if name in mine):
            values = mine[column].to_numpy(dtype=float)
            if np.isfinite(values).any():
                worst = int(np.nanargmax(values))
                row = {"bearing": bearing, "peak": column, "largest": float(values[worst])}
                rows.append(row | {"at_degC": airs[worst]})
    return pd.DataFrame(rows)


def coldest_sentences(table: pd.DataFrame) -> list[str]:
    """The verdict of the coldest day, and the envelope, in words.

    Parameters
    ----------
    table : of `judged`.

    Returns
    -------
    list of str : one for each bearing.

    Examples
    --------
    >>> import thermobearing as tb
    >>> study = tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", -20, duration=2)
    >>> coldest_sentences(judged(study, [Motion(name="jra-ii-i-1")], "largest", []))[0][:43]
    'shen-bilinear-bridge: OK on the coldest day'
    """
    said = []
    for bearing, mine in table.groupby("bearing", sort=False) if len(table) else ():
        rows = mine.to_dict("records")
        cold = min(rows, key=lambda row: row["ambient_degC"])
        far, force = (max(rows, key=lambda row: row[k]) for k in ("displacement_mm", "force_kN"))
        fails = f" ({cold['fails']})" if cold["fails"] else ""
        said.append(
            f"{bearing}: {cold['verdict']} on the coldest day, {cold['ambient_degC']:g} degC"
            f"{fails}: strain {cold['strain']:.0%}, force {cold['force_kN']:.0f} kN, ductility "
            f"{cold['ductility']:.2f}; over all temperatures at most "
            f"{far['displacement_mm']:.0f} mm (at {far['ambient_degC']:g} degC) and "
            f"{force['force_kN']:.0f} kN (at {force['ambient_degC']:g} degC)"
        )
    return said
