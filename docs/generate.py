"""Regenerate every number and figure in README and docs: `make docs`.

Runs the tests (which record what they measure) and the benches, draws the loops, and writes
the tables between the `generated` marks. `--texts-only` rewrites the texts from the
numbers that are there, which the tests use to see that nobody typed a number by hand.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
README = DOCS.parent / "README.md"
MEASURED, BENCH = DOCS / "measured.json", DOCS / "bench.json"

# Rows of the README, by the names that tests and benches give their numbers.
IN_README = (
    "exact increment against scipy solve_ivp, of d_y",
    "core against a plain NumPy stepper, force, of the peak",
    "layer forces apart, of the peak force",
    "conduction, rubber and steel: observed order in space",
    "conduction: observed order in time",
    "energy books, cyclic: thermal residual",
    "adiabatic core, exponential strength, against the exact rise",
    "lead rise against OpenSees LeadRubberX while heating",
    "K_eq of the bridge bearing at 178 mm, K_r = 25 kN/mm, against Table 6.1",
    "K_eq of the LHDR bridge bearing at 178 mm against Table 6.1",
    "energy of LHDR over HDR, Table 3.4, -20, 0, 23 degC",
    "pier-p1, bilinear bearings, force against OpenSees: peak, whole history",
    "energy books of pier P1, shen-lhdr-bridge, average-acceleration, of the input",
    "first period of pier-p1, published mass",
    "lead confined, bridge, 175 %: largest error, half-space and finite plates",
    "NRMSE of the real HDR test, with scragging",
    "energy errors of its cycles, with scragging",
    "K_B of G8 at 178 mm, 600 x 600 mm, 112 mm",
    "design loop from 50, 100, 200, 400 mm: displacement, rounds",
    "inner-layer rise, published over conservative, -20 degC, 250 %",
)
LEAD_TEXT = """## Lead core against OpenSees

Heating agrees. LeadRubberX cools at half the rate of its own equations, and its clock counts from
the domain's time zero instead of the start of the motion. Drawn by
`python -m benchmarks.opensees_lead_figure OUT.png`.

![Lead temperature, OpenSees beside this package](figures/opensees_lead.png)"""
PIER_TEXT = """## Structures against OpenSees

Both structures with linear and bilinear bearings, 20 s of a Level 2 motion. Drawn by
`python -m benchmarks.opensees_pier_figure OUT.png`.

![Histories of pier P1, OpenSees beside this package](figures/opensees_pier.png)"""
SOURCE_TEXT = """## The bridge beside the source

Colder means less strain, more pier displacement and less energy in the bearing on every motion
tried, the four built-in ones and the real records above. "More force" does not hold everywhere:
where the warm HDR bearing is strained beyond about 165 % it hardens, and where the pier yields in
the cold it caps the force.

The source's ductilities (about 1 at 23, up to 3 at -20 degC) and its energy drop at 0 degC
(-9.3 %) are not met with the printed numbers, whichever mass matrix is used. The rows "rocking
spring ten times as stiff" and "no damping but hysteresis" show what would: a foundation that
hardly rocks, or no Rayleigh damping of the first mode. With the printed ground springs most of the
pier's displacement is rocking, and their 10 % damping gives the first mode 6 %. The energy drop
at -20 degC (-56.1 %) is met within a few per cent."""
FE_TEXT = """## Is one dimension good enough?

The rows "against finite elements" above compare layers and lead with an axisymmetric solution
that gets the heat of our own run. In the layers of both specimens the conservative scheme is
good, and practically all of its error in the HDR specimen is the two cells of a layer, which miss
the middle of its parabola (`cells.rubber = 8` mends that). `published` has the lead far too cold
(P4) and the inside too hot while it cools (P1); a single temperature is too low inside and too
high outside.

The source's formula for the heat that leaves lead (`lead_ends = "half-space"`) is the weak part.
With p = 1/2 it suits the confined core of the specimen at the end of a loading, but the lead
runs low while it cools, and the taller core of the bridge bearing runs low by a fifth of its
rise: what is missing is the core's own conduction and the finite plate. Neither the clock, nor
another p, nor the exact superposition of the half-space response mends this. Cores in touch with
the shims are left too hot while loaded, and worse when loaded again, since a long rest starts
the clock anew; `surface_ratio = 0.7` cures one instant only.

