"""Slips of the printed heat scheme, one by one: from `conservative` to `published`."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from reproduction.slips import (
    ALL,
    AMBIENT,
    BOOKKEEPING,
    CLOCK,
    PLATES,
    QUANTITIES,
    REFERENCE,
    SHIMS,
    SHORT,
    SIDES,
    SLIPS,
    SlipRow,
    draw_slips,
    possible_slips,
    slip_values,
    slips_table,
    total_change,
    with_slips,
)
from tests import tolerances as tol
from thermobearing.core.step import step
from thermobearing.core.types import Constants, new_state, new_workspace
from thermobearing.model.options import ModelOptions, build_model

SPECIMENS = ("shen-hdr-specimen", "shen-lhdr-specimen")
OF_LEAD = {PLATES, CLOCK, REFERENCE}


def same(one: Constants, other: Constants) -> None:
    """In what acts: a bearing without lead has no bookkeeping, one without film no side."""
    acting = (["lead", "viscous"] if one.lead.cores else []) + (
        ["side_implicit"] if other.cells.side_loss.any() else []
    )
    for name in acting:
        assert getattr(one, name) == getattr(other, name), name
    assert_array_equal(one.lead_cells, other.lead_cells)
    for mine, theirs in zip(one.cells, other.cells, strict=True):
        assert_allclose(mine, theirs, rtol=tol.LOOP, atol=0.0)


@pytest.mark.parametrize("name", SPECIMENS)
def test_without_slips_it_is_conservative_with_all_of_them_published(name: str) -> None:
    bearing = tb.load_bearing(name)
    same(with_slips(bearing, set()).constants, build_model(bearing).constants)
    whole = with_slips(bearing, set(possible_slips(bearing))).constants
    same(whole, build_model(bearing, ModelOptions(scheme="published")).constants)


def test_each_slip_changes_something() -> None:
    for name in SPECIMENS:
        bearing = tb.load_bearing(name)
        slips = possible_slips(bearing)
        assert set(slips) == set(SLIPS) - ({SIDES} if bearing.lead else set(SLIPS) - {SHIMS, SIDES})
        for k in range(len(slips)):
            before, after = (with_slips(bearing, set(slips[:m])).constants for m in (k, k + 1))
            with pytest.raises(AssertionError):
                same(before, after)


def test_shims_alone_receive_twice() -> None:
    bearing = tb.load_bearing(SPECIMENS[0])
    model = with_slips(bearing, {SHIMS})
    ratio = (
        model.constants.cells.to_previous[1:] / build_model(bearing).constants.cells.to_previous[1:]
    )
    assert_allclose(ratio, np.where(model.stack.lone_shim[1:], 2.0, 1.0), rtol=tol.LOOP)


def exchanged(slips: set[str], cells_at: float, lead_at: float) -> tuple[float, float]:
    """Heat that plates gain and cores lose in a step at rest [kN mm]."""
    constants = with_slips(tb.load_bearing(SPECIMENS[1]), slips).constants
    cells = np.full(len(constants.cells.capacity), cells_at)
    state, new = new_state(constants, cells, lead_at), new_state(constants, cells, lead_at)
    step(constants, new_workspace(constants), state, 0.0, 1e-3, cells_at, new)
    gained = float(constants.cells.capacity @ (new.temperature - cells))
    fallen = lead_at - float(new.branches[0].lead_temperature)
    return gained, fallen * constants.lead.capacity * constants.lead.cores


def test_bookkeeping_alone_breaks_the_balance() -> None:
    """Of what lead 50 K above steel and air gives: as much without the slip, 5.13 as much with."""
    gained, lost = exchanged(OF_LEAD, 0.0, 50.0)
    # The faces lose a millionth of it in the same step.
    assert_allclose(gained, lost, rtol=tol.FACES_OF_A_STEP)
    wrong, more = exchanged(OF_LEAD | {BOOKKEEPING}, 0.0, 50.0)
    assert_allclose(wrong / more, 5.1256, rtol=tol.FACES_OF_A_STEP)
    assert_allclose(more, 4.0 * lost, rtol=0.01)  # of n_l = 4 cores, explicit


def test_reference_alone_keeps_the_heat_but_not_its_way() -> None:
    """As much leaves towards the air as towards the plate, while both are as warm."""
    assert_allclose(
        exchanged(OF_LEAD, 0.0, 50.0)[1], exchanged({PLATES, CLOCK}, 0.0, 50.0)[1], rtol=0.01
    )


@pytest.mark.parametrize("slips", [{CLOCK}, {PLATES, BOOKKEEPING}, {REFERENCE}])
def test_slips_that_need_another(slips: set[str]) -> None:
    with pytest.raises(ValueError, match="needs"):
        with_slips(tb.load_bearing(SPECIMENS[1]), slips)


def test_values_are_those_of_run_and_bridge() -> None:
    """All slips: `scheme = "published"` by the public functions, with the cells of the print."""
    bearing = tb.load_bearing("shen-lhdr-specimen")
    values = slip_values("LHDR", frozenset(possible_slips(bearing)))
    assert set(values) == set(QUANTITIES)
    test = tb.cyclic_test(strain=[2.5], wave="sine", closing_strain=None)
    run = tb.run(bearing, test, AMBIENT, model=tb.ModelOptions(scheme="published"))
    last = run.cycles.iloc[-1]
    assert_allclose(
        values["inner_layer_K"], last["rubber3_degC"] - AMBIENT, atol=tol.SINGLE_PRECISION
    )
    assert_allclose(values["lead_K"], last["lead_degC"] - AMBIENT, atol=tol.SINGLE_PRECISION)
    work = run.energy["work_in_kN_mm"].iloc[0]
    assert_allclose(values["energy_kN_mm"], work, rtol=tol.LOOP)
    bridge = tb.load_bearing("shen-lhdr-bridge")
    cells = bridge.cells.model_copy(update={"rubber": 2, "shim": 1})
    bridge = bridge.model_copy(update={"cells": cells})
    table = tb.bridge(
        bridge, "jra-ii-i-1", AMBIENT, model=tb.ModelOptions(scheme="published")
    ).table
    assert_allclose(values["pier_ductility"], table["pier_ductility"][0], rtol=tol.LOOP)
    force = table["bearing_force_max_kN"][0]
    assert_allclose(values["bridge_force_kN"], force, rtol=tol.LOOP)


def row(kind: str, slip: str, value: float, bearing: str = "LHDR") -> SlipRow:
    values = dict.fromkeys(QUANTITIES, value)
    if bearing == "HDR":
        values["lead_K"] = float("nan")
    return SlipRow(bearing, kind, slip, values)


@pytest.fixture
def rows() -> list[SlipRow]:
    lhdr = [("chain", "", 10.0), ("chain", CLOCK, 11.0), ("chain", SHIMS, 22.0)]
    result = [row(*each) for each in [*lhdr, ("alone", CLOCK, 10.5), ("alone", SHIMS, 20.0)]]
    return [*result, row("chain", "", 5.0, "HDR"), row("chain", SHIMS, 4.0, "HDR")]


def test_table(rows: list[SlipRow]) -> None:
    table = slips_table(rows)
    changes = table["force_kN_change_percent"].to_numpy()
    assert_allclose(changes, [0.0, 10.0, 100.0, 5.0, 100.0, 0.0, -20.0], rtol=tol.LOOP)
    assert table["means"][0].startswith("conservative")
    assert np.isnan(table["lead_K"].iloc[-1])
    assert_allclose(total_change(rows, "LHDR", "force_kN"), 120.0, rtol=tol.LOOP)
    assert_allclose(total_change(rows, "HDR", "force_kN"), -20.0, rtol=tol.LOOP)


def test_figure(rows: list[SlipRow]) -> None:
    """Bars of what each bearing has, with their numbers; the sum of all at the bottom."""
    axes: Any = draw_slips(rows).axes
    names = [label.get_text() for label in axes[0].get_yticklabels()]
    assert names == [*SHORT.values(), ALL]
    reported = [text.get_text() for text in axes[2].texts]
    assert reported == ["+5.0", "+100.0", "\N{MINUS SIGN}20.0", "+120.0"]
    assert [text.get_text() for text in axes[1].texts] == ["+5.0", "+100.0", "+120.0"]
