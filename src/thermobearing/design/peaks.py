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
from thermobearing.quantities.warned import Warned
from thermobearing.quantities.words import counted

if TYPE_CHECKING:
    from thermobearing.design.case import LineGroup

PeakRule = Literal["largest", "mean", "mean of seven"]
OTHERS = "the group of all others"  # motions that neither are built in nor state a group
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
    """A rule for the peaks of several motions; `unverified`: its source was not read.

    `least` are the motions of a group that a mean needs; with fewer than `fewest` the rule of the
    code is not met, whichever peak is taken.
    """

    name: PeakRule
    says: str
    source: str
    unverified: bool
    least: Annotated[int, Field(ge=1)] = 1
    fewest: Annotated[int, Field(ge=1)]
    fewest_source: str
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
    return motion.group or (built_in[1] if built_in else OTHERS)


def _combined(values: Sequence[float], motions: Sequence[Motion], rule: PeakRule) -> float:
    """Return the peak of several motions by a rule."""
    peaks = np.asarray(values, dtype=float)
    if rule == "largest":
        return float(peaks.max())
    groups = np.array([mean_group(motion) for motion in motions])
    peaks_by_group = [peaks[groups == group] for group in dict.fromkeys(groups)]
    # A mean needs the number of motions that the rule states; a group of fewer gives its largest.
    least = peak_rule(rule).least
    return float(
        np.max(
            [
                group_peaks.mean() if len(group_peaks) >= least else group_peaks.max()
                for group_peaks in peaks_by_group
            ]
        )
    )


def few_motions(motions: Sequence[Motion], rule: PeakRule) -> list[Warned]:
    """Return a warning of the groups that have fewer motions than the rule takes a mean of."""
    least = peak_rule(rule).least
    groups = [mean_group(motion) for motion in motions]
    counts = {group: groups.count(group) for group in groups}
    small_groups = [f"{group} has {count}" for group, count in counts.items() if count < least]
    needs = f"the largest peaks are used; a mean needs {least} motions or more"
    if (fewest := peak_rule(rule).fewest) < least and min(counts.values()) < fewest:
        needs = (
            f"too few motions for the rule of the code: the largest peaks need {fewest} motions or "
            f"more, a mean {least}"
        )
    sentence = f"{needs} of a group, and {', '.join(small_groups)}"
    # Without groups of the case, motions that are too few together need no word on groups.
    if not any(motion.group for motion in motions) and len(motions) < least:
        sentence = f"{needs}, and there {'is' if len(motions) == 1 else 'are'} {len(motions)}"
    return [Warned(sentence, "few_motions")] if small_groups else []


def too_few_motions(motions: Sequence[Motion], rule: PeakRule) -> str:
    """Return that some motions are too few for any peak by a rule, with both numbers; else empty.

    >>> too_few_motions([Motion(name="a.csv"), Motion(name="b.csv")], "mean of seven")
    'with 2 motions: not sufficient for the rule of the code, which needs 3 or more'
    """
    fewest = peak_rule(rule).fewest
    groups = [mean_group(motion) for motion in motions]
    smallest = min(map(groups.count, groups), default=0)
    if smallest >= fewest:
        return ""
    of_group = " of a group" if len(set(groups)) > 1 else ""
    return (
        f"with {counted(smallest, 'motion')}{of_group}: not sufficient for the rule of the code, "
        f"which needs {fewest} or more"
    )


def peaks_by_part(
    data: "xr.Dataset",
    name: str,
    motions: Sequence[Motion],
    rule: PeakRule,
    runs: Any = slice(None),
) -> Floats:
    """Return the peak of each bearing line or pier by a rule."""
    variable = PARTS.get(name, name)
    values = np.asarray(data[variable if variable in data else name])[runs].reshape(
        len(motions), -1
    )
    return np.array([_combined(column.tolist(), motions, rule) for column in values.T])


