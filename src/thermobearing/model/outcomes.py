"""Outcomes of an analysis, and the limits at which it ends."""

from typing import Annotated, Final

import numpy as np

from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, in_unit
from thermobearing.core.march import is_possible
from thermobearing.core.plane import plain
from thermobearing.core.types import (
    COMPLETED,
    EULER_UNSTABLE,
    NOT_CONVERGED,
    NOT_FINITE,
    SOFTENED,
    TEMPERATURE_RUNAWAY,
    Constants,
    Limits,
    State,
)

INTERRUPTED: Final = "interrupted"
NOT_PHYSICAL: Final = "not_physical"
PIER_BEYOND_LIMIT: Final = "pier_beyond_limit"
NAMES: Final = {
    COMPLETED: "completed",
    SOFTENED: "completed",
    NOT_CONVERGED: "layer_forces_not_converged",
    NOT_FINITE: "not_finite",
    EULER_UNSTABLE: "euler_unstable",
    TEMPERATURE_RUNAWAY: "temperature_runaway",
}
SENTENCES: Final = {
    "completed": "The analysis was completed.",
    "layer_forces_not_converged": (
        "The layer forces did not converge in a step. Try a smaller dt, or integrator exact."
    ),
    "not_finite": (
        "A force or temperature became infinite or undefined. Try a smaller dt and check the "
        "units of the bearing file."
    ),
    "euler_unstable": (
        "The explicit Euler integration of Z is unstable. Try a smaller dt, or integrator exact."
    ),
    "temperature_runaway": (
        "A rubber layer left -273 to 400 degC (it decomposes) or the lead reached 327 degC (it "
        "melts). Try fewer cycles, a smaller amplitude or a slower motion, and check the units of "
        "stiffness, plan and heat capacity. With very stiff rubber, heat_source dissipation can "
        "cause this during holds."
    ),
    NOT_PHYSICAL: (
        "A bearing was strained beyond 500 % (it tears), a plate left -273 to 1500 degC, or the "
        "energy balance does not close. Check the units of stiffness, thicknesses, conductivities "
        "and temperature coefficients, and try a smaller dt."
    ),
    INTERRUPTED: "The run was interrupted; the results up to that time were saved.",
}
EQUAL_FORCES: Final = "equal_layer_forces"
SOFTENED_LAYERS: Final = "softened_layers"
SHARING_SENTENCES: Final = {
    EQUAL_FORCES: "All rubber layers carried the same force in every step.",
    SOFTENED_LAYERS: (
        "The tangent stiffness of a layer was not safely positive in some steps (large strain in "
        "the cold, just after reversal): there the hardening factor was taken partly at the mean "
        "strain; layer_force_mismatch_max_kN is the difference from the force of the layer law."
    ),
}


class TemperatureLimits(Strict):
    """Temperature limits of the data file [degC]."""

    absolute_zero: Annotated[float, in_unit("degC")]
    rubber_decomposes: Annotated[float, in_unit("degC")]
    lead_melts: Annotated[float, in_unit("degC")]
    steel_melts: Annotated[float, in_unit("degC")]


def _temperature_limits() -> TemperatureLimits:
    return read_data(TemperatureLimits, "materials", "limits.toml")


def limits_of_a_step() -> Limits:
    """Return the limits that every step checks."""
    found = _temperature_limits()
    return Limits(
        coldest=found.absolute_zero, rubber=found.rubber_decomposes, lead=found.lead_melts
    )


def possible_temperatures() -> tuple[float, float]:
    """Return the lowest and highest possible temperature of any cell [degC]."""
    found = _temperature_limits()
    return found.absolute_zero, found.steel_melts


def is_physical(constants: Constants, state: State, recoverable_before: float = 0.0) -> bool:
    """Return whether every cell has a possible temperature and the energy balance closes.

    `recoverable_before` is the recoverable energy at the start [kN mm]. Only temperatures are
    checked where the balance cannot close: of the published scheme, and where the rounding of the
    temperature of a lead of endless heat capacity (the bilinear model) is a noticeable heat.
    """
    return bool(
        plain(is_possible, state)(
            np.ascontiguousarray(state.temperature),
            state.books,
            recoverable_before,
            *possible_temperatures(),
            not constants.lead.published and constants.viscous.heats,
        )
    )
