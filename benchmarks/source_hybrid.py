"""Compare four statements of the source about energy and damping with the model.

`python -m benchmarks.source_hybrid` prints a Markdown table: the numbers of docs/verification.md,
"What the source says of energy and damping". `--motion FILE` takes another motion.
"""

import argparse
from typing import Any

import numpy as np

import thermobearing as tb
from tests.validation.hybrid_source import (
    ABOUT,
    AMBIENT,
    ENERGY,
    HDR,
    LHDR,
    Evidence,
    damping_ratios,
    energy_signs,
    evidence,
    format_values,
    pair,
)

COUNTS = (8, 2)
SHARE = 0.75  # 5.4.2.1
TABLES = {HDR: "4.2", LHDR: "5.2", "shen-hdr-bridge": "6.4", "shen-lhdr-bridge": "6.4"}


def marked(text: str, holds: bool) -> str:
    """The numbers with their verdict."""
    return f"{text} ({'yes' if holds else '**no**'})"


def about_two(values: Any) -> bool:
    """Whether all may be called approximately twice."""
    return bool(np.all((values > ABOUT[0]) & (values < ABOUT[1])))


def hybrid_rows(results: list[Evidence]) -> list[list[str]]:
    """Statements about the hybrid tests, one column for each number of bearings."""
    rows = []
    for mode, name in (("rt", "real time"), ("pd", "pseudo-dynamic")):
        ratios = [e.energies(mode) for e in results]
        cells = [marked(format_values(r), about_two(r)) for r in ratios]
        rows.append([f"energy LHDR/HDR, {name}", "about 2 (3.4.5)", *cells])
    cells = []
    for e in results:
        signs = energy_signs(e)
        text = f"{pair(lambda b, e=e: e.ratio(b, ENERGY), '.3f')}: {sum(signs)} of 6"
        cells.append(marked(text, all(signs)))
    rows.append(["energy RT/PD, HDR; LHDR", "above 1, but HDR at -20 (3.4.5)", *cells])
    shares = [np.array([e.rate_share(ambient) for ambient in AMBIENT]) for e in results]
    cells = [marked(format_values(share), bool(np.all(share > SHARE))) for share in shares]
    name = "LHDR, PD, first 2 s: largest share of the rate-dependent force"
    return [*rows, [name, "over 0.75 (5.4.2.1)", *cells]]


def cyclic_rows() -> list[list[str]]:
    """Statements that need no structure."""
    energy = [
        tb.run(name, ambient=AMBIENT).energy["work_in_kN_mm"].to_numpy() for name in (LHDR, HDR)
    ]
    ratio = energy[0] / energy[1]
    text = marked(format_values(ratio), about_two(ratio))
    rows = [["energy LHDR/HDR, cyclic (Table 3.4)", "not said", text, ""]]
    for name, table in TABLES.items():
        ratios = damping_ratios(name)
        text = marked(format_values(ratios, ".3f"), bool(np.all(np.diff(ratios) > 0.0)))
        label = f"h_eq, 175 %, third cycle, {name} (Table {table})"
        rows.append([label, "rises in the cold (3.5, 6.1)", text, ""])
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.source_hybrid", description=__doc__)
    parser.add_argument("--motion", help="name or file, instead of the default")
    motion = parser.parse_args().motion
    results = [evidence(count, motion) for count in COUNTS]
    print("| at 23, 0, -20 degC | source | eight bearings (default) | two bearings |")
    print("|---|---|---|---|")
    for row in (*hybrid_rows(results), *cyclic_rows()):
        print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
