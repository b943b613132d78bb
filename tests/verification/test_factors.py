"""Temperature factors, bound models, and bearings at another scale."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import needs_opensees, ops
from tests.quick import quick_cases
from tests.unit.inputs import assert_mentions, assert_refused, command
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.design import codes
from thermobearing.design.bounds import bound_models, opensees_text
from thermobearing.design.factors import (
    _chosen_cycles,
    factors_at_speed,
    scale_study,
    scaled_bearing,
    temperature_factors,
)
from thermobearing.design.tables import _factors_table as _factors_of_screen
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.model.element import BearingElement

HDR = tb.load_bearing("shen-hdr-bridge")
TEMPERATURES = [-40.0, -20.0, 0.0, 23.0, 40.0]


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return temperature_factors(
        HDR, reference_temperature=23.0, temperatures=TEMPERATURES, strains=[1.0, 1.75]
    )


def values(table: pd.DataFrame, quantity: str, basis: str, strain: float = 1.75) -> np.ndarray:
    rows = table[
        (table["quantity"] == quantity) & (table["basis"] == basis) & (table["strain"] == strain)
    ]
    return np.asarray(rows.sort_values("ambient_degC")["factor"], dtype=float)


def test_factors_are_one_at_the_reference(table: pd.DataFrame) -> None:
    at = table[table["ambient_degC"] == 23.0]
    assert len(at) == 2 * 3 * 5
    assert_allclose(at["factor"], 1.0, rtol=0.0)
    assert np.isfinite(table["value"]).all()
    assert table["factor_low"].isna().all()


@pytest.mark.parametrize("name", quick_cases(tb.list_bearings(), 0, 3))
def test_monotone_where_physics_says_so(name: str, measured: Recorder) -> None:
    """Colder is stiffer, stronger and takes more energy; self-heating takes the edge off."""
    bearing = tb.load_bearing(name)
    result = temperature_factors(
        bearing, reference_temperature=23.0, temperatures=TEMPERATURES, strains=[1.0]
    )
    blind = bearing.hysteresis.elastic_temperature_coefficient == 0.0
    for quantity in ("K_eq", "Q_d", "energy"):
        first, heated = (values(result, quantity, basis, 1.0) for basis in ("first", "heated"))
        if blind and bearing.lead is not None and quantity == "K_eq":
            assert np.all(np.diff(first) <= 0.0)
            continue
        assert np.all(np.diff(first) < 0.0), quantity
        assert heated[0] < first[0], quantity
    measured(
        f"{name}, 100 %, -20 against 23 degC, first cycle and heated: K_eq, Q_d",
        ", ".join(
            f"{values(result, q, b, 1.0)[1]:.2f}"
            for q in ("K_eq", "Q_d")
            for b in ("first", "heated")
        ),
        "reported",
    )


def test_values_are_those_of_a_run(table: pd.DataFrame) -> None:
    step = {"step": "cycles", "strain": 1.75, "wave": "sine", "period": 2.0, "count": 3}
    result = tb.run(HDR, tb.CyclicTest(dt=0.01, steps=[step]), ambient=-20.0)
    rows = table.query("strain == 1.75 and ambient_degC == -20 and quantity == 'energy'")
    energy = rows.set_index("basis")["value"]
    cycles = result.cycles["energy_kN_mm"].to_numpy()
    assert_allclose(
        [energy["first"], energy["heated"], energy["mean"]], [cycles[0], cycles[2], cycles.mean()]
    )


@pytest.mark.parametrize("options", [{}, {"speed": 30.0}])
def test_the_rise_of_the_lead_is_that_of_the_first_cycle(options: dict[str, Any]) -> None:
    """Of a run of one cycle; a bearing without lead has none."""
    compute = factors_at_speed if options else temperature_factors
    bearing = tb.load_bearing("lrb-example")
    common: dict[str, Any] = {"reference_temperature": 20.0, "temperatures": [-20.0]}
    table = compute([bearing], strains=[1.0], **common, **options)
    period = 4.0 * bearing.total_rubber_thickness / 30.0 if options else 2.0
    step = {"step": "cycles", "strain": 1.0, "wave": "sine", "period": period, "count": 1}
    test = CyclicTest(dt=min(0.01, period / 200.0), steps=[step])
    for row in table.attrs["lead_rises"]:
        lead = tb.run(bearing, test, row["ambient_degC"])["lead_temperature"].values[0]
        assert row["lead_rise_K"] == pytest.approx(lead[-1] - row["ambient_degC"], rel=1e-6)
        assert row["lead_rise_K"] > 5.0
    assert [row["ambient_degC"] for row in table.attrs["lead_rises"]] == [20.0, -20.0]
    rubber = temperature_factors("shen-hdr-bridge", strains=[1.0], **common)
    assert rubber.attrs["lead_rises"] == []


@pytest.mark.parametrize(("reference", "other"), [(-0.0, -0.0), (1e-9, -0.0), (-0.0, 20.0)])
def test_zero_has_no_sign(reference: float, other: float) -> None:
    """-0.0 degC made a KeyError: its run is called that at 0 degC."""
    table = temperature_factors(
        HDR, reference_temperature=reference, temperatures=[other], strains=[1.0]
    )
    at = table[table["ambient_degC"] == reference]
    assert_allclose(at["factor"], 1.0, rtol=1e-12)


def test_a_posterior_makes_bands() -> None:
    samples = [HDR]
    for factor in (0.9, 0.95, 1.05, 1.1):
        h = HDR.hysteresis
        changed = h.model_copy(
            update={"elastic_temperature_coefficient": factor * h.elastic_temperature_coefficient}
        )
        samples.append(HDR.model_copy(update={"hysteresis": changed}))
    result = temperature_factors(
        samples, reference_temperature=23.0, temperatures=[-20.0], strains=[1.0]
    )
    cold = result.query("ambient_degC == -20 and quantity == 'K_eq'")
    assert np.all(cold["factor_low"] < cold["factor"])
    assert np.all(cold["factor"] < cold["factor_high"])
    at = result.query("ambient_degC == 23")
    assert_allclose(at["factor_low"], 1.0)


@needs_opensees
def test_opensees_text_gives_the_same_loop(table: pd.DataFrame) -> None:
    """Both languages, executed; the loop of the material against our bilinear bearing."""
    models = bound_models(table, 1.75, HDR.total_rubber_thickness)
    python, tcl = (opensees_text(models, "x", language) for language in ("python", "tcl"))
    numbers = [line.split()[2:] for line in tcl.splitlines() if line.startswith("uniaxial")]
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    exec(compile(python, "bounds.py", "exec"), {})
    path = 178.0 * np.sin(np.linspace(0.0, 4.0 * np.pi, 400))
    for tag, row in enumerate(models.to_dict("records"), 1):
        p = BilinearParameters(row["Q_d_kN"], row["K_2_kN_mm"], row["K_1_kN_mm"])
        expected = [tag, row["Q_y_kN"], p.initial, p.post_yield / p.initial]
        assert_allclose([float(v) for v in numbers[tag - 1]], expected)
        element = BearingElement.from_constants(bilinear_constants(p), 0.0)
        ops.testUniaxialMaterial(tag)
        for x in path:
            ops.setStrain(float(x))
            force = element.set_trial(float(x), 0.01, 0.0).force
            element.commit()
            assert abs(force - ops.getStress()) < tol.STEEL01 * row["Q_y_kN"]
    ops.wipe()


@pytest.mark.parametrize("name", tb.list_bearings())
def test_scaled_bearing_is_exact_without_heat_flow(name: str) -> None:
    """Adiabatic and alike in strain and time: temperatures, strains and stresses are the same."""
    bearing = tb.load_bearing(name)
    step = {"step": "cycles", "strain": 1.0, "wave": "sine", "period": 2.0, "count": 2}
    test = tb.CyclicTest(dt=0.01, steps=[step])
    factor = 0.4
    full, small = (
        tb.run(item, test, ambient=-10.0, model="adiabatic")
        for item in (bearing, scaled_bearing(bearing, factor))
    )
    for quantity in ("stress", "strain", "rubber_temperature", "lead_temperature"):
        if quantity in full.dataset:
            assert_allclose(
                small[quantity].values, full[quantity].values, rtol=tol.SCALED, atol=tol.SCALED
            )
    assert_allclose(small["force"].values, factor**2 * full["force"].values, atol=tol.SCALED * 1e3)


def test_specimen_temperatures_do_not_carry_over(measured: Recorder) -> None:
    """Section 7.2: heat leaves with the square of the size."""
    for name in ("shen-hdr-bridge", "shen-lhdr-bridge"):
        table, _ = scale_study(tb.load_bearing(name))
        small, full = table.to_dict("records")
        assert small["inner_at_end_K"] < full["inner_at_end_K"]
        assert small["inner_after_10_min_K"] < 0.4 * full["inner_after_10_min_K"]
        assert small["stress_cycle_5_over_1"] > full["stress_cycle_5_over_1"]
        measured(
            f"{name}, scale 1/6 and 1: inner rise at the end and 10 min later, stress 5/1",
            "; ".join(
                f"{row['inner_at_end_K']:.1f}, {row['inner_after_10_min_K']:.1f} K, "
                f"{row['stress_cycle_5_over_1']:.2f}"
                for row in (small, full)
            ),
            "reported (7.2)",
        )


@pytest.mark.parametrize("name", ["shen-hdr-bridge", "shen-lhdr-bridge", "lrb-example"])
def test_compared_with_published_factors(name: str, measured: Recorder) -> None:
    """Colder is stiffer, heated less so; docs/verification.md says why codes differ."""
    air = [-30.0, -10.0, 0.0, 40.0]
    table = temperature_factors(
        name, reference_temperature=20.0, temperatures=air, strains=[1.0], cycles="3"
    )
    for quantity in ("K_eq", "Q_d", "K_d"):
        result = []
        for basis in ("first", "heated"):
            rows = table[(table["quantity"] == quantity) & (table["basis"] == basis)]
            by = rows.set_index("ambient_degC")["factor"]
            assert by[20.0] == 1.0
            assert (np.diff(by.to_numpy()) < 0.0).all()
            result.append(by[air].to_numpy())
        assert (result[1][:1] <= result[0][:1] * tol.HEATED_FACTOR).all()
        reported = "; ".join(", ".join(f"{v:.2f}" for v in values) for values in result)
        measured(
            f"{name}, {quantity} at -30, -10, 0, 40 over 20 degC, first; third",
            reported,
            "reported",
        )


def test_published_factors_compared_with_ours(measured: Recorder) -> None:
    for item in codes.published().tables:
        at = dict(zip(item.temperatures, item.factors, strict=True))
        if "formula" not in item.name:
            assert at.get(20.0, 1.0) == 1.0
        assert list(item.factors) == sorted(item.factors, reverse=True)
        reported = ", ".join(f"{at[t]:.2f}" if t in at else "-" for t in (-30.0, -10.0, 0.0, 40.0))
        name = f"published {item.name}: {item.quantity}, the same temperatures"
        measured(name + "*" * item.unverified, reported, "reported")


def test_published_tables_say_what_is_unverified() -> None:
    published = codes.published()
    assert [one.name for one in published.codes] == ["AASHTO", "EN", "JRA", "CSA S6"]
    for item in published.tables:
        assert len(item.temperatures) == len(item.factors)
        assert ("not checked" in item.source) == item.unverified == bool(item.code)
    lead = [item for item in published.tables if "MVBR" in item.name]
    for item, (rise, at_zero) in zip(lead, [(-0.004278, 1.086), (-0.002944, 1.059)], strict=True):
        assert_allclose(item.factors, at_zero + rise * np.array(item.temperatures), atol=1e-9)


def test_codes_on_another_reference_temperature() -> None:
    item = next(one for one in codes.tables_for("HDR") if one.code and one.quantity == "Q_d")
    result = item.relative_to(0.0, np.array([-40.0, -30.0, -20.0, 0.0, 40.0]))
    assert_allclose(result, [np.nan, 2.5 / 1.3, 1.95 / 1.3, 1.0, 1.0 / 1.3])


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_factors_of_a_bilinear_loop(share: float) -> None:
    """K_eq and h_eq of loops with scaled Q_d and K_d, by the formulas of AASHTO."""
    displacement, strength, stiffness = 200.0, share * 400.0, (1.0 - share) * 2.0
    yielding = 0.0  # the formulas have the same (D - D_y) in both

    def properties(q: float, k: float) -> tuple[float, float]:
        equivalent = q * strength / displacement + k * stiffness
        energy = 4.0 * q * strength * (displacement - yielding)
        return equivalent, energy / (2.0 * np.pi * equivalent * displacement**2)

    result = codes.bilinear_factors(np.array(1.95), np.array(1.7), share)
    before, after = properties(1.0, 1.0), properties(1.95, 1.7)
    assert_allclose(result["K_eq"], after[0] / before[0], rtol=1e-14)
    if share:
        assert_allclose(result["h_eq"], after[1] / before[1], rtol=1e-14)


def _factors_table(first: dict[str, float], half_band: float = np.nan) -> pd.DataFrame:
    """Return a table of factors at -20 over 20 degC, with Q_d 100 kN and K_d 1 kN/mm."""
    values = {"K_eq": 2.0, "Q_d": 100.0, "K_d": 1.0, "h_eq": 0.2}
    rows = []
    for quantity, value in values.items():
        for ambient, factor in ((20.0, 1.0), (-20.0, first[quantity]), (-45.0, 9.0)):
            row = {"strain": 1.0, "ambient_degC": ambient, "quantity": quantity}
            row |= {"value": value * factor, "factor": factor}
            row |= {"factor_low": factor - half_band, "factor_high": factor + half_band}
            rows += [row | {"basis": basis} for basis in ("first", "heated")]
    return pd.DataFrame(rows)


def test_a_bearing_beside_the_codes() -> None:
    """At the coldest temperature of the codes; above, within and below, with intervals."""
    first = {"K_eq": 2.0, "Q_d": 1.8, "K_d": 1.87, "h_eq": 0.9}
    table = _factors_table(first, 0.2)
    share = codes.strength_share(table, 1.0, 20.0, 100.0)
    assert share == 0.5
    rows = codes.compare_with_codes(table, 1.0, "HDR", 20.0, share)
    assert {row["ambient_degC"] for row in rows} == {-20.0}
    by = {row["quantity"]: row for row in rows}
    assert by["Q_d"]["codes"]["AASHTO"] == pytest.approx({"HDRB-1": 1.95, "HDRB-2": 1.7})
    assert by["K_eq"]["codes"]["AASHTO"] == pytest.approx({"HDRB-1": 1.825, "HDRB-2": 1.5})
    assert by["Q_d"]["difference"] == "within"
    assert by["K_d"]["difference"] == "10 % above, interval overlaps"
    assert by["h_eq"]["difference"] == "16 % below, interval overlaps"
    assert len(codes.reasons(tb.load_bearing("shen-hdr-bridge"), rows, share)) == 4
    cold = codes.compare_with_codes(table[table["ambient_degC"] != -20.0], 1.0, "HDR", 20.0, share)
    assert {row["difference"] for row in cold} == {"none stated"}
    assert codes.compare_with_codes(table, 1.0, "LRB", 20.0, share)[1]["codes"] == {
        "AASHTO": {"LDRB": pytest.approx(1.45)}
    }


BAD_WORDS: list[tuple[list[Any], list[str]]] = [
    (["shen-hdr-bridg"], ['"shen-hdr-bridge"?']),
    (["shen-hdr-bridge", "--reference", 90], ["--reference-temperature = 90", "-60 to 60"]),
    (["shen-hdr-bridge", "--reference-temperature", 90], ["--reference-temperature = 90"]),
    (["shen-hdr-bridge", "--temperature", -90], ["--temperature = -90", "-60 to 60"]),
    (["shen-hdr-bridge", "--strain", 0.0], ["--strain = 0.0", "0.1 to 3"]),
    (["shen-hdr-bridge", "--strain", 30], ["--strain = 30.0", "0.1 to 3"]),
    (["shen-hdr-bridge", "--period", 0.01], ["period = 0.01", "0.2 to 1000"]),
    (["shen-hdr-bridge", "--period", 0], ["period = 0.0", "0.2 to 1000"]),
    (["shen-hdr-bridge", "--speed", -3], ["speed = -3"]),
    (["shen-hdr-bridge", "--speed", 0], ["speed = 0", "greater than 0"]),
    (["shen-hdr-bridge", "--speed", 3, "--period", 2], ["--period or --speed"]),
    (["shen-hdr-bridge", "--cycles", "third"], ['cycles = "third"', "all-but-first"]),
    (["shen-hdr-bridge", "--cycles", "0,1"], ["cycles = [0, 1]", "1 to 100"]),
    (["shen-hdr-bridge", "--cycles", "1-4"], ['cycles = "1-4"', '"1-3"?']),
    (["shen-hdr-bridge", "shen-lhdr-bridge"], ["(HDR)", "(LHDR)", "separate runs"]),
]


@pytest.mark.parametrize(("words", "pieces"), BAD_WORDS)
def test_bad_words(tmp_path: Path, words: list[Any], pieces: list[str]) -> None:
    done = command("lambda", *words, "-o", tmp_path / "no")
    assert done.exit_code == 2, done.output
    assert_mentions(done.output, pieces)
    assert not (tmp_path / "no").exists()


@pytest.mark.parametrize(
    ("call", "pieces"),
    [
        (lambda: temperature_factors([], reference_temperature=23.0), ["one or more"]),
        (lambda: temperature_factors(HDR, reference_temperature="23"), ["reference_temperature"]),  # type: ignore[arg-type]
        (lambda: temperature_factors(HDR, reference_temperature=True), ["reference_temperature"]),
        (lambda: temperature_factors(HDR, reference_temperature=float("nan")), ["reference"]),
        (
            lambda: temperature_factors(HDR, reference_temperature=23.0, strains=[]),
            ["strains: give at least one"],
        ),
        (lambda: _chosen_cycles([]), ["cycles = []"]),
        (lambda: _chosen_cycles([1.5]), ["integers"]),  # type: ignore[list-item]
        (lambda: scaled_bearing(HDR, 0.0), ["factor = 0.0"]),
        (lambda: scaled_bearing(HDR, float("nan")), ["factor"]),
        (lambda: scaled_bearing(HDR, "half"), ["factor = 'half'"]),  # type: ignore[arg-type]
    ],
)
def test_bad_arguments(call: Any, pieces: list[str]) -> None:
    assert_refused(call, *pieces)


def test_makers_beside_a_bearing_with_lead() -> None:
    """The maker's line of K_eq of lead rubber, 1.086 - 0.004278 t, at -20 over 20 degC."""
    table = _factors_table({"K_eq": 1.19, "Q_d": 1.3, "K_d": 1.1, "h_eq": 1.05})
    by_kind = {
        kind: codes.compare_with_makers(table, 1.0, kind, 20.0) for kind in ("HDR", "LHDR", "LRB")
    }
    of_lead = {row["quantity"]: row for row in by_kind["LRB"]}
    assert set(of_lead) == {"K_eq", "h_eq"}
    assert of_lead["K_eq"]["factor"] == pytest.approx(1.17156 / 1.00044, rel=1e-12)
    assert of_lead["K_eq"]["first"] == 1.19
    assert not any("LRB" in row["kinds"] for row in by_kind["HDR"])
    assert by_kind["LHDR"][: len(by_kind["HDR"])] == by_kind["HDR"]  # its own kind first
    assert by_kind["LHDR"][len(by_kind["HDR"]) :] == by_kind["LRB"]


@pytest.mark.parametrize(("reference", "noted"), [(15.0, True), (20.0, False), (23.0, False)])
def test_an_unusual_reference_is_noted(reference: float, noted: bool) -> None:
    row = {"strain": 1.0, "basis": "first", "quantity": "K_eq", "unit": "kN/mm"}
    row |= {"ambient_degC": reference, "value": 2.0, "factor": 1.0}
    summary = {"factors": [row], "reference_degC": reference, "bearing": "pier"}
    note = _factors_of_screen(summary | {"motion": "sine", "cycles": "1-3"}).note
    assert ("--reference" in note) == noted
