"""What the source reports of the hybrid test and of the bridge, and the trends on real records."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.shared_data import shared_data

TYPE_II = {"II-I-1": "II-I-1_like_JMA_NS.csv", "II-I-2": "II-I-2_like_JMA_EW.csv"}
TAKATORI = "II-II-1_like_TAK000.csv"
REAL = {
    "Kobe JMA NS": {"name": "jma_kobe_ns_ew_gal_dt0.005.txt", "component": "NS"},
    "Takatori": {"name": "TAK000.AT2"},
    "El Centro": {"name": "RSN6_IMPVALL.I_I-ELC180.AT2", "factor": 2.5},
    "El Centro (Peknold)": {"name": "STAIRlab_elCentro.at2", "factor": 2.5},
    "Chi-Chi TCU122": {"name": "RSN1546_CHICHI_TCU122-N.AT2", "factor": 1.5},
    "Tohoku KiK-net NS": {"name": "TKYH121103111446.NS2", "factor": 3.0},
    "Kumamoto JMA NS": {"name": "Q4149CF2.csv", "component": "NS", "factor": 2.0},
    "Tohoku K-NET KNG007": {"name": "KNG007_NS_t_g.txt", "factor": 3.0},
}
# Where the source's "more force" does not hold: the warm bearing is strained so far (165 to 405 %)
# that it hardens, or the pier yields in the cold and caps the force. The other three trends hold
# on every motion.
CAPPED = {"more force"}
EXCEPTIONS: dict[tuple[str, str], set[str]] = {
    ("Takatori", "shen-hdr-bridge"): CAPPED,
    ("Takatori", "shen-lhdr-bridge"): CAPPED,
    ("El Centro", "shen-hdr-bridge"): CAPPED,
    ("Tohoku K-NET KNG007", "shen-hdr-bridge"): CAPPED,
}
# With less viscous damping than the source's also these; on Chi-Chi by 3 %, because the structure
# gets too stiff in the cold for that motion.
LESS_DAMPED: dict[tuple[str, str], set[str]] = {
    ("Chi-Chi TCU122", "shen-lhdr-bridge"): CAPPED,
    ("Kumamoto JMA NS", "shen-lhdr-bridge"): CAPPED,
    ("Tohoku K-NET KNG007", "shen-lhdr-bridge"): CAPPED,
}
ALLOWED = {"source": EXCEPTIONS, "modal": EXCEPTIONS | LESS_DAMPED}
STUDIED = [(record, "modal") for record in REAL]
STUDIED += [(record, "source") for record, _ in LESS_DAMPED]
BEARINGS = ["shen-hdr-bridge", "shen-lhdr-bridge"]
AMBIENT = [23.0, 0.0, -20.0]


def shared_motion(choice: dict[str, Any]) -> dict[str, Any]:
    return choice | {"name": str(shared_data(f"motions/{choice['name']}"))}


def by_temperature(table: pd.DataFrame, bearing: str, column: str) -> np.ndarray:
    rows = table[table["bearing"] == bearing].sort_values("ambient_degC", ascending=False)
    return np.asarray(rows[column], dtype=float)


def reported(values: np.ndarray, form: str = "{:.2f}") -> str:
    return ", ".join(form.format(value) for value in values)


def check_trends(table: pd.DataFrame, bearing: str) -> list[str]:
    strain = by_temperature(table, bearing, "bearing_strain_max")
    force = by_temperature(table, bearing, "bearing_force_max_kN")
    pier = by_temperature(table, bearing, "pier_displacement_max_mm")
    energy = by_temperature(table, bearing, "bearing_energy_kN_mm")
    checks = {
        "less strain": strain[-1] < strain[0],
        "more force": force[-1] > force[0],
        "more pier displacement": pier[-1] > pier[0],
        "less energy": energy[-1] < energy[0],
    }
    return [name for name, holds in checks.items() if not holds]


@pytest.mark.parametrize("damping", quick_cases(["modal", "source"], 0))
@pytest.mark.parametrize(
    "motion",
    [
        "jra-i-i-1",
        pytest.param("jra-i-i-2", marks=pytest.mark.thorough),
        "jra-ii-i-1",
        pytest.param("jra-ii-i-2", marks=pytest.mark.thorough),
    ],
)
def test_trends_on_the_four_motions(motion: str, damping: Any, measured: Recorder) -> None:
    """And the share of the input that viscous damping takes: more where stiff bearings leave more
    to the foundation."""
    table = tb.bridge(BEARINGS, motion, AMBIENT, damping=damping).table
    for bearing in BEARINGS:
        wrong = check_trends(table, bearing)
        share = by_temperature(table, bearing, "damping_of_input")
        measured(
            f"pier P1, {bearing}, {motion}, damping {damping}, 23, 0, -20 degC: strain, "
            "ductility, share of the input that is damped",
            reported(by_temperature(table, bearing, "bearing_strain_max"))
            + "; "
            + reported(by_temperature(table, bearing, "pier_ductility"))
            + "; "
            + reported(share),
            "colder: less strain, more force and pier displacement, less energy"
            + (f"; not: {', '.join(wrong)}" if wrong else ""),
        )
        assert not set(wrong) - ALLOWED[damping].get((motion, bearing), set())
        assert np.all(np.diff(share) > 0.0)


@pytest.mark.parametrize(
    ("record", "damping"),
    [
        pytest.param(*pair, marks=[pytest.mark.thorough] if i else [])
        for i, pair in enumerate(STUDIED)
    ],
)
def test_trends_on_real_records(record: str, damping: Any, measured: Recorder) -> None:
    table = tb.bridge(BEARINGS, shared_motion(REAL[record]), AMBIENT, damping=damping).table
    for bearing in BEARINGS:
        wrong = check_trends(table, bearing)
        measured(
            f"pier P1, {bearing}, {record}, damping {damping}, 23, 0, -20 degC: strain, energy of "
            "23 degC",
            reported(by_temperature(table, bearing, "bearing_strain_max"))
            + "; "
            + reported(by_temperature(table, bearing, "energy_of_warmest")),
            "as above" + (f"; not: {', '.join(wrong)}" if wrong else ""),
        )
        assert not set(wrong) - ALLOWED[damping].get((record, bearing), set())


@pytest.mark.parametrize("damping", quick_cases(["modal", "source"], 0))
@pytest.mark.parametrize("mass", quick_cases(["consistent", "published"], 1))
def test_energy_and_ductility_compared_with_shen(
    mass: Any, damping: Any, measured: Recorder
) -> None:
    """LHDR, II-I-1: -9.3 % and -56.1 % printed; ductility about 1 at 23, up to 3 at -20 degC."""
    motions = [shared_motion({"name": name}) for name in TYPE_II.values()]
    table = tb.bridge("shen-lhdr-bridge", motions, AMBIENT, mass=mass, damping=damping).table
    first = table[table["motion"] == table["motion"].iloc[0]]
    drop = 100.0 * (by_temperature(first, "shen-lhdr-bridge", "energy_of_warmest")[1:] - 1.0)
    ductility = by_temperature(first, "shen-lhdr-bridge", "pier_ductility")
    measured(
        f"LHDR, stand-in for II-I-1, {mass} mass, damping {damping}: energy at 0 and -20 degC "
        "against 23 degC",
        reported(drop, "{:+.1f} %"),
        "-9.3 %, -56.1 % (6.3.2)",
    )
    measured(
        f"LHDR, stand-in for II-I-1, {mass} mass, damping {damping}: ductility at 23, 0, -20 degC",
        reported(ductility),
        "about 1, up to 3 (6.3.3)",
    )
    assert drop[1] < drop[0] < 0.0
    assert np.all(np.diff(ductility) > 0.0)


def first_layer(motion: Any, count: int = 2) -> np.ndarray:
    """Of the LHDR at -20 degC in real time, at 5, 10, 15, 20 s."""
    structure = tb.load_structure("hybrid-pier")
    line = structure.bearings[0].model_copy(
        update={"count": count, "equivalent_stiffness": 376.0 / count}
    )
    structure = structure.model_copy(update={"bearings": [line]})
    result = tb.hybrid("shen-lhdr-specimen", motion, -20.0, structure=structure)
    time, outer = result["time"].values[0], result["rubber_temperature"].values[0, :, 0]
    known = np.isfinite(time)
    return np.interp([5.0, 10.0, 15.0, 20.0], time[known], outer[known])


ON_TWO = "hybrid-pier-two-bearings"
PRINTED_LAYER = "about -15 and -5 at 5 and 10 s, below 0 at 20 s (3.4.4)"


@pytest.mark.parametrize("count", [2, 8])
def test_first_layer_of_the_hybrid_test(count: int, measured: Recorder) -> None:
    """LHDR at -20 degC, stand-in for II-II-1: outer layer at 5, 10, 15, 20 s (3.4.4)."""
    motion = shared_motion({"name": TAKATORI, "factor": 687.0 / 607.0})
    result = first_layer(motion, count)
    measured(
        f"hybrid test, LHDR, -20 degC, {count} bearings: outer layer at 5, 10, 15, 20 s",
        reported(result, "{:.1f}") + " degC",
        PRINTED_LAYER,
    )
    if count == 2:
        assert np.abs(result[:2] - [-15.0, -5.0]).max() < tol.HYBRID_LAYER
        assert result[3] < 0.0
    else:  # less motion, less heat
        assert np.all(result < [-18.0, -10.0, -9.0, -11.0])


def test_first_layer_on_the_built_in_motion(measured: Recorder) -> None:
    """As near to the print as the given motion of the record's phases that fits the spectrum."""
    built_in = first_layer("jra-ii-ii-1")
    given = first_layer(shared_motion({"name": TAKATORI}))
    for name, result in (("jra-ii-ii-1", built_in), ("Takatori's phases", given)):
        measured(
            f"hybrid test, LHDR, -20 degC, 2 bearings, {name}: outer layer at 5, 10, 15, 20 s",
            reported(result, "{:.1f}") + " degC",
            PRINTED_LAYER,
        )
    assert np.abs(built_in[:2] - [-15.0, -5.0]).max() < tol.BUILT_IN_LAYER
    assert built_in[3] < 0.0
    assert np.abs(built_in - given).max() < tol.LIKE_THE_RECORD


