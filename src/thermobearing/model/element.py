"""Bearing element with trial, commit and revert, for iterative solvers.

A structure's Newton iteration, or an outside finite element program, proposes
displacements until it converges; only then is the state committed. The wrapper keeps two
states and calls the coupled step; it adds no physics.
"""

import copy
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Self, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.ambient import check_temperature
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, short_repr
from thermobearing.border.schema import validated
from thermobearing.border.units import HUGEST, is_number, number_list, refuse_hidden
from thermobearing.core.compiled.kernel import prepare
from thermobearing.core.march import copy_state
from thermobearing.core.plane import count_components, line_only_options, plain, step_plane
from thermobearing.core.records import Floats
from thermobearing.core.step import step
from thermobearing.core.types import COMPLETED, SOFTENED, Constants, State, new_state, new_workspace
from thermobearing.model.earlier import Model
from thermobearing.model.handover import SpecimenState, begun_from
from thermobearing.model.options import ModelKeywords, ModelOptions, build_model, model_table
from thermobearing.model.outcomes import NAMES

DEFAULT_AMBIENT = 23.0  # [degC]


@dataclass(frozen=True)
class Trial:
    """Response to one trial displacement."""

    force: float  # restoring force [kN], positive with positive displacement
    tangent: float  # its slope [kN/mm]
    outcome: str  # "completed", or the reason why the step ended early


@dataclass(frozen=True)
class PlaneTrial:
    """Response to one trial displacement in a horizontal plane, as `Trial` with components.

    The tangent has derivatives of the force (rows) by the displacement (columns); it is not
    symmetric in general, because a hysteretic force has no potential.
    """

    force: Floats  # [2]
    tangent: Floats  # [2, 2]
    outcome: str


