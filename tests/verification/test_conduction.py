"""Conduction against exact solutions: decaying modes, a steady composite fin, adiabatic heating.

Half stacks of one rubber layer: y runs from the symmetry plane (adiabatic) to the upper face,
B is half the rubber, H the half height. The mesh is uneven (rubber cells are half as thick as
end-plate cells), so the interface formula is at work in one material too.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from tests.conftest import Recorder
from tests.tolerances import ADIABATIC_RISE, FIXED_POINT, MODE_CAP, ORDER, STEADY_CAP, TIME_CAP
from tests.verification.models import (
    assembled,
    changed,
    heat_step,
    marched,
    rate_matrix,
    sine,
    slab,
    specimen,
)
from thermobearing.bearing.model import Bearing, Material
from thermobearing.core.types import Floats
from thermobearing.model.stack import EndFace, build_stack
from thermobearing.verify.closed_forms import composite_mode, film_wave

RUBBER = Material(conductivity=0.31, specific_heat=1732.0, density=1146.0)
STEEL = Material(conductivity=38.76, specific_heat=432.0, density=7740.0)
MESHES = (4, 8, 16, 32)  # cells in half the rubber, and in one end plate
B, H = 10.0, 30.0  # mm, as slab() makes them
SLENDERNESS = 400.0 / 1e4  # perimeter over area of its plan, a square of 100 mm [1/mm]
FILM = 800.0  # W/(m2 K) at the end face
SIDE = 30.0  # W/(m2 K)
ADIABATIC, FIXED = EndFace(eta=1.0), EndFace(eta=3.0)

Profile = Callable[[Floats], Floats]


def conductivity(material: Material) -> float:
    """[kN/(s K)]"""
    return material.conductivity * 1e-3


def diffusivity(material: Material) -> float:
    """[mm2/s]"""
    return conductivity(material) / material.volumetric_heat


def heights(bearing: Bearing) -> Floats:
    """y of the cell centres [mm]."""
    return np.asarray(H - build_stack(bearing, half=True).depth)


@dataclass(frozen=True)
class Mode:
    rubber: Material
    steel: Material
    side_film: float
    face: EndFace
    rate: float
    profile: Profile


def single_mode(wave: float, face: EndFace, material: Material, side_film: float) -> Mode:
    """cos(wave y) in one material, cooled by conduction and through the side."""
    side = side_film * 1e-6 * SLENDERNESS / material.volumetric_heat
    rate = diffusivity(material) * wave**2 + side
    return Mode(material, material, side_film, face, rate, lambda y: np.cos(wave * y))


def film_mode() -> Mode:
    """The slowest mode with a film at the upper face."""
    return single_mode(film_wave(STEEL, FILM), EndFace(film=FILM), STEEL, 0.0)


def two_materials() -> Mode:
    """The slowest mode of rubber and steel, whose face has the ambient temperature."""
    return Mode(RUBBER, STEEL, 0.0, FIXED, *composite_mode(RUBBER, STEEL))


MODES: dict[str, Callable[[], Mode]] = {
    "adiabatic face": lambda: single_mode(math.pi / H, ADIABATIC, STEEL, 0.0),
    "fixed face": lambda: single_mode(0.5 * math.pi / H, FIXED, RUBBER, 0.0),
    "second mode and side loss": lambda: single_mode(1.5 * math.pi / H, FIXED, RUBBER, SIDE),
    "film at the face": film_mode,
    "rubber and steel": two_materials,
}


def mode_error(mode: Mode, cells: int) -> float:
    """Largest error relative to the mode's peak after 1/rate, marched by the coupled step."""
    bearing = slab(rubber=mode.rubber, steel=mode.steel, side_film=mode.side_film, cells=cells)
    constants = assembled(bearing, upper=mode.face)
    ambient, steps = -20.0, 1000  # so many steps that space alone limits the accuracy
    profile = mode.profile(heights(bearing))
    run = marched(constants, np.zeros(steps), 1.0 / mode.rate / steps, ambient + profile, ambient)
    return float(np.max(np.abs(run.cells[-1] - ambient - math.exp(-1.0) * profile)))


@pytest.mark.parametrize("name", MODES)
def test_decaying_mode_has_order_two_in_space(name: str, measured: Recorder) -> None:
    errors = np.array([mode_error(MODES[name](), cells) for cells in MESHES])
    orders = np.log2(errors[:-1] / errors[1:])
    measured(f"conduction, {name}: observed order in space", f"{orders[-1]:.3f}", "2 +- 0.1")
    measured(
        "conduction, decaying modes: error of the finest mesh, of the peak",
        errors[-1],
        f"{MODE_CAP:g}",
    )
    assert_allclose(orders[-1], 2.0, rtol=0.0, atol=ORDER)
    assert_allclose(errors[-1], 0.0, rtol=0.0, atol=MODE_CAP)


