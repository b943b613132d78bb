"""The coupled equations once more, in plain NumPy and SciPy, from the equations alone.

    layer law    f = alpha e^{m (T-23)/100} K d + [1 + b (d/t_r)^2] (1-alpha) e^{n (T-23)/100} K Z
                 dZ/dt = dd/dt - beta |dd/dt Z| Z - gamma dd/dt Z^2           (Eq. 4.34-4.37)
    in series    the same force in every layer, displacements add up          (section 4.3.2)
    heat         w = (f_0 + f_1)/2 (d_1 - d_0) / V in the rubber              (Eq. 4.22)
                 Crank-Nicolson, side loss 4 h (T - T_A)/a, eta_B at the face (Eq. 4.6-4.15)

It takes nothing from the package but the bearing's data. Where the package is scalar,
compiled and tuned, this is arrays over the layers, a Newton iteration on all layer
displacements and the force at once, a banded solver, and temperatures instead of their
changes. It knows square bearings with an even number of layers, cut at the symmetry plane,
the conservative scheme and -1 < s < 1, and has no rule for a layer that softens (large
strain in the cold): it says so instead. Units: kN, mm, s, degC.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from thermobearing.bearing.model import Bearing, SquarePlan

Floats = NDArray[np.float64]

NEWTON_STEPS = 50
FORCE_TOLERANCE = 1e-12  # of K d_y: differences of the layer forces when Newton stops
METRE = 1e3  # [mm]; 1 J = 1 kN mm needs no factor


def increment_of_z(z: Floats, dd: Floats, d_y: float, curvature: float) -> tuple[Floats, Floats]:
    """Z after displacement increments dd of the layers, and dZ/dd there.

    In u = Z sign(dd) and the path e = |dd|, Eq. 4.35 is du/de = 1 - (u/d_y)^2 where u >= 0:
    a hyperbolic tangent, and du/de = 1 + c u^2 where u < 0: a tangent that reaches zero after
    the path atan(-u sqrt(c))/sqrt(c). `curvature` is c = beta - gamma > 0 [1/mm2].
    """
    sign = np.where(dd < 0.0, -1.0, 1.0)
    u, e, k = sign * z, np.abs(dd), np.sqrt(curvature)
    below = np.minimum(u, 0.0)
    to_zero = np.arctan(-k * below) / k
    with np.errstate(divide="ignore"):  # atanh(1) = inf is right: Z stays saturated
        start = np.arctanh(np.clip(u / d_y, 0.0, 1.0))
    loading = d_y * np.tanh(start + np.maximum(e - to_zero, 0.0) / d_y)
    unloading = np.tan(np.arctan(k * below) + k * np.minimum(e, to_zero)) / k
    u = np.where(e >= to_zero, loading, unloading)
    slope = np.where(u >= 0.0, 1.0 - (u / d_y) ** 2, 1.0 + curvature * u**2)
    return sign * u, slope


@dataclass(frozen=True)
class Cells:
    """Cells of half a stack, from the upper face down."""

    thickness: Floats  # [mm]
    conductivity: Floats  # [kN/(s K)]
    volumetric_heat: Floats  # [kN/(mm2 K)] = [kN mm/(mm3 K)]
    rubber: list[slice]  # the cells of each layer


def half_stack(bearing: Bearing) -> Cells:
    """End plate, then rubber and shims in turn, down to the middle of the middle shim."""
    geometry, count = bearing.geometry, bearing.cells
    steel, rubber = bearing.materials.steel, bearing.materials.rubber
    parts = [(geometry.end_plate_thickness, count.end_plate, steel)]
    for _ in range(geometry.rubber_layers // 2):
        parts.append((geometry.rubber_thickness, count.rubber, rubber))
        parts.append((geometry.shim_thickness, count.shim, steel))
    parts[-1] = (0.5 * geometry.shim_thickness, (count.shim + 1) // 2, steel)
    ends = np.cumsum([number for _, number, _ in parts])
    repeat = [number for _, number, _ in parts]
    return Cells(
        thickness=np.repeat([t / number for t, number, _ in parts], repeat),
        conductivity=np.repeat([m.conductivity / METRE for _, _, m in parts], repeat),
        volumetric_heat=np.repeat(
            [m.density * m.specific_heat / METRE**3 for _, _, m in parts], repeat
        ),
        rubber=[slice(int(ends[i - 1]), int(ends[i])) for i in range(1, len(parts), 2)],
    )


class NumpyStepper:
    """One bearing between two alike end faces; `step` moves it.

    Parameters
    ----------
    bearing : square plan, an even number of rubber layers.
    temperature : of all cells at the start [degC].
    eta : heat exchange of the end faces, eta_B of Eq. 4.15.
    """

    def __init__(self, bearing: Bearing, temperature: float, eta: float = 2.0) -> None:
        geometry, plan = bearing.geometry, bearing.geometry.plan
        if not isinstance(plan, SquarePlan) or geometry.rubber_layers % 2:
            raise ValueError("square bearings with an even number of layers only")
        self.law = h = bearing.hysteresis
        self.layer_thickness = geometry.rubber_thickness
        self.curvature = (1.0 - h.shape) / (1.0 + h.shape) / h.yield_displacement**2
        self.cells = cells = half_stack(bearing)
        self.volume = plan.side**2 * geometry.rubber_thickness  # of one layer [mm3]
        self.middle = np.array([self._middle(part) for part in cells.rubber])
        dx, k = cells.thickness, cells.conductivity
        # Exchange between neighbours [kN/(s mm K)]: two half cells in series.
        between = 2.0 / (dx[:-1] / k[:-1] + dx[1:] / k[1:])
        film = bearing.materials.side_film / METRE**2
        loss = 4.0 * film / plan.side * dx
        loss[0] += (eta - 1.0) * k[0] / dx[0]
        heat = cells.volumetric_heat * dx
        self.loss = loss / heat  # to the ambient [1/s]
        self.upper = between / heat[:-1]
        self.lower = between / heat[1:]
        self.diagonal = -self.loss.copy()
        self.diagonal[:-1] -= self.upper
        self.diagonal[1:] -= self.lower
        layers = len(cells.rubber)
        self.x, self.force = 0.0, 0.0
        self.d, self.z = np.zeros(layers), np.zeros(layers)
        self.temperature = np.full(len(dx), float(temperature))

    @staticmethod
    def _middle(part: slice) -> tuple[int, int]:
        count = part.stop - part.start
        return part.start + (count - 1) // 2, part.start + count // 2

    @property
    def layer_temperature(self) -> Floats:
        """At mid-thickness [degC], outer layer first."""
        return np.asarray(self.temperature[self.middle].mean(axis=1))

    def step(self, x: float, dt: float, ambient: float) -> float:
        """Move to the displacement x [mm] within dt [s]; returns the force [kN]."""
        d, z, force = self._share(x)
        work = 0.5 * (self.force + force) * (d - self.d)
        source = np.zeros_like(self.temperature)
        for part, done in zip(self.cells.rubber, work, strict=True):
            source[part] = done / (self.volume * self.cells.volumetric_heat[part])
        self._conduct(source, dt, ambient)
        self.x, self.force, self.d, self.z = x, force, d, z
        return force

    def _share(self, x: float) -> tuple[Floats, Floats, float]:
        """Layer displacements, their Z and the common force: Newton on (d_1 .. d_L, F)."""
        law, layers = self.law, len(self.d)
        warmer = (self.layer_temperature - law.reference_temperature) / 100.0
        k, m, n = (
            law.layer_stiffness,
            law.elastic_temperature_coefficient,
            law.hysteretic_temperature_coefficient,
        )
        elastic = law.post_yield_ratio * k * np.exp(m * warmer)
        hysteretic = (1.0 - law.post_yield_ratio) * k * np.exp(n * warmer)
        b = law.hardening / self.layer_thickness**2
        d, force = self.d + (x - self.x) / (2 * layers), self.force
        jacobian = np.zeros((layers + 1, layers + 1))
        jacobian[:layers, layers] = -1.0
        jacobian[layers, :layers] = 2.0  # two alike layers, one in either half
        for _ in range(NEWTON_STEPS):
            z, slope = increment_of_z(self.z, d - self.d, law.yield_displacement, self.curvature)
            forces = elastic * d + (1.0 + b * d**2) * hysteretic * z
            tangent = elastic + hysteretic * (2.0 * b * d * z + (1.0 + b * d**2) * slope)
            if tangent.min() <= 0.0:
                raise ArithmeticError("a layer softens: this stepper has no rule for that")
            residual = np.append(forces - force, 2.0 * d.sum() - x)
            if np.abs(residual).max() <= FORCE_TOLERANCE * k * law.yield_displacement:
                return d, z, force
            jacobian[range(layers), range(layers)] = tangent
            change = np.linalg.solve(jacobian, -residual)
            d, force = d + change[:layers], force + float(change[layers])
        raise ArithmeticError("no equal layer forces found")

    def _conduct(self, source: Floats, dt: float, ambient: float) -> None:
        """Crank-Nicolson: (1 - dt/2 R) T_1 = (1 + dt/2 R) T_0 + dt loss T_A + source."""
        t, half = self.temperature, 0.5 * dt
        right = t + half * self.diagonal * t + dt * self.loss * ambient + source
        right[:-1] += half * self.upper * t[1:]
        right[1:] += half * self.lower * t[:-1]
        band = np.zeros((3, len(t)))
        band[0, 1:] = -half * self.upper
        band[1] = 1.0 - half * self.diagonal
        band[2, :-1] = -half * self.lower
        self.temperature = solve_banded((1, 1), band, right)
