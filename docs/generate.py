"""Regenerate every number and figure in README and docs: `make docs`.

Runs the tests (which record what they measure) and the benches, draws the loops, and writes
the tables between the `generated` marks. `--texts-only` rewrites the texts from the
numbers that are there, and the descriptions of options that help reads, which the tests use to see
that nobody typed a number by hand.
"""

import argparse
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

import numpy as np

from docs.builder import keys, sketch
from thermobearing import cli  # noqa: F401 (it has all commands)
from thermobearing.commands.descriptions import descriptions_text
from thermobearing.commands.options import DESCRIPTIONS, MADE
from thermobearing.design.factors import scale_study

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
# Of the benches, what the page on verification says of speed.
BENCH_SHOWN = (
    "coupled step, 19 cells, 3 layers, Table 3.4 at -20 degC",
    "coupled step with lead, 29 cells, 3 layers and core, Table 3.4 at -20 degC",
    "default bridge study, 36 runs, two cores",
    "pier P1 on LHDR, 40 s, 8000 steps of 5 ms, one core",
    "coupled step in a plane, circle, shen-hdr-specimen, over one on a line",
    "pier P1 on LHDR in plan with two components, over the same in one direction",
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


HEADLINE = "jra-ii-i-1"  # the motion of the headline, one of those of ground I


def headline_sentence() -> str:
    """Return what cold bearings do to the pier of the default bridge, with its range by motion."""
    import thermobearing as tb

    motions = [name for name in tb.list_motions() if name.split("-")[2] == "i"]
    table = tb.bridge("shen-lhdr-bridge", motions, ambient=[23, -20]).table
    ratios = []
    for name in ("bearing_force_max_kN", "pier_moment_max_kN_m"):
        peaks = table.pivot(index="motion", columns="ambient_degC", values=name)
        ratios.append(100.0 * (peaks[-20.0] / peaks[23.0] - 1.0))
    force, moment = (f"{ratio[HEADLINE]:.0f} %" for ratio in ratios)
    forces, moments = (f"{ratio.min():.0f} to {ratio.max():.0f} %" for ratio in ratios)
    return (
        "In the same earthquake, high-damping rubber bearings with lead cores transmit "
        f"{force} more force at -20 °C than at 23 °C, and the bending moment at the base of the "
        f"bridge pier is {moment} larger ({forces} and {moments} in the {len(motions)} built-in "
        "motions of ground I). An analysis with the properties at 23 °C shows neither."
    )


def heat_error(text: str) -> str:
    """Return an error such as "-0.8 of 73.5 K; cooling -1.0 K" in words."""
    error, rise, cooled = NUMBER.findall(text)
    return f"{error} K at its largest rise of {rise} K and {cooled} K after cooling"


def validated_rows(measured: list[dict[str, str]]) -> str:
    """Return what README says of validation."""
    value = {m["what"]: m["value"] for m in measured}
    peak = value["pier-p1, bilinear bearings, force against OpenSees: peak, complete history"]
    ids = ledger_groups()["statements"]
    counts = ledger_counts(ids)
    error = 100.0 * float(value["NRMSE of the real HDR test, with scragging"])
    agree = counts["reproduced"] + counts["echoes an input"] + counts["trend holds"]
    lines = [
        f"**OpenSees**: the force of a pier on bilinear bearings agrees to {peak.split(',')[0]} of "
        "the peak, the temperature rise of a lead core within "
        f"{value['lead rise against OpenSees LeadRubberX while heating']}.",
        f"**Finite elements**: the temperature of the lead is off by {heat_error(value[LEAD])}, "
        f"that of the inner rubber layer by {heat_error(value[INNER_LAYER])}.",
        "**A real test** of a high-damping rubber bearing: the calibrated force has a normalised "
        f"rms error of {error:.1f} %, the energy of the cycles is off by "
        f"{value['energy errors of its cycles, with scragging']}.",
        f"**The dissertation**: of {len(ids)} statements of Shen (2023), {agree} are confirmed, "
        f"{counts['contradicted']} are contradicted, and the others need its test data or motions.",
    ]
    return "\n".join(f"* {line}" for line in lines)


def readme_text(old: str, measured: list[dict[str, str]]) -> str:
    """Return README with its generated parts written anew."""
    text = between(old, "headline", headline_sentence())
    return between(text, "validated", validated_rows(measured))


def verification_text(measured: list[dict[str, str]], bench: dict[str, Any]) -> str:
    """Return docs/verification.md: what was checked, against what, with which error, and speed."""
    values = {m["what"]: m["value"] for m in measured}
    rows = [
        [row["what"], row["against"], NAMED.sub(lambda found: values[found[1]], row["result"])]
        for row in tomllib.loads(SUMMARY.read_text(encoding="utf-8"))["rows"]
    ]
    by_what = {row[0]: row for row in bench_rows(bench)}
    about = bench["machine"]
    return (
        "\n\n".join(
            [
                "# Verification",
                "Written by `make docs`. Each value is recorded by a test that asserts a limit on "
                "it; [all values](appendix/measured.md), with their limits and tests, and longer "
                "studies are in the appendix; see also the "
                "[comparison with Shen](comparison_with_shen.md).",
                table(["what", "compared with", "result"], rows),
                "Further checks without a number: golden files of every command, hostile input "
                "(100 000 cases), and small errors put into the code, which tests must detect.",
                "## Speed",
                f"{about['processor']}, one core, Python {about['python']}, numba "
                f"{about['numba']}; `make bench` measures on your machine.",
                table(
                    ["what", "measured", "target", "met"], [by_what[name] for name in BENCH_SHOWN]
                ),
            ]
        )
        + "\n"
    )


def measured_text(measured: list[dict[str, str]], bench: dict[str, Any]) -> str:
    """Return docs/appendix/measured.md: all values of tests and benches, and longer studies."""
    about = ", ".join(f"{key} {value}" for key, value in bench["machine"].items())
    parts = [
        "# All measured values",
        "Written by `make docs`; do not edit. The first table is what the tests measured (each "
        "asserts its limit), the last what `make bench` measured.",
        table(["what", "measured", "limit", "test"], test_rows(measured)),
        *((TEXTS / f"{name}.md").read_text(encoding="utf-8").strip() for name in SECTIONS),
        f"## Benches\n\n{about}",
        table(["what", "measured", "target", "met"], bench_rows(bench)),
    ]
    text = "\n\n".join(parts) + "\n"
    for name in ("theory.md", "files.md"):
        text = text.replace(f"({name}", f"(../{name}")
    return ORPHAN + text.replace("(figures/", "(../figures/")


def counts_table() -> str:
    """Return the counts of verdicts on the statements of Shen (2023), by chapter."""
    from reproduction.claims import CHAPTERS, GROUPS, load_claims

    ledger = load(LEDGER)
    claims = {part: [c.id for c in load_claims(part) if c.id in ledger] for part in CHAPTERS}
    ids = {CHAPTERS[part]: claims[part] for part in GROUPS["statements"]}
    ids |= {f"**{name}**": found for name, found in ledger_groups().items()}
    every = {name: ledger_counts(found) for name, found in ids.items()}
    kinds = [
        k for k in ledger_counts(list(ledger)) if any(found.get(k) for found in every.values())
    ]
    rows = [[name, *(str(found.get(k, 0)) for k in kinds)] for name, found in every.items()]
    return table(["", *kinds], rows)


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


def coverage_text(items: list[dict[str, Any]]) -> str:
    """docs/coverage.md, all of it: what it means, the counts, and a table a chapter."""
    counts = {name: sum(i["verdict"] == name for i in items) for name in VERDICTS}
    counted = [[name, str(count), VERDICTS[name]] for name, count in counts.items()]
    parts: list[Any] = [
        "# Coverage",
        "Written by `make docs` from `docs/coverage.toml`, the ledger of claims and the measured "
        "values; do not edit. Every model, measure, test and figure of Shen (2023), what runs it, "
        "and the result compared with Shen's. Numbers with a verdict in brackets are rows of the "
        f"[ledger](reproduction.md). {len(items)} items:",
        table(["verdict", "items", "meaning"], counted),
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
    text = "\n\n".join(p if isinstance(p, str) else table(heads, p) for p in parts) + "\n"
    for name in ("theory.md", "files.md", "verification.md"):
        text = text.replace(f"({name}", f"(../{name}")
    return ORPHAN + text


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


def reproduction_text() -> str:
    """docs/reproduction.md, all of it: the counts, and every claim with what flips it."""
    from reproduction.claims import CHAPTERS, ECHOES, load_claims, rule_words
    from reproduction.report import READING

    ledger = load(LEDGER)
    claims = {part: [c for c in load_claims(part) if c.id in ledger] for part in CHAPTERS}
    heads = ["place", "statement", "rule", "computed", "verdict", "as printed", "flips"]
    parts = [
        "# Reproduction",
        "Written by `make docs` from the ledger that the tests check "
        "(`tests/reproduction/ledger.json`); do not edit. `make reproduce` (`python -m "
        "reproduction`) makes the ledger, with every figure and table, from data files and code "
        "alone. Every verdict is computed at every run from the rule in its row.",
        "\n".join(f"* {text}" for text in READING),
        counts_table(),
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
    return ORPHAN + "\n\n".join(parts) + "\n"


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


def draw_cold(path: Path) -> None:
    """Draw the picture of the README: one bridge in one earthquake, warm and cold."""
    import thermobearing as tb
    from thermobearing.results import drawing

    ambient = [23, -20]
    result = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", ambient=ambient)
    colours = drawing.ambient_colours(np.array(ambient, dtype=float))
    title = "The same bridge in the same earthquake"
    figure, (loops, moments) = drawing.panels(1, 2, (8.4, 3.4), title)
    for run, colour in enumerate(colours):
        history = result.history(run)
        look = {"color": colour, "linewidth": 1.0, "label": f"{ambient[run]} °C"}
        loops.plot(history["displacement_mm"], history["force_kN"], **look)
        shaken = history["time_s"].between(8.0, 20.0)
        moment = history["pier_moment_kN_m"][shaken] / 1e3
        moments.plot(history["time_s"][shaken], moment, **look)
    drawing.name_axes(loops, "bearing displacement [mm]", "bearing force [kN]")
    drawing.name_axes(moments, "time [s]", "moment at the pier base [MN m]")
    loops.legend(fontsize=drawing.SMALL, frameon=False)
    drawing.save_figure(figure, path, dpi=110)


def draw() -> None:
    """Draw the figures of README and guides."""
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
    draw_cold(DOCS / "figures" / "cold.png")


def draw_guides() -> None:
    """Draw the sketch of the default bridge, and the pictures of the how-tos by their blocks."""
    import thermobearing as tb
    from thermobearing.results.drawing import save_figure

    sketch.draw_pier(DOCS / "figures" / "pier_p1.png")
    plan = tb.examine_structure("five-span-bridge").plot.plan()
    save_figure(plan, DOCS / "figures" / "five_span_bridge_plan.png", dpi=110)
    pages = [str(path) for path in sorted((DOCS / "guide").glob("*.md"))]
    command = [sys.executable, "-m", "docs.builder.outputs", "--figures", *pages]
    subprocess.run(command, check=True, cwd=DOCS.parent)


def main() -> None:
    """Measure, draw and write, or a part of that."""
    parser = argparse.ArgumentParser(
        "python -m docs.generate",
        description="Run the measuring tests and benchmarks, draw all figures, and write all "
        "generated texts; this takes half an hour or more.",
    )
    parser.add_argument("--texts-only", action="store_true", help="write the generated texts only")
    parser.add_argument("--guides", action="store_true", help="draw the figures of guides only")
    options = parser.parse_args()
    if options.guides:
        draw_guides()
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
        draw()
        draw_guides()
        subprocess.run([sys.executable, str(DOCS / "contact.py")], check=True)
        loops = ["-m", "benchmarks.small_loops", "--figure", str(DOCS / "figures/small_loops.png")]
        subprocess.run([sys.executable, *loops], check=True, cwd=DOCS.parent)
        for name in ("opensees_lead", "opensees_pier", "takeda"):
            figure = ["-m", f"benchmarks.{name}_figure", str(DOCS / f"figures/{name}.png")]
            subprocess.run([sys.executable, *figure], check=True, cwd=DOCS.parent)
    write_texts()


def write_texts() -> None:
    """Write every page that is generated, and every generated part of the others."""
    for path, text in generated_texts().items():
        path.write_text(text, encoding="utf-8")


def generated_texts() -> dict[Path, str]:
    """Return what every generated page, and page with generated parts, must contain."""
    measured, bench = load(MEASURED), load(BENCH)
    pages = {
        name: (DOCS / f"{name}.md").read_text(encoding="utf-8")
        for name in ("architecture", "comparison_with_shen", "nomenclature")
    }
    found = {
        README: readme_text(README.read_text(encoding="utf-8"), measured),
        DOCS / "verification.md": verification_text(measured, bench),
        DOCS / "architecture.md": architecture_text(pages["architecture"]),
        DOCS / "comparison_with_shen.md": between(
            pages["comparison_with_shen"], "counts", counts_table()
        ),
        DOCS / "nomenclature.md": between(pages["nomenclature"], "columns", quantities_table()),
        APPENDIX / "measured.md": measured_text(measured, bench),
        APPENDIX / "coverage.md": coverage_text(coverage_items()),
        APPENDIX / "reproduction.md": reproduction_text(),
    }
    pages_of_files = sorted((DOCS / "files").glob("*.md"))
    found |= {path: keys.fill(path.read_text(encoding="utf-8")) for path in pages_of_files}
    found[DESCRIPTIONS] = descriptions_text(MADE)
    bearing = DOCS / "files" / "bearing.md"
    return found | {bearing: between(found[bearing], "laws", laws_table())}


if __name__ == "__main__":
    main()
