"""Valid input of every kind, small: what the mutations start from. No tests.

Tests last a second or two in coarse steps, so that what is still valid after a mutation can be
run many times.
"""

import copy
import tomllib
from functools import cache
from importlib import resources
from typing import Any

from hypothesis import strategies as st

import tests.fuzz.sheets as sheets
import tests.unit.motion_files as motion_files
import thermobearing as tb

BEARINGS = ["shen-hdr-specimen", "shen-lhdr-specimen", "shen-hdr-bridge", "lrb-example"]
Table = dict[str, Any]


@cache
def _stored(path: str) -> Table:
    text = resources.files("thermobearing") / "data" / path
    return tomllib.loads(text.read_text(encoding="utf-8"))


def between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False).map(lambda value: round(value, 4))


@st.composite
def quantities(draw: st.DrawFn, low: float, high: float, unit: str) -> str:
    return f"{draw(between(low, high))} {unit}"


@st.composite
def bearings(draw: st.DrawFn) -> Table:
    table = copy.deepcopy(_stored(f"bearings/{draw(st.sampled_from(BEARINGS))}.toml"))
    if draw(st.booleans()):
        amplitude = draw(between(0.0, 2.0))
        table["scragging"] = {"amplitude": amplitude, "strain": 0.3, "mullins_amplitude": 0.2}
    if draw(st.booleans()):
        table["rate"] = {"stiffness": draw(quantities(0.5, 5, "kN/mm")), "damping": "1 kN s/mm"}
    if draw(st.booleans()):
        table["cells"] = {name: draw(st.integers(1, 6)) for name in ("end_plate", "rubber", "shim")}
    if draw(st.booleans()):
        table["geometry"]["sealing_plate_thickness"] = draw(quantities(1, 9, "mm"))
    return table


def bilinear_bearings() -> st.SearchStrategy[Table]:
    return st.just(_stored("bilinear/shen-bilinear-bridge.toml"))


@st.composite
def damping(draw: st.DrawFn) -> Table:
    """Each kind, with and without its numbers; some of them a chain of few bodies does not have."""
    kind = draw(st.sampled_from(["modal", "rayleigh", "element", "none", "source"]))
    table: Table = {} if kind == "modal" and draw(st.booleans()) else {"kind": kind}
    ratio = between(0.0, 0.1)
    if kind in ("modal", "source") and table and draw(st.booleans()):
        table["ratios"] = [draw(ratio)] if kind == "modal" else [draw(ratio), draw(ratio)]
    if kind == "rayleigh" and draw(st.booleans()):
        table["modes"] = draw(st.sampled_from([[1], [2], [1, 2], [2, 1], [1, 3]]))
        table["ratios"] = [draw(ratio) for _ in table["modes"]]
    return table


@st.composite
def structures(draw: st.DrawFn) -> Table:
    if draw(st.booleans()):
        return _stored(f"structures/{draw(st.sampled_from(['pier-p1', 'hybrid-pier']))}.toml")
    count = draw(st.integers(1, 4))
    names = [f"body {k}" for k in range(count)]
    below = ["ground", *names[:-1]]
    springs = [
        {
            "name": f"spring {k}",
            "body": names[k],
            "base": below[k],
            "stiffness": draw(quantities(1, 100, "kN/mm")),
            "damping_ratio": draw(between(0.0, 0.1)),
        }
        for k in range(count)
    ]
    return {
        "name": "chain",
        "bodies": [{"name": name, "moves": True} for name in names],
        "masses": [
            {"body": name, "height": "0 mm", "mass": draw(quantities(0.01, 1, "kN s^2/mm"))}
            for name in names
        ],
        "springs": springs,
        "bearings": [
            {
                "name": "bearings",
                "body": names[-1],
                "base": below[-1],
                "count": draw(st.integers(1, 6)),
                "equivalent_stiffness": draw(quantities(0.5, 5, "kN/mm")),
            }
        ],
        "damping": draw(damping()),
        "report": {"deck": names[-1], "pier": names[0], "pier_top": "1 m"},
    }


@st.composite
def steps(draw: st.DrawFn) -> Table:
    kind = draw(st.sampled_from(["cycles", "cycles", "rest", "ramp", "recorded"]))
    if kind == "cycles":
        timing = draw(
            st.sampled_from([{"speed": "300 mm/s"}, {"period": "1 s"}, {"frequency": "2 Hz"}])
        )
        size = {"strain": draw(between(0.1, 2.0))} if draw(st.booleans()) else {"amplitude": "9 mm"}
        wave = draw(st.sampled_from(["sine", "triangular"]))
        closing = {"closing_strain": 0.1} if draw(st.booleans()) else {}
        return {"step": "cycles", "wave": wave, "count": 1, **size, **timing, **closing}
    if kind == "rest":
        way = {"duration": "5 s"} if draw(st.booleans()) else {"within": "20 K"}
        return {"step": "rest", **way}
    if kind == "ramp":
        way = {"speed": "50 mm/s"} if draw(st.booleans()) else {"duration": "0.5 s"}
        return {
            "step": "ramp",
            **({"to": "0 mm"} if draw(st.booleans()) else {"to_strain": 0.0}),
            **way,
        }
    return {"step": "recorded", "file": "moved.csv"}