@pytest.mark.parametrize("half", [True, False])
def test_crank_nicolson_has_order_two_in_time(half: bool, measured: Recorder) -> None:
    """Against expm of the same rate matrix, on the specimen's mesh: no error in space."""
    constants = assembled(
        changed(specimen(), materials={"side_film": SIDE}), half=half, upper=EndFace(eta=2.0)
    )
    n = len(constants.cells.capacity)
    start, ambient, duration = np.random.default_rng(7).uniform(-20.0, 20.0, n), -5.0, 8.0
    exact = ambient + expm(-duration * rate_matrix(constants)) @ (start - ambient)
    errors = []
    for steps in (100, 200, 400):
        run = marched(constants, np.zeros(steps), duration / steps, start, ambient)
        errors.append(float(np.max(np.abs(run.cells[-1] - exact))))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    measured("conduction: observed order in time", f"{orders[-1]:.4f}", "2 +- 0.1")
    measured("conduction: error in time at the smallest step [K]", errors[-1], f"{TIME_CAP:g}")
    assert_allclose(orders, 2.0, rtol=0.0, atol=ORDER)
    assert_allclose(errors[-1], 0.0, rtol=0.0, atol=TIME_CAP)


def fin_profile(source: float) -> Profile:
    """Steady T above ambient: source [kN/(mm2 s)] in the rubber, side loss, film at y = H.

    k T'' = side T - source, so T is cosh and sinh of m y; three conditions give A, C, D.
    """
    side = SIDE * 1e-6 * SLENDERNESS
    k_r, k_s, film = conductivity(RUBBER), conductivity(STEEL), FILM * 1e-6
    m_r, m_s, a = math.sqrt(side / k_r), math.sqrt(side / k_s), H - B
    sinh, cosh = math.sinh(m_s * a), math.cosh(m_s * a)
    conditions = np.array(
        [
            [math.cosh(m_r * B), -1.0, 0.0],  # temperature at B
            [k_r * m_r * math.sinh(m_r * B), 0.0, -k_s * m_s],  # flux at B
            [0.0, k_s * m_s * sinh + film * cosh, k_s * m_s * cosh + film * sinh],  # film at H
        ]
    )
    base, c, d = np.linalg.solve(conditions, [-source / side, 0.0, 0.0])

    def profile(y: Floats) -> Floats:
        rubber = source / side + base * np.cosh(m_r * y)
        steel = c * np.cosh(m_s * (y - B)) + d * np.sinh(m_s * (y - B))
        return np.asarray(np.where(y < B, rubber, steel))

    return profile


def test_steady_composite_fin_has_order_two(measured: Recorder) -> None:
    """Uniform source in the rubber against side loss and an end film: a steady cosh profile."""
    source, ambient, dt, errors = 2e-4, -20.0, 3.0, []
    for cells in MESHES:
        bearing = slab(rubber=RUBBER, steel=STEEL, side_film=SIDE, cells=cells)
        constants = assembled(bearing, upper=EndFace(film=FILM))
        y = heights(bearing)
        rise = np.asarray((y < B) * (source / RUBBER.volumetric_heat), dtype=np.float64)
        steady = np.asarray(np.linalg.solve(rate_matrix(constants), rise), dtype=np.float64)
        exact = fin_profile(source)(y)
        errors.append(float(np.max(np.abs(steady - exact)) / np.max(exact)))
        # The core must agree that this is its steady state.
        change = heat_step(constants, steady + ambient, dt, ambient, dt * rise).change
        assert_allclose(change, 0.0, rtol=0.0, atol=FIXED_POINT * np.max(exact))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    measured(
        "steel and rubber fin with source, side loss and film: observed order",
        f"{orders[-1]:.3f}",
        "2 +- 0.1",
    )
    assert_allclose(orders[-1], 2.0, rtol=0.0, atol=ORDER)
    assert_allclose(errors[-1], 0.0, rtol=0.0, atol=STEADY_CAP)


@pytest.mark.parametrize("half", [True, False])
def test_rubber_that_conducts_nothing_heats_by_its_work(half: bool) -> None:
    """Adiabatic limit through the coupled step: every layer's rise is work / (c rho V)."""
    bearing = specimen()
    insulating = bearing.materials.rubber.model_copy(update={"conductivity": 1e-14})
    bearing = changed(bearing, materials={"rubber": insulating, "side_film": 0.0})
    x = sine(bearing, strain=1.5, period=4.0, cycles=3, dt=0.01)
    run = marched(assembled(bearing, half=half, upper=ADIABATIC), x, 0.01, -20.0, -20.0)
    volume = bearing.area * bearing.total_rubber_thickness
    work = run.response["work_in"][-1]
    rise = work / (insulating.volumetric_heat * volume)
    assert rise > 1.0
    rubber = np.array(build_stack(bearing, half=half).part) == "rubber"
    assert_allclose(run.cells[-1] + 20.0, rubber * rise, rtol=0.0, atol=ADIABATIC_RISE * rise)