def collect_peaks(
    study: EarthquakeResult,
    motions: Sequence[Motion],
    rule: PeakRule,
    limits: Sequence[Check],
    groups: Sequence["LineGroup"] = (),
) -> "pd.DataFrame":
    """Return peaks of every bearing at every temperature, and which limits they pass."""
    limit_by_check = {check.what: check.limit for check in limits}
    limit_by_column = {
        "strain": limit_by_check.get("shear strain"),
        "ductility": limit_by_check.get("pier ductility"),
    }
    data, rows = study.dataset, []
    for (bearing, ambient), runs_table in study.table.groupby(
        ["bearing", "ambient_degC"], sort=False
    ):
        runs = runs_table.index.to_numpy()
        peaks = {c: peaks_by_part(data, n, motions, rule, runs) for n, c in COLLECTED.items()}
        for group in groups or (None,):
            row: dict[str, Any] = {"bearing": bearing, "ambient_degC": ambient}
            places: Any = slice(None)
            if group is not None:
                lines = data["line"].values.tolist()
                places = [lines.index(line) for line in group.lines]
                line_bearing = str(data["line_bearing"].values[runs[0], places[0]])
                row = {"bearing": line_bearing, "group": group.name, "ambient_degC": ambient}
            # Of bearings the lines of the group, of piers and deck the whole bridge.
            for name, column in COLLECTED.items():
                values = peaks[column][places if name in OF_LINES else slice(None)]
                # fmax: a pier without a hinge has no ductility.
                row[column] = float(np.fmax.reduce(values))
            if group is not None:
                governing = place_of_largest(peaks["ductility"])
                row["pier"] = str(data["pier_part"].values[governing])
            fails = [
                k for k, limit in limit_by_column.items() if limit is not None and row[k] > limit
            ]
            fails += [str(v) for v in dict.fromkeys(runs_table["outcome"]) if v != "completed"]
            row |= {"verdict": "NG" if fails else "OK", "fails": " ".join(fails)}
            rows.append(row)
    table = pd.DataFrame(rows)
    table.attrs["tested_range"] = study.tested_range.to_dict("records")
    return table


def of_group(name: str, group: str = "") -> str:
    """Return the name of a bearing with its group of lines, where there are several."""
    return f"{name} ({group})" if group else name


def _key_columns(table: "pd.DataFrame") -> list[str]:
    """Return the key columns of `collect_peaks` except the temperature."""
    return [name for name in ("bearing", "group") if name in table]


def envelope(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return the largest of every peak over the temperatures, and where it occurs."""
    rows = []
    for key, group in table.groupby(_key_columns(table), sort=False) if len(table) else ():
        temperatures = group["ambient_degC"].tolist()
        for column in (name for name in COLLECTED.values() if name in group):
            values = group[column].to_numpy(dtype=float)
            if np.isfinite(values).any():
                worst = place_of_largest(values)
                row = dict(zip(_key_columns(table), key, strict=True)) | {"peak": column}
                rows.append(row | {"largest": float(values[worst]), "at_degC": temperatures[worst]})
    return pd.DataFrame(rows)


STATE_PEAKS = {"force_kN": ".0f", "ductility": ".2f", "displacement_mm": ".0f"}


def state_sentences(tested: "pd.DataFrame", virgin: "pd.DataFrame") -> list[str]:
    """Return the bounds of both states of the rubber: displacement, force and ductility."""
    sentences = []
    for key, virgin_rows in virgin.groupby(_key_columns(virgin), sort=False) if len(virgin) else ():
        # A list selects a table even of one row; an index of one column has names and no tuples.
        tested_rows = tested.set_index(_key_columns(tested)).loc[[key if len(key) > 1 else key[0]]]
        largest = {
            name: [
                f"{float(np.fmax.reduce(table[name])):{form}}"
                for table in (virgin_rows, tested_rows)
            ]
            for name, form in STATE_PEAKS.items()
        }
        fails = sorted({word for text in virgin_rows["fails"] for word in str(text).split()})
        verdict = f"NG ({', '.join(fails)})" if fails else "OK"
        force, ductility, displacement = (largest[name] for name in STATE_PEAKS)
        sentences.append(
            f"{of_group(*map(str, key))}: {verdict} with virgin rubber: force at most {force[0]} "
            f"kN (tested {force[1]} kN), ductility {ductility[0]} (tested {ductility[1]}); "
            f"displacement at most {displacement[1]} mm with tested rubber (virgin "
            f"{displacement[0]} mm)"
        )
    return sentences


def coldest_sentences(table: "pd.DataFrame") -> list[str]:
    """Return the verdict of the coldest day, and the envelope, in words."""
    sentences = []
    for key, group in table.groupby(_key_columns(table), sort=False) if len(table) else ():
        rows = group.to_dict("records")
        coldest = min(rows, key=lambda row: row["ambient_degC"])
        displacement, force = (
            rows[place_of_largest(group[name])] for name in ("displacement_mm", "force_kN")
        )
        fails = f" ({coldest['fails']})" if coldest["fails"] else ""
        pier = f" of {coldest['pier']}" if "pier" in coldest else ""
        sentences.append(
            f"{of_group(*map(str, key))}: {coldest['verdict']} on the coldest day, "
            f"{coldest['ambient_degC']:g} degC{fails}: strain {coldest['strain']:.0%}, force "
            f"{coldest['force_kN']:.0f} kN, ductility {coldest['ductility']:.2f}{pier}; over all "
            f"temperatures at most {displacement['displacement_mm']:.0f} mm (at "
            f"{displacement['ambient_degC']:g} degC) and {force['force_kN']:.0f} kN (at "
            f"{force['ambient_degC']:g} degC)"
        )
    return sentences