@st.composite
def faces(draw: st.DrawFn) -> Table:
    return {"eta": draw(between(1.0, 3.0))} if draw(st.booleans()) else {"film": "9 W/(m^2 K)"}


@st.composite
def cyclic_cases(draw: st.DrawFn, *, bearing: bool = True) -> Table:
    """A cyclic test; the files it names are those of `companions`."""
    table: Table = {
        "test": {
            "name": "quick",
            "dt": draw(quantities(0.02, 0.1, "s")),
            "steps": draw(st.lists(steps(), min_size=1, max_size=3)),
        }
    }
    if bearing:
        table["bearing"] = draw(st.one_of(st.sampled_from([*BEARINGS, "bearing.toml"]), bearings()))
    if draw(st.booleans()):
        table["ambient"] = draw(st.sampled_from([["-20 degC"], ["23 degC", "0 degC"], "5 degC"]))
    elif draw(st.booleans()):
        table["ambient_series"] = "night.csv"
    if draw(st.booleans()):
        table["analysis"] = {
            "scheme": draw(st.sampled_from(["conservative", "published"])),
            "integrator": draw(st.sampled_from(["exact", "exact", "euler"])),
            "heat_source": draw(st.sampled_from(["work", "dissipation"])),
            "upper_face": draw(faces()),
            "keep_every": draw(st.integers(1, 4)),
            "keep": draw(st.lists(st.sampled_from(["rubber", "cells", "hysteretic"]), unique=True)),
        }
    start = draw(st.integers(0, 5))
    if start == 0:
        table["initial"] = draw(quantities(-20, 40, "degC"))
    elif start == 1 and table.get("bearing") == "shen-hdr-specimen":
        table["initial_result"] = "earlier.nc"
    return table


@st.composite
def motion_tables(draw: st.DrawFn) -> Any:
    name = draw(st.sampled_from(["jra-ii-i-1", "motion.csv", "motion.at2"]))
    if draw(st.booleans()):
        return name
    return {"name": name, "factor": draw(between(0.1, 2.0))}


@st.composite
def earthquake_cases(draw: st.DrawFn) -> Table:
    command = draw(st.sampled_from(["bridge", "hybrid"]))
    table: Table = {
        "command": command,
        "structure": draw(
            st.one_of(st.sampled_from(["pier-p1", "hybrid-pier", "structure.toml"]), structures())
        ),
        "bearings": [
            draw(st.one_of(st.sampled_from([*BEARINGS, "shen-bilinear-bridge"]), bearings()))
        ],
        "motions": [draw(motion_tables())],
        "duration": draw(quantities(0.05, 0.4, "s")),
        "analysis": {"dt": draw(quantities(0.005, 0.02, "s"))},
    }
    if draw(st.booleans()):
        table["ambient"] = [draw(quantities(-30, 40, "degC"))]
    else:
        table["weather"] = "night.csv"
    if command == "hybrid":
        table["laboratory"] = {
            "mode": draw(st.sampled_from(["rt", "pd"])),
            "speed": "10 mm/s",
            "delay": draw(quantities(0, 0.02, "s")),
            "force_noise": draw(quantities(0, 1, "kN")),
            "seed": draw(st.integers(0, 99)),
        }
    elif draw(st.booleans()):
        methods = ["average-acceleration", "linear-acceleration", "predictor-corrector"]
        table["analysis"]["method"] = draw(st.sampled_from(methods))
        table["analysis"]["mass"] = draw(st.sampled_from(["consistent", "published"]))
    if draw(st.booleans()):
        kinds = ["modal", "rayleigh", "element", "none", "source"]
        table["analysis"]["damping"] = draw(st.sampled_from(kinds))
    return table


