"""The whole of Table 3.4, rests included: the books close, and the time step is small enough."""

from itertools import pairwise

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder

NAMES = ["shen-hdr-specimen", "shen-lhdr-specimen", "shen-lhdr-bridge", "lrb-example"]
AMBIENTS = [-20.0, 0.0, 23.0]


@pytest.mark.parametrize("heat_source", ["work", "dissipation"])
@pytest.mark.parametrize("name", NAMES)
def test_books_close(name: str, heat_source: str, measured: Recorder) -> None:
    books = tb.run(name, ambient=AMBIENTS, heat_source=heat_source).energy
    mechanical = float(books["mechanical_residual"].abs().max())
    thermal = float(books["thermal_residual"].abs().max())
    assert mechanical <= tol.ENERGY_BOOKS
    assert thermal <= tol.ENERGY_BOOKS
    measured(f"Table 3.4 with rests, {name}: mechanical residual", mechanical, "1e-10")
    measured(f"Table 3.4 with rests, {name}: thermal residual", thermal, "1e-10")


@pytest.mark.parametrize("name", NAMES[:2])
def test_published_books_do_not_close(name: str, measured: Recorder) -> None:
    """The printed coefficients create heat; with lead, the Maxwell branch also warms nothing."""
    books = tb.run(name, ambient=AMBIENTS, scheme="published").energy
    thermal = books["thermal_residual"].to_numpy()
    assert (np.abs(thermal) > 0.05).all()
    text = ", ".join(f"{-value:+.1%}" for value in thermal)
    measured(f"published scheme, {name}, -20, 0, 23 degC: heat created, of the work", text, "told")
    if name == "shen-hdr-specimen":
        assert np.abs(books["mechanical_residual"]).max() <= tol.ENERGY_BOOKS
    else:
        lost = books["mechanical_residual"].to_numpy()
        assert (lost > 1e-4).all()
        text = ", ".join(f"{value:.2%}" for value in lost)
        measured(
            "published scheme with lead: work of the Maxwell branch that warms nothing",
            text,
            "told",
        )


@pytest.mark.parametrize("name", NAMES[:2])
def test_halving_the_step_changes_no_cycle(name: str, measured: Recorder) -> None:
    """From 10 ms on, per-cycle G_e and h_eq are settled to 0.1 % (exact increment)."""
    tables = [tb.run(name, ambient=AMBIENTS, dt=dt).cycles for dt in (0.01, 0.005, 0.0025)]
    for column, what in (("G_eq_MPa", "G_e"), ("h_eq", "h_eq")):
        values = [table[column].to_numpy() for table in tables]
        first, second = (np.abs(b / a - 1.0).max() for a, b in pairwise(values))
        assert first <= tol.STEP_HALVING
        assert second < first
        measured(f"{name}: largest change of {what}, dt 10 to 5 ms", first, f"{tol.STEP_HALVING:g}")


def test_euler_is_coarser_than_exact(measured: Recorder) -> None:
    """What the published explicit Euler costs at the same 5 ms."""
    best = tb.run(NAMES[0], ambient=23.0, dt=0.00125).cycles["h_eq"].to_numpy()
    error = {
        integrator: float(
            np.abs(
                tb.run(NAMES[0], ambient=23.0, integrator=integrator).cycles["h_eq"] / best - 1
            ).max()
        )
        for integrator in ("exact", "euler")
    }
    assert error["exact"] <= tol.STEP_HALVING
    assert error["euler"] > 5.0 * error["exact"]
    measured(
        "h_eq at 5 ms, exact increment: largest error", error["exact"], f"{tol.STEP_HALVING:g}"
    )
    measured("h_eq at 5 ms, published Euler: largest error", error["euler"], "told")
