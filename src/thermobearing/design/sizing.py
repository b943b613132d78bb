"""Design rubber, the size of a bearing round by round, layered bearings of the same stiffness."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import scipy
from pydantic import Field

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import resized
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import read_data
from thermobearing.border.schema import RATIO, Strict, in_unit
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import isothermal_cycle, solve_backbone
from thermobearing.cyclic.protocol import cyclic_test
from thermobearing.cyclic.run import run
from thermobearing.model.checks import Check
from thermobearing.model.earlier import BilinearParameters
from thermobearing.results.sums import sum_of_products

# The rubber: JRA equivalent linearisation of high damping rubber (Eq. 6.1-6.3).
Kind = Literal["HDR", "HDR-S"]


class DesignRubber(Strict):
    """Coefficients of one rubber: G_e [MPa] and h_B by powers of the design shear strain."""

    name: str
    kind: Kind
    shear_modulus: Annotated[list[float], Field(min_length=1)]
    damping_ratio: Annotated[list[float], Field(min_length=1)]
    note: str = ""


class Curves(Strict):
    """The file of design curves, with the strains it may be used for."""

    citation: str
    smallest_strain: Annotated[float, Field(ge=0)]
    largest_strain: Annotated[float, Field(gt=0)]
    compounds: list[DesignRubber]


def load_curves() -> Curves:
    """Return the design curves shipped with the package."""
    return read_data(Curves, "rubber", "jra-hdr.toml")


def load_rubber(name: str, kind: Kind = "HDR") -> DesignRubber:
    """Return a compound by name and kind."""
    compounds = {item.name: item for item in load_curves().compounds if item.kind == kind}
    if name in compounds:
        return compounds[name]
    wrong, names = (name, list(compounds)) if compounds else (kind, ["HDR", "HDR-S"])
    raise InputError(f'no {kind} rubber is called "{wrong}"{nearest(wrong, names)}')


def _powers(strain: float, count: int) -> Floats:
    """Return powers of a strain, if the curves may be used for it."""
    curves = load_curves()
    if not curves.smallest_strain <= strain <= curves.largest_strain:
        raise InputError(
            f"design shear strain {strain:.3g}: the curves are for {curves.smallest_strain:g} to "
            f"{curves.largest_strain:g}; choose a thicker or thinner bearing"
        )
    return np.asarray(strain ** np.arange(count))


def shear_modulus(compound: DesignRubber, strain: float) -> float:
    """Return design equivalent shear modulus G_e [MPa] at a design shear strain (Eq. 6.2)."""
    return sum_of_products(compound.shear_modulus, _powers(strain, len(compound.shear_modulus)))


def damping_ratio(compound: DesignRubber, strain: float) -> float:
    """Return design equivalent damping ratio h_B at a design shear strain (Eq. 6.3)."""
    return sum_of_products(compound.damping_ratio, _powers(strain, len(compound.damping_ratio)))


def equivalent_stiffness(
    compound: DesignRubber, area: float, total_rubber_thickness: float, displacement: float
) -> float:
    """Return K_B = G_e A_e / sum t_e (Eq. 6.1) [kN/mm]."""
    modulus = shear_modulus(compound, displacement / total_rubber_thickness)
    return modulus * area / total_rubber_thickness / NEWTON_PER_KILONEWTON


def equivalent_bilinear(
    stiffness: float, damping: float, displacement: float, stiffness_ratio: float
) -> BilinearParameters:
    """Return the bilinear model of an equivalent stiffness and damping ratio at a displacement."""
    parameters = solve_backbone(stiffness, damping, displacement, stiffness_ratio)
    if parameters is None:
        raise InputError(
            f"no bilinear model with K_2/K_1 = {stiffness_ratio:g} has a damping ratio of "
            f"{damping:g}; try a smaller ratio"
        )
    return parameters


# The size of a bearing.
MOST_LAYERS = 60
STRAIN_LIMIT, DUCTILITY_LIMIT = 2.5, 3.0  # Table 3.4, section 6.3.3


class SizingRules(Strict):
    """How a bearing is sized; the defaults give the bearing of Shen (2023) for its displacement.

    As many layers as keep the design strain, then the smallest square plan (in full steps)
    with the second shape factor and under the stress. `strain_limit` and `ductility_limit` are
    what the largest strain and the pier's ductility are judged by, at every temperature.
    """

    layer_thickness: Annotated[float, in_unit("mm"), Field(ge=0.5, le=200)] = 14.0  # Table 6.1
    design_strain: Annotated[float, RATIO, Field(ge=0.05, le=2.5)] = 1.75
    second_shape_factor: Annotated[float, Field(ge=0.1, le=100)] = 5.0
    stress: Annotated[float, in_unit("MPa"), Field(ge=0.05, le=200)] = 6.0
    plan_step: Annotated[float, in_unit("mm"), Field(ge=1, le=1000)] = 50.0
    strain_limit: Annotated[float, RATIO, Field(ge=0.05, le=5)] = STRAIN_LIMIT
    ductility_limit: Annotated[float, Field(ge=0.1, le=20)] = DUCTILITY_LIMIT


@dataclass(frozen=True)
class Size:
    """A square bearing: side of the plan and thickness of a rubber layer [mm]."""

    side: float
    layers: int
    layer_thickness: float

    @property
    def area(self) -> float:
        """[mm2]"""
        return self.side**2

    @property
    def total_rubber_thickness(self) -> float:
        """[mm]"""
        return self.layers * self.layer_thickness

    @property
    def first_shape_factor(self) -> float:
        """Plan area over the free side area of one layer."""
        return self.side / (4.0 * self.layer_thickness)

    @property
    def second_shape_factor(self) -> float:
        """Side over total rubber thickness."""
        return self.side / self.total_rubber_thickness


def size_bearing(displacement: float, weight: float, rules: SizingRules) -> Size:
    """Return the smallest bearing that keeps the rules."""
    if not displacement > 0.0 or not weight > 0.0:
        raise InputError(f"displacement {displacement:g} mm and weight {weight:g} kN must be > 0")
    # 1e-9: rounding must not add a layer, nor a step, to a size that fits exactly.
    layers = max(1, math.ceil(displacement / (rules.design_strain * rules.layer_thickness) - 1e-9))
    if layers > MOST_LAYERS:
        raise InputError(
            f"a design displacement of {displacement:.0f} mm needs {layers} layers of "
            f"{rules.layer_thickness:g} mm; the limit is {MOST_LAYERS}"
        )
    side_for_stability = rules.second_shape_factor * layers * rules.layer_thickness
    side_for_stress = math.sqrt(weight * NEWTON_PER_KILONEWTON / rules.stress)
    steps = math.ceil(max(side_for_stability, side_for_stress) / rules.plan_step - 1e-9)
    return Size(steps * rules.plan_step, layers, rules.layer_thickness)


def report_checks(
    size: Size, weight: float, strain: float, rules: SizingRules, part: str = ""
) -> list[Check]:
    """Return the calculation sheet of a bearing: strain, stress, shape factors."""
    stress = weight * NEWTON_PER_KILONEWTON / size.area
    first, second = size.first_shape_factor, size.second_shape_factor
    limit_source = "largest strain tested, Table 3.4"
    if rules.strain_limit != STRAIN_LIMIT:
        limit_source = "sizing.strain_limit"
    tests = "of the tests, section 3.3"
    chosen, usual = "chosen", "usual in Japan"
    return [
        Check("shear strain", strain, rules.strain_limit, "1", limit_source, part=part),
        Check("compressive stress", stress, rules.stress, "MPa", tests, part=part),
        Check("first shape factor", first, 5.0, "1", chosen, True, part, True),
        Check("second shape factor", second, 4.0, "1", usual, True, part, True),
    ]


def pier_checks(ductility: Mapping[str, float], rules: SizingRules) -> list[Check]:
    """Return the check of the ductility of every pier that has a hinge."""
    limit_source = "a large value for a pier in an isolated bridge, section 6.3.3"
    if rules.ductility_limit != DUCTILITY_LIMIT:
        limit_source = "sizing.ductility_limit"
    return [
        Check("pier ductility", value, rules.ductility_limit, "1", limit_source, part=pier)
        for pier, value in ductility.items()
        if not math.isnan(value)
    ]


def design_values(compound: DesignRubber, size: Size, displacement: float) -> tuple[float, float]:
    """Return K_B [kN/mm] and h_B of a size at a displacement."""
    thickness = size.total_rubber_thickness
    stiffness = equivalent_stiffness(compound, size.area, thickness, displacement)
    return stiffness, damping_ratio(compound, displacement / thickness)


ROUNDING = 5.0  # mm: plans are made in such steps
MOST_EQUAL_LAYERS = 200  # of any bearing


@dataclass(frozen=True)
class EqualBearing:
    """A layered bearing scaled to a stiffness, at the reference temperature of its rubber."""

    bearing: Bearing
    stiffness: float  # K_eq of its third cycle without heating [kN/mm]
    damping: float  # h_eq, likewise
    displacement: float  # design displacement u_B [mm]
    group: str = ""  # of bearing lines


def _with_side(template: Bearing, side: float, layers: int) -> Bearing:
    """Return the template with another square plan and number of layers; its compound stays."""
    plan = template.geometry.plan.model_copy(update={"side": side})
    geometry = template.geometry.model_copy(update={"plan": plan, "rubber_layers": layers})
    name = f"{template.kind.lower()}-{side:g}-{layers}x{geometry.rubber_thickness:g}"
    about = f"{template.name} scaled to the stiffness of a design"
    return resized(template, geometry).model_copy(update={"name": name, "description": about})


@checked
def equal_bearing(
    template: Bearing | str | Path,
    stiffness: float,
    displacement: float,
    design_strain: float = 1.75,
) -> EqualBearing:
    """Return a bearing of the template's rubber, layers and lead with a given K_B.

    As many layers as keep the design strain; the side of the square plan follows from K_B, in
    steps of 5 mm; the rest follows from the compound (bearing/scaling.py).

    Parameters
    ----------
    template : a layered bearing with a square plan: a Bearing, a library name, or a TOML file.
    stiffness : K_B [kN/mm], > 0.
    displacement : design displacement u_B [mm], > 0.
    design_strain : largest strain, u_B over total rubber thickness, > 0.

    Raises
    ------
    InputError : a number out of range, a plan that is not square, more than 200 layers, or no plan
        between the lead and 5 m has that stiffness.

    Examples
    --------
    >>> found = equal_bearing("shen-hdr-bridge", 2.6153, 178.0)
    >>> found.bearing.area**0.5, found.bearing.geometry.rubber_layers
    (480.0, 6)
    """
    template = as_bearing(template, "template")
    for name, value, high in (
        ("stiffness", stiffness, 1e6),
        ("displacement", displacement, 1e5),
        ("design_strain", design_strain, 5.0),
    ):
        if isinstance(value, bool | str) or not 1e-6 <= value <= high:
            raise InputError(f"{name} = {value!r}: must be a number from 1e-06 to {high:g}")
    if template.geometry.plan.shape != "square":
        raise InputError(f"{template.name}: only square plans are scaled")
    thickness = template.geometry.rubber_thickness
    layers = max(1, math.ceil(displacement / (design_strain * thickness) - 1e-9))
    if layers > MOST_EQUAL_LAYERS:
        raise InputError(
            f"a displacement of {displacement:g} mm needs {layers} layers of {thickness:g} "
            f"mm; the limit is {MOST_EQUAL_LAYERS}"
        )
    strain = displacement / (layers * thickness)

    def _stiffness_of_side(side: float) -> float:
        return isothermal_cycle(_with_side(template, side, layers), strain).stiffness_kN_mm

    # The stiffness increases with the side; the smallest plan must hold the lead.
    low, high = math.sqrt(1.02 * template.lead_area) + ROUNDING, 5000.0
    if not _stiffness_of_side(low) <= stiffness <= _stiffness_of_side(high):
        raise InputError(
            f"{template.name}: no plan of {low:.0f} to {high:.0f} mm gives {stiffness:g} kN/mm"
        )
    exact = scipy.optimize.brentq(
        lambda side: _stiffness_of_side(side) - stiffness, low, high, xtol=0.05
    )
    side = ROUNDING * round(exact / ROUNDING)
    # Stiffness and damping are those of the rounded plan, not the ones that were asked for.
    bearing = _with_side(template, side, layers)
    measured = isothermal_cycle(bearing, strain)
    return EqualBearing(bearing, measured.stiffness_kN_mm, measured.h_eq, displacement)


def third_cycle(bearing: Bearing, displacement: float) -> tuple[Floats, Floats]:
    """Displacement [mm] and force [kN] of a bearing's third cycle, from soaked, with heating."""
    strain = displacement / bearing.total_rubber_thickness
    test = cyclic_test(strain=[strain], cycles=3, closing_strain=None)
    result = run(bearing, test, bearing.hysteresis.reference_temperature)
    last = np.flatnonzero(result["cycle"].values[0] == 3)
    return result["displacement"].values[0, last], result["force"].values[0, last]


