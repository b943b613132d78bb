"""Outcomes of an analysis, and the limits at which it ends."""

from functools import cache
from typing import Annotated, Final

import numpy as np
from pydantic import Field

from thermobearing.border.library import data_path, read_data
from thermobearing.border.schema import Strict, in_unit
from thermobearing.border.toml import read_toml
from thermobearing.core.march import LEAST, MISSING, is_possible
from thermobearing.core.plane import plain
from thermobearing.core.types import (
    COMPLETED,
    EULER_UNSTABLE,
    LEAD_MELTED,
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
MELTED: Final = "lead_melted"
PIER_BEYOND_LIMIT: Final = "pier_beyond_limit"
NAMES: Final = {
    COMPLETED: "completed",
    SOFTENED: "completed",
    NOT_CONVERGED: "layer_forces_not_converged",
    NOT_FINITE: "not_finite",
    EULER_UNSTABLE: "euler_unstable",
    TEMPERATURE_RUNAWAY: "temperature_runaway",
    LEAD_MELTED: MELTED,
}
_TEXTS = read_toml(data_path("reports", "outcomes.toml"))
SENTENCES: Final[dict[str, str]] = _TEXTS["analysis"]
ALL_SENTENCES: Final = SENTENCES | _TEXTS["structure"]
SHARING_SENTENCES: Final[dict[str, str]] = _TEXTS["layer_forces"]


class TemperatureLimits(Strict):
    """Temperature limits of the data file [degC], and the share that is near one."""

    absolute_zero: Annotated[float, in_unit("degC")]
    rubber_decomposes: Annotated[float, in_unit("degC")]
    lead_melts: Annotated[float, in_unit("degC")]
    lead_near_melting: Annotated[float, Field(gt=0, lt=1)]  # share of `lead_melts`
    steel_melts: Annotated[float, in_unit("degC")]


@cache
def temperature_limits() -> TemperatureLimits:
    """Return the limits of materials."""
    return read_data(TemperatureLimits, "materials", "limits.toml")


def limits_of_a_step() -> Limits:
    """Return the limits that every step checks."""
    limits = temperature_limits()
    return Limits(
        coldest=limits.absolute_zero, rubber=limits.rubber_decomposes, lead=limits.lead_melts
    )


def possible_temperatures() -> tuple[float, float]:
    """Return the lowest and highest possible temperature of any cell [degC]."""
    limits = temperature_limits()
    return limits.absolute_zero, limits.steel_melts


def is_physical(constants: Constants, state: State, recoverable_before: float = 0.0) -> bool:
    """Return whether every cell has a possible temperature and the energy balance closes.

    `recoverable_before` is the recoverable energy at the start [kN mm]. Only temperatures are
    checked where the balance cannot close: of the published scheme, and where the rounding of the
    temperature of a lead of endless heat capacity (the bilinear model) is a noticeable heat.
    """
    lead = constants.lead
    rounding = lead.cores * lead.capacity * np.spacing(abs(state.branches[0].lead_temperature))
    noticeable = rounding > MISSING * LEAST
    return bool(
        plain(is_possible, state)(
            np.ascontiguousarray(state.temperature),
            state.books,
            recoverable_before,
            *possible_temperatures(),
            not lead.published and constants.viscous.heats and not noticeable,
        )
    )