@pytest.mark.parametrize("phases", ["jra-ii-ii-1", "Takatori's phases"])
def test_real_time_against_pseudo_dynamic(phases: str, measured: Recorder) -> None:
    """LHDR on two bearings: the rate-dependent share is larger in real time and smaller in the
    cold (5.4.2.1). On eight: test_source_hybrid.py.

    "Real-time force above pseudo-dynamic force" holds here at 23 degC; in the cold the slow test
    gives the specimen time to cool, which stiffens it by about as much: with the record's phases
    real time is above by 1 % all the same, on the built-in motion it is below. Energy grows in
    the cold while the pier is elastic (Fig. 3.25), other than in the bridge.
    """
    record = phases != "jra-ii-ii-1"
    motion = shared_motion({"name": TAKATORI}) if record else phases
    results = {
        mode: tb.hybrid(
            "shen-lhdr-specimen", motion, AMBIENT, structure=ON_TWO, laboratory={"mode": mode}
        )
        for mode in ("rt", "pd")
    }
    force = {mode: r.table["bearing_force_max_kN"].to_numpy() for mode, r in results.items()}
    share = {
        mode: np.nanmax(np.abs(r["viscous_force"].values), axis=1) / force[mode]
        for mode, r in results.items()
    }
    energy = results["rt"].table["energy_of_warmest"].to_numpy()
    measured(
        f"hybrid test, LHDR, 2 bearings, {phases}, 23, 0, -20 degC: peak force in real time over "
        "pseudo-dynamic",
        reported(force["rt"] / force["pd"], "{:.3f}"),
        "above 1 (3.4.3)",
    )
    measured(
        f"hybrid test, LHDR, 2 bearings, {phases}: largest rate-dependent force over peak force, "
        "real time; pd",
        reported(share["rt"], "{:.3f}") + "; " + reported(share["pd"], "{:.3f}"),
        "larger in real time, smaller when colder (5.4.2.1)",
    )
    measured(
        f"hybrid test, LHDR, 2 bearings, {phases}: energy at 0 and -20 degC of that at 23 degC",
        reported(energy[1:]),
        "grows in the cold (Fig. 3.25)",
    )
    assert force["rt"][0] > force["pd"][0]
    assert np.all(share["rt"] > 10.0 * share["pd"])
    assert np.all(share["rt"][1:] < 0.9 * share["rt"][0])
    assert np.all(np.diff(energy) > 0.0)
    if record:
        assert np.all(force["rt"] > force["pd"])
        assert np.all(np.diff(share["rt"]) < 0.0)


