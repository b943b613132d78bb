"""Plausibility of a bearing's parameters: detects errors of units and signs that pass the limits.

The limits of the fields reject values that the model cannot use. Values between them and the usual
range (data/plausible/bearing.toml) cause a warning that cites the source of the range.
"""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.quantities.warned import UNUSABLE, Warned


class Usual(Strict):
    """Usual values of one number of a bearing, and where they are from."""

    key: str  # of a bearing's file, or the name of a derived number
    lowest: str  # with its unit
    largest: str
    kinds: tuple[str, ...] = ()  # of bearings that it applies to; all if empty
    source: Annotated[str, Field(min_length=1)]
    note: Annotated[str, Field(min_length=1)]
    slip: Annotated[str, Field(min_length=1)]  # the usual cause of a value outside

    @property
    def unit(self) -> str:
        """Of both ends; empty for a pure number."""
        return self.lowest.partition(" ")[2]

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and largest as numbers in that unit."""
        low, high = (float(text.partition(" ")[0]) for text in (self.lowest, self.largest))
        return low, high


class Usuals(Strict):
    """Content of the data file."""

    usual: list[Usual]


def usual_values(name: str = "bearing.toml") -> list[Usual]:
    """Return the usual ranges of the package.

    `name`: of the file in data/plausible: "bearing.toml" or "structure.toml".
    """
    return read_data(Usuals, "plausible", name).usual


def implausible(bearing: Bearing | BilinearBearing) -> list[Warned]:
    """Return a sentence for each parameter of a bearing outside its usual range.

    It states key, value, usual range with its source, and the usual cause. Two temperature laws
    that multiply give a sentence too.
    """
    layered = isinstance(bearing, Bearing)
    derived = _derived(bearing) if isinstance(bearing, Bearing) else _of_bilinear(bearing)
    sentences: list[Warned] = []
    for usual in usual_values():
        if usual.kinds and bearing.kind not in usual.kinds:
            continue
        value = derived.get(usual.key)
        if value is None and layered:
            value = _value(bearing, usual.key)
        low, high = usual.ends
        if value is None or low <= value <= high or _does_nothing(bearing, usual.key, value):
            continue
        sentences.append(unusual(usual.key, value, usual))
    return sentences + (doubled_law(bearing) if isinstance(bearing, Bearing) else [])


def doubled_law(bearing: Bearing) -> list[Warned]:
    """Return a warning if a table or a registered law multiplies exponents that act too."""
    law, rubber = bearing.temperature_law, bearing.hysteresis
    m_t, n_t = rubber.elastic_temperature_coefficient, rubber.hysteretic_temperature_coefficient
    if law is None or not law.scales_stiffness or m_t == n_t == 0.0:
        return []
    sentence = (
        f"temperature_law and the exponents m_T = {m_t:g} and n_T = {n_t:g} multiply each other; "
        "set both exponents to 0 if temperature_law is the complete law"
    )
    return [Warned(sentence, "two_temperature_laws")]


def unusual(what: str, value: float, usual: Usual) -> Warned:
    """Return the warning for a value outside its usual range.

    `what`: label of the parameter; `value`: in the unit of the range.

    >>> unusual("layer", 200.0, usual_values()[0])[:47]
    'layer = 200 mm: the usual range is 1.5 to 40 mm'
    """
    low, high = usual.ends
    unit = f" {usual.unit}" if usual.unit else ""
    sentence = (
        f"{what} = {value:.4g}{unit}: the usual range is {low:g} to {high:g}{unit} "
        f"({usual.source}: {usual.note}). Usual cause: {usual.slip}"
    )
    return Warned(sentence, f"unusual.{what}", UNUSABLE)


def _value(item: Any, key: str) -> float | None:
    """Return a number by its dotted key; None where the bearing has no such part."""
    for name in key.split("."):
        item = getattr(item, name, None)
    return None if item is None else float(item)


def _does_nothing(bearing: Bearing | BilinearBearing, key: str, value: float) -> bool:
    """Return whether a value is a placeholder: the law is in a table, or the rubber is linear."""
    if not isinstance(bearing, Bearing):
        return False
    law = bearing.temperature_law
    if key.endswith("temperature_coefficient") and value == 0.0:
        return law is not None and law.scales_stiffness
    # Linear rubber has no hysteretic part, so that its parameters have no effect.
    hysteretic = key.startswith(("yield strain", "hysteresis.hysteretic"))
    return hysteretic and bearing.hysteresis.post_yield_ratio == 1.0


def _derived(bearing: Bearing) -> Mapping[str, float]:
    """Return parameters derived from several keys."""
    g, h = bearing.geometry, bearing.hysteresis
    modulus = h.layer_stiffness * g.rubber_thickness / bearing.area * NEWTON_PER_KILONEWTON
    numbers = {
        "first shape factor S1": g.first_shape_factor,
        "second shape factor S2": g.second_shape_factor,
        "shear modulus K_r t_r / A": modulus,
        "yield strain d_y / t_r": h.yield_displacement / g.rubber_thickness,
    }
    if bearing.lead is not None:
        stiffness = bearing.lead.stiffness * NEWTON_PER_KILONEWTON
        modulus = stiffness * bearing.total_rubber_thickness / bearing.lead.core_area
        numbers["shear modulus of a lead core K_l H / A_l"] = modulus
    if bearing.rate is not None:
        numbers["relaxation time c_v / K_v"] = bearing.rate.damping / bearing.rate.stiffness
    return numbers


def _of_bilinear(bearing: BilinearBearing) -> Mapping[str, float]:
    """Return derived parameters of a backbone."""
    first, second = bearing.initial_stiffness, bearing.post_yield_stiffness
    return {
        "total_rubber_thickness": bearing.total_rubber_thickness,
        "K_1 / K_2": first / second,
        "yield displacement Q_d / (K_1 - K_2)": bearing.strength / (first - second),
    }
