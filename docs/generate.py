"""Regenerate every number and figure in README and docs: `make docs`.

Runs the tests (which record what they measure) and the benches, draws all pictures (`--pictures`
draws these alone), and writes the tables between the `generated` marks. `--texts-only` rewrites
the texts from the numbers that are there, and the descriptions of options that help reads, which
the tests use to see that nobody typed a number by hand.
"""

import argparse
import ast
import csv
import io
import json
import os
import re
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

from docs import notebook, readme
from docs.builder import keys, pictures
from thermobearing import cli  # noqa: F401 (it has all commands)
from thermobearing.commands.descriptions import descriptions_text
from thermobearing.commands.options import COMMAND_FIELDS, DESCRIPTIONS
from thermobearing.verify.rows import EVIDENCE, row_definitions

DOCS = Path(__file__).parent
README = DOCS.parent / "README.md"
TEXTS = DOCS / "texts"  # written by hand, between the tables of verification.md
SECTIONS = ("one_dimension", "factors", "lead", "structures", "near_fault", "source")
# Tables between marks in the texts, each printed by `python -m benchmarks.NAME`.
TABLES = {"lead": ("lead_rise",), "source": ("bearing_count", "source_hybrid")}
COVERAGE = DOCS / "coverage.toml"  # every item of Shen (2023); written by hand
NUMBER = re.compile(r"[-+]?\d+\.\d+")
NAMED = re.compile(r"\{([^}]+)\}")  # of docs/measured.json, in the words of an item
sys.path.append(str(DOCS.parent))  # for the package `reproduction`
LEDGER = DOCS.parent / "tests" / "reproduction" / "ledger.json"  # see its baseline.py
APPENDIX = DOCS / "appendix"  # generated, outside the navigation of the site
ORPHAN = "---\norphan: true\n---\n\n"
SUMMARY = DOCS / "verification.toml"  # rows of docs/verification.md
MEASURED, BENCH = DOCS / "measured.json", DOCS / "bench.json"

VERDICTS = {
    "works": "runs, and does not contradict Shen (2023)",
    "partial": "runs, but something of it is missing, as said",
    "undecided": "runs; another motion of the same spectrum, or less than 1 %, decides",
    "contradicted": "runs, but the words or numbers of Shen (2023) say otherwise",
    "needs data": "runs; only the measurements of Shen (2023) can judge it",
    "outside": "outside a model with heat flow through the height only",
    "later": "comes later",
}

LEAD = "LHDR, lead, conservative against finite elements, after loading"
INNER_LAYER = "LHDR, middle of rubber 3, conservative against finite elements, after loading"
PIER = "pier P1 on LHDR, 40 s, 8000 steps of 5 ms, one core"
PIER_TIME = re.compile(r"(takes about )[\d.]+ ms")  # of the same in README, with one digit
# Of the benches, what the page on verification says of speed.
BENCH_SHOWN = (
    "coupled step, 19 cells, 3 layers, Table 3.4 at -20 degC",
    "coupled step with lead, 29 cells, 3 layers and core, Table 3.4 at -20 degC",
    "default bridge study, 36 runs, two cores",
    PIER,
    "coupled step in a plane, circle, shen-hdr-specimen, over one on a line",
    "pier P1 on LHDR in plan with two components, over the same in one direction",
    "OpenSees, pier P1 on LeadRubberX with lead heating",
    "ratio of the two, pier P1",
    "lockstep over one by one, pier P1, 8000 steps",
    "100 000 histories of pier P1, two cores",
)


def load(path: Path) -> Any:
    """A JSON file."""
    return json.loads(path.read_text(encoding="utf-8"))