class BearingElement:
    """A bearing for an external solver, modelled as in `run`.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    ambient : ambient temperature [degC], in [-100, 100]: also that of the bearing at the start,
        unless `initial` is given, and the default of each trial.
    initial : temperature at the start [degC], in [-100, 100]: uniform, or one per cell (upper
        face first); or the state at the end of an earlier test, from `tb.end_state`, whose
        energies restart at zero.
    initial_lead : lead temperature at the start [degC]; that of the adjacent cells by default.
    components : horizontal directions of motion: 1, or 2 for a bearing in a plane. In a plane
        displacements and forces are pairs (x, y); not with integrator "euler", small_loops
        "closed" and hardening "monotone".
    model : `ModelOptions`, or the name of an earlier model (model/earlier.py) but "bilinear",
        whose constants `from_constants` takes; "multi-layer" by default.
    exposure, state : fields of `ModelOptions`, in place of those of `model`.

    Raises
    ------
    InputError : no such bearing, options or temperatures that do not fit it, neither 1 nor 2
        components.

    Examples
    --------
    >>> element = BearingElement("shen-hdr-specimen", ambient=-20)
    >>> trial = element.set_trial(3.0, dt=0.1)  # mm, s
    >>> element.commit()
    >>> trial.outcome, trial.force > 10.0  # kN
    ('completed', True)
    >>> element = BearingElement("shen-hdr-specimen", ambient=-20, components=2)
    >>> trial = element.set_trial((3.0, 4.0), dt=0.1)
    >>> trial.force.shape, trial.tangent.shape
    ((2,), (2, 2))
    """

    @checked
    def __init__(
        self,
        bearing: Bearing | str | Path,
        ambient: float = DEFAULT_AMBIENT,
        *,
        initial: float | Sequence[float] | NDArray[np.float64] | SpecimenState | None = None,
        initial_lead: float | None = None,
        components: int = 1,
        model: ModelOptions | Model | None = None,
        **options: Unpack[ModelKeywords],
    ) -> None:
        bearing = as_bearing(bearing)
        chosen = validated(ModelOptions, model_table(model, options), "BearingElement()")
        problems = chosen.misfits(bearing)
        if initial_lead is not None and bearing.lead is None:
            problems.append("initial_lead: needs a bearing with lead")
        if problems:
            raise InputError(problems, "BearingElement()")
        constants = build_model(bearing, chosen).constants
        self._start_from(constants, ambient, initial, initial_lead, components)

    @classmethod
    @checked
    def from_constants(
        cls,
        constants: Constants,
        ambient: float = DEFAULT_AMBIENT,
        *,
        initial: float | Sequence[float] | NDArray[np.float64] | SpecimenState | None = None,
        initial_lead: float | None = None,
        components: int = 1,
    ) -> Self:
        """Return an element from constants of the coupled step, such as those of a modified model.

        Parameters
        ----------
        constants : from `build_model(...).constants` or `bilinear_constants`.
        ambient, initial, initial_lead, components : as of the class [degC], [degC], [degC], [1].

        Raises
        ------
        InputError : temperatures that do not fit the cells.

        Examples
        --------
        >>> from thermobearing.model.earlier import BilinearParameters, bilinear_constants
        >>> element = BearingElement.from_constants(bilinear_constants(BilinearParameters(5, 1, 9)))
        >>> round(element.set_trial(0.1, dt=0.1).force, 6)  # 9 kN/mm before it yields
        0.9
        """
        element = cls.__new__(cls)
        element._start_from(constants, ambient, initial, initial_lead, components)
        return element

    def _start_from(
        self,
        constants: Constants,
        ambient: float,
        initial: Any,
        initial_lead: float | None,
        components: int,
    ) -> None:
        """Allocate the states at the start."""
        if components not in (1, 2):
            raise InputError(f"components = {short_repr(components)}: must be 1 or 2")
        lacking = line_only_options(constants) if components == 2 else []
        if lacking:
            raise InputError([f"components = 2: not with {option}" for option in lacking])
        self._ambient = float(check_temperature(ambient, "ambient"))
        if initial_lead is not None:
            initial_lead = float(check_temperature(initial_lead, "initial_lead"))
        if isinstance(initial, SpecimenState):
            start = begun_from(initial, constants, initial_lead, components)
        else:
            cells = len(constants.cells.capacity)
            temperature = ambient if initial is None else initial
            start = new_state(
                constants, _of_cells("initial", temperature, cells), initial_lead, components
            )
        # Three states: where it began, the last commit, and the trial that a step writes.
        self._constants = constants
        self._work = new_workspace(constants, components)
        self._start = start
        self._committed = new_state(constants, start.temperature, components=components)
        self._trial = new_state(constants, start.temperature, components=components)
        _copy(start, self._committed)
        _copy(start, self._trial)
        self._failed = ""

    @cached_property
    def _run_step(self) -> Callable[..., Any]:
        """Call `step` of the displacement, the duration and the ambient temperature."""
        # Solvers call this thousands of times with the same records: their addresses are looked up
        # once, and a call passes three numbers.
        records = (self._constants, self._work, self._committed)
        kernel: Any = step if self.components == 1 else step_plane
        return prepare(kernel, *records, *[0.0] * (2 + self.components), self._trial)

    @cached_property
    def _accept(self) -> Callable[[], None]:
        if self.components > 1:
            return partial(_copy, self._trial, self._committed)
        return prepare(copy_state, self._trial, self._committed)

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy has in common; prepared calls belong to the own arrays."""
        # They hold addresses of these arrays, so that a copy would write into the original.
        prepared = ("_run_step", "_accept")
        kept = {key: value for key, value in vars(self).items() if key not in prepared}
        return kept | {"_process": os.getpid()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Refuse a law of a user from another process, where its address means nothing."""
        # Addresses of compiled functions are those of the process that made them.
        vars(self).update(state)
        if self._constants.rubber.law != 0 and state["_process"] != os.getpid():
            raise InputError("an element with a hysteresis_law cannot move to another process")

    @property
    def state(self) -> State:
        """The committed state (a live record: copy it, or `save`, to keep it).

        `temperature` [degC] of each cell from the upper face, of a half stack to its middle;
        `layers` with displacement `d` and `z` [mm] of each modelled layer, the outermost first;
        `branches["lead_temperature"]` [degC]; `response` of one row with `clock` [s],
        `displacement`, `force` and its shares, and energies since the start [kN mm]: `work_in`,
        `heat_released`, `heat_stored`, `heat_lost_ends`, `heat_lost_sides`, `recoverable`.
        """
        return self._committed

    @property
    def constants(self) -> Constants:
        """The constants of the coupled step."""
        return self._constants

    @property
    def ambient(self) -> float:
        """The default ambient temperature of a trial [degC]."""
        return self._ambient

    @property
    def components(self) -> int:
        """Horizontal directions of motion, 1 or 2."""
        return count_components(self._committed)

    def __repr__(self) -> str:
        response = self._committed.response
        at, force = (
            ", ".join(f"{component:g}" for component in np.atleast_1d(response[name][0]))
            for name in ("displacement", "force")
        )
        warmest = self._committed.temperature.max()
        return (
            f"<BearingElement at {at} mm, {force} kN, "
            f"{response['clock'][0]:g} s; warmest cell {warmest:.1f} degC>"
        )

    @overload
    def set_trial(self, x: float, dt: float, ambient: float | None = None) -> Trial: ...

    @overload
    def set_trial(
        self, x: Sequence[float] | Floats, dt: float, ambient: float | None = None
    ) -> PlaneTrial: ...

    def set_trial(self, x: Any, dt: float, ambient: float | None = None) -> Trial | PlaneTrial:
        """Apply displacement x [mm] after a step dt [s] from the committed state.

        Parameters
        ----------
        x : displacement of the upper face relative to the lower one [mm]; with two components a
            pair (x, y).
        dt : length of the step [s], > 0.
        ambient : ambient temperature [degC]; that of the element by default.

        Returns
        -------
        Trial : after any `outcome` but "completed" there is nothing to commit. `PlaneTrial` with
            two components.

        Raises
        ------
        InputError : not a number or a pair of numbers, a step that is not positive, an ambient
            temperature out of range.
        """
        air = self._ambient
        at, dt = _numbers("x", "mm", x, self.components), _step_length(dt)
        if ambient is not None:
            air = float(check_temperature(ambient, "set_trial(): ambient"))
        *response, outcome = self._run_step(*at, dt, air)
        if len(at) == 1:
            return Trial(response[0], response[1], self._note(outcome))
        numbers = np.array(response)
        return PlaneTrial(numbers[:2], numbers[2:].reshape(2, 2), self._note(outcome))

    def _note(self, outcome: int) -> str:
        """Return the name of the outcome of a trial, which decides whether it can be accepted."""
        # A softened step is in equilibrium, with hardening shared among the layers; it may be
        # accepted.
        self._failed = "" if outcome in (COMPLETED, SOFTENED) else NAMES[outcome]
        return NAMES[outcome]

    def commit(self) -> None:
        """Accept the last trial.

        Raises
        ------
        InputError : the trial did not complete; the committed state is unchanged.
        """
        self._check_trial()
        self._accept()

    def _check_trial(self) -> None:
        """Refuse a trial that did not complete."""
        if self._failed:
            raise InputError(
                f"commit(): the last trial ended as {self._failed} (its `outcome`); try a smaller "
                "step from the committed state"
            )

    def revert_to_start(self) -> None:
        """Reset to the initial state: a virgin bearing, or the end of an earlier test."""
        # The trial too: `commit` without a new trial must not bring back what was before.
        self._failed = ""
        _copy(self._start, self._committed)
        _copy(self._start, self._trial)

    def save(self) -> State:
        """Return a copy of the committed state."""
        saved = new_state(self._constants, self._committed.temperature, components=self.components)
        _copy(self._committed, saved)
        return saved

    def __copy__(self) -> Self:
        """Return an independent element with copies of the states."""
        duplicate: Self = copy.deepcopy(self)
        return duplicate

    def restore(self, saved: State) -> None:
        """Continue from a state that `save` returned.

        Raises
        ------
        InputError : no state, or one of another bearing.
        """
        committed = self._committed
        if (
            not isinstance(saved, State)
            or saved.temperature.shape != committed.temperature.shape
            or count_components(saved) != self.components
        ):
            raise InputError("restore(): needs a state that save() of this bearing returned")
        self._failed = ""
        _copy(saved, self._committed)
        _copy(saved, self._trial)


