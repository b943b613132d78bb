"""The design loop of Fig. 6.4: assume a displacement, size, analyse, compare, repeat."""

from collections.abc import Callable
from dataclasses import dataclass, field

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.design.case import DesignCase
from thermobearing.design.rubber import bilinear_of, load_compound, load_curves
from thermobearing.design.sizing import Check, Size, checks_of, design_values, size_bearing
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake

ENOUGH = 0.10  # of the displacement: "no more than 10 %" (6.2.2)
BLIND = 23.0  # degC: the bilinear bearing does not care


@dataclass(frozen=True)
class Round:
    """One turn of the loop.

    Attributes
    ----------
    number : from 1.
    assumed : design displacement u_B that the bearing was sized for [mm].
    size : the bearing.
    stiffness, damping : K_B [kN/mm] and h_B at u_B.
    strength, post_yield, initial : Q_d [kN], K_2, K_1 [kN/mm] of the bilinear model.
    found : largest displacement over the motions [mm].
    ductility : largest of the pier over the motions.
    """

    number: int
    assumed: float
    size: Size
    stiffness: float
    damping: float
    strength: float
    post_yield: float
    initial: float
    found: float
    ductility: float

    @property
    def difference(self) -> float:
        """Found over assumed displacement, less one."""
        return self.found / self.assumed - 1.0


@dataclass
class Design:
    """What the loop came to.

    Attributes
    ----------
    rounds : all turns.
    outcome : "converged", or why not.
    sentence : the same for people.
    checks : the calculation sheet of the last round.
    bearing : bilinear bearing of the last round.
    study : the last dynamic analyses.
    """

    rounds: list[Round] = field(default_factory=list)
    outcome: str = "not_converged"
    sentence: str = ""
    checks: list[Check] = field(default_factory=list)
    bearing: BilinearBearing | None = None
    study: EarthquakeResult | None = None

    @property
    def last(self) -> Round:
        """The final turn."""
        return self.rounds[-1]

    @property
    def first_within(self) -> int | None:
        """Number of the first round within the source's 10 %."""
        return next((r.number for r in self.rounds if abs(r.difference) <= ENOUGH), None)


def bearing_weight(case: DesignCase) -> float:
    """Vertical load of one bearing [kN]: given, or the deck's weight over the count."""
    if case.weight is not None:
        return case.weight
    structure = case.structure
    gravity = 9.80665e3  # mm/s2, ISO 80000-3
    mass = sum(item.mass for item in structure.masses if item.body == structure.report.deck)
    return mass * gravity / structure.bearings[0].count


def earthquake_of(case: DesignCase, bearing: BilinearBearing, stiffness: float) -> EarthquakeCase:
    """The dynamic analysis of one round; eigenvalues and damping follow the bearing's K_B."""
    line = case.structure.bearings[0].model_copy(update={"equivalent_stiffness": stiffness})
    structure = case.structure.model_copy(update={"bearings": [line]})
    return make_earthquake_case(
        {"command": "bridge"},
        "design",
        structure=structure,
        bearings=[bearing],
        motions=[motion.model_dump(exclude_none=True) for motion in case.motions],
        ambient=[BLIND],
        dt=case.dt,
        mass=case.mass,
    )


def one_round(case: DesignCase, number: int, assumed: float) -> tuple[Round, Design]:
    """Size for a displacement and analyse."""
    compound = load_compound(case.compound, case.compound_kind)
    size = size_bearing(assumed, bearing_weight(case), case.sizing)
    effective = case.effective_displacement_factor * assumed
    thickness = size.total_rubber_thickness
    curves = load_curves()  # a first guess may lie outside the strains of the curves
    low, high = curves.smallest_strain * thickness, curves.largest_strain * thickness
    effective = min(max(effective, low), high)
    stiffness, damping = design_values(compound, size, effective)
    model = bilinear_of(stiffness, damping, effective, case.stiffness_ratio)
    bearing = BilinearBearing(
        name=f"{case.compound}-{size.side:g}-{size.layers}x{size.layer_thickness:g}",
        description=f"{case.compound_kind} {case.compound}, designed for {assumed:.0f} mm",
        total_rubber_thickness=thickness,
        strength=model.strength,
        initial_stiffness=model.initial,
        post_yield_stiffness=model.post_yield,
    )
    study = run_earthquake(earthquake_of(case, bearing, stiffness))
    found = float(study["bearing_displacement_max"].max())
    ductility = float(study["pier_ductility"].max())
    turn = Round(
        number, assumed, size, stiffness, damping, model.strength, model.post_yield,
        model.initial, found, ductility,
    )  # fmt: skip
    checks = checks_of(size, bearing_weight(case), found / thickness, ductility, case.sizing)
    return turn, Design(checks=checks, bearing=bearing, study=study)


def run_design(case: DesignCase, tell: Callable[[Round], None] | None = None) -> Design:
    """Carry out the loop; says why if it does not converge, never raises for that.

    The found displacement replaces the assumed one (6.2.2) until they agree within the
    tolerance. Sizes are whole layers, so the found displacement may jump between two of them:
    when the assumed displacement is about to repeat, it goes half-way only.

    Parameters
    ----------
    case : from `load_design_case` or `make_design_case`.
    tell : called after each round.

    Returns
    -------
    Design

    Examples
    --------
    >>> from thermobearing.design.case import make_design_case
    >>> design = run_design(make_design_case({}, "example", motions=["jra-ii-i-1"]))
    >>> design.outcome, design.last.size.side >= 400.0
    ('converged', True)
    """
    design = Design()
    assumed, gain = case.start, 1.0
    for number in range(1, case.most_rounds + 1):
        turn, state = one_round(case, number, assumed)
        design.rounds.append(turn)
        design.checks, design.bearing, design.study = state.checks, state.bearing, state.study
        if tell:
            tell(turn)
        if state.study is not None and state.study.outcome != "completed":
            design.outcome = state.study.outcome
            design.sentence = state.study.sentence
            return design
        if abs(turn.difference) <= case.tolerance:
            design.outcome = "converged"
            design.sentence = (
                f"The displacement of {turn.found:.0f} mm is within {case.tolerance:.0%} of the "
                f"assumed {turn.assumed:.0f} mm after {number} rounds."
            )
            return design
        if number > 1 and turn.difference * design.rounds[-2].difference < 0.0:
            gain *= 0.5
        assumed += gain * (turn.found - assumed)
    design.sentence = (
        f"After {case.most_rounds} rounds the displacement still changes by "
        f"{design.last.difference:+.0%}: assumed {design.last.assumed:.0f}, found "
        f"{design.last.found:.0f} mm. Try thinner layers (the size jumps by whole layers), more "
        "rounds, or a larger tolerance."
    )
    return design
