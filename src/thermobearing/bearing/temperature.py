"""What is known of a rubber's stiffness over its temperature: the range, and a table."""

from itertools import pairwise
from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.schema import Strict, in_unit

Celsius = Annotated[float, in_unit("degC"), Field(ge=-150, le=300)]
Factor = Annotated[float, Field(ge=1e-3, le=1e3)]
Factors = Annotated[list[Factor], Field(min_length=2, max_length=100)]


class TemperatureLaw(Strict):
    """Range of the law of Eq. 4.34, and a table that multiplies it.

    Attributes
    ----------
    coldest, warmest : temperatures of the rubber in the tests that the law was identified on
        [degC]; those of the table if not given.
    temperatures : of the table [degC], growing.
    elastic, hysteretic : factors on the two stiffness terms there; between them a monotone cubic in
        the logarithm, beyond them as steep as at the end. A table that is the whole law goes with
        m_T = n_T = 0.

    Examples
    --------
    >>> TemperatureLaw(temperatures=[-20, 40], elastic=[1.4, 0.9], hysteretic=[2, 0.8]).range
    (-20.0, 40.0)
    """

    coldest: Celsius | None = None
    warmest: Celsius | None = None
    temperatures: Annotated[list[Celsius], Field(min_length=2, max_length=100)] | None = None
    elastic: Factors | None = None
    hysteretic: Factors | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """Half a range, half a table, or a table out of order."""
        found = []
        table = [name for name in ("temperatures", "elastic", "hysteretic") if name in given]
        if ("coldest" in given) != ("warmest" in given):
            found.append("give both coldest and warmest, or neither")
        if len(table) not in (0, 3):
            found.append("a table needs temperatures, elastic and hysteretic")
        elif len({len(given[name]) for name in table if isinstance(given[name], list)}) > 1:
            found.append("temperatures, elastic and hysteretic must be equally long")
        return found

    def model_post_init(self, context: Any) -> None:
        """What can be compared only when units are plain numbers."""
        values = self.temperatures or []
        if any(after <= before for before, after in pairwise(values)):
            raise ValueError("temperatures must grow from one to the next")
        if self.coldest is not None and self.warmest is not None and self.coldest >= self.warmest:
            raise ValueError("coldest must be below warmest")

    @property
    def range(self) -> tuple[float, float] | None:
        """Coldest and warmest temperature that the law is known at [degC]."""
        if self.coldest is not None and self.warmest is not None:
            return self.coldest, self.warmest
        if self.temperatures is not None:
            return self.temperatures[0], self.temperatures[-1]
        return None
