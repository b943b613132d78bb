"""What the document of an earthquake study says, from a result as it is loaded again."""

import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.earthquake.report_inputs import assumptions, bearings_of, inputs_of, question
from thermobearing.earthquake.report_plots import figures_of
from thermobearing.earthquake.report_tables import books_table, cold_ratios, tables_of
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.earlier import BLIND
from thermobearing.report.identity import identity_of
from thermobearing.report.limits import (
    BOOKS_CLOSE,
    IN_EARTHQUAKES,
    RIG,
    TESTED_RANGE,
    limit_checks,
    quality_table,
    verdict,
)
from thermobearing.report.pieces import NOT_JUDGED, Check, Pieces, ReportTable
from thermobearing.report.words import (
    change,
    counted,
    degrees,
    joined,
    number,
    percent,
    plain,
    tidy,
)
from thermobearing.results.ranges import parted, rate_note, ring_note

Case = Mapping[str, Any]
# Of the input: with average acceleration the books close but for rounding; other methods are off by
# what a step is off (1e-5 in the default hybrid test).
INEXACT = 1e-2
COMMANDS = {"bridge": "Earthquake study", "hybrid": "Hybrid test"}


def pieces_of(result: EarthquakeResult) -> Pieces:
    """Everything that the document of a study says.

    Parameters
    ----------
    result : of `bridge` or `hybrid`, or loaded again: both give the same.

    Examples
    --------
    >>> import thermobearing as tb
    >>> pieces = pieces_of(tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=2))
    >>> pieces.command, len(pieces.tables["peaks"].rows)
    ('bridge', 2)
    """
    attrs = result.dataset.attrs
    case = tomllib.loads(attrs["case"])
    found, warnings = parted(result.warnings)
    given = any(one.get("tested_range") is not None for one in bearings_of(case))
    validity = [tidy(text) for text in found] if given else []
    unknown = "" if given else " ".join(map(tidy, found))
    checks = checks_of(result, case)
    rate = rate_note(result.tested_range.to_dict("records"))
    ring = ring_note(lead_rise(result))
    quality, poor = quality_of(result, case)
    command = str(attrs["command"])
    return Pieces(
        command=command,
        title=f"{COMMANDS[command]} of {attrs['structure']}",
        question=question(result, case),
        answer=answer(result, verdict(checks, validity, unknown, rate)),
        inputs=inputs_of(result, case),
        tables=tables_of(result) | {"quality": quality} if result.runs else {},
        figures=figures_of(result),
        checks=checks,
        validity=validity,
        notes=[tidy(f"{note[:1].upper()}{note[1:]}") for note in (rate, ring) if note],
        validity_unknown=unknown,
        books=books_table(result) if result.runs else None,
        assumptions=assumptions(result, case),
        warnings=[*poor, *(tidy(text) for text in warnings)],
        identity=identity_of(
            str(attrs["version"]),
            str(attrs["case"]),
            f"thermobearing {command} case.resolved.toml",
        ),
    )


def answer(result: EarthquakeResult, told: str) -> list[str]:
    """What came out: what governs, what the cold changes, whether limits were kept."""
    if not result.runs:
        return [f"No run was finished ({result.outcome}): {tidy(result.sentence)}"]
    return [*early_words(result), _governing(result), _cold(result), told]


def lead_rise(result: EarthquakeResult) -> float:
    """Return the largest rise of the lead in any run and line [K]; 0 without lead."""
    own = [result.rises(run)["lead"] for run in range(result.runs)]
    rises = result.lines["lead_rise_K"].tolist() if "lead_rise_K" in result.lines else own
    return max((float(rise) for rise in rises if rise == rise), default=0.0)


def early_words(result: EarthquakeResult) -> list[str]:
    """That runs ended early or are missing, and why; nothing if none did."""
    if result.outcome == "completed":
        return []
    outcomes = [str(name) for name in result["outcome"].values]
    names = [n for n, out in zip(result.run_names, outcomes, strict=True) if out != "completed"]
    where = f" in {counted(len(names), 'run')}, first {plain(names[0])}" if names else ""
    return [
        f"The analysis was not completed{where} ({result.outcome.replace('_', ' ')}); what follows "
        f"is what was computed: {tidy(result.sentence)}"
    ]


def _largest(result: EarthquakeResult, column: str, part: str) -> tuple[float, str]:
    """Return the largest value of a column, and its run and line or pier in words."""
    table = result.table
    if not table[column].notna().any():
        return float("nan"), ""
    place = int(np.nanargmax(table[column].to_numpy(dtype=float)))
    where = f", {_named(part, table[part].iloc[place])}" if part in table else ""
    return float(table[column].iloc[place]), plain(result.run_names[place] + where)


def _named(column: str, name: str) -> str:
    """Return a line or pier as "line A1"; a name that begins so stands alone."""
    kind = column.rpartition("_")[2]
    return name if name.lower().startswith(kind) else f"{kind} {name}"


def _governing(result: EarthquakeResult) -> str:
    """Largest strain, force, and what the pier takes, each with its run."""
    strain, where = _largest(result, "bearing_strain_max", "strain_line")
    force, pushed = _largest(result, "bearing_force_max_kN", "force_line")
    which = "a" if len(result.piers) else "the"
    pier, moved = _largest(result, "pier_displacement_max_mm", "displacement_pier")
    told = [
        f"the largest shear strain is {percent(strain)} ({where})",
        f"the largest force of one bearing {number(force, '.4g')} kN"
        + (f" ({pushed})" if pushed != where else " (the same run)"),
        f"{which} pier top moves {pier:.1f} mm relative to its base ({moved})",
    ]
    ductility, bent = _largest(result, "pier_ductility", "ductility_pier")
    hinge = "the hinge that turns most" if len(result.piers) else "its hinge"
    if ductility == ductility:
        if ductility > 1.0:
            told.append(f"{hinge} yields, to a ductility of {ductility:.2f} ({bent})")
        else:
            told.append(f"{hinge} does not yield (ductility {ductility:.2f} at most, {bent})")
    many = f"Of {counted(result.runs, 'run')}, " if result.runs > 1 else ""
    text = f"{many}{joined(told)}."
    return f"{text[:1].upper()}{text[1:]}"