`lead_ends = "finite-plate"`, the default, needs neither p nor clock ([theory.md](theory.md)).
The rows "largest error, half-space and finite plates" compare both over a loading, two minutes
of rest, the same loading and ten minutes of rest, for confined cores, with films and with faces
held, and for cores in touch with shims: thin and thick layers, slender and stout cores, one and
four, natural rubber and rubber that heats itself by 35 K. The finite elements get the rubber's
own heat too: it moves the lead by the layers' temperature beside it, which the cells have. One
number is empirical: `lead.end_spreading` of confined cores (0.8 with sealing plates, chosen on
the first case, kept in the others, 1 without). Ten round bearings drawn at random, 400 to 1300
mm, with one core or four (`python -m benchmarks.lead_drawn`), were looked at last: -1.5 to +1.0
K of 76 to 123 K, where the formula errs by -12 to +39 K.

What the change of the default did, at -20 degC, 175 %, 0.5 Hz, eleven cycles, ten minutes,
eleven cycles, and in jra-ii-i-1 (`python -m benchmarks.lead_defaults`; energy of single cycles):

| | half-space (old) | finite plates (new) | change |
|---|---|---|---|
| shen-lhdr-specimen, cycle 11: lead, degC | 121.3 | 121.7 | +0.4 |
| shen-lhdr-specimen, cycle 11: Q_d, kN | 103 | 103 | -0.00027 |
| shen-lhdr-specimen, cycle 11: energy, kJ | 21.75 | 21.75 | -6.9e-05 |
| shen-lhdr-specimen, cycle 12: lead, degC | -2.703 | -2.718 | -0.014 |
| shen-lhdr-specimen, cycle 12: Q_d, kN | 125.9 | 125.8 | -0.0076 |
| shen-lhdr-specimen, cycle 12: energy, kJ | 27.61 | 27.61 | -0.0015 |
| shen-lhdr-specimen, cycle 22: lead, degC | 122.1 | 122.5 | +0.44 |
| shen-lhdr-specimen, cycle 22: Q_d, kN | 97.17 | 97.17 | -0.0022 |
| shen-lhdr-specimen, cycle 22: energy, kJ | 20.09 | 20.08 | -0.00041 |
| shen-lhdr-bridge, cycle 11: lead, degC | 222.1 | 223.3 | +1.2 |
| shen-lhdr-bridge, cycle 11: Q_d, kN | 230.9 | 230.9 | -4.7e-08 |
| shen-lhdr-bridge, cycle 11: energy, kJ | 173.8 | 173.8 | -3.4e-08 |
| shen-lhdr-bridge, cycle 12: lead, degC | 12.63 | 34.94 | +22 |
| shen-lhdr-bridge, cycle 12: Q_d, kN | 304.1 | 304.6 | +0.44 |
| shen-lhdr-bridge, cycle 12: energy, kJ | 230.3 | 230.5 | +0.23 |
| shen-lhdr-bridge, cycle 22: lead, degC | 229.4 | 252.3 | +23 |
| shen-lhdr-bridge, cycle 22: Q_d, kN | 208.5 | 208.6 | +0.1 |
| shen-lhdr-bridge, cycle 22: energy, kJ | 152.5 | 152.5 | +0.046 |
| lrb-example, cycle 11: lead, degC | 163.1 | 152.9 | -10 |
| lrb-example, cycle 11: Q_d, kN | 66.72 | 71.48 | +4.8 |
| lrb-example, cycle 11: energy, kJ | 73.53 | 78.52 | +5 |
| lrb-example, cycle 12: lead, degC | 18.48 | 24.15 | +5.7 |
| lrb-example, cycle 12: Q_d, kN | 189.1 | 181.1 | -8 |
| lrb-example, cycle 12: energy, kJ | 203.7 | 195.6 | -8.1 |
| lrb-example, cycle 22: lead, degC | 164 | 157.1 | -6.9 |
| lrb-example, cycle 22: Q_d, kN | 66.32 | 69.43 | +3.1 |
| lrb-example, cycle 22: energy, kJ | 73.09 | 76.32 | +3.2 |
| pier P1 on shen-lhdr-bridge: lead, degC | -14.01 | -14.14 | -0.13 |
| pier P1 on shen-lhdr-bridge: bearing displacement, mm | 47.38 | 47.38 | -9.7e-12 |
| pier P1 on shen-lhdr-bridge: energy in the bearing, kJ | 45.51 | 45.51 | +3.9e-12 |
| pier P1 on shen-lhdr-bridge: pier ductility | 0.8946 | 0.8946 | -1.2e-14 |
| pier P1 on lrb-example: lead, degC | -0.4786 | -2.156 | -1.7 |
| pier P1 on lrb-example: bearing displacement, mm | 221.9 | 221.6 | -0.28 |
| pier P1 on lrb-example: energy in the bearing, kJ | 117.3 | 116.8 | -0.57 |
| pier P1 on lrb-example: pier ductility | 0.6991 | 0.6994 | +0.00027 |