@dataclass(frozen=True)
class Round:
    """One turn of the loop, of one group of bearing lines; `row` has the names of its numbers."""

    number: int
    assumed: float
    size: Size
    stiffness: float
    damping: float
    strength: float
    post_yield: float
    initial: float
    found: float  # displacement over the motions that the rule of the case takes [mm]
    ductility: float  # of the pier, likewise
    largest: float = math.nan  # displacement of all motions [mm]
    group: str = ""  # of bearing lines; empty where there is only one

    @property
    def difference(self) -> float:
        """Found over assumed displacement, less one."""
        return self.found / self.assumed - 1.0

    def row(self) -> dict[str, Any]:
        """Return the round as people read it."""
        return {
            "round": self.number,
            **({"group": self.group} if self.group else {}),
            "u_B_assumed_mm": self.assumed,
            "side_mm": self.size.side,
            "layers": self.size.layers,
            "layer_thickness_mm": self.size.layer_thickness,
            "K_B_kN_mm": self.stiffness,
            "h_B": self.damping,
            "Q_d_kN": self.strength,
            "K_1_kN_mm": self.initial,
            "K_2_kN_mm": self.post_yield,
            "u_found_mm": self.found,
            "u_largest_mm": self.largest,
            "difference": self.difference,
            "pier_ductility": self.ductility,
        }