def test_what_explains_the_ductility(measured: Recorder) -> None:
    """The printed ductilities (about 1, up to 3) come out with a foundation that hardly rocks, or
    nearly without the damping that the ground springs give to the first mode; with the printed
    numbers the rocking takes most of the displacement, and its 10 % most of the peaks, be it as
    Rayleigh's 6 % of the first mode or where the ground springs are."""
    structure = tb.load_structure("pier-p1")
    sideways, rocking = structure.springs
    stiff = rocking.model_copy(
        update={"rotational_stiffness": 10.0 * (rocking.rotational_stiffness or 0.0)}
    )
    stiffer = structure.model_copy(update={"springs": (sideways, stiff)})
    variants: dict[str, tuple[Any, Any]] = {
        "as printed, damping source": (structure, "source"),
        "as printed, damping modal": (structure, "modal"),
        "rocking spring ten times as stiff, damping source": (stiffer, "source"),
        "rocking spring ten times as stiff, damping modal": (stiffer, "modal"),
        "no damping but hysteresis": (structure, "none"),
    }
    motion = shared_motion({"name": TYPE_II["II-I-1"]})
    result = {}
    for name, (variant, damping) in variants.items():
        table = tb.bridge(
            "shen-lhdr-bridge", motion, AMBIENT, structure=variant, damping=damping
        ).table
        result[name] = by_temperature(table, "shen-lhdr-bridge", "pier_ductility")
        energy = by_temperature(table, "shen-lhdr-bridge", "energy_of_warmest")
        measured(
            f"LHDR, stand-in for II-I-1, {name}: ductility; energy of 23 degC",
            f"{reported(result[name])}; {reported(energy)}",
            "about 1, up to 3; 0.91, 0.44 (6.3.2, 6.3.3)",
        )
    assert result["rocking spring ten times as stiff, damping source"][-1] > 2.5
    assert result["rocking spring ten times as stiff, damping modal"][-1] > 2.5
    assert result["no damping but hysteresis"][-1] > 2.0
    assert result["as printed, damping source"][-1] < 1.0
    assert result["as printed, damping modal"][-1] < 1.1


