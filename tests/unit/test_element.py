"""Trial, commit, revert: the element for outside solvers does what the march does."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import changed_table, specimen_table
from tests.verification.models import assembled, marched, smooth_history, specimen
from thermobearing.bearing.library import bearing_from_table
from thermobearing.core.types import Floats, State

AIR, START, DT = -20.0, -10.0, 0.005
PATH = smooth_history(np.random.default_rng(12), 90.0, 400)  # 300 % in the cold: softening too


def fresh() -> tb.BearingElement:
    constants = assembled(specimen())
    return tb.BearingElement.from_constants(constants, START)


def assert_same_state(one: State, other: State) -> None:
    for a, b in zip(one, other, strict=True):
        assert_array_equal(a, b)


def follow(element: tb.BearingElement, path: Floats) -> list[float]:
    forces = []
    for x in path:
        trial = element.set_trial(float(x), DT, AIR)
        assert trial.outcome == "completed"
        forces.append(trial.force)
        element.commit()
    return forces


def test_committed_trials_are_the_march() -> None:
    run = marched(assembled(specimen()), PATH, DT, START, AIR)
    assert run.softened > 0
    element = fresh()
    assert_array_equal(follow(element, PATH), run.books["force"])
    assert_array_equal(element.state.temperature, run.cells[-1])
    assert element.state.books[0].displacement == PATH[-1]


def test_trials_that_are_not_committed_leave_no_trace() -> None:
    """A solver that proposes three wrong displacements before each right one gets the same."""
    plain, searching = fresh(), fresh()
    rng = np.random.default_rng(2)
    for x in PATH:
        for wrong in rng.uniform(-90.0, 90.0, 3):
            searching.set_trial(float(wrong), 7 * DT, 40.0)
        trials = [element.set_trial(float(x), DT, AIR) for element in (plain, searching)]
        assert trials[0] == trials[1]
        plain.commit()
        searching.commit()
    assert_same_state(plain.state, searching.state)


def test_commit_twice_moves_once() -> None:
    element = fresh()
    element.set_trial(3.0, DT, AIR)
    element.commit()
    once = element.save()
    element.commit()
    assert_same_state(element.state, once)
    assert element.state.books[0].clock == DT


def test_revert_to_start() -> None:
    element = fresh()
    virgin = element.save()
    first = follow(element, PATH)
    element.revert_to_start()
    assert_same_state(element.state, virgin)
    assert_array_equal(follow(element, PATH), first)


def test_save_and_restore() -> None:
    element = fresh()
    follow(element, PATH[:150])
    saved = element.save()
    rest = follow(element, PATH[150:])
    assert saved.books[0].displacement == PATH[149]  # a copy: the motion went on without it
    element.restore(saved)
    assert_array_equal(follow(element, PATH[150:]), rest)


def test_failed_trial_cannot_be_committed() -> None:
    """After a trial that ran away the element is where it was, and a commit says so."""
    table = changed_table(specimen_table(), {"hysteresis.yield_displacement": "0.1 mm"})
    constants = assembled(bearing_from_table(table, "table"), integrator="euler")
    element = tb.BearingElement.from_constants(constants, START)
    follow(element, np.array([0.01, 0.02]))
    before = element.save()
    trial = element.set_trial(60.0, DT, AIR)
    assert trial.outcome == "euler_unstable"
    with pytest.raises(tb.InputError, match="ended as euler_unstable"):
        element.commit()
    assert_same_state(element.state, before)
    assert element.set_trial(0.03, DT, AIR).outcome == "completed"
    element.commit()
    assert element.state.books[0].displacement == 0.03


@pytest.mark.parametrize("back", ["restore", "revert_to_start"])
def test_a_failed_trial_is_forgotten_with_its_state(back: str) -> None:
    element = fresh()
    saved = element.save()
    assert element.set_trial(float("nan"), DT, AIR).outcome == "not_finite"
    if back == "restore":
        element.restore(saved)
    else:
        element.revert_to_start()
    element.commit()
    assert_same_state(element.state, saved)


@pytest.mark.parametrize("name", ["shen-hdr-specimen", "shen-lhdr-specimen"])
def test_an_element_goes_on_where_a_test_ended(name: str) -> None:
    """As a second test of the package does, forces and temperatures to the bit."""
    test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None, dt=0.01, closing_strain=None)
    first = tb.run(name, test, ambient=AIR)
    second = tb.run(name, test, ambient=AIR, initial=first)
    element = tb.element(name, ambient=AIR, initial=tb.end_state(first, name))
    x, clock = second["displacement"].values[0], second["time"].values
    forces = [float(element.state.books["force"][0])]
    for k in range(1, len(x)):
        forces.append(element.set_trial(x[k], clock[k] - clock[k - 1]).force)
        element.commit()
    peak = np.abs(forces).max()
    assert_allclose(second["force"].values[0], forces, rtol=0.0, atol=tol.CLOCK_FORCE * peak)
    element.revert_to_start()
    assert element.state.books["force"][0] == first["force"].values[0, -1]


def test_an_element_begins_only_where_its_bearing_was() -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1, rest=None, dt=0.02)
    result = tb.run("shen-hdr-specimen", test, ambient=[AIR, 23.0])
    with pytest.raises(tb.InputError, match="not of this"):
        tb.end_state(result, "shen-lhdr-specimen", AIR)
    with pytest.raises(tb.InputError, match="2 runs"):
        tb.end_state(result, "shen-hdr-specimen")
    warm = tb.end_state(result, "shen-hdr-specimen", 23.0)
    assert min(warm.temperature) > 22.0
    with pytest.raises(tb.InputError, match="end_state"):
        tb.element("shen-hdr-specimen", initial=result)
    fine = tb.changed_bearing("shen-hdr-specimen", cells={"rubber": 4})
    with pytest.raises(tb.InputError, match="cells"):
        tb.element(fine, initial=warm)