def size_name(turn: Round) -> str:
    """Return a size in words."""
    size = turn.size
    return f"{size.side:g} mm with {size.layers}x{size.layer_thickness:g} mm"


def _two_sizes(rounds: Sequence[Round], tolerance: float) -> tuple[Round, Round] | None:
    """Rounds on both sides of a jump between two sizes where no design is; None if there may be."""
    too_small = [turn for turn in rounds if turn.difference > tolerance]
    large_enough = [turn for turn in rounds if turn.difference < -tolerance]
    if not too_small or not large_enough:
        return None
    # The largest displacement whose size moves farther, and the smallest whose size moves less: if
    # they have come together and their sizes still differ, full layers leave no size between them.
    low = max(too_small, key=lambda turn: turn.assumed)
    high = min(large_enough, key=lambda turn: turn.assumed)
    close = 0.0 < high.assumed - low.assumed <= tolerance * low.assumed
    return (low, high) if close and low.size != high.size else None


@dataclass
class Search:
    """The search for the displacement that one group of lines is sized for.

    The found displacement replaces the assumed one [mm]; where they cross over, the next guess goes
    half-way only (`gain`). Between two sizes that alternate (`alternating`) it holds the larger
    one, until the other groups have changed so much that this one moves farther than it is sized
    for.
    """

    assumed: float
    gain: float = 1.0
    rounds: list[Round] = field(default_factory=list)
    alternating: tuple[Round, Round] | None = None

    def settled(self, turn: Round, tolerance: float) -> bool:
        """Return whether a round needs no other: it agrees, or its held size is large enough."""
        is_larger_size = (
            self.alternating is not None and turn.assumed == self.alternating[1].assumed
        )
        return turn.difference <= tolerance and (is_larger_size or turn.difference >= -tolerance)

    def advance(self, turn: Round, tolerance: float) -> None:
        """Take a round and choose the next assumed displacement."""
        if self.alternating is not None and turn.difference > tolerance:
            # The other groups have changed: earlier rounds of this one no longer hold.
            self.rounds, self.alternating, self.gain = [], None, 1.0
        previous, self.rounds = self.rounds[-1:], [*self.rounds, turn]
        self.alternating = self.alternating or _two_sizes(self.rounds, tolerance)
        # The last step went past the solution: half-way converges where the full step swings.
        if previous and turn.difference * previous[0].difference < 0.0:
            self.gain *= 0.5
        unconstrained = self.assumed + self.gain * (turn.found - self.assumed)
        self.assumed = self.alternating[1].assumed if self.alternating else unconstrained
