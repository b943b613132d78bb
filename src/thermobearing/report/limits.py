"""Checks and marks from what runs asked of a rig, or of the tests behind a bearing."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from thermobearing.report.pieces import EXCEEDED, NOT_JUDGED, PASSED, Check, Column, ReportTable
from thermobearing.report.words import counted, plain, printed_unit
from thermobearing.results.ranges import SLACK, TESTED

# Largest residual of energy books, of the largest energy in them: rounding comes to 1e-10, what is
# more is a fault of the computation.
BOOKS_CLOSE = 1e-6
MARKED = "Marked: beyond what the bearing was tested at"
TESTED_RANGE = "tested range"  # how the source of those limits begins
RIG = {"force": "force", "stroke": "stroke", "speed": "speed"}
TESTS = {name: title for name, (_, title, _, _) in TESTED.items()}
TESTS |= {"strain": "shear strain", "ambient": "ambient temperature"}
TESTS |= {"lead_temperature": "temperature of the lead"}
IN_EARTHQUAKES = {name: title for name, title in TESTS.items() if name != "strain_rate"}
Row = Mapping[Any, Any]


def limit_checks(
    rows: Iterable[Row],
    titles: Mapping[str, str],
    source: str,
    bearings: Sequence[str] = (),
) -> list[Check]:
    """A check for each end of each limit: the run that goes farthest.

    Parameters
    ----------
    rows : of `results.ranges.compared`.
    titles : words for a limit; others are left out.
    source : of the limits.
    bearings : names with which runs begin, whose limits are their own; none where there is one
        for all runs.

    Examples
    --------
    >>> row = {"run": "kobe", "limit": "force", "unit": "kN", "asked": 445.0, "lowest": 0.0,
    ...        "largest": 400.0, "passed": True}
    >>> check, = limit_checks([row], RIG, "shen-rig")
    >>> check.what, check.verdict
    ('force (kobe)', 'exceeded')
    """
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row["limit"] in titles:
            run = str(row["run"])
            bearing = next((name for name in bearings if run.startswith(f"{name}, ")), "")
            groups.setdefault((bearing, row["limit"]), []).append(row)
    found = []
    for (bearing, limit), mine in groups.items():
        name = f"{bearing}: {titles[limit]}" if bearing else titles[limit]
        above = max(mine, key=lambda row: row["asked"])
        found.append(_check(name, above, bearing, source, lower=False))
        below = min(mine, key=lambda row: row["asked"])
        if below["passed"] and below["asked"] < below["lowest"]:
            found.append(_check(name, below, bearing, source, lower=True))
    return found


def _check(name: str, row: Row, bearing: str, source: str, *, lower: bool) -> Check:
    """One end of a limit."""
    limit = float(row["lowest"] if lower else row["largest"])
    value = float(row["asked"])
    unit, factor = printed_unit(str(row["unit"]))
    if row["limit"] == "strain":
        unit, factor = "%", 100.0
    outside = value < limit if lower else value > limit
    passed = bool(row["passed"]) and outside
    if outside and not passed:
        source = f"{source}, and {SLACK:.0%} more".replace("%", " %")
    run = plain(str(row["run"]).removeprefix(f"{bearing}, "))
    verdict = EXCEEDED if passed else PASSED
    told = f"{name} ({run})"
    return Check(told, factor * value, factor * limit, unit, source, verdict, lower)


def quality_table(rows: Iterable[tuple[str, float, float, str]]) -> tuple[ReportTable, list[str]]:
    """Return the residuals of the energy balance as a table, and warnings of those too large.

    They judge the computation, not the structure, and are none of the checks.

    Parameters
    ----------
    rows : what, value, limit (NaN: none), where the limit is from.

    Examples
    --------
    >>> table, warnings = quality_table([("mechanical residual", 1e-12, 1e-6, "rounding")])
    >>> table.rows[0][-1], warnings
    ('within', [])
    """
    cells, warnings = [], []
    for what, value, limit, source in rows:
        judged = value == value and limit == limit
        verdict = (PASSED if abs(value) <= limit else EXCEEDED) if judged else NOT_JUDGED
        cells.append([what, abs(value), limit, source, verdict])
        if verdict == EXCEEDED:
            warnings.append(
                f"The {what} of the energy balance is {abs(value):.1e}, above {limit:.0e}: the "
                "numbers are not those of the model; take a smaller dt."
            )
    columns = [Column("Energy balance"), Column("Largest", "", ".1e"), Column("Limit", "", ".0e")]
    columns += [Column("Source of the limit"), Column("Verdict")]
    return ReportTable("Numerical quality", columns, cells), warnings


def verdict_of(checks: Iterable[Check]) -> str:
    """Return what the checks come to: what is exceeded first, then what could not be judged.

    Examples
    --------
    >>> verdict_of([Check("force", 445.0, 400.0, "kN", "rig", EXCEEDED)])
    'Of 1 check, 1 is exceeded: force.'
    """
    every = list(checks)
    if not every:
        return "No limit was given."
    beyond = [check.what for check in every if check.verdict == EXCEEDED]
    unknown = [check.what for check in every if check.verdict == NOT_JUDGED]
    many = counted(len(every), "check")
    told = [
        f"{len(names)} {'is' if len(names) == 1 else 'are'} {verdict}: {_first(names)}"
        for names, verdict in ((beyond, EXCEEDED), (unknown, NOT_JUDGED))
        if names
    ]
    if told:
        return f"Of {many}, {'; '.join(told)}."
    return (
        f"All {many} are within their limits."
        if len(every) > 1
        else "The check is within its limit."
    )


def _first(names: Sequence[str]) -> str:
    """Return the first names, and how many more there are."""
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"{', '.join(names[:3])}{more}"


def verdict(
    checks: Iterable[Check], validity: Sequence[str], unknown: str = "", rate: str = ""
) -> str:
    """Return the sentences on limits and validity, the last of an answer.

    Parameters
    ----------
    checks : of the result.
    validity : sentences on what left the range behind the parameters.
    unknown : why there is no such range.
    rate : note on strain rates beyond the tests.

    Examples
    --------
    >>> verdict([Check("force", 4.0, 5.0, "kN", "rig", PASSED)], [])  # doctest: +ELLIPSIS
    'The check is within its limit. Nothing left the range...'
    """
    if unknown:
        told = "The range that the parameters were identified in is not given, so validity is not "
        told += "judged."
    elif validity:
        told = "Beyond the range that the parameters were identified in, results are extrapolated: "
        told += f"{_few(validity)}."
    elif rate:
        told = "But for strain rates, nothing left the range that the parameters were identified "
        told += "in."
    else:
        told = "Nothing left the range that the parameters were identified in."
    return f"{verdict_of(checks)} {told}"


def _few(validity: Sequence[str]) -> str:
    """The first sentences without their ends, and how many more there are."""
    shown = [text.rstrip(".").split(" (")[0].split(", outside")[0] for text in validity[:2]]
    more = len(validity) - len(shown)
    return "; ".join(shown) + (f"; and {more} more" if more else "")


def beyond_mark(rows: Iterable[Row], run: str, limit: str, value: float) -> bool:
    """Whether a value of a run lies outside the range, and the run was found to leave it."""
    return any(
        row["passed"]
        and row["run"] == run
        and row["limit"] == limit
        and not row["lowest"] <= value <= row["largest"]
        for row in rows
    )
