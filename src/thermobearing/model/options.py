"""Options for modelling a bearing, shared by all analyses, and the model built from them.

The cyclic test, the earthquake, identification, the equivalent bilinear model and the element
for external solvers all build their model here, so that the model is the same everywhere.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self, TypedDict

from pydantic import Field, model_validator

from thermobearing.bearing.exposure import TWICE, Exposure, exposed
from thermobearing.bearing.model import Bearing, Clock, Hardening, SmallLoops
from thermobearing.bearing.state import RubberState, State, in_state
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, in_unit
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.core.plane import line_only_options
from thermobearing.core.types import Constants
from thermobearing.laws import find_law
from thermobearing.model.constants import (
    HeatSource,
    Integrator,
    LeadEnds,
    build_constants,
    lead_clock,
)
from thermobearing.model.earlier import ONE_CELL, BilinearParameters, apply_model
from thermobearing.model.earlier import Model as ModelName
from thermobearing.model.stack import EndFace, Scheme, Stack, build_stack, through_side

Stacked = Literal["auto", "half", "full"]
WITH_LEAD_ENDS = ("multi-layer", "temperature-blind")  # the others use Eq. 5.5
WITH_CLOCK = (*WITH_LEAD_ENDS, "lead-alone")  # in the others lead exchanges no heat, or instantly
DEFAULT_ETA = 2.0  # Shen (2023) uses a "middle" value between 1 and 3 (Eq. 4.15)


class Side(Strict):
    """Heat exchange of the side of a bearing with the ambient air.

    Attributes
    ----------
    film : film coefficient [W/(m^2 K)], in [0, 1e5]; 0 insulates the side.
    cover : thickness of the cover rubber [mm], in [0, 1000].

    Examples
    --------
    >>> Side(film=12.0).cover
    0.0
    """

    film: Annotated[float, in_unit("W/(m^2 K)"), Field(ge=0, le=1e5)]
    cover: Annotated[float, in_unit("mm"), Field(ge=0, le=1e3)] = 0.0


@checked
class ModelOptions(Strict):
    """How to model a bearing.

    Attributes
    ----------
    model : "multi-layer" (default), or an earlier model for comparison.
    scheme : scheme of heat conduction: "conservative" (default) or "published".
    integrator : integration of Z: "exact" (default) or "euler".
    hardening : form of the hardening term: "printed" (Eq. 4.34) or "monotone", which is equal to it
        during loading and never lets the force increase during unloading; by default that of the
        bearing's file, or "printed".
    small_loops : law of small reversals: "published" (Eq. 4.35: the force does not return to the
        value at the reversal) or "closed" (it does); by default that of the bearing's file, or
        "published".
    heat_source : heat in the rubber: "work" (Eq. 4.22) or "dissipation"; by default dissipation for
        natural rubber (LRB), whose elastic work is recovered, otherwise work.
    lead_ends : heat flow from lead to steel: "finite-plate" (default: plates of finite thickness,
        shims as fins) or "half-space" (Eq. 5.4-5.5, with surface_ratio and clock), which the
        published scheme and the earlier models use.
    clock : diffusivity that makes t+ of Eq. 5.6 dimensionless for lead on a half-space: "lead" (as
        published) or "steel" (Kalpakidis & Constantinou 2009); by default that of the bearing's
        file, or lead with the published scheme and steel with the conservative one.
    stack : modelled height: "auto" (default: the upper half if both faces are equal, otherwise the
        full height), "half" or "full".
    upper_face, lower_face : heat exchange of the end faces; eta_B = 2 by default.
    side : heat exchange of the side; None for the film of the bearing's materials without cover.
        With a weather file, faces and side have other defaults, see `outdoors`.
    exposure : factors for long cold and ageing (`Exposure`), for bearings without them.
    state : state of the rubber at the start: "tested", "virgin" or "recovered after 5 years"; by
        default tested, or virgin where the bearing's file has a table `scragging`.
    """

    model: ModelName = "multi-layer"
    scheme: Scheme = "conservative"
    integrator: Integrator = "exact"
    hardening: Hardening | None = None
    small_loops: SmallLoops | None = None
    heat_source: HeatSource | None = None
    lead_ends: LeadEnds | None = None
    clock: Clock | None = None
    stack: Stacked = "auto"
    upper_face: EndFace = EndFace(eta=DEFAULT_ETA)
    lower_face: EndFace = EndFace(eta=DEFAULT_ETA)
    side: Side | None = None
    exposure: Exposure | None = None
    state: State = None

    @model_validator(mode="after")
    def _fit_each_other(self) -> Self:
        equal_faces = self.upper_face == self.lower_face
        if self.stack == "half" and not equal_faces:
            raise ValueError('stack "half" needs both faces alike; use "auto" or "full"')
        if self.model in ONE_CELL and self.stack == "half":
            raise ValueError(f'model "{self.model}" has one cell for all layers; use stack "auto"')
        behind = self.upper_face.heat_capacity or self.lower_face.heat_capacity
        if behind and (self.scheme == "published" or self.model in ONE_CELL):
            raise ValueError(
                "heat_capacity behind a face needs the conservative scheme of the multi-layer model"
            )
        if self.lead_ends == "finite-plate" and self.scheme == "published":
            raise ValueError('scheme "published" needs lead_ends "half-space"')
        return self

    @property
    def half(self) -> bool:
        """Return whether only the upper half is modelled."""
        if self.model in ONE_CELL:
            return False
        return self.stack == "half" or (self.stack == "auto" and self.upper_face == self.lower_face)

    def build_stack(self, bearing: Bearing) -> Stack:
        """Build the cells and layers of a bearing as these options model them."""
        side = None
        if self.side is not None:
            side = through_side(bearing, self.side.film, self.side.cover)
        behind = [face.heat_capacity or 0.0 for face in (self.upper_face, self.lower_face)]
        return build_stack(bearing, half=self.half, side_film=side, behind=(behind[0], behind[1]))

    def misfits(self, bearing: Bearing) -> list[str]:
        """Return what a bearing lacks for these options, in sentences that begin with the key."""
        messages = []
        if self.exposure is not None and bearing.exposure is not None:
            messages.append(f"exposure: {TWICE}")
        messages += self.misfit_of_state(self.state)
        if self.scheme == "published" and bearing.cells.grading != 1.0:
            messages.append(
                'scheme = "published": its coefficients are those of equal cells, and '
                f'"{bearing.name}" has cells.plate_grading = {bearing.cells.grading:g}; use scheme '
                '"conservative", or omit plate_grading'
            )
        loops = self.small_loops or bearing.hysteresis.small_loops
        # Each takes the place of Eq. 4.35, so that only one can.
        laws = {  # of Z: a bearing has one of them
            'small_loops = "closed"': loops == "closed",
            'integrator = "euler"': self.integrator == "euler",
            f'the hysteresis_law of "{bearing.name}"': bearing.hysteresis_law is not None,
        }
        chosen_laws = [name for name, chosen in laws.items() if chosen]
        messages += [f"{law}: not with {chosen_laws[-1]}" for law in chosen_laws[:-1]]
        if bearing.lead is None:
            needs_lead = [
                ("model", self.model, self.model == "lead-alone"),
                ("lead_ends", self.lead_ends, self.lead_ends == "finite-plate"),
                ("clock", self.clock, self.clock is not None),
            ]
            messages += [
                f'{key} = "{value}": needs a bearing with lead; "{bearing.name}" has none'
                for key, value, needs in needs_lead
                if needs
            ]
        elif self.clock is not None and not self._has_clock(bearing):
            finite = self.model in WITH_LEAD_ENDS
            reason = 'lead_ends "finite-plate"' if finite else f'model "{self.model}"'
            cure = 'use lead_ends = "half-space" or scheme = "published", or ' if finite else ""
            messages.append(f'clock = "{self.clock}": {reason} has no clock; {cure}omit it')
        return messages

    def misfit_of_state(self, state: RubberState | None) -> list[str]:
        """Return why the model cannot have rubber in a state."""
        if state is None or state.share == 0.0 or self.model != "bilinear":
            return []
        return [f'state = "{state.rubber}": model "bilinear" has tested rubber; omit it']

    def _lead_ends(self, bearing: Bearing) -> LeadEnds:
        """Return the option, where there is a choice."""
        finite = bearing.lead is not None and self.scheme == "conservative"
        if not finite or self.model not in WITH_LEAD_ENDS or self.lead_ends == "half-space":
            return "half-space"
        return "finite-plate"

    def _has_clock(self, bearing: Bearing) -> bool:
        """Return whether the diffusivity of t+ affects the result."""
        formula = self._lead_ends(bearing) == "half-space" and self.model in WITH_CLOCK
        return bearing.lead is not None and formula

    def settled(self, bearing: Bearing) -> Self:
        """Return the options with defaults of the bearing filled in."""
        lead, clock = bearing.lead, self.clock
        if lead is None:
            clock = None
        elif self._has_clock(bearing):
            clock = lead_clock(lead, published=self.scheme == "published", chosen=clock)
        filled = {
            "hardening": self.hardening or bearing.hysteresis.hardening_form or "printed",
            "small_loops": self.small_loops or bearing.hysteresis.small_loops,
            "heat_source": self.heat_source or _default_heat_source(bearing),
            "lead_ends": self._lead_ends(bearing),
            "clock": clock,
        }
        return self.model_copy(update=filled)


class ModelKeywords(TypedDict, total=False):
    """Fields of `ModelOptions` that most analyses state, and that are keyword arguments too."""

    exposure: Exposure | dict[str, Any] | None
    state: RubberState | dict[str, Any] | str | None


def model_table(model: ModelOptions | str | None, keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Return options by key: the fields set in `model`, or its name, with keywords over them."""
    table: dict[str, Any] = {} if model is None else {"model": model}
    if isinstance(model, ModelOptions):
        table = {name: getattr(model, name) for name in model.model_fields_set}
    return table | {name: value for name, value in keywords.items() if value is not None}


