"""The finite elements that judge the package, judged themselves: exact modes, books, the gap."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.special import j0, j1

from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.bearing.model import Material
from thermobearing.core.types import Floats

pytest.importorskip("skfem", reason="scikit-fem is not installed")

RUBBER = Material(conductivity=0.31, specific_heat=1732.0, density=1146.0)
STEEL = Material(conductivity=38.76, specific_heat=432.0, density=7740.0)
R, H, B = 40.0, 30.0, 10.0  # mm: radius, height, thickness of the rubber at the symmetry plane
Mode = Callable[[Floats, Floats], Floats]  # of r and z
FACE, SIDE = 8e-4, 5e-4  # kN/(s mm K), films at z = 0 and r = R


def conductivity(material: Material) -> float:
    """[kN/(s K)]"""
    return material.conductivity * 1e-3


def diffusivity(material: Material) -> float:
    """[mm2/s]"""
    return conductivity(material) / material.volumetric_heat


def decayed(blocks: tuple[Any, ...], side: float, rate: float, mode: Mode) -> float:
    from tests.reference.fe_heat import FiniteElements, Problem, graded

    count = 8
    z = np.concatenate([[0.0], graded(0.0, H - B, count), graded(H - B, H, count)])
    r = np.concatenate([[0.0], graded(0.0, R, count)])
    elements = FiniteElements(Problem(r, z, blocks, face_film=FACE, side_film=side))
    place = elements.basis.doflocs
    start = mode(place[0], place[1])
    steps = 200
    history = elements.march([(1.0 / rate / steps, steps)], start=start)
    assert_allclose(history.stored, -history.lost, rtol=tol.FE_BOOKS)
    return float(np.max(np.abs(history.final - start * math.exp(-1.0))) / np.max(np.abs(start)))


def test_cylinder_with_films_on_face_and_side(measured: Recorder) -> None:
    """J0(m r) cos(w (H - z)) with k m J1(m R) = film J0(m R) and k w tan(w H) = film."""
    from tests.reference.fe_heat import Block

    k = conductivity(STEEL)
    m = brentq(lambda x: k * x * j1(x * R) - SIDE * j0(x * R), 1e-9, 2.4 / R)
    w = brentq(lambda x: k * x * math.sin(x * H) - FACE * math.cos(x * H), 1e-9, 0.5 * math.pi / H)
    error = decayed(
        (Block("steel", (0.0, R), (0.0, H), STEEL),),
        SIDE,
        diffusivity(STEEL) * (m * m + w * w),
        lambda r, z: j0(m * r) * np.cos(w * (H - z)),
    )
    measured("finite elements, cylinder with films: error, of the peak", error, f"{tol.FE_MODE:g}")
    assert error < tol.FE_MODE


def test_steel_on_rubber_with_a_film(measured: Recorder) -> None:
    """cos(p y) in the rubber, y = H - z; in the steel what fits it, with the film at the face."""
    from tests.reference.fe_heat import Block

    k_r, k_s = conductivity(RUBBER), conductivity(STEEL)

    def waves(rate: float) -> tuple[float, float, float, float]:
        p, q = math.sqrt(rate / diffusivity(RUBBER)), math.sqrt(rate / diffusivity(STEEL))
        return p, q, math.cos(p * B), -k_r * p * math.sin(p * B) / (k_s * q)

    def gap(rate: float) -> float:
        _, q, a, d = waves(rate)
        sine, cosine = math.sin(q * (H - B)), math.cos(q * (H - B))
        return k_s * q * (d * cosine - a * sine) + FACE * (a * cosine + d * sine)

    longest = diffusivity(RUBBER) * (0.5 * math.pi / B) ** 2
    rate = brentq(gap, 1e-6 * longest, longest, xtol=1e-16)
    p, q, a, d = waves(rate)

    def mode(r: Floats, z: Floats) -> Floats:
        y = H - z
        steel = a * np.cos(q * (y - B)) + d * np.sin(q * (y - B))
        return np.where(y < B, np.cos(p * y), steel)

    blocks = (
        Block("steel", (0.0, R), (0.0, H - B), STEEL),
        Block("rubber", (0.0, R), (H - B, H), RUBBER),
    )
    error = decayed(blocks, 0.0, rate, mode)
    measured("finite elements, steel on rubber: error, of the peak", error, f"{tol.FE_MODE:g}")
    assert error < tol.FE_MODE


def test_a_gap_lets_no_heat_through() -> None:
    """A core with its wall doubled warms by its heat over c rho V everywhere; the rest does not."""
    from tests.reference.fe_heat import Block, FiniteElements, Problem, graded

    core, heat = 15.0, 1000.0
    r = np.concatenate([[0.0], graded(0.0, core, 4), graded(core, R, 4)])
    z = np.concatenate([[0.0], graded(0.0, H, 6)])
    blocks = (
        Block("around", (core, R), (0.0, H), STEEL),
        Block("core", (0.0, core), (0.0, H), RUBBER),
    )
    elements = FiniteElements(Problem(r, z, blocks, slit=(core, -1.0)))
    history = elements.march([(0.5, 40)], {"core": (np.array([0.0, 20.0]), np.array([0.0, heat]))})
    rise = heat / (RUBBER.volumetric_heat * math.pi * core**2 * H)
    warm = np.abs(history.final - rise) < tol.FE_BOOKS * rise
    cold = np.abs(history.final) < tol.FE_BOOKS * rise
    assert (warm | cold).all()
    assert_allclose(history.means["core"][-1], rise, rtol=tol.FE_BOOKS)
    assert_allclose(history.means["around"], 0.0, rtol=0.0, atol=tol.FE_BOOKS * rise)
