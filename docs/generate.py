"""Regenerate every number and figure in README and docs: `make docs`.

Runs the tests (which record what they measure) and the benches, draws the loops, and writes
the tables between the `generated` marks. `--texts-only` rewrites the texts from the
numbers that are there, which the tests use to see that nobody typed a number by hand.
"""

import ast
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

from thermobearing.design.factors import scale_study

DOCS = Path(__file__).parent
README = DOCS.parent / "README.md"
TEXTS = DOCS / "texts"  # written by hand, between the tables of verification.md
SECTIONS = ("one_dimension", "factors", "lead", "structures", "near_fault", "source")
# Tables between marks in the texts, each printed by `python -m benchmarks.NAME`.
TABLES = {"lead": ("lead_rise",), "source": ("bearing_count", "source_hybrid")}
COVERAGE = DOCS / "coverage.toml"  # every item of Shen (2023); written by hand
NAMED = re.compile(r"\{([^}]+)\}")  # of docs/measured.json, in the words of an item
sys.path.append(str(DOCS.parent))  # for the package `reproduction`
LEDGER = DOCS.parent / "tests" / "reproduction" / "ledger.json"  # see its baseline.py
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

# Rows of the README, by the names that tests and benches give their numbers; few, since
# docs/verification.md has all.
IN_README = (
    "exact increment against scipy solve_ivp, of d_y",
    "core against a plain NumPy stepper, force, of the peak",
    "conduction, rubber and steel: observed order in space",
    "energy books, cyclic: thermal residual",
    "lead rise against OpenSees LeadRubberX while heating",
    "pier-p1, bilinear bearings, force against OpenSees: peak, whole history",
    "K_eq of the bridge bearing at 178 mm, K_r = 25 kN/mm, against Table 6.1",
    "NRMSE of the real HDR test, with scragging",
    "energy errors of its cycles, with scragging",
)
BENCH_IN_README = (
    "coupled step, 19 cells, 3 layers, Table 3.4 at -20 degC",
    "coupled step with lead, 29 cells, 3 layers and core, Table 3.4 at -20 degC",
    "default bridge study, 36 runs, two cores",
    "pier P1 on LHDR, 40 s, 8000 steps of 5 ms, one core",
    "OpenSees, pier P1 on LeadRubberX with lead heating",
)


def load(path: Path) -> Any:
    """A JSON file."""
    return json.loads(path.read_text(encoding="utf-8"))