@st.composite
def parts(draw: st.DrawFn) -> Table:
    kind = draw(st.sampled_from(["cyclic", "hybrid", "rest"]))
    table: Table = {"part": kind}
    if draw(st.booleans()):
        table["name"] = draw(st.sampled_from(["first", "a / b", "免震", "..", "x" * 60]))
    if draw(st.integers(0, 3)) == 0:
        table["ambient"] = draw(quantities(-30, 40, "degC"))
    if kind == "cyclic":
        back = {"step": "ramp", "to": "0 mm", "speed": "50 mm/s"}
        table["dt"] = draw(quantities(0.02, 0.1, "s"))
        table["steps"] = [back, *draw(st.lists(steps(), max_size=2))]
    elif kind == "rest":
        table |= {"duration": "5 s"} if draw(st.booleans()) else {"within": "20 K"}
    else:
        table |= {"duration": draw(quantities(0.05, 0.3, "s")), "dt": "0.02 s"}
        table["motion"] = draw(motion_tables())
        if draw(st.booleans()):
            table["structure"] = draw(st.one_of(st.just("structure.toml"), structures()))
        if draw(st.booleans()):
            table["laboratory"] = {"mode": draw(st.sampled_from(["rt", "pd"])), "seed": 3}
    return table


@st.composite
def sequence_cases(draw: st.DrawFn) -> Table:
    table: Table = {
        "bearing": draw(st.one_of(st.sampled_from([*BEARINGS, "bearing.toml"]), bearings())),
        "ambient": draw(quantities(-30, 40, "degC")),
        "parts": draw(st.lists(parts(), min_size=1, max_size=3)),
    }
    if draw(st.booleans()):
        limits = st.sampled_from(["shen-rig", {"force": "50 kN"}, {"speed": "9 mm/s"}])
        table["rig"] = draw(limits)
    if draw(st.booleans()):
        table["analysis"] = {
            "scheme": draw(st.sampled_from(["conservative", "published"])),
            "keep_every": draw(st.integers(1, 4)),
        }
    return table


@st.composite
def design_cases(draw: st.DrawFn) -> Table:
    return {
        "structure": "pier-p1",
        "motions": [draw(st.sampled_from(["motion.csv", "motion.at2"]))],
        "compound": draw(st.sampled_from(["G8", "G10", "G12"])),
        "start": draw(quantities(50, 300, "mm")),
        "weight": draw(quantities(300, 1200, "kN")),
        "most_rounds": draw(st.integers(1, 2)),
        "dt": "0.02 s",
        "sizing": {"layer_thickness": "14 mm", "stress": "6 MPa", "plan_step": "50 mm"},
        "equal": draw(st.sampled_from([[], ["shen-hdr-bridge"]])),
    }


@st.composite
def sidecars(draw: st.DrawFn) -> Table:
    table: Table = {
        "name": "cold",
        "bearing": draw(st.sampled_from(["shen-hdr-specimen", "bearing.toml"])),
        "ambient": draw(quantities(-30, 40, "degC")),
        "columns": {"time": "time_s", "force": "force_kN"},
        "units": {"time": "s"} if draw(st.booleans()) else {},
        "flip_force": draw(st.booleans()),
        "force_offset": draw(quantities(-0.1, 0.1, "kN")),
        "weight": draw(between(0.1, 4.0)),
        "first_cycle_weight": draw(between(0.0, 1.0)),
        "cycle_balance": draw(between(0.0, 1.0)),
    }
    if draw(st.booleans()):
        table["file"] = "test.csv"
    elif draw(st.booleans()):
        table["blocks"] = [{"file": "test.csv"}, {"file": "test.csv", "rest_before": "1 h"}]
    if draw(st.booleans()):
        table["thermocouples"] = {"inner_degC": "rubber 3"}
    if draw(st.booleans()):
        table |= {"separator": ",", "decimal": ".", "encoding": "utf-8", "despike": True}
    return table


MOTIONS = {
    "motion.csv": motion_files.csv_text(),
    "motion.txt": motion_files.one_column("% acc in gal, dt = 0.01 s"),
    "motion.at2": motion_files.at2_text(),
    "motion.knet": motion_files.knet_text(),
    "motion.jma": motion_files.jma_text(),
}
TABLES = {
    "test.csv": sheets.TEST,
    "moved.csv": sheets.MOVED,
    "night.csv": sheets.NIGHT,
    "measured.csv": sheets.MEASURED,
}


@cache
def earlier_result() -> bytes:
    from pathlib import Path
    from tempfile import TemporaryDirectory

    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05)
    with TemporaryDirectory() as folder:
        saved = tb.run("shen-hdr-specimen", test, ambient=-20).save(f"{folder}/out", figures=False)
        return Path(saved, "result.nc").read_bytes()


@cache
def companions() -> dict[str, bytes]:
    import tomli_w

    texts = {
        **TABLES,
        **MOTIONS,
        "bearing.toml": tomli_w.dumps(_stored("bearings/shen-hdr-specimen.toml")),
        "structure.toml": tomli_w.dumps(_stored("structures/hybrid-pier.toml")),
    }
    return {name: text.encode() for name, text in texts.items()} | {"earlier.nc": earlier_result()}