def table(heads: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def csv_text(heads: list[str], rows: list[list[str]]) -> str:
    """Return a table as CSV, for spreadsheets and pandas."""
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows([heads, *rows])
    return buffer.getvalue()


def bench_rows(bench: dict[str, Any]) -> list[list[str]]:
    """What the benches measured, with target and whether it was met."""
    marks = {True: "yes", False: "**no**", None: ""}
    return [
        [row["what"], number(row["value"], row["unit"]), row["target"], marks[row["met"]]]
        for rows in bench["rows"].values()
        for row in rows
    ]


def number(value: float | None, unit: str) -> str:
    """A value as people read it."""
    if value is None:
        return "-"
    text = f"{value:.1e}" if value and abs(value) < 1e-3 else f"{value:.3g}"
    return f"{f'{value:.0f}' if abs(value) >= 1000 else text} {unit}".strip()


def heat_agreement(lead: str, layer: str) -> str:
    """Return errors such as "-0.8 of 73.5 K; cooling -1.0 K", of the LHDR specimen, in words."""
    numbers = [NUMBER.findall(text) for text in (lead, layer)]
    worst = max(abs(float(error)) for heated, _, cooled in numbers for error in (heated, cooled))
    (_, of_lead, _), (_, of_layer, _) = numbers
    return (
        f"temperatures of the LHDR specimen agree within {worst:.1f} K (largest rise of the lead "
        f"{of_lead} K, of the inner rubber layer {of_layer} K)"
    )


def validated_rows(measured: list[dict[str, str]]) -> str:
    """Return what README says of validation."""
    value = {m["what"]: m["value"] for m in measured}
    peak = value["pier-p1, bilinear bearings, force against OpenSees: peak, complete history"]
    ids = ledger_groups()["statements"]
    counts = ledger_counts(ids)
    facts, asides = contradictions()
    wrong, aside = (sum(map(len, groups.values())) for groups in (facts, asides))
    error = 100.0 * float(value["NRMSE of the real HDR test, with scragging"])
    lines = [
        f"**OpenSees**: the force of a pier on bilinear bearings agrees to {peak.split(',')[0]} of "
        "the peak, the temperature rise of a lead core within "
        f"{value['lead rise against OpenSees LeadRubberX while heating']}.",
        f"**Finite elements**: {heat_agreement(value[LEAD], value[INNER_LAYER])}.",
        "**A real test** of a high-damping rubber bearing: the calibrated force has a normalised "
        f"rms error of {error:.1f} %, the energy of the cycles is off by "
        f"{value['energy errors of its cycles, with scragging']}.",
        f"**The dissertation**: of {len(ids)} statements of Shen (2023), "
        f"{counts['reproduced']} are reproduced to the digit, {counts['trend holds']} in trend, "
        f"and {counts['echoes an input']} follow from inputs; {wrong + aside} are contradicted "
        f"({len(facts)} facts in {wrong} statements, and {aside} misprints or second readings). "
        "The others need its test data or motions.",
    ]
    return "\n".join([*(f"* {line}" for line in lines), "", verify_sentence()])


def verify_sentence() -> str:
    """Return how many comparisons `verify` makes, and with what."""
    rows = row_definitions()
    count = Counter(EVIDENCE[row.evidence] for row in rows)
    stored, recorded = count.pop(EVIDENCE["stored"]), count.pop(EVIDENCE["recorded"])
    return (
        f"`thermobearing verify` makes {len(rows)} comparisons on your machine in a minute: "
        f"{count.total()} are computed there in full, {stored} compare with stored numbers (those "
        "of finite elements and OpenSees are computed anew where scikit-fem and openseespy are "
        f"installed), and {recorded} states a recorded number."
    )


def readme_text(old: str, measured: list[dict[str, str]], bench: dict[str, Any]) -> str:
    """Return README with its generated parts written anew."""
    times = [row["value"] for rows in bench["rows"].values() for row in rows if row["what"] == PIER]
    text, count = PIER_TIME.subn(rf"\g<1>{float(f'{times[0]:.1g}'):g} ms", old)
    if count != 1:
        raise SystemExit(f"README must state once that the pier {PIER_TIME.pattern}")
    text = between(text, "headline", readme.headline())
    text = between(text, "virgin", readme.bullets_on_library())
    return between(text, "validated", validated_rows(measured))


def verify_rows() -> list[list[str]]:
    """Return the rows of `thermobearing verify`, whose definitions are in data/verify."""
    return [
        [
            row.what,
            row.against,
            f"{row.limit:.2g} {row.unit}",
            EVIDENCE[row.evidence] or "calculation",
        ]
        for row in row_definitions()
    ]


def verification_text(measured: list[dict[str, str]], bench: dict[str, Any]) -> str:
    """Return docs/verification.md: what was checked, against what, with which error, and speed."""
    values = {m["what"]: m["value"] for m in measured}
    rows = [
        [row["what"], row["against"], NAMED.sub(lambda match: values[match[1]], row["result"])]
        for row in tomllib.loads(SUMMARY.read_text(encoding="utf-8"))["rows"]
    ]
    by_what = {row[0]: row for row in bench_rows(bench)}
    ratios = [row["what"] for row in bench["rows"].get("releases", ())]
    machine = bench["machine"]
    return (
        "\n\n".join(
            [
                "# Verification",
                "Written by `make docs`. Each value is recorded by a test that asserts a limit on "
                "it; [all values](appendix/measured.md), with their limits and tests, and longer "
                "studies are in the appendix; see also the "
                "[comparison with Shen](comparison_with_shen.md).",
                table(["what", "compared with", "result"], rows),
                "## In a minute",
                "`thermobearing verify` repeats these comparisons where the program is installed, "
                "without tests or network, and explains what is beyond its limit (exit status 1); "
                "`--html FILE` writes a page. Stored numbers of finite elements and OpenSees carry "
                "the digest of their script, and are computed anew where scikit-fem and openseespy "
                "are installed.",
                table(["what", "compared with", "limit", "by"], verify_rows()),
                "Further checks without a number: golden files of every command, hostile input "
                "(100 000 cases), and small errors put into the code, which tests must detect.",
                "## Speed",
                f"{machine['processor']}, one core, version {machine['thermobearing']}, Python "
                f"{machine['python']}, numba {machine['numba']}; `make bench` measures on your "
                "machine, and compares with the last release.",
                table(
                    ["what", "measured", "target", "met"],
                    [by_what[name] for name in (*BENCH_SHOWN, *ratios)],
                ),
            ]
        )
        + "\n"
    )


def measured_texts(
    measured: list[dict[str, str]], bench: dict[str, Any]
) -> tuple[str, dict[str, str]]:
    """Return docs/appendix/measured.md with longer studies, and all values as CSV files."""
    machine = ", ".join(f"{key} {value}" for key, value in bench["machine"].items())
    bench_table = [[cell.strip("*") for cell in row] for row in bench_rows(bench)]
    files = {
        "measured.csv": csv_text(
            ["what", "measured", "limit", "test"],
            [[row[key] for key in ("what", "value", "limit", "test")] for row in measured],
        ),
        "benches.csv": csv_text(["what", "measured", "target", "met"], bench_table),
    }
    parts = [
        "# Measured values and longer studies",
        "Written by `make docs`; do not edit.",
        f"* [measured.csv](measured.csv): {len(measured)} values that tests measure, each with the "
        "limit that the test asserts.\n"
        f"* [benches.csv](benches.csv): {len(bench_table)} results of `make bench`, on {machine}.",
        *((TEXTS / f"{name}.md").read_text(encoding="utf-8").strip() for name in SECTIONS),
    ]
    text = "\n\n".join(parts) + "\n"
    for name in ("theory.md", "files.md"):
        text = text.replace(f"({name}", f"(../{name}")
    return ORPHAN + text.replace("(figures/", "(../figures/"), files


def counts_table() -> str:
    """Return the counts of verdicts on the statements of Shen (2023), by chapter."""
    from reproduction.claims import CHAPTERS, GROUPS, load_claims

    ledger = load(LEDGER)
    claims = {part: [c.id for c in load_claims(part) if c.id in ledger] for part in CHAPTERS}
    ids = {CHAPTERS[part]: claims[part] for part in GROUPS["statements"]}
    ids |= {f"**{name}**": group for name, group in ledger_groups().items()}
    verdicts = {name: ledger_counts(group) for name, group in ids.items()}
    kinds = [
        k for k in ledger_counts(list(ledger)) if any(group.get(k) for group in verdicts.values())
    ]
    rows = [[name, *(str(group.get(k, 0)) for k in kinds)] for name, group in verdicts.items()]
    return table(["", *kinds], rows)


def contradictions() -> tuple[dict[str, list[Any]], dict[str, list[Any]]]:
    """Return the contradicted statements by fact, and those that are no fact by the reason."""
    from reproduction.claims import CONTRADICTED, load_claims

    ledger = load(LEDGER)
    facts: dict[str, list[Any]] = {}
    asides: dict[str, list[Any]] = {}
    statements = set(ledger_groups()["statements"])
    for claim in load_claims():
        if claim.id not in statements or ledger[claim.id]["verdict"] != CONTRADICTED:
            continue
        # Several statements may rest on one fact, which counts once; misprints are no facts.
        if (claim.fact is None) == (claim.aside is None):
            raise ValueError(f"{claim.id} is contradicted: state either its fact or its aside")
        groups, name = (facts, claim.fact) if claim.fact else (asides, claim.aside)
        groups.setdefault(str(name), []).append(claim)
    return facts, asides


def comparison_text(page: str) -> str:
    """Return docs/comparison_with_shen.md with its generated parts."""
    from reproduction.claims import record_needs
    from reproduction.records import list_wanted

    rows = [
        [", ".join(f"`{name}`" for name in files.split(", ")), means, columns]
        for files, means, columns, _ in list_wanted(record_needs())
    ]
    page = between(page, "counts", counts_table())
    page = between(page, "contradictions", contradictions_text())
    return between(page, "records", table(["files", "record", "columns"], rows))


def contradictions_text() -> str:
    """Return the facts that are contradicted, once each, and what else contradicts Shen (2023)."""
    facts, asides = contradictions()
    ledger = load(LEDGER)
    rows = [
        [
            str(number),
            fact,
            "; ".join(dict.fromkeys(claim.place for claim in claims)),
            "; ".join(ledger[claim.id]["words"].removeprefix("contradicted: ") for claim in claims),
        ]
        for number, (fact, claims) in enumerate(facts.items(), 1)
    ]
    asides_text = "; ".join(
        f"{len(claims)} for a {reason} in " + " and ".join(claim.place for claim in claims)
        for reason, claims in asides.items()
    )
    heads = ["", "fact", "places", "here"]
    count = sum(map(len, asides.values()))
    return (
        f"{table(heads, rows)}\n\nNot counted as facts are {count} more statements: {asides_text}."
    )


def quantities_table() -> str:
    """Return all quantities of tables and CSV files, from the register."""
    from thermobearing.quantities.register import registered_quantities

    rows = [
        [f"`{row.name}`", row.head, row.stored, row.definition.replace("|", "\\|")]
        for row in sorted(registered_quantities().values(), key=lambda row: row.name)
        if row.stored
    ]
    return table(["column", "head", "unit", "meaning"], rows)


def laws_table() -> str:
    """Return the laws of the package that a bearing can state, from the register."""
    from thermobearing.laws import built_in_laws

    rows = [
        [
            f"`{law.name}`",
            ", ".join(f"`{key}`" for key in (law.key, *law.also)),
            f'"{law.value}"',
            law.description,
            law.source,
        ]
        for law in built_in_laws().values()
    ]
    return table(["law", "key", "value", "meaning", "source"], rows)


def coverage_items() -> list[dict[str, Any]]:
    """Return the items of docs/coverage.toml with numbers and verdicts of ledger and tests."""
    items = list(tomllib.loads(COVERAGE.read_text(encoding="utf-8"))["items"])
    ledger, measured = load(LEDGER), {m["what"]: m["value"] for m in load(MEASURED)}
    for item in items:
        judged, numbers = item.get("ledger", []), item.get("numbers", [])
        missing = [name for name in (*judged, *numbers) if name not in ledger]
        missing += [name for name in NAMED.findall(item.get("ours", "")) if name not in measured]
        if missing:
            raise ValueError(f"coverage.toml, item {item['item']}: no claim or value {missing}")
        words = NAMED.sub(lambda found: measured[found[1]], item.get("ours", ""))
        rows = [(ledger[name]["computed"], f"({ledger[name]['verdict']})") for name in judged]
        results = [" ".join(filter(None, row)) for row in rows]
        results += [ledger[name]["computed"] for name in numbers]
        item["ours"] = ": ".join(filter(None, (words, "; ".join(results))))
        if judged:
            item["verdict"] = coverage_verdict({ledger[name]["verdict"] for name in judged})
    return items


def coverage_verdict(kinds: set[str]) -> str:
    """Return the verdict of an item from those of its claims: the worst of them."""
    from reproduction.claims import CLOSE, CONTRADICTED, NEEDS, UNDECIDED

    if CONTRADICTED in kinds:
        return "contradicted"
    if kinds & {UNDECIDED, CLOSE}:
        return "undecided"
    return "needs data" if kinds == {NEEDS} else "works"


def coverage_texts(items: list[dict[str, Any]]) -> tuple[str, str]:
    """Return docs/appendix/coverage.md with meaning and counts, and the items as CSV."""
    counts = {name: sum(i["verdict"] == name for i in items) for name in VERDICTS}
    counted = [[name, str(count), VERDICTS[name]] for name, count in counts.items()]
    parts = [
        "# Coverage",
        "Written by `make docs` from `docs/coverage.toml`, the ledger of claims and the measured "
        "values; do not edit. [coverage.csv](coverage.csv) lists every model, measure, test and "
        "figure of Shen (2023), what runs it, and the result compared with Shen's. Numbers with a "
        "verdict in brackets are rows of the [ledger](reproduction.md). "
        f"{len(items)} items:",
        table(["verdict", "items", "meaning"], counted),
        "The test records and accelerograms of Shen (2023) are not public: a figure that compares "
        'the model with a test "works" if it can be drawn with any test, one of an earthquake if '
        "the built-in motions draw it. `CASE.toml`, `TEST.toml` and `TEST.csv` are files of the "
        "user ([files.md](files.md)); lines that begin with `tb.` are Python after "
        "`import thermobearing as tb`. Why the model departs from Shen (2023) where they differ: "
        "[theory.md](theory.md), [verification.md](verification.md).",
    ]
    heads = ["chapter", "#", "place", "what", "run by", "here", "Shen (2023)", "verdict"]
    chapter, rows = "", []
    for item in items:
        chapter = item.get("chapter", chapter)
        cells = [item[key] for key in ("item", "source", "what", "run", "ours", "says", "verdict")]
        rows.append([chapter, *map(str, cells)])
    text = "\n\n".join(parts) + "\n"
    for name in ("theory.md", "files.md", "verification.md"):
        text = text.replace(f"({name}", f"(../{name}")
    return ORPHAN + text, csv_text(heads, rows)


def ledger_counts(ids: list[str]) -> dict[str, int]:
    """Of some claims of the source, how many have each verdict."""
    from reproduction.claims import FAILED, VERDICTS

    kinds = [load(LEDGER)[name]["verdict"] for name in ids]
    return {name: kinds.count(name) for name in VERDICTS if name != FAILED or FAILED in kinds}


def ledger_groups() -> dict[str, list[str]]:
    """Return the ids of the claims that are counted together."""
    from reproduction.claims import GROUPS, group_by_id

    ledger = list(load(LEDGER))
    return {group: [name for name in ledger if group_by_id(name) == group] for group in GROUPS}


def reproduction_texts() -> tuple[str, dict[str, str]]:
    """Return docs/appendix/reproduction.md with the counts, and every claim as CSV files."""
    from reproduction.claims import CHAPTERS, ECHOES, load_claims, rule_words
    from reproduction.report import READING

    ledger = load(LEDGER)
    claims = {part: [c for c in load_claims(part) if c.id in ledger] for part in CHAPTERS}
    rows = []
    for part, chapter_claims in claims.items():
        for claim in chapter_claims:
            row = ledger[claim.id]
            flips = "; ".join(flip_words(*item) for item in row["flips"].items())
            reason = (
                f" ({claim.depends})" if row["stands_5_per_cent_more_K_r"] and claim.depends else ""
            )
            verdict = row["words"]
            start = [CHAPTERS[part], claim.place, claim.statement, rule_words(claim.rule)]
            same = row["printed_model"] == verdict.removeprefix(f"{ECHOES}: ")
            printed = "the same" if same else row["printed_model"]
            rows.append([*start, row["computed"], verdict, printed, f"{flips}{reason}"])
    heads = ["chapter", "place", "statement", "rule", "computed", "verdict", "as printed", "flips"]
    files = {"reproduction.csv": csv_text(heads, rows)}
    record_rows = []
    for claim in filter(lambda item: item.measured, load_claims()):
        rule, names = rule_words(claim.measured.rule), ", ".join(claim.measured.records)
        cells = [claim.place, claim.statement, names, rule, claim.measured.computed]
        record_rows.append([*cells, claim.measured.assumes])
    heads = ["place", "statement", "records", "rule", "expression", "the words taken as"]
    files["records.csv"] = csv_text(heads, record_rows)
    parts = [
        "# Reproduction",
        "Written by `make docs` from the ledger that the tests check "
        "(`tests/reproduction/ledger.json`); do not edit. `make reproduce` (`python -m "
        "reproduction`) makes the ledger, with every figure and table, from data files and code "
        "alone. Every verdict is computed at every run from the rule in its row.",
        f"* [reproduction.csv](reproduction.csv): {len(rows)} statements with rule, computed "
        "value, verdict, verdict on the printed model, and the smallest change that turns it.\n"
        f"* [records.csv](records.csv): {len(record_rows)} statements that records of the tests "
        "would judge. `python -m reproduction --records FOLDER` judges those whose records are in "
        "the folder; the files are listed in the [comparison](../comparison_with_shen.md).",
        "## How to read the verdicts",
        "\n".join(f"* {text}" for text in READING),
        counts_table(),
    ]
    return ORPHAN + "\n\n".join(parts) + "\n", files


def flip_words(symbol: str, change: float | None) -> str:
    """A parameter with the smallest change that flips a verdict."""
    return f"{symbol} none" if change is None else f"{symbol} {100.0 * change:+.1f} %"


def between(text: str, name: str, content: str) -> str:
    """The text with what stands between two marks replaced."""
    start, end = f"<!-- generated: {name} -->", "<!-- end generated -->"
    head, following = text.split(start)
    return f"{head}{start}\n{content}\n{end}{following.split(end, 1)[1]}"


def modules_texts() -> tuple[str, str]:
    """Return docs/appendix/modules.md with the packages, and the subject of each module as CSV."""
    source = DOCS.parent / "src" / "thermobearing"
    packages, modules = [], []
    for folder in sorted({path.parent for path in source.rglob("*.py")}):
        name = ".".join(folder.relative_to(source).parts) or source.name
        packages.append([f"`{name}`", subject(folder / "__init__.py").replace("|", "\\|")])
        modules += [
            [name, path.stem, subject(path)]
            for path in sorted(folder.glob("*.py"))
            if path.name != "__init__.py"
        ]
    page = (
        "# Modules\n\nWritten by `make docs` from the first paragraph of each docstring. "
        f"[modules.csv](modules.csv) has the subject of all {len(modules)} modules; these are the "
        f"packages:\n\n{table(['package', 'subject'], packages)}\n"
    )
    return page, csv_text(["package", "module", "subject"], modules)


def subject(path: Path) -> str:
    """The first paragraph of a module's docstring."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


def fill_tables() -> None:
    """The tables between the marks of the texts, from the programs that print them."""
    for name, programs in TABLES.items():
        path = TEXTS / f"{name}.md"
        for program in programs:
            command = [sys.executable, "-m", f"benchmarks.{program}"]
            process = subprocess.run(command, check=True, cwd=DOCS.parent, capture_output=True)
            text = path.read_text(encoding="utf-8")
            path.write_text(between(text, program, process.stdout.decode().strip()))


def cold_town() -> None:
    """Carry out the studies of the cold town (minutes) and write their tables."""
    from benchmarks.cold_town import carry_out

    page = DOCS / "cold_town.md"
    text = between(page.read_text(encoding="utf-8"), "cold_town", carry_out()[0])
    page.write_text(text, encoding="utf-8")


def main() -> None:
    """Measure, draw and write, or a part of that."""
    parser = argparse.ArgumentParser(
        "python -m docs.generate",
        description="Run the measuring tests and benchmarks, draw all figures, and write all "
        "generated texts; this takes half an hour or more.",
    )
    parser.add_argument("--texts-only", action="store_true", help="write the generated texts only")
    parser.add_argument(
        "--pictures",
        nargs="*",
        metavar="NAME.png",
        help="draw only the pictures of docs/figures: those named, or all",
    )
    options = parser.parse_args()
    if options.pictures is not None:
        pictures.draw_pictures(options.pictures)
        return
    if not options.texts_only:
        environment = os.environ | {"THERMOBEARING_MEASURED": str(MEASURED)}
        numeric = [f"tests/{kind}" for kind in ("verification", "cross_code", "validation")]
        pytest = [sys.executable, "-m", "pytest", "-q", *numeric]
        subprocess.run(pytest, check=True, cwd=DOCS.parent, env=environment)
        bench = [sys.executable, "-m", "benchmarks", "--json", str(BENCH)]
        subprocess.run(bench, check=True, cwd=DOCS.parent)
        fill_tables()
        cold_town()
        pictures.draw_pictures()
    write_texts()


def write_texts() -> None:
    """Write every page that is generated, and every generated part of the others."""
    for path, text in generated_texts().items():
        path.write_text(text, encoding="utf-8", newline="\n")


def generated_texts() -> dict[Path, str]:
    """Return what every generated page, and page with generated parts, must contain."""
    measured, bench = load(MEASURED), load(BENCH)
    pages = {
        name: (DOCS / f"{name}.md").read_text(encoding="utf-8")
        for name in ("comparison_with_shen", "nomenclature")
    }
    texts = {
        README: readme_text(README.read_text(encoding="utf-8"), measured, bench),
        DOCS / "verification.md": verification_text(measured, bench),
        DOCS / "comparison_with_shen.md": comparison_text(pages["comparison_with_shen"]),
        DOCS / "nomenclature.md": between(pages["nomenclature"], "columns", quantities_table()),
    }
    tables: dict[str, str] = {}
    texts[APPENDIX / "measured.md"], files = measured_texts(measured, bench)
    tables |= files
    texts[APPENDIX / "reproduction.md"], files = reproduction_texts()
    tables |= files
    texts[APPENDIX / "coverage.md"], tables["coverage.csv"] = coverage_texts(coverage_items())
    texts[APPENDIX / "modules.md"], tables["modules.csv"] = modules_texts()
    texts |= {APPENDIX / name: text for name, text in tables.items()}
    pages_of_files = sorted((DOCS / "files").glob("*.md"))
    texts |= {path: keys.fill(path.read_text(encoding="utf-8")) for path in pages_of_files}
    texts[DESCRIPTIONS] = descriptions_text(COMMAND_FIELDS)
    texts |= notebook.notebook_texts()
    bearing = DOCS / "files" / "bearing.md"
    return texts | {bearing: between(texts[bearing], "laws", laws_table())}


if __name__ == "__main__":
    main()