@dataclass(frozen=True)
class Trials:
    """Responses of several bearings to one trial displacement each, as those of `Trial`."""

    force: NDArray[np.float64]
    tangent: NDArray[np.float64]
    outcome: tuple[str, ...]


class BearingElements:
    """Several bearings that an external solver moves in one call.

    Parameters
    ----------
    elements : elements of any bearings, in their order; each keeps its ambient temperature and its
        initial state.

    Raises
    ------
    InputError : none, one element twice, or one that moves in a plane.

    Examples
    --------
    >>> piers = BearingElements(
    ...     [BearingElement("shen-hdr-bridge", ambient=ambient) for ambient in (-20, 0, 23)]
    ... )
    >>> trial = piers.set_trial([40.0, 45.0, 50.0], dt=0.01)  # mm, s
    >>> piers.commit()
    >>> trial.force.round(), trial.tangent.shape  # kN
    (array([281., 222., 165.]), (3,))
    """

    @checked
    def __init__(self, elements: Sequence[BearingElement]) -> None:
        self.elements = [*elements]
        if not elements or len({id(element) for element in elements}) < len(elements):
            raise InputError("BearingElements(): needs one element or more, each of them once")
        if any(element.components > 1 for element in elements):
            raise InputError("BearingElements(): takes elements with one component only")

    def set_trial(
        self,
        x: Sequence[float] | NDArray[np.float64],
        dt: float,
        ambient: float | Sequence[float] | NDArray[np.float64] | None = None,
    ) -> Trials:
        """Apply one displacement to each bearing after a step from the committed states.

        Parameters
        ----------
        x : displacements of the upper faces relative to the lower ones [mm].
        dt : length of the step [s], > 0.
        ambient : ambient temperatures, or that of all [degC]; those of the elements by default.

        Returns
        -------
        Trials : after any outcome but "completed" there is nothing to commit.

        Raises
        ------
        InputError : not one number for each bearing, or a number that one element refuses.
        """
        goals, dt = _row("x", x, len(self.elements)), _step_length(dt)
        air = [element.ambient for element in self.elements]
        if ambient is not None:
            air = _row("ambient", ambient, len(air))
            # If both ends are in the range, all are.
            for extreme in (min(air), max(air)):
                check_temperature(extreme, "set_trial(): ambient")
        force, tangent, outcomes = np.empty(len(air)), np.empty(len(air)), []
        for k, element in enumerate(self.elements):
            force[k], tangent[k], outcome = element._run_step(goals[k], dt, air[k])
            outcomes.append(element._note(outcome))
        return Trials(force, tangent, tuple(outcomes))

    def commit(self) -> None:
        """Accept the last trials of all bearings.

        Raises
        ------
        InputError : one trial did not complete; no committed state is changed.
        """
        # All are checked before one is changed.
        for element in self.elements:
            element._check_trial()
        for element in self.elements:
            element._accept()

    def revert_to_start(self) -> None:
        """Reset all bearings to their initial states."""
        for element in self.elements:
            element.revert_to_start()


