"""Exposure factors multiply what they say, once, in every analysis, and are reported."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.bearing.exposure import Exposure, exposed, exposed_bilinear
from thermobearing.bearing.model import Bearing
from thermobearing.border.toml import to_toml
from thermobearing.cli import app
from thermobearing.commands.options import exposure_table
from thermobearing.core.types import Rubber
from thermobearing.cyclic.case import load_case
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.model.earlier import isothermal
from thermobearing.model.options import ModelOptions, build_model

FACTORS: dict[str, Any] = {"stiffness": 1.3, "strength": 1.7, "source": "an example"}
LAYERED = ("shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example")
TEST = tb.cyclic_test(strain=[1.0], cycles=1, rest=None, dt=0.02)


def with_table(name: str, **factors: Any) -> Bearing:
    table = Exposure(**{**FACTORS, **factors})
    return tb.load_bearing(name).model_copy(update={"exposure": table})


@pytest.mark.parametrize("name", LAYERED)
@pytest.mark.parametrize("way", ["table", "option"])
def test_factors_on_the_constants_of_the_step(name: str, way: str) -> None:
    plain = build_model(tb.load_bearing(name)).constants
    bearing = with_table(name) if way == "table" else tb.load_bearing(name)
    options = ModelOptions(exposure=Exposure(**FACTORS) if way == "option" else None)
    result = build_model(bearing, options).constants
    wanted = {"elastic_stiffness": 1.3, "hysteretic_stiffness": 1.7}
    for key in Rubber.__annotations__:
        was, now = (getattr(item.rubber, key) for item in (plain, result))
        assert now == pytest.approx(wanted.get(key, 1.0) * was, rel=tol.ROUNDING), key
    lead = {"strength": 1.7, "stiffness": 1.7} if plain.lead.cores else {}
    for key in type(plain.lead)._fields:
        was, now = (getattr(item.lead, key) for item in (plain, result))
        assert now == pytest.approx(lead.get(key, 1.0) * was, rel=tol.ROUNDING), key
    assert result.viscous == plain.viscous
    for part, other in zip(plain.cells, result.cells, strict=True):
        assert np.array_equal(part, other)


def force(name: str, stiffness: float, strength: float) -> np.ndarray:
    """Of displacements there and back, everything at one temperature, without rate dependence."""
    bearing = tb.load_bearing(name)
    lead = bearing.lead and bearing.lead.model_copy(
        update={"softening": 0.0, "softening_beyond_tests": 0.0}
    )
    bearing = bearing.model_copy(update={"rate": None, "lead": lead})
    options = ModelOptions(exposure=Exposure(stiffness=stiffness, strength=strength, source="x"))
    element = tb.BearingElement.from_constants(
        isothermal(build_model(bearing, options).constants), 5.0
    )
    forces = []
    path = [*np.linspace(0.0, 1.5, 40), *np.linspace(1.5, -1.2, 80), *np.linspace(-1.2, 0.3, 50)]
    for strain in path[1:]:
        moved = element.set_trial(strain * bearing.total_rubber_thickness, 0.05)
        element.commit()
        forces.append(moved.force)
    return np.array(forces)


@pytest.mark.parametrize("name", LAYERED)
def test_force_is_stiffness_times_elastic_and_strength_times_hysteretic_part(name: str) -> None:
    as_tested = force(name, 1.0, 1.0)
    elastic = force(name, 2.0, 1.0) - as_tested
    hysteretic = force(name, 1.0, 2.0) - as_tested
    peak = np.abs(as_tested).max()
    assert np.abs(elastic).max() > 0.1 * peak
    assert np.abs(hysteretic).max() > 0.1 * peak
    assert np.allclose(elastic + hysteretic, as_tested, rtol=0, atol=tol.FORCES_ADD_UP * peak)
    both = force(name, 1.3, 1.7)
    wanted = 1.3 * elastic + 1.7 * hysteretic
    assert np.allclose(both, wanted, rtol=0, atol=tol.FORCES_ADD_UP * peak)


@pytest.mark.parametrize("name", LAYERED)
def test_a_cyclic_test_has_them_once_and_says_so(name: str) -> None:
    by_hand = tb.run(exposed(with_table(name)), TEST, -10)
    assert "exposure" not in by_hand.summary()
    for result in (
        tb.run(tb.load_bearing(name), TEST, -10, exposure=FACTORS),
        tb.run(with_table(name), TEST, -10),
    ):
        assert np.array_equal(result["force"].values, by_hand["force"].values)
        assert result.summary()["exposure"] == {name: FACTORS}
        output = f"{name}: exposure: stiffness times 1.3 and strength times 1.7 (an example)"
        assert result.summary()["warnings"][0] == output
    plain = tb.run(name, TEST, -10)
    assert not np.allclose(plain["force"].values, by_hand["force"].values)


def test_factors_of_one_change_nothing_and_are_not_reported() -> None:
    plain = tb.run(LAYERED[0], TEST)
    same = tb.run(LAYERED[0], TEST, exposure={"stiffness": 1.0})
    assert np.array_equal(plain["force"].values, same["force"].values)
    assert "exposure" not in same.summary()
    assert same.warnings == plain.warnings


def test_a_bridge_has_them_once_and_says_so() -> None:
    """Layered and bilinear bearings side by side: by option, by table, by hand."""
    layered, bilinear = tb.load_bearing("shen-hdr-bridge"), load_bilinear("shen-bilinear-bridge")
    ways = []
    for bearings, option in (
        ([layered, bilinear], FACTORS),
        (
            [
                item.model_copy(update={"exposure": Exposure(**FACTORS)})
                for item in (layered, bilinear)
            ],
            None,
        ),
        (
            [
                exposed(layered, Exposure(**FACTORS)),
                exposed_bilinear(bilinear, Exposure(**FACTORS)),
            ],
            None,
        ),
    ):
        study = tb.bridge(bearings, "jra-ii-i-1", -10, duration=3.0, exposure=option)
        ways.append(study.dataset["bearing_force"].values)
        reported = study.summary().get("exposure", {})
        assert set(reported) == (set() if len(ways) == 3 else {layered.name, bilinear.name})
        assert sum("exposure" in text for text in study.warnings) == len(reported)
    for other in ways[1:]:
        assert np.array_equal(ways[0], other, equal_nan=True)


def test_a_bilinear_bearing_keeps_its_yield_displacement() -> None:
    was = load_bilinear("shen-bilinear-bridge")
    now = exposed_bilinear(was, Exposure(**FACTORS))
    assert now.strength == 1.7 * was.strength
    assert now.post_yield_stiffness == 1.3 * was.post_yield_stiffness
    yields = [b.strength / (b.initial_stiffness - b.post_yield_stiffness) for b in (was, now)]
    assert yields[0] == pytest.approx(yields[1], rel=tol.ROUNDING)


def test_earlier_models_and_the_equivalent_bilinear_model_have_them_once() -> None:
    by_hand = exposed(with_table(LAYERED[0]))
    assert bilinear_parameters(with_table(LAYERED[0])) == bilinear_parameters(by_hand)
    for model in ("bilinear", "adiabatic"):
        forces = [
            tb.run(bearing, TEST, model=model, exposure=option)["force"].values
            for bearing, option in ((by_hand, None), (tb.load_bearing(LAYERED[0]), FACTORS))
        ]
        assert np.array_equal(*forces)


def test_a_fit_refuses_them_and_the_forward_model_has_them_once() -> None:
    record = tb.synthetic_record(tb.load_bearing(LAYERED[0]), 23.0, TEST)
    with pytest.raises(tb.InputError, match="table exposure"):
        tb.identify_bearing(record, with_table(LAYERED[0]), free=["K_r"])
    bearing = with_table(LAYERED[0])
    model = ForwardModel(record, bearing)
    one, other = model.run(bearing), model.run()
    assert one
    assert other
    assert np.array_equal(one.force, other.force)


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ({"source": ""}, ["give the source"]),
        ({"stiffness": 0.0}, ["stiffness = 0.0", "at least 0.1 and at most 20"]),
        ({"strength": "1.2"}, ["strength", "must be a number"]),
        ({"stifness": 1.2}, ['"stifness"', 'did you mean "stiffness"']),
    ],
)
def test_bad_factors(factors: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        Exposure(**{**FACTORS, **factors})
    for word in words:
        assert word in str(caught.value)


def test_table_and_option_together_are_refused() -> None:
    for call in (
        lambda: tb.run(with_table(LAYERED[0]), TEST, exposure=FACTORS),
        lambda: tb.BearingElement(with_table(LAYERED[0]), exposure=FACTORS),
        lambda: tb.bridge(with_table("shen-hdr-bridge"), exposure=FACTORS),
        lambda: build_model(with_table(LAYERED[0]), ModelOptions(exposure=Exposure(**FACTORS))),
    ):
        with pytest.raises(tb.InputError, match=r"exposure.*not both"):
            call()
    bilinear = load_bilinear("shen-bilinear-bridge")
    table = bilinear.model_copy(update={"exposure": Exposure(**FACTORS)})
    with pytest.raises(tb.InputError, match=r"exposure.*not both"):
        tb.bridge(table, "jra-ii-i-1", 23, duration=2.0, exposure=FACTORS)


def test_files_and_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "cold.toml"
    file.write_text(to_toml(with_table(LAYERED[0])), encoding="utf-8")
    assert tb.load_bearing(file).exposure == Exposure(**FACTORS)
    case = tmp_path / "case.toml"
    case.write_text(
        'ambient = "0 degC"\n[test]\nsteps = [{step = "cycles", strain = 0.5, wave = "sine", '
        'period = "2 s", count = 1}]\n',
        encoding="utf-8",
    )
    words = [f"--exposure={key}={value}" for key, value in FACTORS.items()]
    out = tmp_path / "out"
    done = CliRunner().invoke(
        app, ["cyclic", str(case), *words, "-o", str(out), "--no-figures"], env={"COLUMNS": "200"}
    )
    assert done.exit_code == 0, done.output
    assert "exposure: stiffness times 1.3 and strength times 1.7" in done.output
    assert json.loads((out / "summary.json").read_text())["exposure"][LAYERED[0]] == FACTORS
    assert load_case(out / "case.resolved.toml").analysis.exposure == Exposure(**FACTORS)
    for bad in ("stiffness", "stiffness=much", "stiffness=1.2", "stifness=1"):
        failed = CliRunner().invoke(app, ["cyclic", str(case), "--exposure", bad])
        assert failed.exit_code == 2, bad
        assert "exposure" in failed.output or "stifness" in failed.output
    for words in (["source"], ["stiffness=1.2", "strength=1", "stiffness=1.3", "source=x"]):
        with pytest.raises(tb.InputError, match="--exposure"):
            exposure_table(words)
