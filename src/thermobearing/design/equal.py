"""Layered bearings with the equivalent stiffness of a design, as the source chose them by hand."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import resized
from thermobearing.border.errors import InputError
from thermobearing.cyclic.equivalent import isothermal_cycle
from thermobearing.cyclic.protocol import cyclic_test
from thermobearing.cyclic.run import run

Floats = NDArray[np.float64]

ROUNDING = 5.0  # mm: plans are made in such steps
TRIES = 60
MOST_LAYERS = 200  # of any bearing


@dataclass(frozen=True)
class EqualBearing:
    """A layered bearing scaled to a stiffness.

    Attributes
    ----------
    bearing : ready for `bridge`.
    stiffness, damping : K_eq [kN/mm] and h_eq of its third cycle without heating at the design
        displacement and the reference temperature of its rubber.
    displacement : u_B that it is sized for [mm].
    group : name of the group of lines that it is for; empty where there is only one.
    """

    bearing: Bearing
    stiffness: float
    damping: float
    displacement: float
    group: str = ""


def with_side(template: Bearing, side: float, layers: int) -> Bearing:
    """The template with another square plan and number of layers; its compound stays.

    Parameters
    ----------
    template : a layered bearing with a square plan.
    side : of the plan [mm], its square larger than the lead.
    layers : number of rubber layers, >= 1.

    Returns
    -------
    Bearing, not checked again: quick, for a search.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> with_side(load_bearing("shen-hdr-bridge"), 400.0, 5).name
    'hdr-400-5x17'
    """
    plan = template.geometry.plan.model_copy(update={"side": side})
    geometry = template.geometry.model_copy(update={"plan": plan, "rubber_layers": layers})
    return resized(template, geometry).model_copy(
        update={
            "name": f"{template.kind.lower()}-{side:g}-{layers}x{geometry.rubber_thickness:g}",
            "description": f"{template.name} scaled to the stiffness of a design",
        }
    )


def equal_bearing(
    template: Bearing | str | Path,
    stiffness: float,
    displacement: float,
    design_strain: float = 1.75,
) -> EqualBearing:
    """A bearing of the template's rubber, layers and lead with a given K_B.

    As many layers as keep the design strain; the side of the square plan follows from K_B, in
    steps of 5 mm; the rest follows from the compound (bearing/scaling.py).

    Parameters
    ----------
    template : a layered bearing with a square plan: a Bearing, a library name, or a TOML file.
    stiffness : K_B [kN/mm], > 0.
    displacement : design displacement u_B [mm], > 0.
    design_strain : largest strain, u_B over total rubber thickness, > 0.

    Returns
    -------
    EqualBearing

    Raises
    ------
    InputError : a number out of range, a plan that is not square, more than 200 layers, or no plan
        between the lead and 5 m has that stiffness.

    Examples
    --------
    >>> found = equal_bearing("shen-hdr-bridge", 2.6153, 178.0)
    >>> found.bearing.area**0.5, found.bearing.geometry.rubber_layers
    (480.0, 6)
    """
    template = as_bearing(template, "template")
    for name, value, high in (
        ("stiffness", stiffness, 1e6),
        ("displacement", displacement, 1e5),
        ("design_strain", design_strain, 5.0),
    ):
        if isinstance(value, bool | str) or not 1e-6 <= value <= high:
            raise InputError(f"{name} = {value!r}: must be a number from 1e-06 to {high:g}")
    if template.geometry.plan.shape != "square":
        raise InputError(f"{template.name}: only square plans are scaled")
    thickness = template.geometry.rubber_thickness
    layers = max(1, math.ceil(displacement / (design_strain * thickness) - 1e-9))
    if layers > MOST_LAYERS:
        raise InputError(
            f"a displacement of {displacement:g} mm takes {layers} layers of {thickness:g} mm; at "
            f"most {MOST_LAYERS} make sense"
        )
    strain = displacement / (layers * thickness)
    low, high = math.sqrt(1.02 * template.lead_area) + ROUNDING, 5000.0
    softest, stiffest = (_stiffness(template, side, layers, strain) for side in (low, high))
    if not softest <= stiffness <= stiffest:
        raise InputError(
            f"{template.name}: no plan of {low:.0f} to {high:.0f} mm gives {stiffness:g} kN/mm"
        )
    for _ in range(TRIES):
        middle = 0.5 * (low + high)
        if _stiffness(template, middle, layers, strain) < stiffness:
            low = middle
        else:
            high = middle
        if high - low < 0.1:
            break
    side = ROUNDING * round(0.5 * (low + high) / ROUNDING)
    bearing = with_side(template, side, layers)
    measured = isothermal_cycle(bearing, strain)
    return EqualBearing(bearing, measured.stiffness_kN_mm, measured.h_eq, displacement)


def _stiffness(template: Bearing, side: float, layers: int, strain: float) -> float:
    return isothermal_cycle(with_side(template, side, layers), strain).stiffness_kN_mm


def third_cycle(bearing: Bearing, displacement: float) -> tuple[Floats, Floats]:
    """Displacement [mm] and force [kN] of a bearing's third cycle, from soaked, with heating.

    Parameters
    ----------
    bearing : layered.
    displacement : amplitude of the cycles [mm], > 0; the test begins at the reference
        temperature of the rubber.

    Returns
    -------
    displacement [mm] and force [kN] of the steps of the cycle.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> x, force = third_cycle(load_bearing("shen-hdr-bridge"), 178.0)
    >>> round(float(x.max())), bool(force.max() > 0.0)
    (178, True)
    """
    strain = displacement / bearing.total_rubber_thickness
    test = cyclic_test(strain=[strain], cycles=3, closing_strain=None)
    result = run(bearing, test, bearing.hysteresis.reference_temperature)
    last = np.flatnonzero(result["cycle"].values[0] == 3)
    return result["displacement"].values[0, last], result["force"].values[0, last]
