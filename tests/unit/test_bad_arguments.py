"""Bad arguments of the Python functions are told like bad files; see test_bad_input.py."""

from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.inputs import assert_told

TEST = tb.cyclic_test(strain=[0.5], cycles=1)


@pytest.mark.parametrize(
    ("options", "pieces"),
    [
        ({"ambient": 500}, ["ambient[0] = '500.0 degC'", "at most 100 degC"]),
        ({"ambient": float("nan")}, ["ambient[0]", "not a finite number"]),
        ({"ambient": [1, float("inf")]}, ["ambient[1]", "not a finite number"]),
        ({"ambient": "cold"}, ["ambient[0] = 'cold'", '"1.5 degC"']),
        ({"ambient": True}, ["ambient[0] = True", '"1.5 degC"']),
        ({"scheme": "conservativ"}, ["analysis.scheme", 'did you mean "conservative"']),
        ({"heat_source": "sun"}, ["analysis.heat_source = 'sun'", "'dissipation'"]),
        ({"stack": "quarter"}, ["analysis.stack = 'quarter'", "'half'"]),
        ({"dt": "soon"}, ["test.dt = 'soon'", '"1.5 s"']),
        ({"dt": True}, ["test.dt = True", '"1.5 s"']),
        ({"upper_face": 2.0}, ["analysis.upper_face = 2.0", "must be a table"]),
        ({"keep": ["heat"]}, ["analysis.keep[0] = 'heat'", "'cells'"]),
        ({"keep": tb.Keep(every=0)}, ["analysis.keep_every = 0", "at least 1"]),
        ({"keep": tb.Keep(every=1.5)}, ["analysis.keep_every = 1.5", "whole number"]),
        ({"initial": 500}, ["initial = '500.0 degC'", "at most 100 degC"]),
        ({"initial": [1, 2]}, ["has 2 temperatures", "19 cells"]),
        ({"initial": np.full(19, np.nan)}, ["19 problems", "initial_profile[18]"]),
        ({"test": "Table 3.4"}, ["test = 'Table 3.4'", "two arrays"]),
        ({"bearing": 3}, ["bearing = 3", "must be a table"]),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_argument_of_run(options: dict[str, Any], pieces: list[str]) -> None:
    given = {"bearing": "shen-hdr-specimen", "test": TEST, "ambient": 0} | options
    with pytest.raises(tb.InputError) as caught:
        tb.run(**given)
    assert_told(str(caught.value), ["run(): ", *pieces])


@pytest.mark.parametrize(
    ("options", "pieces"),
    [
        ({"strain": [-1]}, ["steps[0].strain = -1", "at least 1e-06 and at most 5"]),
        ({"strain": [50, 100]}, ["steps[0].strain = 50", "steps[2].strain = 100"]),
        ({"strain": [float("nan")]}, ["strain = nan"]),
        ({"strain": None}, ["strain"]),
        ({"strain": []}, ["strain", "at least one"]),
        ({"cycles": 1.5}, ["count = 1.5", "whole number"]),
        ({"wave": "sin"}, ["wave = 'sin'", '"sine"?']),
        ({"speed": 0}, ["speed = 0", "at least 1e-06 and at most 1e+06 mm/s"]),
        ({"dt": 100}, ["dt = 100", "at most 10 s"]),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_argument_of_cyclic_test(options: dict[str, Any], pieces: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.cyclic_test(**options)
    assert_told(str(caught.value), ["cyclic_test(): ", *pieces])


@pytest.mark.parametrize(
    ("make", "pieces"),
    [
        (lambda: tb.EndFace(eta=5), ["EndFace()", "eta = 5", "at most 3"]),
        (lambda: tb.EndFace(eta=2.0, film=3.0), ["EndFace()", "either eta", "or film"]),
        (lambda: tb.EndFace(film=-3.0), ["film = -3.0", "at least 0 and at most 100000 W/(m^2 K)"]),
        (lambda: tb.CyclicTest(steps=[]), ["CyclicTest()", "steps = []", "at least 1"]),
        (lambda: tb.Ambient.constant(500), ["ambient", "500 degC", "-100 to 100 degC"]),
        (lambda: tb.Ambient.constant("cold"), ["ambient", "'cold'"]),
        (lambda: tb.Ambient.series([0, 1], [0]), ["equally long"]),
        (lambda: tb.Ambient.series([0, 0], [0, 1]), ["does not increase"]),
        (lambda: tb.Ambient.series([0, 1], [0, np.nan]), ["nan degC"]),
        (lambda: tb.Ambient.series([0, np.inf], [0, 1]), ["not finite"]),
        (lambda: tb.Ambient.series("night", "day"), ["numbers"]),
        (lambda: tb.load_result("no-such-result"), ["no-such-result", "no result.nc"]),
        (lambda: tb.load_result(__file__), [__file__, "not a result file"]),
    ],
    ids=range(13),
)
def test_bad_argument_elsewhere(make: Any, pieces: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        make()
    assert_told(str(caught.value), pieces)


def test_a_wrong_name_is_told_once_and_the_rest_is_checked() -> None:
    """Nothing takes the place of what cannot be loaded: only its own fault is reported."""
    names = ["shen-hdr-brige", "shen-lhdr-bridge"]
    with pytest.raises(tb.InputError) as caught:
        tb.bridge(names, "jra-ii-i-1", 500, structure="pier-p9", mass="heavy")
    starts = [text.split(" ")[0].rstrip(":") for text in caught.value.problems]
    assert starts == ["structure", "bearings[0]", "ambient[0]", "analysis.mass"]