The lead of the LHDR bearings has constant strength (softening 0): there its temperature is
nearly all that changes. In lrb-example, whose lead softens, the formula had Q_d 7 % low after
eleven cycles and 4 % high in the first cycle after the rest."""
BENCH_IN_README = (
    "coupled_step",
    "whole_test",
    "numpy_stepper",
    "opensees",
    "structure",
    "memory",
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


def bench_rows(bench: dict[str, Any], items: tuple[str, ...] | None = None) -> list[list[str]]:
    """What the benches measured, with target and whether it was met."""
    marks = {True: "yes", False: "**no**", None: ""}
    return [
        [row["what"], number(row["value"], row["unit"]), row["target"], marks[row["met"]]]
        for item, rows in bench["rows"].items()
        if items is None or item in items
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
    missing = [name for name in IN_README if name not in by_name]
    if missing:
        raise SystemExit(f"no test measured: {missing}")
    about = bench["machine"]
    parts = [
        table(
            ["verified", "measured", "limit"],
            [[m["what"], m["value"], m["limit"]] for m in (by_name[n] for n in IN_README)],
        ),
        f"Speed and memory ({about['processor']}, one core, Python {about['python']}, "
        f"numba {about['numba']}):",
        table(["what", "measured", "target", "met"], bench_rows(bench, BENCH_IN_README)),
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
                FE_TEXT,
                LEAD_TEXT,
                PIER_TEXT,
                SOURCE_TEXT,
                f"## Benches\n\n{about}",
                table(["what", "measured", "target", "met"], bench_rows(bench)),
            ]
        )
        + "\n"
    )


def between(text: str, name: str, content: str) -> str:
    """The text with what stands between two marks replaced."""
    start, end = f"<!-- generated: {name} -->", "<!-- end generated -->"
    head, rest = text.split(start)
    return f"{head}{start}\n{content}\n{end}{rest.split(end, 1)[1]}"


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
    motions = [name for name in tb.motions.list_motions() if name.split("-")[2] == "i"]
    title = "shen-hdr-bridge: bounds (bars), coupled (dots)"
    figure = draw_bounds(tb.design.bounds_study(bearing, motions), title)
    save_figure(figure, DOCS / "figures" / "bounds.png", dpi=80)
    lead = tb.load_bearing("shen-lhdr-bridge")
    _, results = tb.design.scale_study(lead)
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
        draw()
        for name in ("opensees_lead", "opensees_pier", "takeda"):
            figure = ["-m", f"benchmarks.{name}_figure", str(DOCS / f"figures/{name}.png")]
            subprocess.run([sys.executable, *figure], check=True, cwd=DOCS.parent)
    measured, bench_numbers = load(MEASURED), load(BENCH)
    README.write_text(readme_text(README.read_text(), measured, bench_numbers))
    (DOCS / "verification.md").write_text(verification_text(measured, bench_numbers))


if __name__ == "__main__":
    main()
