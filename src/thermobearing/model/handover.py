"""The state of a bearing at the end of a test: stored in results and cases, and used as a start.

It is core/types.State with names and units. Energies and the clock restart at zero; forces,
displacements, temperatures and the history variables of rubber and lead continue bit for bit.
A test in a plane also hands over what is across the direction x, and it can continue a test on a
line, whose direction is x.
"""

import math
from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, in_unit
from thermobearing.core.records import Floats
from thermobearing.core.types import DEPTH, NEVER_MOVED, Constants, State, new_state

# Limits of a state, in addition to core/types.Limits and those of the protocol.
MOST = 100_000  # layers, cells or terms
Degrees = Annotated[float, in_unit("degC"), Field(ge=-273.15, le=2000)]
Length = Annotated[float, in_unit("mm"), Field(ge=-1e6, le=1e6)]
Force = Annotated[float, in_unit("kN"), Field(ge=-1e9, le=1e9)]
Energy = Annotated[float, in_unit("kN mm"), Field(ge=-1e12, le=1e12)]
Excess = Annotated[float, in_unit("K"), Field(ge=-1e5, le=1e5)]
Time = Annotated[float, in_unit("s"), Field(ge=0, le=NEVER_MOVED)]
Share = Annotated[float, Field(ge=0, le=1)]
Many = Field(max_length=MOST)
PASSED = 2.0  # Z over d_y: exact integration never passes 1, explicit Euler may by a step
MISSED = 1e-8  # of the displacement: what layers of a converged step miss, with room

# Where each key of SpecimenState is in the records of the step, and its dimension in a dataset.
LAYERS = {
    "layer_displacement": "d",
    "layer_hysteretic": "z",
    "layer_stored": "stored",
    "layer_farthest": "farthest",
    "layer_virgin": "virgin",
}
BRANCHES = {
    "core_force": "core_force",
    "maxwell_force": "maxwell_force",
    "moving_for": "clock",
    "resting_for": "idle",
}
RESPONSE = ("displacement", "force", "rubber_force", "lead_force", "viscous_force", "recoverable")
# Turning points of each layer, the newest first, filled up with zeros; where small loops close.
TURNS = {"turn_displacement": "d", "turn_hysteretic": "z"}
COUNT = "layer_turns"
ENDS = "lead_terms"
MEMORY = (*LAYERS, *BRANCHES, *RESPONSE, ENDS)
OF_LOOPS = (COUNT, *TURNS)
# Dataset dimension of each history variable that is no scalar.
DIMENSIONS = {**dict.fromkeys([*LAYERS, COUNT], "layer"), **dict.fromkeys(TURNS, "turn")}
DIMENSIONS[ENDS] = "lead_term"
PREFIX = "state_"  # of the variables in a dataset


class AcrossState(Strict):
    """The components across (y) of a state in a plane, by key of `SpecimenState`."""

    layer_displacement: Annotated[list[Length], Many]
    layer_hysteretic: Annotated[list[Length], Many]
    core_force: Force
    maxwell_force: Force
    displacement: Length
    force: Force
    rubber_force: Force
    lead_force: Force
    viscous_force: Force


ACROSS = tuple(AcrossState.model_fields)  # what has a component across in a plane


