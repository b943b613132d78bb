"""What a bearing was tested at: the range in which its parameters are known to hold."""

from typing import Annotated, Any, Protocol

from pydantic import Field

from thermobearing.border.schema import Strict, in_unit

Ends = Field(min_length=2, max_length=2)
Strain = Annotated[float, Field(ge=0, le=10)]
Rate = Annotated[float, in_unit("1/s"), Field(ge=0, le=1e4)]
Celsius = Annotated[float, in_unit("degC"), Field(ge=-150, le=400)]
Count = Annotated[float, Field(ge=0, le=1e6)]


class Validity(Strict):
    """Lowest and highest value of each quantity in the tests behind a bearing's parameters.

    What is left out is not known; the temperatures of the rubber stand in `temperature_law`.

    Attributes
    ----------
    strain : largest shear strain of a test, as a share: 2.5 is 250 %, in [0, 10].
    strain_rate : largest speed of a test over the total rubber thickness [1/s], in [0, 1e4].
    ambient : temperature of the air [degC], in [-150, 400].
    cycles : of at least half the largest strain, in a row without a rest, in [0, 1e6].
    lead_temperature : of the lead cores [degC], in [-150, 400].

    Examples
    --------
    >>> Validity(strain=[0.5, 2.5], ambient=[-20, 23]).ranges()
    {'strain': (0.5, 2.5), 'ambient': (-20.0, 23.0)}
    """

    strain: Annotated[list[Strain], Ends] | None = None
    strain_rate: Annotated[list[Rate], Ends] | None = None
    ambient: Annotated[list[Celsius], Ends] | None = None
    cycles: Annotated[list[Count], Ends] | None = None
    lead_temperature: Annotated[list[Celsius], Ends] | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """A range without a quantity says nothing."""
        if set(given) & set(cls.model_fields):
            return []
        return [f"give one of {', '.join(cls.model_fields)} at least, as [lowest, highest]"]

    def model_post_init(self, context: Any) -> None:
        """What can be compared only when units are plain numbers."""
        for name, (low, high) in self.ranges().items():
            if low > high:
                raise ValueError(f"{name}: {low:g} is above {high:g}; write [lowest, highest]")

    def ranges(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest value of each quantity that is known."""
        known = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: (ends[0], ends[1]) for name, ends in known.items() if ends is not None}


class Tested(Protocol):
    """Whatever bearing may say what it was tested at."""

    @property
    def tested_range(self) -> Validity | None:
        """None where it is not given."""


def ranges_of(bearing: Tested) -> dict[str, tuple[float, float]] | None:
    """Of a bearing, lowest and highest value by quantity; None where its file gives none."""
    return None if bearing.tested_range is None else bearing.tested_range.ranges()
