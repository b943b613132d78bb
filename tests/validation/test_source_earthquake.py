"""What the source reports of the hybrid test and of the bridge, and the trends on real records."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.conftest import Recorder
from tests.shared_data import shared_data

TYPE_II = {"II-I-1": "II-I-1_like_JMA_NS.csv", "II-I-2": "II-I-2_like_JMA_EW.csv"}
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
    ("jra-ii-i-2", "shen-hdr-bridge"): CAPPED,
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
    """Values from warm to cold."""
    rows = table[table["bearing"] == bearing].sort_values("ambient_degC", ascending=False)
    return np.asarray(rows[column], dtype=float)


def told(values: np.ndarray, form: str = "{:.2f}") -> str:
    return ", ".join(form.format(value) for value in values)


def check_trends(table: pd.DataFrame, bearing: str) -> list[str]:
    """The source's trends, warm to cold; returns those that do not hold."""
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


@pytest.mark.parametrize("damping", ["modal", "source"])
@pytest.mark.parametrize("motion", ["jra-i-i-1", "jra-i-i-2", "jra-ii-i-1", "jra-ii-i-2"])
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
            told(by_temperature(table, bearing, "bearing_strain_max"))
            + "; "
            + told(by_temperature(table, bearing, "pier_ductility"))
            + "; "
            + told(share),
            "colder: less strain, more force and pier displacement, less energy"
            + (f"; not: {', '.join(wrong)}" if wrong else ""),
        )
        assert not set(wrong) - ALLOWED[damping].get((motion, bearing), set())
        assert np.all(np.diff(share) > 0.0)


@pytest.mark.parametrize(("record", "damping"), STUDIED)
def test_trends_on_real_records(record: str, damping: Any, measured: Recorder) -> None:
    table = tb.bridge(BEARINGS, shared_motion(REAL[record]), AMBIENT, damping=damping).table
    for bearing in BEARINGS:
        wrong = check_trends(table, bearing)
        measured(
            f"pier P1, {bearing}, {record}, damping {damping}, 23, 0, -20 degC: strain, energy of "
            "23 degC",
            told(by_temperature(table, bearing, "bearing_strain_max"))
            + "; "
            + told(by_temperature(table, bearing, "energy_of_warmest")),
            "as above" + (f"; not: {', '.join(wrong)}" if wrong else ""),
        )
        assert not set(wrong) - ALLOWED[damping].get((record, bearing), set())


@pytest.mark.parametrize("damping", ["modal", "source"])
@pytest.mark.parametrize("mass", ["consistent", "published"])
def test_energy_and_ductility_beside_the_source(
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
        told(drop, "{:+.1f} %"),
        "-9.3 %, -56.1 % (6.3.2)",
    )
    measured(
        f"LHDR, stand-in for II-I-1, {mass} mass, damping {damping}: ductility at 23, 0, -20 degC",
        told(ductility),
        "about 1, up to 3 (6.3.3)",
    )
    assert drop[1] < drop[0] < 0.0
    assert np.all(np.diff(ductility) > 0.0)


def test_what_explains_the_ductility(measured: Recorder) -> None:
    """The printed ductilities (about 1, up to 3) come out with a foundation that hardly rocks, or
    nearly without the damping that the ground springs give to the first mode; with the printed
    numbers the rocking takes most of the displacement, and its 10 % most of the peaks, be it as
    Rayleigh's 6 % of the first mode or where the ground springs are."""
    structure = tb.structure.load_structure("pier-p1")
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
    found = {}
    for name, (variant, damping) in variants.items():
        table = tb.bridge(
            "shen-lhdr-bridge", motion, AMBIENT, structure=variant, damping=damping
        ).table
        found[name] = by_temperature(table, "shen-lhdr-bridge", "pier_ductility")
        energy = by_temperature(table, "shen-lhdr-bridge", "energy_of_warmest")
        measured(
            f"LHDR, stand-in for II-I-1, {name}: ductility; energy of 23 degC",
            f"{told(found[name])}; {told(energy)}",
            "about 1, up to 3; 0.91, 0.44 (6.3.2, 6.3.3)",
        )
    assert found["rocking spring ten times as stiff, damping source"][-1] > 2.5
    assert found["rocking spring ten times as stiff, damping modal"][-1] > 2.5
    assert found["no damping but hysteresis"][-1] > 2.0
    assert found["as printed, damping source"][-1] < 1.0
    assert found["as printed, damping modal"][-1] < 1.1


def test_a_night_before_the_earthquake(tmp_path: Path, measured: Recorder) -> None:
    """From -5 to -25 degC in twelve hours: the full-size bearing lags, and is softer for it."""
    hours = np.linspace(0.0, 12.0, 49)
    rows = [f"{3600.0 * h:.0f},{-5.0 - 20.0 * h / 12.0:.4f}" for h in hours]
    path = tmp_path / "night.csv"
    path.write_text("time_s,temperature_degC\n" + "\n".join(rows) + "\n")
    for bearing in BEARINGS:
        night = tb.bridge(bearing, "jra-ii-i-1", weather=str(path))
        soaked = tb.bridge(bearing, "jra-ii-i-1", -25.0)
        layers = night["rubber_temperature"].values[0, 0]
        strain = [float(r.table["bearing_strain_max"][0]) for r in (night, soaked)]
        force = [float(r.table["bearing_force_max_kN"][0]) for r in (night, soaked)]
        measured(
            f"{bearing} after a night from -5 to -25 degC: outer to inner layer; strain and force "
            "against the soaked bearing",
            f"{layers[0]:.1f} to {layers[-1]:.1f} degC; "
            f"{100 * (strain[0] / strain[1] - 1):+.1f} %, {100 * (force[0] / force[1] - 1):+.1f} %",
            "told",
        )
        assert -25.0 < layers[0] < layers[-1] < -15.0
        assert strain[0] > strain[1]
