"""Sizing, loop, bounds and factors by hand: the analyses inside are replaced by known numbers."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.cyclic.equivalent import backbone
from thermobearing.design import bounds, run, sizing
from thermobearing.design import sizing as equal
from thermobearing.design.bounds import bound_models, opensees_text
from thermobearing.design.case import make_design_case
from thermobearing.design.result import Design
from thermobearing.model.earlier import BilinearParameters

LHDR = tb.load_bearing("shen-lhdr-bridge")
G8 = sizing.load_rubber("G8")


def make_case(**table: Any) -> Any:
    return make_design_case(table, "test", motions=["jra-i-i-1", "jra-ii-i-1"])


@pytest.fixture
def analysed(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Cases of the dynamic analyses of a loop; each finds 250 mm in the second motion."""
    asked: list[Any] = []
    result = {
        "bearing_displacement_max": np.array([90.0, 250.0]),
        "pier_ductility": np.array([2.5, 1.2]),
    }

    class Study(dict[str, Any]):
        outcome = "completed"

        @property
        def dataset(self) -> dict[str, Any]:
            return self

    def analyse(case: Any) -> Study:
        asked.append(case)
        return Study(result)

    monkeypatch.setattr(run, "run_earthquake", analyse)
    return asked


@pytest.mark.parametrize(
    ("assumed", "rules", "factor", "effective"),
    [
        (178.0, {}, 1.0, 178.0),
        (178.0, {}, 0.7, 124.6),
        (2.0, {}, 1.0, 0.2 * 14.0),  # below the smallest strain of the curves
        (300.0, {"design_strain": 2.5, "layer_thickness": "60 mm"}, 1.0, 300.0),
    ],
)
def test_one_turn_of_the_loop(
    assumed: float, rules: dict[str, Any], factor: float, effective: float, analysed: list[Any]
) -> None:
    """Stiffness, damping and the bilinear model are those of the effective displacement."""
    turn = run._one_turn(
        make_case(effective_displacement_factor=factor, sizing=rules), 3, [assumed]
    )
    (result,), size = turn.rounds, turn.rounds[0].size
    thickness = size.total_rubber_thickness
    wanted = sizing.equivalent_stiffness(G8, size.area, thickness, effective)
    assert result.stiffness == pytest.approx(wanted, rel=tol.LOOP)
    assert result.damping == pytest.approx(
        sizing.damping_ratio(G8, effective / thickness), rel=tol.LOOP
    )
    peak = result.strength + result.post_yield * effective
    assert peak == pytest.approx(wanted * effective, rel=tol.LOOP)
    assert result.post_yield / result.initial == pytest.approx(0.19, rel=tol.LOOP)
    assert (result.number, result.assumed, result.found) == (3, assumed, 250.0)
    assert result.ductility == 2.5
    assert result.difference == pytest.approx(250.0 / assumed - 1.0)
    # Eigenvalues and damping of the structure follow the stiffness of the bearing.
    assert analysed[0].structure.bearings[0].equivalent_stiffness == result.stiffness
    assert analysed[0].bearings[0].strength == result.strength
    assert analysed[0].bearings[0].initial_stiffness == result.initial
    assert turn.checks[0].value == pytest.approx(250.0 / thickness)