def test_a_night_before_the_earthquake(tmp_path: Path, measured: Recorder) -> None:
    """From -5 to -25 degC in twelve hours: the full-size bearing lags, and is softer for it."""
    hours = np.linspace(0.0, 12.0, 49)
    rows = [f"{3600.0 * h:.0f},{-5.0 - 20.0 * h / 12.0:.4f}" for h in hours]
    path = tmp_path / "night.csv"
    path.write_text("time_s,temperature_degC\n" + "\n".join(rows) + "\n")
    for bearing in BEARINGS:
        night = tb.bridge(bearing, "jra-ii-i-1", ambient=str(path))
        soaked = tb.bridge(bearing, "jra-ii-i-1", -25.0)
        layers = night["rubber_temperature"].values[0, 0]
        strain = [float(r.table["bearing_strain_max"][0]) for r in (night, soaked)]
        force = [float(r.table["bearing_force_max_kN"][0]) for r in (night, soaked)]
        measured(
            f"{bearing} after a night from -5 to -25 degC: outer to inner layer; strain and force "
            "against the soaked bearing",
            f"{layers[0]:.1f} to {layers[-1]:.1f} degC; "
            f"{100 * (strain[0] / strain[1] - 1):+.1f} %, {100 * (force[0] / force[1] - 1):+.1f} %",
            "reported",
        )
        assert -25.0 < layers[0] < layers[-1] < -15.0
        assert strain[0] > strain[1]


@pytest.mark.thorough
def test_colder_is_not_more_pier_displacement_on_every_bridge() -> None:
    """The counterexample of docs/comparison_with_shen.md; on pier P1 it is more on every motion."""
    bridge = tb.bridge("shen-lhdr-bridge", "jra-i-i-1", [23.0, -20.0], structure="five-span-bridge")
    largest = bridge.piers.groupby("ambient_degC")["displacement_max_mm"].max()
    assert largest[23.0] == pytest.approx(12.9, abs=0.05)
    assert largest[-20.0] == pytest.approx(11.4, abs=0.05)