def outdoors() -> tuple[dict[str, Any], dict[str, str]]:
    """Return the options of faces and side in the weather, as a table, and their sources by key."""
    return split_sources(read_toml(data_path("surroundings", "outdoors.toml")))


@dataclass(frozen=True)
class BearingModel:
    """The computational model of a bearing."""

    stack: Stack  # its cells and layers
    constants: Constants  # of the coupled step
    options: ModelOptions  # with the defaults of this bearing


def _default_heat_source(bearing: Bearing) -> HeatSource:
    """Return "dissipation" for natural rubber (LRB), whose elastic work is recovered, else "work".

    >>> from thermobearing.bearing.library import load_bearing
    >>> _default_heat_source(load_bearing("lrb-example"))
    'dissipation'
    """
    return "dissipation" if bearing.kind == "LRB" else "work"


def build_model(
    bearing: Bearing,
    options: ModelOptions | None = None,
    *,
    backbone: Callable[[Bearing], BilinearParameters] | None = None,
) -> BearingModel:
    """Return the model of a bearing: its stack and the constants of the coupled step.

    `backbone` computes the bilinear model of a bearing (`equivalent.bilinear_parameters`), for
    `model` "bilinear". It is a parameter because it runs a test, which imports this module.
    """
    options = (options or ModelOptions()).settled(bearing)
    bearing = exposed(bearing, options.exposure)  # once, before any temperature
    bearing = in_state(bearing, options.state)
    stack = options.build_stack(bearing)
    constants = build_constants(
        bearing,
        stack,
        upper=options.upper_face,
        lower=None if options.half else options.lower_face,
        scheme=options.scheme,
        integrator=options.integrator,
        heat_source=options.heat_source or _default_heat_source(bearing),
        lead_ends=options.lead_ends or "half-space",
        hardening=options.hardening or "printed",
        small_loops=options.small_loops or "published",
        clock=options.clock,
    )
    if options.model == "bilinear" and backbone is None:
        raise InputError('model "bilinear" is for tests and earthquakes; give bilinear constants')
    constants = apply_model(options.model, constants, bearing, stack, backbone)
    return BearingModel(stack, constants, options)


def line_only_faults(bearing: Bearing, constants: Constants) -> list[str]:
    """Return what in a bearing and its options is not available in a plane."""
    law, rubber = bearing.hysteresis_law, constants.rubber
    messages = []
    if law is not None and not rubber.law_in_plane:
        name = find_law(law.law).name
        messages = [f'law "{name}" has no function for two directions; register it with plane=...']
    options = line_only_options(constants._replace(rubber=rubber._replace(law=0)))
    use = "use integrator = exact, small_loops = published, hardening = printed"
    return messages + [
        f"analysis.{option}: is not available in a plane; {use}" for option in options
    ]
