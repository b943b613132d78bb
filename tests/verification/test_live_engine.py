"""The live page computes what Python computes: cases in node."""

import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests.skip_reasons import NO_NODE
from thermobearing.bearing.library import load_bearing
from thermobearing.core.compiled.sources import sources_digest
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import build_tasks, run_task
from thermobearing.live import data as live

HERE = Path(__file__).parent
ENGINE = Path(live.__file__).with_name("engine.js")
KINDS = {
    "HDR": {"base": "shen-hdr-specimen"},
    "LHDR": {"base": "shen-lhdr-specimen"},
    "LRB": {"base": "lrb-example"},
    "plain": {"base": "shen-hdr-bridge", "hysteresis.post_yield_ratio": 1.0},
}
GRADED = tb.changed_bearing(
    "shen-lhdr-specimen",
    name="graded-plates",
    cells={"end_plate": 5, "rubber": 4, "shim": 2, "sealing_plate": 4, "plate_grading": 1.3},
)
DT = 0.02
MOTION = "jra-ii-i-1"
KNOWN = [*tb.list_bearings(), GRADED]


def cycles(strain: float, count: int = 3, wave: str = "triangle", **rate: float) -> dict[str, Any]:
    return {"strain": strain, "cycles": count, "wave": wave, **(rate or {"speed_mm_s": 30.0})}


def case(changes: dict[str, Any], ambient: float, *steps: Any, **more: Any) -> dict[str, Any]:
    return {"changes": changes, "ambient": ambient, "test": {"dt_s": DT, "steps": steps}, **more}


def all_cases() -> Iterator[tuple[str, dict[str, Any]]]:
    for place, ambient in enumerate((-40.0, -20.0, -5.0, 10.0, 23.0, 40.0)):
        for kind, changes in KINDS.items():
            wave = ("triangle", "sine")[place % 2]
            test = cycles((0.5, 1.75, 1.0)[place % 3], 2 + place % 2, wave)
            yield f"{kind} at {ambient:g} degC", case(changes, ambient, test)
    lhdr, hdr, lrb = KINDS["LHDR"], KINDS["HDR"], KINDS["LRB"]
    touch = {"base": "shen-lhdr-in-touch"}
    rest = {"rest_s": 600.0}
    yield "rest", case(touch, -20.0, cycles(1.0, 2), rest, cycles(1.5, 2))
    yield "settles", case(hdr, -20.0, cycles(1.5, 2), {"rest_within_K": 0.5}, cycles(1.0, 1))
    yield "closing", case(lhdr, 0.0, cycles(1.0, 2) | {"closing_strain": 0.1}, cycles(2.5, 2))
    soft = {"base": "shen-lhdr-softening"}
    yield "softening lead", case(soft, -10.0, cycles(2.0, 5, "sine", frequency_hz=0.5))
    yield "softens", case(hdr, -40.0, cycles(4.0, 2))
    yield "runaway", case(lrb, 20.0, cycles(2.0, 60, "sine", frequency_hz=2.0))
    hot = hdr | {"hysteresis.layer_stiffness": 1e5}
    yield "early end", case(hot, 40.0, cycles(2.5, 20, frequency_hz=1.0))
    core = lhdr | {"lead.yield_stress": 9.0, "lead.softening": 0.0069, "rate.damping": 0.4}
    yield "other lead", case(core, -25.0, cycles(1.5))
    plan = hdr | {"geometry.plan.side": 300.0, "geometry.rubber_layers": 7}
    yield "other plan", case(plan, -25.0, cycles(1.5))
    thick = hdr | {"geometry.rubber_thickness": 8.0, "geometry.end_plate_thickness": 20.0}
    yield "other layers", case(thick, 5.0, cycles(1.5))
    large = lrb | {"geometry.plan.diameter": 800.0, "geometry.rubber_layers": 21}
    yield "LRB of 800 mm", case(large, -25.0, cycles(1.0))
    yield "sealing", case(lhdr | {"geometry.sealing_plate_thickness": 0.0}, 0.0, cycles(1.0))
    wide = touch | {
        "lead.diameter": 60.0,
        "lead.cores": 2,
        "geometry.sealing_plate_thickness": 20.0,
    }
    yield "wider cores in touch", case(wide, -20.0, cycles(1.0, 2), rest, cycles(1.5, 2))
    plates = {"base": GRADED.name, "geometry.end_plate_thickness": 30.0}
    yield "graded plates", case(plates, -20.0, cycles(1.5), rest, cycles(1.0))
    for name in ("shen-hdr-bridge", "shen-lhdr-bridge"):
        for ambient in (-20.0, 23.0):
            yield f"{name}, {ambient:g} degC", {
                "changes": {"base": name}, "ambient": ambient, "motion": MOTION,
            }  # fmt: skip