def table(heads: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def test_rows(measured: list[dict[str, str]]) -> list[list[str]]:
    """What the tests measured, with the test that asserts it."""
    return [[m["what"], m["value"], m["limit"], f"`{m['test']}`"] for m in measured]


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


def readme_text(old: str, measured: list[dict[str, str]], bench: dict[str, Any]) -> str:
    """README with its generated part written anew."""
    by_name = {m["what"]: m for m in measured}
    by_what = {row[0]: row for row in bench_rows(bench)}
    missing = [name for name in IN_README if name not in by_name]
    missing += [name for name in BENCH_IN_README if name not in by_what]
    if missing:
        raise SystemExit(f"no test or bench measured: {missing}")
    about = bench["machine"]
    parts = [
        table(
            ["verified", "measured", "limit"],
            [[m["what"], m["value"], m["limit"]] for m in (by_name[n] for n in IN_README)],
        ),
        ledger_sentence(),
        f"Speed and memory ({about['processor']}, one core, Python {about['python']}, "
        f"numba {about['numba']}):",
        table(["what", "measured", "target", "met"], [by_what[n] for n in BENCH_IN_README]),
    ]
    return between(old, "verified", "\n\n".join(parts))


def verification_text(measured: list[dict[str, str]], bench: dict[str, Any]) -> str:
    """docs/verification.md, all of it."""
    about = ", ".join(f"{key} {value}" for key, value in bench["machine"].items())
    return (
        "\n\n".join(
            [
                "# Verification",
                "Written by `make docs`; do not edit. The first table is what the tests measured "
                "(each asserts its limit), the second what `make bench` measured.",
                table(["what", "measured", "limit", "test"], test_rows(measured)),
                *((TEXTS / f"{name}.md").read_text(encoding="utf-8").strip() for name in SECTIONS),
                f"## Benches\n\n{about}",
                table(["what", "measured", "target", "met"], bench_rows(bench)),
            ]
        )
        + "\n"
    )


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
        told = [" ".join(filter(None, row)) for row in rows]
        told += [ledger[name]["computed"] for name in numbers]
        item["ours"] = ": ".join(filter(None, (words, "; ".join(told))))
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


def coverage_text(items: list[dict[str, Any]]) -> str:
    """docs/coverage.md, all of it: what it means, the counts, and a table a chapter."""
    counts = {name: sum(i["verdict"] == name for i in items) for name in VERDICTS}
    told = [[name, str(count), VERDICTS[name]] for name, count in counts.items()]
    parts: list[Any] = [
        "# Coverage",
        "Written by `make docs` from `docs/coverage.toml`, the ledger of claims and the measured "
        "values; do not edit. Every model, measure, test and figure of Shen (2023), what runs it, "
        "and the result compared with Shen's. Numbers with a verdict in brackets are rows of the "
        f"[ledger](reproduction.md). {len(items)} items:",
        table(["verdict", "items", "meaning"], told),
        "The test records and accelerograms of Shen (2023) are not public: a figure that compares "
        'the model with a test "works" if it can be drawn with any test, one of an earthquake if '
        "the built-in motions draw it. `CASE.toml`, `TEST.toml` and `TEST.csv` are files of the "
        "user ([files.md](files.md)); lines that begin with `tb.` are Python after "
        "`import thermobearing as tb`. Why the model departs from Shen (2023) where they differ: "
        "[theory.md](theory.md), [verification.md](verification.md).",
    ]
    rows: list[list[str]] = []
    heads = ["#", "place", "what", "run by", "here", "Shen (2023)", "verdict"]
    for item in items:
        if "chapter" in item:
            rows = []
            parts += [f"## {item['chapter'][0].upper()}{item['chapter'][1:]}", rows]
        verdict = item["verdict"] if item["verdict"] == "works" else f"**{item['verdict']}**"
        words = [item[key] for key in ("ours", "says")]
        start = [str(item["item"]), item["source"], item["what"], f"`{item['run']}`"]
        rows.append([*start, *words, verdict])
    return "\n\n".join(p if isinstance(p, str) else table(heads, p) for p in parts) + "\n"


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


def ledger_sentence() -> str:
    """Return what README says of the claims of Shen (2023)."""
    groups = {name: (len(ids), ledger_counts(ids)) for name, ids in ledger_groups().items()}
    number, counts = groups["statements"]
    told = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
    others = " and ".join(f"{n} {name}" for name, (n, _) in groups.items() if name != "statements")
    return (
        f"Statements of Shen (2023), judged by `make reproduce`: {number}; {told}; "
        f"{others} are counted apart ([docs/reproduction.md](docs/reproduction.md))."
    )


def reproduction_text() -> str:
    """docs/reproduction.md, all of it: the counts, and every claim with what flips it."""
    from reproduction.claims import CHAPTERS, ECHOES, GROUPS, load_claims, rule_words
    from reproduction.report import READING

    ledger = load(LEDGER)
    claims = {part: [c for c in load_claims(part) if c.id in ledger] for part in CHAPTERS}
    groups = ledger_groups()
    ids = {CHAPTERS[part]: [c.id for c in claims[part]] for part in GROUPS["statements"]}
    ids |= {f"**{name}**": found for name, found in groups.items()}
    every = {name: ledger_counts(found) for name, found in ids.items()}
    all_kinds = list(ledger_counts(list(ledger)))
    kinds = [k for k in all_kinds if any(found.get(k) for found in every.values())]
    counts = [[name, *(str(found.get(k, 0)) for k in kinds)] for name, found in every.items()]
    heads = ["place", "statement", "rule", "computed", "verdict", "as printed", "flips"]
    parts = [
        "# Reproduction",
        "Written by `make docs` from the ledger that the tests check "
        "(`tests/reproduction/ledger.json`); do not edit. `make reproduce` (`python -m "
        "reproduction`) makes the ledger, with every figure and table, from data files and code "
        "alone. Every verdict is computed at every run from the rule in its row.",
        "\n".join(f"* {text}" for text in READING),
        table(["", *kinds], counts),
    ]
    for part, found in claims.items():
        if not found:
            continue
        rows = []
        for claim in found:
            row = ledger[claim.id]
            flips = "; ".join(flip_words(*item) for item in row["flips"].items())
            why = (
                f" ({claim.depends})" if row["stands_5_per_cent_more_K_r"] and claim.depends else ""
            )
            verdict = row["words"]
            words = f"**{verdict}**" if row["verdict"] == "contradicted" else verdict
            start = [claim.place, claim.statement, rule_words(claim.rule), row["computed"]]
            same = row["printed_model"] == verdict.removeprefix(f"{ECHOES}: ")
            printed = "the same" if same else row["printed_model"]
            rows.append([*start, words, printed, f"{flips}{why}"])
        parts += [f"## {CHAPTERS[part]}", table(heads, rows)]
    return "\n\n".join(parts) + "\n"


def flip_words(symbol: str, change: float | None) -> str:
    """A parameter with the smallest change that flips a verdict."""
    return f"{symbol} none" if change is None else f"{symbol} {100.0 * change:+.1f} %"


def between(text: str, name: str, content: str) -> str:
    """The text with what stands between two marks replaced."""
    start, end = f"<!-- generated: {name} -->", "<!-- end generated -->"
    head, rest = text.split(start)
    return f"{head}{start}\n{content}\n{end}{rest.split(end, 1)[1]}"


def modules_table() -> str:
    """The subject of each module, by package, from the first line of its docstring."""
    package = DOCS.parent / "src" / "thermobearing"
    parts = []
    for folder in sorted({path.parent for path in package.rglob("*.py")}):
        name = folder.relative_to(package).as_posix()
        rows = [
            [f"`{path.stem}`", subject(path)]
            for path in sorted(folder.glob("*.py"))
            if path.name != "__init__.py"
        ]
        head = "thermobearing" if name == "." else name
        parts.append(f"**{head}**: {subject(folder / '__init__.py')}")
        parts.append(table(["module", "subject"], rows))
    return "\n\n".join(parts)


def subject(path: Path) -> str:
    """The first paragraph of a module's docstring."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).replace("|", "\\|")


def architecture_text(page: str) -> str:
    """The page on the architecture with its list of modules."""
    return between(page, "modules", modules_table())


def fill_tables() -> None:
    """The tables between the marks of the texts, from the programs that print them."""
    for name, programs in TABLES.items():
        path = TEXTS / f"{name}.md"
        for program in programs:
            command = [sys.executable, "-m", f"benchmarks.{program}"]
            done = subprocess.run(command, check=True, cwd=DOCS.parent, capture_output=True)
            text = path.read_text(encoding="utf-8")
            path.write_text(between(text, program, done.stdout.decode().strip()))


def cold_town() -> None:
    """The studies of the cold town (minutes), their tables and figures."""
    page = DOCS / "cold_town.md"
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "benchmarks.cold_town", folder, str(DOCS / "figures")]
        done = subprocess.run(command, check=True, cwd=DOCS.parent, capture_output=True)
    text = between(page.read_text(encoding="utf-8"), "cold_town", done.stdout.decode().strip())
    page.write_text(text, encoding="utf-8")


def draw() -> None:
    """The loops of the README."""
    import thermobearing as tb
    from thermobearing.design.figures import draw_bounds, draw_scale
    from thermobearing.results.drawing import save_figure

    result = tb.run("shen-hdr-specimen", tb.cyclic_test(), ambient=[-20.0, 0.0, 23.0])
    (DOCS / "figures").mkdir(exist_ok=True)
    save_figure(result.plot.loops(), DOCS / "figures" / "loops.png", dpi=110)
    bearings = ["shen-hdr-bridge", "shen-lhdr-bridge"]
    study = tb.bridge(bearings, ["jra-i-i-1", "jra-ii-i-1"], [23.0, 0.0, -20.0])
    bearing = tb.load_bearing("shen-hdr-bridge")
    motions = [name for name in tb.list_motions() if name.split("-")[2] == "i"]
    title = "shen-hdr-bridge: bounds (bars), coupled (dots)"
    figure = draw_bounds(tb.bounds_study(bearing, motions), title)
    save_figure(figure, DOCS / "figures" / "bounds.png", dpi=80)
    lead = tb.load_bearing("shen-lhdr-bridge")
    _, results = scale_study(lead)
    save_figure(draw_scale(lead, results), DOCS / "figures" / "scale.png", dpi=80)
    save_figure(study.plot.loops(), DOCS / "figures" / "bridge.png", dpi=110)


def main() -> None:
    """Measure (unless --texts-only), draw, write."""
    if "--texts-only" not in sys.argv:
        environment = os.environ | {"THERMOBEARING_MEASURED": str(MEASURED)}
        numeric = [f"tests/{kind}" for kind in ("verification", "cross_code", "validation")]
        pytest = [sys.executable, "-m", "pytest", "-q", *numeric]
        subprocess.run(pytest, check=True, cwd=DOCS.parent, env=environment)
        bench = [sys.executable, "-m", "benchmarks", "--json", str(BENCH)]
        subprocess.run(bench, check=True, cwd=DOCS.parent)
        fill_tables()
        cold_town()
        draw()
        subprocess.run([sys.executable, str(DOCS / "contact.py")], check=True)
        loops = ["-m", "benchmarks.small_loops", "--figure", str(DOCS / "figures/small_loops.png")]
        subprocess.run([sys.executable, *loops], check=True, cwd=DOCS.parent)
        for name in ("opensees_lead", "opensees_pier", "takeda"):
            figure = ["-m", f"benchmarks.{name}_figure", str(DOCS / f"figures/{name}.png")]
            subprocess.run([sys.executable, *figure], check=True, cwd=DOCS.parent)
    measured, bench_numbers = load(MEASURED), load(BENCH)
    README.write_text(readme_text(README.read_text(), measured, bench_numbers))
    (DOCS / "verification.md").write_text(verification_text(measured, bench_numbers))
    architecture = DOCS / "architecture.md"
    page = architecture.read_text(encoding="utf-8")
    architecture.write_text(architecture_text(page), encoding="utf-8")
    (DOCS / "coverage.md").write_text(coverage_text(coverage_items()))
    (DOCS / "reproduction.md").write_text(reproduction_text(), encoding="utf-8")


if __name__ == "__main__":
    main()
