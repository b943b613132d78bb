"""The certificate of a calibration: one page for a laboratory to sign."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.opener import LARGEST_MEMBER, file_digest, is_file
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.identify.properties import brief_properties
from thermobearing.identify.report import (
    BRIEF,
    CLOSING,
    LOOPS,
    Row,
    parameters_table,
    rounded_range,
    valid_for,
    with_basis,
    worst_error,
)
from thermobearing.identify.treatments import OF_ALL_RECORDS, describe_treatments
from thermobearing.identify.uncertainty.diagnosis import (
    MISFIT,
    MOST_CAUSES,
    NONE_PLAUSIBLE,
    SIGNALS,
    examined_signals,
    range_words,
)
from thermobearing.identify.uncertainty.groups import CELLS
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import (
    counted,
    degrees,
    first_sentences,
    joined,
    number,
    percent,
    quantity,
    tidy,
)
from thermobearing.report import content
from thermobearing.report.content import TESTS
from thermobearing.report.pieces import Pieces, ReportFigure
from thermobearing.reported import bearing_words
from thermobearing.results.base import COMPLETED
from thermobearing.results.directory import COMPOUND, IDENTIFIED, INPUT_DIGESTS
from thermobearing.results.ranges import EXTREME, REST, names_by_sentence
from thermobearing.results.saved import SavedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIGNED = ("Tested by", "Calibrated by", "Approved by")
# Of all tables on the page of a certificate with a title block and a logo, and of the lines of its
# statements beyond the usual ones.
PAGE_ROWS = 22
OF_A_TABLE = 4  # rows that caption and heads of a table take
LINE = 95  # letters of a statement in one line of the page
USUAL_LINES = 9  # of the range, the specimen, the digests and one more
MOST_WARNINGS = 3  # that are listed
CONCERNS = re.compile("interval|standard error")  # what the tables of the page state
SENTENCE_END = re.compile(r"(?<=[.!?])\s+")
MOST_SPECIMENS = 3  # that the title names
TEMPERATURE_COEFFICIENTS = ("m_T", "n_T")
STATED_CONDITIONS = {"specimen": "Specimen", "laboratory": "laboratory", "date": "date"}
NARROW = 14  # letters of a name in the table of tests that do not break
MOST_FILES = 6  # of tests that are listed; inputs.sha256 has all
MOST_LOOPS = 3  # panels of its figure, besides one of a test held out
LOOP_WIDTHS = 3.4, 0.6  # of the band of a test and of the line of the model [pt]
FIGURE_HEIGHT, LEAST_HEIGHT = 1.4, 1.2  # of the figure [inch], and where the page is full
OVERFULL = -34  # rows of room below which the figure, which report.html has too, is left out
NOTE_LINE = 150  # letters of the small print below a table in one line of the page
ABOUT = ["test", "use", "date", "ambient_degC"]
ABOUT += ["cycles_found", "largest_strain", "largest_speed_mm_s", "R2", "K_eq_error", "h_eq_error"]
ABOUT += ["temperature_error"]
SAME_AMPLITUDE = 0.05  # by which cycles of one amplitude of a test may differ, relative


def build_certificate(saved: SavedResult) -> Pieces:
    """Return the pieces of the certificate of a calibration, which fills one page.

    Raises InputError for anything but a completed calibration.
    """
    summary = saved.summary
    if saved.command != "identify" or "parameters" not in summary:
        raise InputError("only a calibration (`identify`) has a certificate", str(saved.path))
    outcome = str(summary["outcome"])
    if outcome != COMPLETED:
        reason = f"{outcome.replace('_', ' ')}: {summary['sentence']}"
        raise InputError(f"there is no certificate of this calibration ({reason})", str(saved.path))
    bearing, _ = split_sources(read_toml(saved.path / IDENTIFIED))
    named = {**bearing, "name": summary["bearing"]}
    tests = [str(record["name"]) for record in summary["records"]]
    parameters = _certified_parameters(summary, bearing)
    held_out = summary.get("held_out") or {}
    listed = [*summary["records"], *held_out.get("records", [])]
    tables = {"tests": _certified_tests(summary["records"], held_out.get("records", []))}
    identity = content.saved_identity(saved, "thermobearing.identify_bearing(...) in Python")
    answer = [*_certified_range(bearing, summary["records"]), *_certified_conditions(listed)]
    answer += [*_certified_held_out(held_out), *_certified_narrowing(summary)]
    answer += _certified_digests(saved, listed)
    answer += _certified_warnings(saved.warnings, _causes(summary))
    files = _certified_files(listed)
    lines = sum(1 + len(text) // LINE for text in answer)
    broken = sum(_is_broken(record) for record in listed)
    properties = brief_properties(summary.get("properties") or [])
    # The certificate is one page: the cycles take the rows that the other tables leave.
    room = PAGE_ROWS - len(listed) - broken - len(parameters.rows) - max(0, lines - USUAL_LINES)
    room -= sum(len(table.rows) + OF_A_TABLE for table in (properties, files) if table.rows)
    room -= sum(-(-len(table.note) // NOTE_LINE) for table in (tables["tests"], properties))
    cycles = _certified_rows(saved["cycles"]) if "cycles" in saved.tables else None
    if cycles is not None and room >= max(len(tests), cycles["test"].nunique()):
        tables["cycles"] = _certified_cycles(cycles, room)
    elif cycles is not None:
        tables["tests"] = replace(tables["tests"], caption="Tests (their cycles: cycles.csv)")
    tables |= {"properties": properties} if properties.rows else {}
    tables["parameters"] = parameters
    tables |= {"files": files} if files.rows else {}
    height = FIGURE_HEIGHT if room >= 0 else LEAST_HEIGHT
    drawn = "fit" in saved.tables and room >= OVERFULL
    return Pieces(
        command="certificate",
        title=f"Calibration certificate of {_subject(summary)}",
        question=f"The model of the bearing {bearing_words(named)} was calibrated to "
        f"{counted(len(tests), 'test')} ({joined(tests)}). "
        f"{_certified_sizes(saved)}",
        answer=answer,
        tables=tables,
        figures={"loops": _certified_loops(saved, height)} if drawn else {},
        identity=identity,
        signatures=SIGNED,
        one_page=True,
    )


def _certified_tests(records: Sequence[Row], held_out: Sequence[Row]) -> Table:
    """Return what each test was, how it was used, and the errors of the model in it.

    The note states the treatment of its data.
    """
    rows = []
    for use, tests in (("calibration" if held_out else "", records), ("held out", held_out)):
        for record in tests:
            names = ("ambient_degC", "R2")
            row = {"test": record["name"], "use": use} | {name: record[name] for name in names}
            row |= {
                "cycles_found": len(record["cycles"]),
                "K_eq_error": worst_error(record, "G_eq_error"),  # relative errors are the same
                "h_eq_error": worst_error(record, "h_eq_error"),
                "temperature_error": record.get("largest_rise_error"),
            }
            rows.append(record["conditions"] | row)
    if any(row.get("date") for row in rows):
        rows = [row | {"date": row.get("date") or "not stated"} for row in rows]
    heads = {"K_eq_error": "K_eq error", "h_eq_error": "h_eq error"}
    heads["temperature_error"] = "Rise error"
    treatments = " ".join(describe_treatments([*records, *held_out]))
    note = (
        f"Treatment of the records. {treatments} {OF_ALL_RECORDS} Errors: largest over the cycles, "
        "model / test \N{MINUS SIGN} 1."
    )
    if any(row["temperature_error"] is not None for row in rows):
        note += (
            " Rise error: largest difference of a temperature rise at any time, over the largest "
            "rise of the test."
        )
    return make_table(pd.DataFrame(rows), ABOUT, "Tests", heads=heads, note=note, keep_keys=True)


def _subject(summary: Row) -> str:
    """Return the specimens of the tests, or the bearing where no test names one."""
    names = (record["conditions"].get("specimen") for record in summary["records"])
    specimens = [str(name) for name in dict.fromkeys(names) if name]
    if not specimens or len(specimens) > MOST_SPECIMENS:
        return str(summary["bearing"])
    return f"{'specimen' if len(specimens) == 1 else 'specimens'} {joined(specimens)}"


def _certified_sizes(saved: SavedResult) -> str:
    """Return a sentence on the sizes of bearings that the parameters are valid for."""
    text = "The parameters are those of a bearing of this size and rubber compound"
    if is_file(saved.path / COMPOUND):
        return f"{text}; {COMPOUND} contains the compound, for bearings of other sizes."
    return f"{text}."


def _certified_parameters(summary: Row, bearing: Row) -> Table:
    """Return the parameters; the note has what their values are relative to."""
    table = parameters_table(summary, BRIEF)
    symbols = [str(item["symbol"]) for item in summary["parameters"].values()]
    coefficients = [symbol for symbol in TEMPERATURE_COEFFICIENTS if symbol in symbols]
    relative = []
    if "K_r" in symbols:
        reference = quantity(bearing["hysteresis"]["reference_temperature"])
        relative.append(f"K_r is the value at {reference}")
    if coefficients:
        verb = "is" if len(coefficients) == 1 else "are"
        relative.append(f"{joined(coefficients)} {verb} per 100 K")
    table = replace(table, note=f"{joined(relative)}. {table.note}") if relative else table
    return with_basis(table, summary)


def _certified_conditions(records: Sequence[Row]) -> list[str]:
    """Return a statement on specimen, laboratory and rubber of the tests, once if they agree."""
    words = {True: "scragged", False: "virgin", None: "not stated"}
    stated = []
    for key, title in STATED_CONDITIONS.items():
        values = {record["name"]: record["conditions"].get(key) for record in records}
        # The table of tests has a column of dates, if any is stated.
        if key != "date" or not any(values.values()):
            stated.append(f"{title}: {_by_test(values, 'not stated')}")
    loads = {record["name"]: _load(record["conditions"]) for record in records}
    stated.append(f"vertical load: {_by_test(loads, 'not stated')}")
    before = {record["name"]: words[record["conditions"].get("scragged")] for record in records}
    stated.append(f"rubber before the tests: {_by_test(before, 'not stated')}")
    text = "; ".join(stated)
    return [f"{text[:1].upper()}{text[1:]}."]


def _load(conditions: Row) -> str | None:
    """Return the vertical load of a test in kN, and whether it acts on its shear force."""
    if ends := conditions.get("axial_force_kN"):
        shown = " to ".join(dict.fromkeys(number(end, ".4g") for end in ends))
        return f"{shown} kN, which acts on the shear force"
    stated = conditions.get("stated_axial_force_kN")
    return None if stated is None else f"{number(stated, '.4g')} kN, without effect in the model"


def _by_test(values: Row, missing: str) -> str:
    """Return the value of all tests, or each value with its tests."""
    groups = names_by_sentence((str(name), str(value or missing)) for name, value in values.items())
    if len(groups) == 1:
        return groups[0][1]
    return ", ".join(f"{value} ({names})" for names, value in groups)


def _certified_digests(saved: SavedResult, records: Sequence[Row]) -> list[str]:
    """Return what identifies data and bearing, in words by which a reader can check it."""
    bearing = file_digest(saved.path / IDENTIFIED, LARGEST_MEMBER)
    description = f"SHA-256 of {IDENTIFIED}, which describes the bearing: `{bearing}`."
    file = saved.path / INPUT_DIGESTS
    if is_file(file):
        count = counted(len(content.input_files(records)), "file")
        return [
            f"SHA-256 of {INPUT_DIGESTS}: `{file_digest(file, LARGEST_MEMBER)}`. That file lists "
            f"the SHA-256 of each of the {count} of all tests, sidecars and tests held out "
            f"included; `sha256sum -c` with its path verifies them in the folder in "
            f"which the calibration was run. {description}"
        ]
    identity = content.saved_identity(saved, "")
    statements = [f"{label}: `{text}`." for label, text in identity.items() if "inputs" in label]
    return [*statements, description]


def _certified_files(records: Sequence[Row]) -> Table:
    """Return the tables of samples with their digests; no rows where there are too many."""
    rows = [
        [record["name"], Path(path).name, digest]
        for record in records
        for path, digest in content.input_files([record])
        if Path(path).suffix.lower() != ".toml"
    ]
    columns = [Quantity("Test"), Quantity("File"), Quantity("SHA-256 of the file")]
    caption = "Measured data (the sidecars: inputs.sha256)"
    return Table(caption, columns, rows if len(rows) <= MOST_FILES else [], keys=2)


def _is_broken(record: Row) -> bool:
    """Return whether the row of a test breaks into two lines."""
    names = [record["name"], record["conditions"].get("date", "")]
    return any(len(str(name)) > NARROW for name in names)


def _certified_held_out(held_out: Row) -> list[str]:
    """Return a statement on each test that was held out, with its errors and limits."""
    statements = []
    for test in held_out.get("tests", []):
        if test["role"] != "held out":
            continue
        errors = [
            f"{name} {number(100.0 * test[f'{name}_error'], '+.1f')} % (limit {percent(limit)})"
            for name, limit in held_out["limits"].items()
            if test.get(f"{name}_error") is not None
        ]
        whose = f"Held out of fold {test['fold']}" if test.get("fold") else "Held out"
        statements.append(
            f"{whose}: {test['test']} at {degrees([test['ambient_degC']])}; largest errors: "
            f"{joined(errors) or 'not known'}."
        )
    return statements


def _causes(summary: Row) -> str:
    """Return what the causes of a misfit are, with their sizes; of one, what else it stands for.

    "" without any.
    """
    suspects = summary.get("suspects") or []
    if not suspects:
        return ""
    first, *others = suspects
    signals = first.get("explains") or examined_signals(temperatures=False)
    if not first.get("plausible", True):
        return NONE_PLAUSIBLE.replace(SIGNALS, signals)
    others = [item for item in others if item.get("named") and item.get("plausible")]
    if not others:
        cause = f" ({first['cause']})" if first.get("cause") else ""
        return f"Most plausible cause of {signals}: {_cause(first)}{cause}"
    listed = [_cause(item) for item in [first, *others][:MOST_CAUSES]]
    if hidden := 1 + len(others) - len(listed):
        listed.append(f"{hidden} more in report.html")
    first_words = (
        f"Possible causes of {signals}, one or several, which the tests do not distinguish"
    )
    return f"{first_words}: {'; '.join(listed)}"


def _cause(suspect: Row) -> str:
    """Return a cause of a misfit with its size."""
    words = str(suspect["name"])
    if suspect["key"] == CELLS:
        return words
    sizes = suspect.get("sizes") or [suspect["size"]] * 2  # results of older versions have one
    return f"{words}, {range_words(sizes, suspect['unit'])}"


def _certified_narrowing(summary: Row) -> list[str]:
    """Return how well a prediction is known and which test would narrow it; none without one."""
    posterior = summary.get("posterior") or {}
    if not posterior.get("narrowing"):
        return []
    return [tidy(str(posterior["notes"][-1]))]


def _certified_warnings(warnings: Sequence[str], cause: str = "") -> list[str]:
    """Return what some warnings say of the page, and what the report has more.

    A misfit comes first, since it puts the model in doubt; then come the warnings that concern the
    numbers on the page. `cause` is a sentence on that of a misfit, behind whose size it stands.
    """
    ordered = sorted(warnings, key=lambda text: (MISFIT not in text, CONCERNS.search(text) is None))
    texts = [f"Warning: {tidy(text)}" for text in ordered[:MOST_WARNINGS]]
    shown = [_certified_warning(text) for text in texts]
    shown = [f"{text} {cause}." if cause and MISFIT in text else text for text in shown]
    remaining = len(warnings) - len(shown)
    rest = [counted(remaining, "more warning")] if remaining else []
    if shown != texts:
        rest.append(f"the full text of {'this warning' if len(shown) == 1 else 'these warnings'}")
    return [*shown, f"The file report.html has {joined(rest)}."] if rest else shown


def _certified_warning(text: str) -> str:
    """Return the first sentences of a warning, and those that concern the numbers on the page."""
    first = first_sentences(text, LINE)
    sentences = [sentence for sentence in SENTENCE_END.split(text) if CONCERNS.search(sentence)]
    later = [sentence for sentence in sentences if sentence.removesuffix(".") not in first]
    if later and later[0].startswith(first.removesuffix(".")):
        return " ".join(later)  # the first clause is one of a sentence that is needed completely
    return " ".join([first, *later])


def _certified_rows(cycles: "pd.DataFrame") -> "pd.DataFrame":
    """Return the cycles of all tests; tests that were held out say so in their name."""
    roles = cycles["bearing"].astype(str).str.partition(", ")[2]
    tests = cycles["test"].astype(str)
    return cycles.assign(test=tests.where(roles != "held out", tests + " (held out)"))


def _certified_cycles(cycles: "pd.DataFrame", room: int) -> Table:
    """Return K_eq, Q_d and h_eq of cycles in test and model, in as many rows as there is room."""
    groups = [rows for _, rows in cycles.groupby("test", sort=False)]
    limit = max(1, room // len(groups))
    frame = pd.concat(
        rows.iloc[np.linspace(0, len(rows) - 1, min(limit, len(rows))).round().astype(int)]
        for rows in groups
    )
    frame["cycle_displacement_mm"] = 0.5 * (frame["D+_mm"] - frame["D-_mm"])
    names = ["test", "ambient_degC", "cycle", "cycle_displacement_mm"]
    for name in ("K_eq", "Q_d", "h_eq"):
        names += [f"{name}_test", f"{name}_model"]
    notes = []
    if len(frame) < len(cycles):
        listed = f"At most {counted(limit, 'cycle')} of each test, spread evenly from the first to "
        notes.append(f"{listed}the last; cycles.csv has all {len(cycles)}.")
    notes += [CLOSING] * any(rows["cycle"].max() > len(rows) for rows in groups)
    caption = "Cycles in test and model"
    return make_table(frame, names, caption, keys=3, note=" ".join(notes), keep_keys=True)


def _cycles_by_amplitude(records: Sequence[Row]) -> str:
    """Return the cycles of at least a part EXTREME of the largest amplitude, in words.

    Of the test that has most of them, such as "3 at 175 % and 3 at 100 %"; amplitudes that differ
    by less than `SAME_AMPLITUDE` are one. Empty without full cycles.
    """
    counts: list[dict[float, int]] = []
    for record in records:
        strains = sorted((float(c["amplitude_strain"]) for c in record["cycles"]), reverse=True)
        count: dict[float, int] = {}
        for strain in strains:
            if strain >= EXTREME * strains[0]:
                amplitude = next((a for a in count if strain > (1.0 - SAME_AMPLITUDE) * a), strain)
                count[amplitude] = count.get(amplitude, 0) + 1
        counts.append(count)
    most = max(counts, key=lambda count: sum(count.values()), default={})
    return joined(f"{number} at {percent(strain)}" for strain, number in most.items())


def _certified_range(bearing: Row, records: Sequence[Row]) -> list[str]:
    """Return a statement on the conditions that the parameters are valid for."""
    ranges = bearing.get("tested_range") or {}
    valid = valid_for(bearing)
    if not valid:
        return []
    conditions = []
    for name, ends in ranges.items():
        text = rounded_range(ends)
        if name == "cycles":
            by_amplitude = _cycles_by_amplitude(records)
            conditions.append(
                f"up to {rounded_range(ends[-1:])} cycles of at least {percent(EXTREME)} of the "
                f"largest displacement without a pause of {REST / 60.0:g} min or more"
                + f" (full cycles of a test: {by_amplitude} shear strain)"
                * bool(by_amplitude)
            )
        elif name not in ("strain", "ambient", "strain_rate"):
            conditions.append(f"a {TESTS[name]} of {text}")
    return [f"{valid}, {joined(conditions)}." if conditions else f"{valid}."]


def _samples_of_tests(saved: SavedResult) -> "list[tuple[str, pd.DataFrame]]":
    """Return the samples of the tests that the figure shows, by a title.

    The last one is a test that was held out, if there is one. The table of tests has temperatures.
    """
    summary = saved.summary
    held_out = (summary.get("held_out") or {}).get("records", [])
    panels = []
    for table, records, role, most in (
        ("fit", summary["records"], "", MOST_LOOPS),
        ("held_out", held_out, " (held out)", 1),
    ):
        if table in saved.tables:
            groups = list(saved[table].groupby("record", sort=False))[:most]
            panels += [(f"{records[int(str(k))]['name']}{role}", rows) for k, rows in groups]
    return panels


def _certified_loops(saved: SavedResult, height: float) -> ReportFigure:
    """Return the loops of tests and model, in panels side by side, `height` inches high."""
    records = saved.summary["records"]
    some = f", {MOST_LOOPS} of {len(records)} tests" if len(records) > MOST_LOOPS else ""

    def _draw() -> "Figure":
        from thermobearing.results import drawing

        groups = _samples_of_tests(saved)
        figure, axes = drawing.panels(1, len(groups), (7.0, height), "")
        for ax, (title, rows) in zip(axes, groups, strict=True):
            for (_, column, colour, _), width in zip(LOOPS, LOOP_WIDTHS, strict=True):
                ax.plot(rows["displacement_mm"], rows[column], color=colour, linewidth=width)
            drawing.name_axes(ax, "displacement [mm]", "force [kN]", title)
        return figure

    caption = f"Loops of the test (grey band) and the model (red line){some}."
    return ReportFigure(caption, draw=_draw)