class SpecimenState(Strict):
    """The state of a bearing at the end of an earlier test.

    Attributes
    ----------
    temperature : of each cell, upper face first [degC].
    lead_temperature : of the lead [degC].
    layer_displacement, layer_hysteretic : d and Z of each modelled rubber layer [mm].
    layer_stored : recoverable energy of one layer [kN mm].
    layer_farthest, layer_virgin : history variables of virgin rubber [mm], [1].
    core_force, maxwell_force : of one core, of the rate-dependent branch [kN].
    moving_for, resting_for : clock of the lead [s].
    lead_terms : excess temperatures of the terms of the lead's ends [K].
    layer_turns : number of turning points of each layer, 0 to 12, where small loops close.
    turn_displacement, turn_hysteretic : d and Z there [mm], the newest first and filled up with
        zeros, 12 of each layer.
    displacement, force : of the bearing [mm], [kN].
    rubber_force, lead_force, viscous_force : shares of the force [kN].
    recoverable : recoverable energy [kN mm].
    zero : displacement [mm] at which the instruments of the next test read zero; 0 by default.
    across : the components across (y) after a test in a plane; the others are those along x.

    Give either all of them (turning points, `zero` and `across` are optional) or temperatures
    alone.
    Without turning points a run with closed small loops begins with none.
    """

    temperature: Annotated[list[Degrees], Field(min_length=1, max_length=MOST)]
    lead_temperature: Degrees | None = None
    layer_displacement: Annotated[list[Length], Many] | None = None
    layer_hysteretic: Annotated[list[Length], Many] | None = None
    layer_stored: Annotated[list[Energy], Many] | None = None
    layer_farthest: Annotated[list[Length], Many] | None = None
    layer_virgin: Annotated[list[Share], Many] | None = None
    core_force: Force | None = None
    maxwell_force: Force | None = None
    moving_for: Time | None = None
    resting_for: Time | None = None
    displacement: Length | None = None
    force: Force | None = None
    rubber_force: Force | None = None
    lead_force: Force | None = None
    viscous_force: Force | None = None
    recoverable: Energy | None = None
    lead_terms: Annotated[list[Excess], Many] | None = None
    zero: Length | None = None
    across: AcrossState | None = None
    layer_turns: Annotated[list[Annotated[int, Field(ge=0, le=DEPTH)]], Many] | None = None
    turn_displacement: Annotated[list[Length], Many] | None = None
    turn_hysteretic: Annotated[list[Length], Many] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        lacking = [name for name in MEMORY if name not in values]
        turns = [name for name in OF_LOOPS if name not in values]
        # Temperatures alone are a state too: of a bearing that has not moved.
        if len(lacking) == len(MEMORY) and "across" not in values:
            lacking = []
        if 0 < len(turns) < len(OF_LOOPS):
            lacking += turns
        if not lacking:
            return []
        return [f"the state is incomplete; missing: {', '.join(lacking)}"]

    @property
    def complete(self) -> bool:
        """Return whether history variables are present, not only temperatures."""
        return self.layer_displacement is not None

    @property
    def at(self) -> float:
        """Displacement of the bearing along x [mm]."""
        return self.displacement or 0.0

    @property
    def reads(self) -> float:
        """Displacement along x that the instruments of the next test read [mm]."""
        return self.at - (self.zero or 0.0)

    def in_plane(self, key: str) -> Any:
        """Return a value of the state with the components along and across as its last axis."""
        along = np.array(getattr(self, key))
        if key not in ACROSS:
            return along
        across = np.zeros_like(along) if self.across is None else getattr(self.across, key)
        return np.stack([along, across], axis=-1)


def state_memory(state: State) -> dict[str, Any]:
    """Return the history variables of a state without temperatures, by key of `SpecimenState`.

    In a plane those of `ACROSS` have both components as their last axis.
    """
    memory: dict[str, Any] = {key: state.layers[name].copy() for key, name in LAYERS.items()}
    memory |= {key: state.branches[name][0].copy() for key, name in BRANCHES.items()}
    memory |= {name: state.response[name][0].copy() for name in RESPONSE}
    if state.turns.shape[1]:
        memory[COUNT] = state.layers["turns"].astype(int)
        # Entries beyond the count are left from earlier motions.
        used = np.arange(DEPTH) < memory[COUNT][:, np.newaxis]
        memory |= {
            key: (used * state.turns[name][:, :DEPTH]).ravel() for key, name in TURNS.items()
        }
    return memory | {ENDS: state.ends.copy()}


def specimen_state(
    temperature: Floats, lead: float, memory: Mapping[str, Any] | None
) -> SpecimenState:
    """Return a `SpecimenState` of temperatures [degC] (NaN without lead) and history variables."""
    values = {key: np.asarray(value).tolist() for key, value in (memory or {}).items()}
    if memory is not None and np.ndim(memory["displacement"]):
        pairs = {key: np.moveaxis(np.asarray(memory[key]), -1, 0).tolist() for key in ACROSS}
        values |= {key: along for key, (along, _) in pairs.items()}
        values["across"] = {key: across for key, (_, across) in pairs.items()}
    values["temperature"] = np.asarray(temperature).tolist()
    if not math.isnan(lead):
        values["lead_temperature"] = float(lead)
    return SpecimenState(**values)