def test_strain_beyond_the_curves_is_held_at_their_end(
    analysed: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sizes keep the design strain, so only other curves can be left at their upper end."""
    curves = sizing.load_curves().model_copy(update={"largest_strain": 1.0})
    monkeypatch.setattr(sizing, "load_curves", lambda: curves)
    result = run._one_turn(make_case(), 1, [178.0]).rounds[0]
    wanted = sizing.equivalent_stiffness(G8, result.size.area, 112.0, 112.0)
    assert result.stiffness == pytest.approx(wanted, rel=tol.LOOP)


def turns(monkeypatch: pytest.MonkeyPatch, answer: Any) -> None:
    """Turns of the loop that find `answer(assumed)`."""

    def turn(case: Any, number: int, assumed: list[float]) -> Any:
        (u,), size = assumed, sizing.Size(600.0, 8, 14.0)
        one = sizing.Round(number, u, size, 2.6, 0.15, 125.0, 1.8, 9.5, answer(u), 1.0)
        study = SimpleNamespace(outcome="completed")
        return SimpleNamespace(rounds=[one], checks=[], bearings=[], study=study)

    monkeypatch.setattr(run, "_one_turn", turn)


def test_loop_takes_what_it_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """No swinging: each round assumes what the one before found, until 1 %."""
    turns(monkeypatch, lambda assumed: 100.0 + 0.5 * assumed)
    design = run.run_design(make_case(start="360 mm"))
    assumed = [turn.assumed for turn in design.rounds]
    assert_allclose(assumed, [360.0, 280.0, 240.0, 220.0, 210.0, 205.0, 202.5], rtol=tol.LOOP)
    assert design.outcome == "converged"
    assert design.first_within == 3  # 220 for 240 mm
    assert "within 1% of the assumed 202 mm after 7 rounds" in design.sentence


def test_loop_that_swings_goes_half_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between two sizes: 300 mm are found below 250, 200 mm above; then 240 and 248."""
    turns(monkeypatch, lambda assumed: 300.0 if assumed < 250.0 else 200.0)
    design = run.run_design(make_case(start="200 mm", most_rounds=5))
    assumed = [turn.assumed for turn in design.rounds]
    # gains 1, 1/2, 1/2 (the same side again), 1/4
    assert_allclose(assumed[:4], [200.0, 300.0, 250.0, 225.0], rtol=tol.LOOP)
    assert assumed[4] == pytest.approx(225.0 + 0.25 * 75.0)
    assert design.outcome == "not_converged"
    assert len(design.rounds) == 5


def sized(number: int, assumed: float, found: float, layers: int) -> sizing.Round:
    size = sizing.Size(600.0, layers, 14.0)
    return sizing.Round(number, assumed, size, 2.6, 0.15, 125.0, 1.8, 9.5, found, 1.0)


def test_two_sizes_that_alternate_end_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    """Below 250 mm 8 layers move 300, above 9 layers move 200: before, 40 rounds of that."""
    checks: list[str] = []

    def turn(case: Any, number: int, assumed: list[float]) -> Any:
        low = assumed[0] < 250.0
        one = sized(number, assumed[0], 300.0 if low else 200.0, 8 if low else 9)
        checks.append("low" if low else "high")
        study = SimpleNamespace(outcome="completed")
        return SimpleNamespace(rounds=[one], checks=[checks[-1]], bearings=[], study=study)

    monkeypatch.setattr(run, "_one_turn", turn)
    design = run.run_design(make_case(start="200 mm"))
    assert design.outcome == "two_sizes"
    assert design.usable
    assert len(design.rounds) < 15
    assert design.last.size.layers == 9  # sized for more than it moves
    assert design.last.difference < 0.0
    assert design.checks == ["high"]  # type: ignore[comparison-overlap]


def coupled(monkeypatch: pytest.MonkeyPatch, answer: Any) -> Any:
    """A design of two groups, "a" and "b", whose turns find `answer(u_a, u_b)`."""

    def turn(case: Any, number: int, assumed: list[float]) -> Any:
        rounds = [
            replace(sized(number, u, result, layers), group=group)
            for group, u, (result, layers) in zip("ab", assumed, answer(*assumed), strict=True)
        ]
        study = SimpleNamespace(outcome="completed")
        return SimpleNamespace(rounds=rounds, checks=[], bearings=[], study=study)

    monkeypatch.setattr(run, "_one_turn", turn)
    line = make_case().structure.bearings[0]
    lines = [line.model_copy(update={"name": name}) for name in "ab"]
    structure = make_case().structure.model_copy(update={"bearings": lines})
    return make_case(structure=structure, line_groups=[{"lines": ["a"]}, {"lines": ["b"]}])


def test_groups_are_searched_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """u_a = 100 + u_a/5 + u_b/5 and u_b = 150 - u_a/5 + u_b/5, so 161.8 and 147.1 mm."""
    case = coupled(
        monkeypatch, lambda a, b: ((100.0 + 0.2 * a + 0.2 * b, 8), (150.0 - 0.2 * a + 0.2 * b, 8))
    )
    design = run.run_design(case)
    assert design.outcome == "converged"
    assert [turn.group for turn in design.taken] == ["a", "b"]
    assert_allclose([turn.found for turn in design.taken], [161.76, 147.06], rtol=0.02)
    assert all(abs(turn.difference) <= 0.01 for turn in design.taken)
    assert list(design.table["group"]) == ["a", "b"] * len(design.rounds[::2])
    assert design.first_within == next(
        one.number
        for one, other in zip(design.rounds[::2], design.rounds[1::2], strict=True)
        if max(abs(one.difference), abs(other.difference)) <= 0.1
    )


def test_a_group_that_alternates_is_held_and_the_other_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Group a moves 300 mm with 8 layers and 200 with 9; b follows it until it agrees."""

    def answer(a: float, b: float) -> Any:
        low = a < 250.0
        return (300.0 if low else 200.0, 8 if low else 9), (100.0 + 0.3 * b + 0.2 * a, 8)

    design = run.run_design(coupled(monkeypatch, answer))
    assert design.outcome == "two_sizes"
    a, b = design.taken
    assert a.size.layers == 9
    assert a.assumed - a.found > 2.5  # more than it moves
    assert b.found == pytest.approx((100.0 + 0.2 * a.assumed) / 0.7, rel=0.01)


def test_a_held_size_that_becomes_too_small_is_searched_again() -> None:
    search = sizing.Search(200.0)
    for assumed, result, layers in ((249.0, 300.0, 8), (251.0, 200.0, 9)):
        search.advance(sized(1, assumed, result, layers), 0.01)
    assert search.alternating is not None
    assert search.assumed == 251.0
    assert search.settled(sized(2, 251.0, 200.0, 9), 0.01)
    assert not search.settled(sized(2, 251.0, 260.0, 9), 0.01)
    search.advance(sized(3, 251.0, 260.0, 9), 0.01)  # since the other group has changed
    assert search.alternating is None
    assert search.assumed == 260.0


def test_one_size_with_a_jump_is_not_two() -> None:
    assert sizing._two_sizes([sized(1, 250.0, 300.0, 8), sized(2, 251.0, 200.0, 8)], 0.01) is None
    assert sizing._two_sizes([sized(1, 200.0, 300.0, 8), sized(2, 251.0, 200.0, 9)], 0.01) is None
    low, high = sized(1, 250.0, 300.0, 8), sized(2, 251.0, 200.0, 9)
    assert sizing._two_sizes([sized(3, 230.0, 300.0, 8), high, low], 0.01) == (low, high)


def test_row_and_loop_of_a_round() -> None:
    q, k1, k2, u = 125.0, 9.5, 1.8, 178.0
    turn = sizing.Round(2, u, sizing.Size(600.0, 8, 14.0), 2.6, 0.15, q, k2, k1, 190.0, 1.7)
    row = turn.row()
    assert row["u_B_assumed_mm"] == 178.0
    assert row["u_found_mm"] == 190.0
    assert (row["K_1_kN_mm"], row["K_2_kN_mm"], row["Q_d_kN"]) == (9.5, 1.8, 125.0)
    assert (row["side_mm"], row["layers"], row["layer_thickness_mm"]) == (600.0, 8, 14.0)
    bearing: Any = SimpleNamespace(name="b")
    none: Any = None
    design = Design(
        case=make_case(),
        rounds=[turn],
        outcome="",
        sentence="",
        checks=[],
        bearings=[bearing],
        study=none,
    )
    x, force = design.loops[""]["b (bilinear)"]
    area = abs(np.trapezoid(force, x))
    assert area == pytest.approx(4.0 * q * (u - q / (k1 - k2)), rel=tol.LOOP)
    assert force.max() == pytest.approx(q + k2 * u)


@pytest.mark.parametrize(
    ("displacement", "weight", "side", "layers"),
    [
        (178.0, 784.5, 600.0, 8),  # of the source: 5 x 112 = 560 mm
        (171.5, 784.5, 500.0, 7),  # 7 x 14 x 1.75 exactly
        (171.6, 784.5, 600.0, 8),
        (20.0, 784.5, 400.0, 1),  # the stress governs: sqrt(784500/6) = 361.6 mm
        (20.0, 735.0, 350.0, 1),  # exactly 350 mm
    ],
)
def test_sizes_by_hand(displacement: float, weight: float, side: float, layers: int) -> None:
    size = sizing.size_bearing(displacement, weight, sizing.SizingRules())
    assert (size.side, size.layers) == (side, layers)
    assert size.first_shape_factor == pytest.approx(side / 56.0)  # a^2 / (4 a t_r)
    assert size.second_shape_factor == pytest.approx(side / (14.0 * layers))


def test_limits_may_be_upper_or_lower() -> None:
    assert [sizing.Check("", v, 2.0, "1", "").verdict for v in (1.0, 2.0, 3.0)] == [
        "OK",
        "OK",
        "NG",
    ]
    least = [sizing.Check("", v, 2.0, "1", "", least=True).verdict for v in (1.0, 2.0, 3.0)]
    assert least == ["NG", "OK", "OK"]


def test_stiffness_of_a_layer_follows_the_rubber_area() -> None:
    """Four cores are not rubber, before nor after; lead and rate branch shear over all layers."""
    assert LHDR.lead is not None
    assert LHDR.rate is not None
    bearing = equal._with_side(LHDR, 600.0, 7)
    lead = 4 * np.pi * (0.5 * LHDR.lead.diameter) ** 2
    side = LHDR.area**0.5
    wanted = (600.0**2 - lead) / (side**2 - lead) * LHDR.hysteresis.layer_stiffness
    assert bearing.hysteresis.layer_stiffness == pytest.approx(wanted, rel=tol.LOOP)
    assert (bearing.area, bearing.geometry.rubber_layers) == (360_000.0, 7)
    assert bearing.lead is not None
    assert bearing.rate is not None
    assert bearing.lead.stiffness == pytest.approx(6 / 7 * LHDR.lead.stiffness, rel=tol.LOOP)
    assert bearing.lead.model_copy(update={"stiffness": LHDR.lead.stiffness}) == LHDR.lead
    share = 6 / 7 * wanted / LHDR.hysteresis.layer_stiffness
    assert bearing.rate.stiffness == pytest.approx(share * LHDR.rate.stiffness, rel=tol.LOOP)
    assert bearing.rate.damping == pytest.approx(share * LHDR.rate.damping, rel=tol.LOOP)


@pytest.mark.parametrize(
    ("displacement", "stiffness", "side", "layers"),
    [
        (178.0, 4.37, 435.0, 6),
        (178.5, 4.37, 435.0, 6),
        (179.0, 4.32, 430.0, 7),
        (20.0, 4.34, 435.0, 1),
    ],
)
def test_layers_and_sides_of_equal_bearings(
    displacement: float, stiffness: float, side: float, layers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """17 mm layers at 175 %, sides to the nearest 5 mm; a stiffness of 1 % of the side."""

    def cycle(bearing: tb.Bearing, _: float) -> Any:
        side = bearing.geometry.plan.model_dump()["side"]
        return SimpleNamespace(stiffness_kN_mm=0.01 * side, h_eq=0.1)

    monkeypatch.setattr(equal, "isothermal_cycle", cycle)
    result = equal.equal_bearing("shen-hdr-bridge", stiffness, displacement).bearing
    assert (result.area**0.5, result.geometry.rubber_layers) == (side, layers)


def factor_table() -> pd.DataFrame:
    """One strain: K_eq of first and heated cycles at three temperatures; energy 1000 K_eq."""
    rows = []
    for basis, values in (
        ("first", (5.0, 3.0, 2.0)),
        ("heated", (4.0, 2.5, 1.8)),
        ("mean", (9, 9, 1)),
    ):
        for air, stiffness in zip((-20.0, 0.0, 23.0), values, strict=True):
            # Q_d is 0.3 of the peak force.
            for quantity, value in (
                ("K_eq", stiffness),
                ("energy", 1000.0 * stiffness),
                ("Q_d", 0.3 * 1.75 * 102.0 * stiffness),
            ):
                rows.append((1.75, basis, air, quantity, float(value)))
    return pd.DataFrame(rows, columns=["strain", "basis", "ambient_degC", "quantity", "value"])


def test_bounds_are_the_softest_and_stiffest_of_single_cycles() -> None:
    models = bound_models(factor_table(), 1.75, 102.0)
    result = models[["bound", "basis", "ambient_degC"]].to_numpy().tolist()
    assert result == [["lower", "heated", 23.0], ["upper", "first", -20.0]]
    u = 1.75 * 102.0
    for row, stiffness in zip(models.to_dict("records"), (1.8, 5.0), strict=True):
        strength, initial, post_yield = (row[k] for k in ("Q_d_kN", "K_1_kN_mm", "K_2_kN_mm"))
        assert initial > post_yield
        assert strength + post_yield * u == pytest.approx(stiffness * u)
        loop = 4.0 * strength * (u - strength / (initial - post_yield))
        assert loop == pytest.approx(1000.0 * stiffness)
        own, steep = row["cycle_Q_d_kN"], row["cycle_K_2_kN_mm"]
        assert own == pytest.approx(0.3 * u * stiffness)
        assert own + steep * u == pytest.approx(stiffness * u)  # the same peak force
        ratio = initial / post_yield
        energy = 4.0 * own * (u - own / (steep * (ratio - 1.0)))
        assert row["cycle_energy_ratio"] * loop == pytest.approx(energy)
    with pytest.raises(tb.InputError, match=r"the table has 1\.75"):
        bound_models(factor_table(), 1.0, 102.0)


def test_tables_and_texts_of_bounds_keep_the_stiffnesses_apart() -> None:
    lower = bound_models(factor_table(), 1.75, 102.0).head(1)
    row = lower.iloc[0]
    p = backbone(1.8, 1800.0, 1.75 * 102.0, "LRB")
    assert (row["Q_d_kN"], row["K_1_kN_mm"], row["K_2_kN_mm"]) == (
        p.strength,
        p.initial,
        p.post_yield,
    )
    knee = p.strength / (p.initial - p.post_yield)
    assert row["Q_y_kN"] == pytest.approx(p.initial * knee)
    for language in ("tcl", "python"):
        text = opensees_text(lower, "b", language)
        assert "links.txt" in text  # which has the other K_1
        last = text.splitlines()[-1]
        numbers = last.replace(",", " ").replace(")", " ").split()[-3:]
        assert_allclose(
            [float(n) for n in numbers], [p.initial * knee, p.initial, p.post_yield / p.initial]
        )


def test_bounding_analysis_by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Known demands: the bounds hold one, are unsafe for one and wasteful for one."""
    demands = list(bounds.DEMANDS)
    soft, stiff = [1.0, 2.0, 3.0, 4.0], [2.0, 1.0, 6.0, 5.0]
    coupled = {23.0: [1.5, 1.0, 4.0, 5.0], -20.0: [1.0, 2.5, 2.0, 4.0]}
    asked: list[Any] = []

    def analyse(case: Any) -> Any:
        asked.append(case)
        if len(case.bearings) == 3:
            ends = (("lower", soft), ("upper", stiff), ("virgin", [0.5, 2.2, 7.0, 5.2]))
            rows = [{"bearing": n, "ambient_degC": 23.0, **dict(zip(demands, v, strict=True))}
                    for n, v in ends]  # fmt: skip
        else:
            state = case.analysis.state
            more = 1.0 if state is None else 1.0 + 0.4 * state.share
            rows = [{"bearing": "x", "ambient_degC": t,
                     **{d: more * one for d, one in zip(demands, v, strict=True)}}
                    for t, v in coupled.items()]  # fmt: skip
        table = pd.DataFrame(rows).assign(motion="m", beyond_tested="strain")
        none = pd.DataFrame()
        parts = {"lines": none, "piers": none}
        return SimpleNamespace(
            table=table, tested_range=none, outcome="completed", sentence="", **parts
        )

    monkeypatch.setattr(bounds, "run_earthquake", analyse)
    models = {
        23.0: BilinearParameters(90.0, 1.5, 9.75),
        -20.0: BilinearParameters(200.0, 3.0, 19.5),
    }
    monkeypatch.setattr(
        bounds, "bilinear_parameters", lambda *_, strain, temperature, cycle: models[temperature]
    )
    table = bounds.bounds_study("shen-hdr-bridge", "jra-ii-i-1", [23.0, -20.0])
    lower, upper, virgin = asked[0].bearings
    assert (virgin.name, virgin.strength) == ("virgin", 200.0)
    assert "first cycle" in virgin.description
    assert (lower.name, lower.strength, lower.initial_stiffness) == ("lower", 90.0, 9.75)
    assert (upper.name, upper.strength, upper.post_yield_stiffness) == ("upper", 200.0, 3.0)
    assert asked[1].ambient == [23.0, -20.0]
    assert table["lower_bound"].tolist() == soft
    assert table["upper_bound"].tolist() == stiff
    assert table["coupled_max"].tolist() == [1.5, 2.5, 4.0, 5.0]
    assert table["coupled_at_degC"].tolist() == [23.0, -20.0, 23.0, 23.0]
    assert_allclose(table["envelope_over_coupled"], [2.0 / 1.5, 0.8, 1.5, 1.0])
    assert table["verdict"].tolist() == ["wasteful", "unsafe", "wasteful", "good"]
    assert table["coupled_-20_degC"].tolist() == coupled[-20.0]
    assert set(table["beyond_tested"]) == {"strain"}
    assert table["other_bound"].tolist() == [0.5, 2.2, 7.0, 5.2]
    assert_allclose(table["other_coupled_max"], [2.1, 3.5, 5.6, 7.0])
    assert table["other_coupled_at_degC"].tolist() == [23.0, -20.0, 23.0, 23.0]
    assert_allclose(table["envelope_over_both"], [2.0 / 2.1, 2.2 / 3.5, 7.0 / 5.6, 5.2 / 7.0])
    assert table["verdict_of_both"].tolist() == ["good", "unsafe", "good", "unsafe"]