CASES = dict(all_cases())
REFUSED: list[dict[str, Any]] = [
    {"geometry.plan.side": 0.5},
    {"geometry.rubber_layers": 300},
    {"geometry.sealing_plate_thickness": 0.01},
    {"hysteresis.shape": -1.5},
    {"hysteresis.yield_displacement": 80.0},
    {"hysteresis.layer_stiffness": 0.001},
    {"lead.diameter": 150.0},
]


def bearing_in_python(changes: dict[str, Any]) -> tb.Bearing:
    base = GRADED if changes["base"] == GRADED.name else load_bearing(changes["base"])
    tables: dict[str, Any] = {}
    for path, value in changes.items():
        *above, name = path.split(".")
        table = tables
        for part in above:
            table = table.setdefault(part, {})
        if above:
            table[name] = value
    if "plan" in tables.get("geometry", {}):
        tables["geometry"]["plan"]["shape"] = base.geometry.plan.shape
    return tb.changed_bearing(base, **tables) if tables else base


def step_in_python(step: dict[str, Any]) -> dict[str, Any]:
    if "rest_s" in step:
        return {"step": "rest", "duration": step["rest_s"]}
    if "rest_within_K" in step:
        return {"step": "rest", "within": step["rest_within_K"]}
    same = {"cycles": "count", "speed_mm_s": "speed", "frequency_hz": "frequency"}
    wave = "triangular" if step["wave"] == "triangle" else "sine"
    renamed = {same.get(key, key): value for key, value in step.items()}
    return {"step": "cycles"} | renamed | {"wave": wave}


def run_in_python(one: dict[str, Any]) -> dict[str, Any]:
    bearing = bearing_in_python(one["changes"])
    if "motion" in one:
        table = {"command": "bridge", "bearings": [bearing], "motions": [one["motion"]]}
        table |= {"ambient": [f"{one['ambient']:g} degC"]}
        (task,) = build_tasks(make_earthquake_case(table, "live"))
        history = run_task(task)  # a result has its histories in single precision
        energies = history.rows.energies
        return {
            "outcome": history.outcome,
            "displacement": history.bearing()["displacement"],
            "force": history.bearing()["force"],
            "temperature": history.layers().ravel(),
            "rotation": history.hinge(0)["rotation"],
            "damping_of_input": energies["damping"][-1:] / energies["input"][-1:],
        }
    steps: Any = [step_in_python(step) for step in one["test"]["steps"]]
    result = tb.run(bearing, CyclicTest(dt=DT, steps=steps), one["ambient"])
    data = result.dataset.isel(ambient=0)
    return {
        "outcome": str(data["outcome"].values),
        "displacement": data["displacement"].values,
        "force": data["force"].values,
        "temperature": data["rubber_temperature"].values.ravel(),
        "lead": data["lead_temperature"].values if bearing.lead else None,
        "cycles": result.cycles,
        "softened": int(data["softened_steps"].values),
    }