def _cold(result: EarthquakeResult) -> str:
    """What the coldest air changes, bearing by bearing; heating where there is no cold."""
    ratios = cold_ratios(result)
    blind = {str(n) for n in result["bearing"].values if result.dataset.attrs.get(f"bilinear:{n}")}
    if len(ratios):
        ratios = ratios[~ratios["bearing"].isin(blind)]
    if not len(ratios):
        return _heating(result)
    coldest, warmest = ratios["ambient_degC"].min(), result.table["ambient_degC"].max()
    cold = ratios[ratios["ambient_degC"] == coldest]
    told = [_cold_of(str(name), group) for name, group in cold.groupby("bearing", sort=False)]
    motions = cold["motion"].nunique()
    mean = " on average over the motions" if motions > 1 else ""
    only = f"; {', '.join(sorted(blind))} knows no temperature" if blind else ""
    return (
        f"{degrees([coldest])} against {degrees([warmest])} changes{mean}: {'; '.join(told)}{only}."
    )


def _cold_of(name: str, group: pd.DataFrame) -> str:
    parts = []
    for column, what in (
        ("bearing_force_max_kN", "force"),
        ("bearing_strain_max", "strain"),
        ("pier_displacement_max_mm", "pier displacement"),
    ):
        values = group[column].dropna()
        if len(values):
            parts.append(f"{what} {change(float(values.mean()), 'more', 'less')}")
    return f"{name}: {joined(parts)}"


def _heating(result: EarthquakeResult) -> str:
    """Return the largest rises of rubber and lead, each with its run and line, as a sentence."""
    found: dict[str, list[tuple[float, str]]] = {"rubber": [], "lead": []}
    for run, name in enumerate(result.run_names):
        for place, rise in result.rises(run).items():
            found["lead" if place == "lead" else "rubber"].append((rise, name))
    if "lead_rise_K" in result.lines:  # earlier results have none
        names = np.repeat(result.run_names, len(result.lines) // result.runs)
        lines = [_named("line", line) for line in result.lines["line"]]
        where = [f"{run}, {line}" for run, line in zip(names, lines, strict=True)]
        found = {k: list(zip(result.lines[f"{k}_rise_K"], where, strict=True)) for k in found}
    told = []
    for what, rises in found.items():
        if known := [one for one in rises if np.isfinite(one[0])]:
            rise, where_ = max(known)
            told.append(f"the {what} by up to {rise:.1f} K ({plain(where_)})")
    if not told:
        return "No bearing of the study knows temperature."
    return f"The motions warm {joined(told)}."


def checks_of(result: EarthquakeResult, case: Case) -> list[Check]:
    """Return the checks: yielding of piers, limits of the rig, tested ranges."""
    if not result.runs:
        return []
    rig = str(case.get("rig", {}).get("name", "rig"))
    found = _ductilities(result)
    found += limit_checks(result.rig.to_dict("records"), RIG, f"rig {rig}")
    names = [str(one["name"]) for one in bearings_of(case)]

    def bearing_of(run: str) -> str:
        return next((name for name in names if run.startswith(f"{name}, ")), "")

    rows = result.tested_range.to_dict("records")
    return found + limit_checks(rows, IN_EARTHQUAKES, f"{TESTED_RANGE} of the bearing", bearing_of)


def quality_of(result: EarthquakeResult, case: Case) -> tuple[ReportTable, list[str]]:
    """Return the largest residuals of the energy balance, and warnings of those too large."""
    found = []
    gaps = case["analysis"]["scheme"] == "published" or case["analysis"]["model"] in BLIND
    for name in ("structure", "mechanical", "thermal"):
        largest = float(result.energy[f"{name}_residual"].abs().max())
        limit, source = BOOKS_CLOSE, "energy balance"
        if name == "thermal" and gaps:
            limit, source = float("nan"), "no limit: this model's books have gaps"
        elif name == "structure" and case["analysis"]["method"] != "average-acceleration":
            limit, source = INEXACT, "this time integration does not keep energy exactly"
        found.append((f"{name} residual", largest, limit, source))
    return quality_table(found)


def _ductilities(result: EarthquakeResult) -> list[Check]:
    """Of each pier; first yield is told, a limit of a code is not in the input."""
    source = "first yield of the hinge; no limit of a code is given"
    piers, names = result.piers, result.run_names
    if len(piers) and piers["ductility"].notna().any():
        groups = [(f"pier {name}", mine) for name, mine in piers.groupby("pier", sort=False)]
        columns = [(what, mine["ductility"].to_numpy(dtype=float)) for what, mine in groups]
    else:
        columns = [("pier", result.table["pier_ductility"].to_numpy(dtype=float))]
    found = []
    for what, values in columns:
        if np.isfinite(values).any():
            place = int(np.nanargmax(values))
            told = f"ductility of {what} ({plain(names[place])})"
            found.append(Check(told, float(values[place]), 1.0, "", source, NOT_JUDGED))
    return found
