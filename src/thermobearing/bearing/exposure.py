"""Factors for long exposure to cold and for ageing.

The model covers the current temperature. Crystallization, which takes days, and ageing
are outside it (docs/exposure.md); factors from tests or a code are given here.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict

if TYPE_CHECKING:
    from thermobearing.bearing.bilinear import BilinearBearing
    from thermobearing.bearing.model import Bearing

Factor = Annotated[float, Field(ge=0.1, le=20)]
TWICE = "give it in the bearing's file or among the options, not both"


class Exposure(Strict):
    """Factors on a bearing's parameters at its reference temperature; 1 is as in the tests.

    The force at any displacement is then `stiffness` times its elastic and `strength` times its
    hysteretic part, if the temperatures are the same.

    Attributes
    ----------
    stiffness : factor on the elastic stiffness K_e = alpha_0 K_r of the rubber, K_2 of a bilinear
        bearing; in [0.1, 20].
    strength : factor on the hysteretic part: K_h = (1 - alpha_0) K_r, with the rubber's K_h d_y,
        sigma_Y and K_l of lead, Q_d and K_1 - K_2 of a bilinear bearing; in [0.1, 20]. Yield
        displacements and the rate branch stay.
    source : the source of the factors, in words; required unless both are 1.

    Examples
    --------
    >>> Exposure(stiffness=1.3, strength=1.4, source="our tests after 14 days").describe()
    'exposure: stiffness times 1.3 and strength times 1.4 (our tests after 14 days)'
    """

    stiffness: Factor = 1.0
    strength: Factor = 1.0
    source: str = ""

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        factors = [values.get(key, 1.0) for key in ("stiffness", "strength")]
        if any(value != 1.0 for value in factors) and not str(values.get("source", "")).strip():
            return ['give the source of the factors, source = "..."']
        return []

    @property
    def _is_neutral(self) -> bool:
        """Whether both factors are 1."""
        return self.stiffness == 1.0 and self.strength == 1.0

    def describe(self) -> str:
        """Return one line for console and summary."""
        return (
            f"exposure: stiffness times {self.stiffness:g} and strength times {self.strength:g} "
            f"({self.source})"
        )


def effective_exposure(
    bearing: "Bearing | BilinearBearing", option: Exposure | None
) -> Exposure | None:
    """Return the factors that apply to a bearing, its own or the option's; None if they are 1."""
    if bearing.exposure is not None and option is not None:
        raise InputError(f"exposure of {bearing.name}: {TWICE}")
    chosen = bearing.exposure or option
    return None if chosen is None or chosen._is_neutral else chosen


def exposures(
    bearings: Iterable["Bearing | BilinearBearing"], option: Exposure | None
) -> dict[str, Exposure]:
    """Return the factors that apply, by name of the bearing; empty if all are 1."""
    exposure_by_name = {bearing.name: effective_exposure(bearing, option) for bearing in bearings}
    return {name: factors for name, factors in exposure_by_name.items() if factors is not None}


def describe_all(factors: Mapping[str, Exposure]) -> list[str]:
    """Return one sentence for each bearing, for results."""
    return [f"{name}: {item.describe()}" for name, item in factors.items()]


def exposure_attribute(factors: Mapping[str, Exposure]) -> dict[str, Any]:
    """Return the factors as an attribute of a dataset; none if all are 1."""
    if not factors:
        return {}
    return {"exposure": {name: item.model_dump() for name, item in factors.items()}}


def exposed(bearing: "Bearing", option: Exposure | None = None) -> "Bearing":
    """Return the bearing with the factors applied to its parameters.

    `bearing`: layered; its own factors count, if it has some; `option`: factors given elsewhere.
    Return the same object if the factors are 1.
    """
    factors = effective_exposure(bearing, option)
    if factors is None:
        return bearing.model_copy(update={"exposure": None}) if bearing.exposure else bearing
    h = bearing.hysteresis
    # K_r and alpha_0 are stored; the factors are on alpha_0 K_r and (1 - alpha_0) K_r.
    elastic = factors.stiffness * h.post_yield_ratio * h.layer_stiffness
    hysteretic = factors.strength * (1.0 - h.post_yield_ratio) * h.layer_stiffness
    total = elastic + hysteretic
    numbers = {"layer_stiffness": total, "post_yield_ratio": elastic / total}
    update: dict[str, Any] = {"exposure": None, "hysteresis": h.model_copy(update=numbers)}
    if bearing.lead is not None:
        update["lead"] = bearing.lead.model_copy(
            update={
                "yield_stress": factors.strength * bearing.lead.yield_stress,
                "stiffness": factors.strength * bearing.lead.stiffness,
            }
        )
    return bearing.model_copy(update=update)


def exposed_bilinear(
    bearing: "BilinearBearing", option: Exposure | None = None
) -> "BilinearBearing":
    """Return a bilinear bearing with factors on K_2 and Q_d; its yield displacement stays.

    `bearing`: bilinear; its own factors count, if it has some; `option`: factors given elsewhere.
    """
    factors = effective_exposure(bearing, option)
    if factors is None:
        return bearing
    k1, k2 = bearing.initial_stiffness, bearing.post_yield_stiffness
    return bearing.model_copy(
        update={
            "exposure": None,
            "strength": factors.strength * bearing.strength,
            "post_yield_stiffness": factors.stiffness * k2,
            "initial_stiffness": factors.stiffness * k2 + factors.strength * (k1 - k2),
        }
    )