@checked
def element(
    bearing: Bearing | str | Path,
    ambient: float = DEFAULT_AMBIENT,
    *,
    initial: float | Sequence[float] | NDArray[np.float64] | SpecimenState | None = None,
    initial_lead: float | None = None,
    components: int = 1,
    model: ModelOptions | Model | None = None,
    **options: Unpack[ModelKeywords],
) -> BearingElement:
    """Return a bearing with trial, commit and revert, for your own integrator or program.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    ambient : ambient temperature, also of the bearing at the start [degC], in [-100, 100].
    initial, initial_lead, components, model, exposure, state : as of `BearingElement`; two
        components are for a bearing that moves in a plane.

    Raises
    ------
    InputError : no such bearing or option, or temperatures that do not fit.

    Examples
    --------
    >>> pier = element("shen-hdr-bridge", ambient=-20)
    >>> force = pier.set_trial(40.0, dt=0.01).force  # mm, s -> kN
    >>> pier.commit()
    >>> force > 100.0
    True
    """
    return BearingElement(
        bearing,
        ambient,
        initial=initial,
        initial_lead=initial_lead,
        components=components,
        model=model,
        **options,
    )


def _copy(source: State, target: State) -> None:
    """Overwrite a state with another."""
    plain(copy_state, source)(source, target)


