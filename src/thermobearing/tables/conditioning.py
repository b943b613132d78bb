"""How a specimen was brought to the temperature of its chamber, as keys of records and cases.

`cyclic/conditioning.py` computes the start temperatures from it.
"""

import re
from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.schema import Strict, in_unit

PLACE = re.compile(r"^(?:rubber ([1-9]\d*)|lead)$")  # of a thermocouple
NEEDED = "conditioned"

Temperature = Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]


class Conditioning(Strict):
    """How long a specimen was in its chamber, and what is known of its temperature.

    Attributes
    ----------
    conditioned : time in the chamber before the test [h], in (0, 10000]; the cells then start at
        temperatures of the soaking model instead of that of the chamber.
    before : uniform temperature of the specimen when it came into the chamber [degC], in
        [-100, 100]; 23 degC by default.
    inside : reading of a thermocouple in the specimen when the test begins [degC], between
        `before` and the temperature of the chamber; the model is then taken at the time at which
        it has this temperature at `inside_place`.
    inside_place : place of that thermocouple, "rubber 1" (the outer layer), "rubber 2", ... or
        "lead"; the layer nearest to the middle of the bearing by default.
    chamber_film : film coefficient between specimen and air of the chamber [W/(m^2 K)], in
        (0, 1000]; 12 by default.

    Examples
    --------
    >>> Conditioning(conditioned="6 h", before="23 degC").conditioned
    6.0
    """

    conditioned: Annotated[float, in_unit("h"), Field(gt=0, le=10_000)] | None = None
    before: Temperature | None = None
    inside: Temperature | None = None
    inside_place: str | None = None
    chamber_film: Annotated[float, in_unit("W/(m^2 K)"), Field(gt=0, le=1000)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        keys = [key for key in Conditioning.model_fields if key in values]
        faults = []
        if keys and NEEDED not in keys:
            faults.append(f'{keys[0]}: needs the time in the chamber, {NEEDED} = "... h"')
        place = values.get("inside_place")
        if place is not None and not (isinstance(place, str) and PLACE.match(place)):
            faults.append(f'inside_place = {place!r}: must be "rubber 1", ... or "lead"')
        if place is not None and "inside" not in keys:
            faults.append('inside_place: needs the reading, inside = "... degC"')
        return faults

    @property
    def conditioning(self) -> "Conditioning | None":
        """These keys alone; None if the time in the chamber is not stated."""
        if self.conditioned is None:
            return None
        return Conditioning(**{name: getattr(self, name) for name in Conditioning.model_fields})