@pytest.fixture(scope="module")
def computed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    node = shutil.which("node")
    if node is None:
        pytest.skip(NO_NODE)
    try:
        module = live.live_module()
    except tb.InputError as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("live")
    (folder / "engine.mjs").write_text(live.engine_source(), encoding="utf-8")
    (folder / "kernels.wasm").write_bytes(module)
    (folder / "data.json").write_text(json.dumps(live.live_data(KNOWN)), encoding="utf-8")
    bad = [{"changes": KINDS["LHDR"] | one} for one in REFUSED]
    texts = json.dumps([*CASES.values(), *bad])
    (folder / "cases.json").write_text(texts, encoding="utf-8")
    files = [
        str(folder / name) for name in ("engine.mjs", "kernels.wasm", "data.json", "cases.json")
    ]
    script = str(HERE / "live_engine.mjs")
    done = subprocess.run([node, script, *files], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def differ(mine: Any, theirs: Any) -> float:
    assert len(mine) == len(theirs)
    if not len(mine):
        return 0.0
    return float(np.abs(np.asarray(mine, dtype=float) - np.asarray(theirs, dtype=float)).max())


HISTORIES = ("displacement", "force", "rotation", "damping_of_input")
MEASURES = {  # of a cycle: in the page, in Python
    "G_eq_MPa": "G_eq_MPa",
    "stiffness_kN_mm": "K_eq_kN_mm",
    "h_eq": "h_eq",
    "energy_kN_mm": "energy_kN_mm",
    "characteristic_strength_kN": "characteristic_strength_kN",
    "post_yield_stiffness_kN_mm": "post_yield_stiffness_kN_mm",
}


def compared(one: dict[str, Any], page: dict[str, Any]) -> dict[str, float]:
    """Largest differences: of forces and displacements by their peak, of temperatures [K]."""
    mine = run_in_python(one)
    assert page["outcome"] == mine["outcome"]
    assert page.get("softened") == mine.get("softened")
    histories = [key for key in HISTORIES if key in mine]
    result = {k: differ(page[k], mine[k]) / float(np.abs(mine[k]).max()) for k in histories}
    result["temperature"] = differ(page["temperature"], mine["temperature"])
    if mine.get("lead") is not None:
        result["lead"] = differ(page["lead"], mine["lead"])
    for key, column in MEASURES.items() if "cycles" in mine else ():
        theirs = np.array([cycle[key] for cycle in page["cycles"]])
        expected = mine["cycles"][column].to_numpy() if len(mine["cycles"]) else np.zeros(0)
        scale = max(1e-2, *np.abs(expected)) if len(expected) else 1.0  # plain rubber has no Q_d
        result[key] = differ(theirs, expected) / scale
    return result


LIMITS = {
    **dict.fromkeys(HISTORIES, 1e-10),  # of the peak
    **dict.fromkeys(("temperature", "lead"), 1e-9),  # [K]
    **dict.fromkeys(MEASURES, 1e-9),
    # A point at 50 % of a sine belongs to the fit or not by the last bit of the sine.
    "post_yield_stiffness_kN_mm": 1e-3,
}


def assert_alike(results: list[dict[str, Any]]) -> None:
    worst: dict[str, float] = {}
    for (name, one), page in zip(CASES.items(), results[: len(CASES)], strict=True):
        result = compared(one, page)
        assert all(value < LIMITS[key] for key, value in result.items()), (name, result)
        worst |= {key: max(value, worst.get(key, 0.0)) for key, value in result.items()}
    print({key: f"{value:.1e}" for key, value in worst.items()})


def test_page_and_python_agree(computed: dict[str, Any]) -> None:
    assert_alike(computed["results"])


def test_cases_end_in_different_ways(computed: dict[str, Any]) -> None:
    ends = {one["outcome"] for one in computed["results"][: len(CASES)]}
    assert {"completed", "temperature_runaway"} <= ends
    assert len(CASES) == 42
    early = computed["results"][list(CASES).index("early end")]
    assert (early["outcome"], early["cycles"]) == ("temperature_runaway", [])
    assert any(one.get("softened") for one in computed["results"])


def test_page_refuses_what_files_may_not_have(computed: dict[str, Any]) -> None:
    for changes, page in zip(REFUSED, computed["results"][len(CASES) :], strict=True):
        with pytest.raises(tb.InputError) as error:
            bearing_in_python(KINDS["LHDR"] | changes)
        assert page["refused"] == error.value.problems


def test_memory_does_not_grow(computed: dict[str, Any]) -> None:
    assert computed["grown"] == 0


def test_module_is_of_these_sources(computed: dict[str, Any]) -> None:
    assert computed["sources"] == sources_digest()