def _number(key: str, unit: str, value: Any) -> float:
    """Return a number as a float; other types would compile the kernels again."""
    if type(value) is float:
        return value
    if not is_number(value):
        raise InputError(f"set_trial(): {key} = {short_repr(value)}: must be a number of {unit}")
    return float(value)


def _step_length(dt: Any) -> float:
    """Return the length of a step as a float [s]."""
    length = _number("dt", "s", dt)
    if not 0.0 < length < HUGEST:
        raise InputError(
            f"set_trial(): dt = {length!r}: must be more than 0 s and below {HUGEST:g}"
        )
    return length


def _row(key: str, values: Any, count: int) -> list[float]:
    """Return one number for each bearing; a single one stands for all."""
    numbers = number_list(values, f"set_trial(): {key}")
    if numbers.shape not in ((1,), (count,)):
        raise InputError(f"set_trial(): {key}: has {numbers.size} numbers for {count} bearings")
    row: list[float] = np.broadcast_to(numbers, count).tolist()
    return row


def _numbers(key: str, unit: str, value: Any, components: int) -> list[float]:
    """Return a number or a pair of numbers as floats."""
    if components == 1:
        return [_number(key, unit, value)]
    pair: list[float] = number_list(value, f"set_trial(): {key}").tolist()
    if len(pair) != components:
        raise InputError(
            f"set_trial(): {key} = {short_repr(value)}: must be a pair (x, y) in {unit}, "
            "because the element has two components"
        )
    return pair


def _of_cells(key: str, temperature: Any, cells: int) -> NDArray[np.float64]:
    """Return the temperature of each cell [degC]."""
    refuse_hidden(temperature, key)
    try:
        temperatures = np.asarray(temperature, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(
            f"{key} = {short_repr(temperature)}: must be numbers in degC, or a state (tb.end_state)"
        ) from None
    if temperatures.ndim and temperatures.shape != (cells,):
        raise InputError(f"{key}: has {temperatures.size} numbers, but the stack has {cells} cells")
    for value in (temperatures.min(), temperatures.max()):
        check_temperature(float(value), key)
    return np.full(cells, temperatures)


def initial_stiffness(constants: Constants, temperature: float | Floats, ambient: float) -> float:
    """Return the stiffness K_0 of a bearing at rest, its tangent without displacement [kN/mm].

    Parameters
    ----------
    constants : those of the coupled step.
    temperature : of the bearing, or of each of its cells [degC].
    ambient : ambient temperature [degC].

    Examples
    --------
    >>> from thermobearing.model.earlier import BilinearParameters, bilinear_constants
    >>> constants = bilinear_constants(BilinearParameters(5, 1, 9))
    >>> round(initial_stiffness(constants, 20.0, 20.0), 6)
    9.0
    """
    displacement = 1e-6  # [mm], so small that no bearing yields; as long a step, at 1 mm/s
    element = BearingElement.from_constants(constants, initial=temperature)
    return element.set_trial(displacement, displacement, ambient).force / displacement
