"""Start temperatures after hours in a chamber, against a series and finite elements."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.models import slab
from tests.verification.test_conduction import MESHES, RUBBER, H, conductivity, diffusivity
from thermobearing.bearing.model import Bearing
from thermobearing.core.types import Floats
from thermobearing.cyclic.conditioning import chamber_numbers, soaked_start
from thermobearing.model.stack import build_stack, through_side
from thermobearing.tables.conditioning import Conditioning

HOURS = (3.0, 6.0, 24.0)
CHAMBERS = (-20.0, -10.0, 0.0)
BEFORE = 23.0  # [degC]
SLAB_HOURS, SLAB_FILM = 0.25, 50.0


def exact_slab(bearing: Bearing, chamber: float, hours: float, film: float) -> Floats:
    """Temperatures of the cells of a slab that came in at BEFORE [degC].

    A series in cos(p y) with k p tan(p H) = film (Carslaw and Jaeger), times the decay through the
    side, where every cell loses heat at the same rate.
    """
    time, biot = 3600.0 * hours, film * 1e-6 * H / conductivity(RUBBER)
    y = H - build_stack(bearing, half=True).depth
    total = np.zeros_like(y)
    for n in range(40):
        low, high = n * math.pi, (n + 0.5) * math.pi
        root = brentq(lambda z: z * math.sin(z) - biot * math.cos(z), low, high, xtol=1e-14)
        weight = 4.0 * math.sin(root) / (2.0 * root + math.sin(2.0 * root))
        decay = math.exp(-diffusivity(RUBBER) * (root / H) ** 2 * time)
        total += weight * np.cos(root * y / H) * decay
    side = through_side(bearing, film, chamber_numbers().cover) * 1e-6
    plan = bearing.geometry.plan
    loss = side * plan.perimeter / plan.area / RUBBER.volumetric_heat
    return chamber + (BEFORE - chamber) * total * math.exp(-loss * time)


def test_series_of_a_slab_with_order_two(measured: Recorder) -> None:
    asked = Conditioning(conditioned=SLAB_HOURS, before=BEFORE, chamber_film=SLAB_FILM)
    errors = []
    for cells in MESHES:
        bearing = slab(rubber=RUBBER, steel=RUBBER, side_film=0.0, cells=cells)
        exact = exact_slab(bearing, -20.0, SLAB_HOURS, SLAB_FILM)
        assert exact.max() - exact.min() > 5.0
        result = soaked_start(bearing, asked, -20.0).temperature
        errors.append(float(np.abs(result - exact).max()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    measured("soaked start, series of a slab: observed order in space", f"{orders[0]:.2f}", "2")
    measured("soaked start, series of a slab: largest error [K]", errors[-1], f"{tol.SOAKED:g}")
    assert errors[-1] < tol.SOAKED
    assert_allclose(orders[0], 2.0, atol=tol.ORDER)


def test_start_is_linear_in_the_difference() -> None:
    bearing = tb.load_bearing("lrb-example")
    asked = Conditioning(conditioned=6.0, before=BEFORE)
    parts = []
    for chamber in CHAMBERS:
        start = soaked_start(bearing, asked, chamber)
        parts.append((np.append(start.temperature, start.lead) - chamber) / (BEFORE - chamber))
    assert_allclose(parts[1:], [parts[0]] * 2, rtol=1e-9)


def test_hours_of_a_large_bearing_as_finite_elements_have_them(measured: Recorder) -> None:
    """A 700 mm LRB from 23 to -20 degC; lead is the farthest off, by 1.0 K after 3 h."""
    pytest.importorskip("skfem", reason="scikit-fem is not installed")
    from thermobearing.verify.finite_elements import FiniteElements, mean_rubber, weather_problem

    bearing = tb.load_bearing("lrb-example")
    numbers = chamber_numbers()
    problem = weather_problem(bearing, numbers.film, numbers.cover)
    elements = FiniteElements(problem)
    history = elements.march([(600.0, 6 * 24)], start=np.ones(elements.basis.N))
    rubber, difference = mean_rubber(problem, history), BEFORE + 20.0
    pairs = []
    for hours in HOURS:
        row = round(6 * hours)
        start = soaked_start(bearing, Conditioning(conditioned=hours, before=BEFORE), -20.0)
        fine = -20.0 + difference * rubber[row]
        lead = -20.0 + difference * history.means["lead"][row]
        pairs.append((start.rubber, fine))
        layers = [history.means[f"rubber {k}"][row] for k in range(1, len(start.layers) + 1)]
        assert_allclose(start.rubber, fine, atol=tol.SOAKED_ELEMENTS)
        assert_allclose(start.lead, lead, atol=tol.SOAKED_ELEMENTS)
        assert_allclose(
            start.layers, -20.0 + difference * np.array(layers), atol=tol.SOAKED_ELEMENTS
        )
    measured(
        "lrb-example in a chamber at -20 degC: rubber after 3, 6, 24 h [degC]",
        ", ".join(f"{ours:.1f}" for ours, _ in pairs),
        "reported",
    )
    measured(
        "lrb-example in a chamber at -20 degC: the same by finite elements [degC]",
        ", ".join(f"{fine:.1f}" for _, fine in pairs),
        f"{tol.SOAKED_ELEMENTS:g} K",
    )