def begun_from(
    specimen: SpecimenState, constants: Constants, lead: float | None = None, components: int = 1
) -> State:
    """Return the state of a bearing that continues from a test; its energies restart at zero.

    `constants`: of the same bearing and model; `lead`: temperature of the lead [degC],
    instead of the given one. With two components a test on a line was along x.
    """
    fault = misfit(specimen, constants, components)
    if fault:
        raise InputError(f"initial_state: {fault}")
    lead = specimen.lead_temperature if lead is None else lead
    state = new_state(constants, np.array(specimen.temperature), lead, components)
    if specimen.complete:
        read = specimen.in_plane if components == 2 else partial(getattr, specimen)
        for key, name in LAYERS.items():
            state.layers[name] = read(key)
        for key, name in BRANCHES.items():
            state.branches[name] = read(key)
        for name in RESPONSE:
            state.response[name] = read(name)
        state.ends[:] = specimen.lead_terms
        if components == 1:
            state.layers["heading"] = np.sign(state.layers["z"])  # as after a first loading
    # A run with open loops has no use for turning points, and forgets them.
    if specimen.layer_turns is not None and constants.rubber.closed_loops:
        state.layers["turns"] = specimen.layer_turns
        for key, name in TURNS.items():
            state.turns[name][:, :DEPTH] = np.reshape(getattr(specimen, key), (-1, DEPTH))
        for j, count in enumerate(specimen.layer_turns):
            # Not stored, since they follow from the points: amplitude, and the sign of the last
            # motion.
            outermost = state.turns["z"][j, count - 1] if count else 0.0
            state.layers["amplitude"][j] = abs(outermost)
            if count:
                state.layers["heading"][j] = np.sign(state.layers["d"][j] - state.turns["d"][j, 0])
    return state


def misfit(specimen: SpecimenState, constants: Constants, components: int = 1) -> str:
    """Return why a bearing cannot start from this state; empty if it can."""
    if specimen.across is not None and components == 1:
        return (
            "is of a test in a plane; continue in a plane (a test along x: a recorded history with "
            "displacement_y_mm = 0), or give its temperatures alone"
        )
    layer_count = len(constants.multiplicity)
    counts = [("temperatures", "cells", len(specimen.temperature), len(constants.cells.capacity))]
    if specimen.complete:
        sizes = [len(specimen.in_plane(key)) for key in LAYERS]
        if specimen.across is not None:
            sizes += [len(getattr(specimen.across, key)) for key in ACROSS[:2]]
        layers = [("layers", "modelled layers", size, layer_count) for size in sizes]
        terms = len(specimen.lead_terms or [])
        counts += [*layers, ("lead_terms", "terms of lead", terms, len(constants.lead_modes))]
    if specimen.layer_turns is not None:
        counts.append(("layer_turns", "modelled layers", len(specimen.layer_turns), layer_count))
        turn_count = DEPTH * layer_count
        counts += [
            (key, "turning points", len(getattr(specimen, key)), turn_count) for key in TURNS
        ]
    for quantity, model_quantity, count, expected in counts:
        if count != expected:
            return (
                f"has {count} {quantity}, but the model has {expected} {model_quantity}; continue "
                "with the model, stack, scheme and lead_ends of the earlier test"
            )
    if specimen.complete:
        moved, at = specimen.in_plane("layer_displacement"), specimen.in_plane("displacement")
        z = np.hypot(*specimen.in_plane("layer_hysteretic").T)
        z = np.array([0.0, *z, *np.abs(specimen.turn_hysteretic or [])])
        yields = constants.rubber.yield_displacement
        if z.max() > PASSED * yields:
            return f"layer_hysteretic reaches {z.max():g} mm; it ends at d_y = {yields:g} mm"
        # Layers at their displacements must add up to that of the bearing, as in any converged
        # step.
        scale = max(1.0, float((constants.multiplicity @ np.abs(moved)).max()))
        if np.abs(constants.multiplicity @ moved - at).max() > MISSED * scale:
            return "layer_displacement does not add up to displacement"
    return ""
