"""Outcomes of an analysis, and the limits at which it ends."""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Any, Final

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
from thermobearing.quantities.words import number, quantity

INTERRUPTED: Final = "interrupted"
NOT_PHYSICAL: Final = "not_physical"
MELTED: Final = "lead_melted"
UNSTABLE: Final = "unstable"
UPLIFT: Final = "uplift"
CAVITATED: Final = "cavitated"
PIER_BEYOND_LIMIT: Final = "pier_beyond_limit"
# Outcomes of a limit that was passed: the run goes on, if it can, and is no early end.
PASSED_LIMITS: Final = (UNSTABLE, UPLIFT, CAVITATED, PIER_BEYOND_LIMIT)
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
AXIAL_SENTENCES: Final[dict[str, str]] = _TEXTS["axial"]
ALL_SENTENCES: Final = SENTENCES | _TEXTS["structure"]  # without those of axial forces
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
    noticeable = False
    if lead.cores > 0.0:
        finest = np.spacing(abs(state.branches["lead_temperature"][0]))
        noticeable = bool(lead.cores * lead.capacity * finest > MISSING * LEAST)
    return bool(
        plain(is_possible, state)(
            np.ascontiguousarray(state.temperature),
            state.response,
            recoverable_before,
            *possible_temperatures(),
            not lead.published and constants.viscous.heats and not noticeable,
        )
    )


@cache
def assumption_texts() -> Mapping[str, Any]:
    """Return the sentences on what the model assumes, by name."""
    return read_toml(data_path("reports", "assumptions.toml"))


def heat_flow(analysis: Mapping[str, Any], bearings: Sequence[Mapping[str, Any]]) -> str:
    """Return how heat flows through bearings and out of them, in a sentence."""
    texts = assumption_texts()
    films = {str(table["materials"].get("side_film", "0.0 W/(m^2 K)")) for table in bearings}
    values = sorted(float(film.split()[0]) for film in films)
    sides = texts["side_film"].format(film=" or ".join(number(v) for v in values))
    if values == [0.0]:
        sides = texts["no_sides"]
    if side := analysis.get("side"):
        cover = quantity(side.get("cover", "0 mm"))
        sides = texts["side_cover"].format(film=quantity(side["film"]), cover=cover)
    faces = []
    for name in ("upper", "lower"):
        face = analysis.get(f"{name}_face", {"eta": 2.0})
        if "eta" in face:
            faces.append(f"{name} η_B = {face['eta']:g} (1 adiabatic, 3 at ambient)")
        else:
            behind = face.get("heat_capacity")
            capacity_text = f" beyond {quantity(behind)}" if behind else ""
            faces.append(f"{name} film {quantity(face['film'])}{capacity_text}")
    text: str = texts["heat_flow"].format(sides=sides, faces=", ".join(faces))
    return text
