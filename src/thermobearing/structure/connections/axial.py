"""The table of axial forces of a bearing line."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from thermobearing.border.schema import Strict, in_unit
from thermobearing.model.axial import DOWELLED, DOWELS_NEEDED, DowelLength, Joint
from thermobearing.structure.fields import Force, Length, Stiffness

ONE_OR_SEVERAL = BeforeValidator(lambda load: load if isinstance(load, list | tuple) else (load,))


class AxialTable(Strict):
    """Axial forces of the bearings of a line, and the section of the deck that they carry.

    Attributes
    ----------
    dead_load : on each bearing [kN], in [0.001, 1e6]: one number, or a list of `count`.
    places : of the bearings across the bridge, from the place of the line [mm]; a list of `count`,
        needed from `axial = "overturning"` on.
    deck_height : of the inertia above mid-height of the bearings [mm]; by default the height of the
        masses of `body` less `height` of the line.
    joint : "bolted" (default): rubber cavitates in tension; or "dowelled": bearings lift.
    dowel_length : uplift at which dowels come out [mm]; without it no uplift is a failure.
    mass : that moves vertically [kN s2/mm]; by default the dead loads over gravity.
    damping_ratio : of the vertical motion on the bearings, 0.03 by default (assumed).
    span_stiffness : vertical, of the spans between the mass and the line [kN/mm]; by default the
        deck is rigid.
    roll_inertia : mass moment of inertia of the deck over the line about its axis along the bridge
        [kN mm s2]; by default the roll is static.
    across : whether a structure that is not in plan is a transverse one, so that the shear of the
        line overturns the section; false by default.
    """

    dead_load: Annotated[tuple[Force, ...], ONE_OR_SEVERAL, Field(min_length=1)]
    places: Annotated[tuple[Length, ...], Field(min_length=1)] | None = None
    deck_height: Annotated[float, in_unit("mm"), Field(gt=0, le=1e6)] | None = None
    joint: Joint = "bolted"
    dowel_length: DowelLength | None = None
    mass: Annotated[float, in_unit("kN s^2/mm"), Field(ge=1e-6, le=1e5)] | None = None
    damping_ratio: Annotated[float, Field(ge=0, lt=1)] = 0.03
    span_stiffness: Stiffness | None = None
    roll_inertia: Annotated[float, in_unit("kN mm s^2"), Field(gt=0, le=1e12)] | None = None
    across: bool | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, object]) -> list[str]:
        if "dowel_length" in values and values.get("joint") != DOWELLED:
            return [DOWELS_NEEDED]
        return []

    def dead_loads(self, count: int) -> tuple[float, ...]:
        """Return the dead load on each of `count` bearings [kN]."""
        return self.dead_load * count if len(self.dead_load) == 1 else self.dead_load
