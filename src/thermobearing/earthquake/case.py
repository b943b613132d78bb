"""An earthquake analysis as data: structure, bearings, motions, weather, and how to compute."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, field_validator

from thermobearing.bearing.bilinear import BILINEAR, BilinearBearing, load_device
from thermobearing.bearing.library import BEARINGS
from thermobearing.bearing.model import AxialForce, Bearing
from thermobearing.bearing.state import RubberState, State
from thermobearing.border.cases import absolute, load_all, load_things, read_case
from thermobearing.border.errors import InputError
from thermobearing.border.library import Library, Sourced, sources_to_keep
from thermobearing.border.schema import Strict, in_unit, overridden
from thermobearing.border.title import case_table
from thermobearing.border.toml import to_toml
from thermobearing.climate.readers import read_air
from thermobearing.cyclic.case import (
    RIGS,
    Ambients,
    Rig,
    Temperature,
    left_by,
    load_rig,
    settle_start,
)
from thermobearing.cyclic.protocol import LONGEST
from thermobearing.earthquake.motions import Motion, settle_motions
from thermobearing.model.axial import AxialFactor
from thermobearing.model.effort import MOST_OF, too_many
from thermobearing.model.handover import SpecimenState, misfit
from thermobearing.model.limits import CodeChecks, load_limits
from thermobearing.model.options import ModelOptions, build_model, line_only_faults, outdoors
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.opensees.specimen import read_address, refuse_remote
from thermobearing.structure.connections.axial import AxialTable
from thermobearing.structure.fields import Stiffness
from thermobearing.structure.model import (
    STRUCTURES,
    DampingKind,
    MassModel,
    Structure,
    axial_table_faults,
    fixed_base,
    line_faults,
    load_structure,
    reported_line,
)
from thermobearing.structure.run import NO_VELOCITY, Method

Device = Annotated[Bearing | BilinearBearing, Field(discriminator="kind")]


class OnLine(Strict):
    """Input of one bearing line; keys that are left out are those of the analysis.

    `line` is its name in the structure, whose `count` and `equivalent_stiffness` it replaces;
    `ambient` the temperature there and of its bearings at the start [degC]; `weather` a file, a
    table or EPW, that ends when the earthquake begins, instead of `ambient`; `axial_force` that on
    one of its bearings [kN], in [-1e6, 1e6]; `state` that of their rubber at the start; `axial` the
    table of its axial forces.
    """

    line: Annotated[str, Field(min_length=1, max_length=60)]
    bearing: Device | None = None
    count: Annotated[int, Field(ge=1, le=10_000)] | None = None
    equivalent_stiffness: Stiffness | None = None
    ambient: Temperature | None = None
    weather: Annotated[str, Field(min_length=1)] | None = None
    axial_force: AxialForce | None = None
    state: State = None
    axial: AxialTable | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        if {"ambient", "weather"} <= set(values):
            return ["give ambient or weather, not both"]
        return []


def _load_line_bearings(table: dict[str, Any], folder: Path) -> list[str]:
    """Load the bearings of `lines` in the table of a case; return what is wrong."""
    if not isinstance(table.get("lines"), list | tuple):
        return []
    faults: list[str] = []
    table["lines"] = [dict(line) if isinstance(line, dict) else line for line in table["lines"]]
    for number, line in enumerate(table["lines"]):
        if isinstance(line, dict):
            faults += load_things(line, "bearing", load_device, folder, before=f"lines[{number}].")
            absolute(line, "weather", folder)
    return faults


def _lines_faults(lines: Sequence[OnLine], structure: Structure) -> list[str]:
    """Return faults of lines: unknown or given twice, weather that cannot be read."""
    faults = line_faults(structure, [item.line for item in lines], "lines")
    lines_with_bearing = {item.line for item in lines if item.bearing is not None}
    if lines_with_bearing >= {line.name for line in structure.bearings}:
        faults.append(
            "lines: every line has its own bearing, so that bearings is not used; remove it, "
            "or leave a line without its own bearing"
        )
    for item in lines:
        if item.weather is not None:
            faults += _weather_faults(item.weather, f"lines, {item.line}: weather")
    return faults


def _weather_faults(path: str, key: str) -> list[str]:
    """Return why a file cannot be the weather before an earthquake."""
    try:
        time = read_air(path).time
    except InputError as error:
        return error.lines(key)
    lasts = time[-1] - time[0]
    if 1.0 <= lasts <= LONGEST:
        return []
    return [f"{key}: lasts {lasts:g} s; must be 1 to {LONGEST:g} s"]


def _into_structure(
    lines: Sequence[OnLine], structure: Structure
) -> tuple[tuple[OnLine, ...], Structure]:
    """Put counts and stiffnesses of lines into the structure; return the lines without them."""
    structure_keys = ("count", "equivalent_stiffness", "axial")
    changes = {
        item.line: {
            key: getattr(item, key) for key in structure_keys if getattr(item, key) is not None
        }
        for item in lines
    }
    if not any(changes.values()):
        return tuple(lines), structure
    bearings = [line.model_copy(update=changes.get(line.name, {})) for line in structure.bearings]
    stripped = [item.model_copy(update=dict.fromkeys(structure_keys)) for item in lines]
    # An item that only had a count or a stiffness is done with; one of an unknown line stays, so
    # that the checks report it.
    line_names = {line.name for line in bearings}
    remaining = tuple(
        item for item in stripped if _has_line_settings(item) or item.line not in line_names
    )
    # Sources of replaced values do not hold for the new ones.
    changed = {
        f"bearings[{place}].{key}"
        for place, line in enumerate(structure.bearings)
        for key in changes.get(line.name, ())
    }
    sources = {key: text for key, text in structure.sources.items() if key not in changed}
    return remaining, structure.model_copy(update={"bearings": bearings}).with_sources(sources)


def _has_line_settings(item: OnLine) -> bool:
    """Return whether a line has settings of its own other than those of the structure."""
    settings = (item.bearing, item.ambient, item.weather, item.axial_force, item.state)
    return any(value is not None for value in settings)


Command = Literal["bridge", "hybrid"]
Kept = Literal["rubber", "cells"]  # temperatures
DEFAULTS: dict[str, dict[str, Any]] = {
    "bridge": {
        "structure": "pier-p1",
        "bearings": ["shen-bilinear-bridge", "shen-hdr-bridge", "shen-lhdr-bridge"],
        "motions": ["jra-i-i-1", "jra-i-i-2", "jra-ii-i-1", "jra-ii-i-2"],
        "ambient": ["23 degC", "0 degC", "-20 degC"],
    },
    "hybrid": {
        "structure": "hybrid-pier",
        "bearings": ["shen-hdr-specimen", "shen-lhdr-specimen"],
        "motions": ["jra-ii-ii-1"],
        "ambient": ["23 degC", "0 degC", "-20 degC"],
        "duration": "20 s",
    },
}
START_KEYS = ("initial_result", "initial_state")  # only one of them
LOADERS = {  # of what a case names
    "structure": load_structure,
    "bearings": load_device,
    "rig": load_rig,
    "limits": load_limits,
}
PSEUDO_DYNAMIC_SPEED = 10.0  # of the test of Shen (2023) [mm/s]
Mode = Literal["rt", "pd"]
ONE_OR_SEVERAL = BeforeValidator(lambda mode: (mode,) if isinstance(mode, str) else mode)


class Laboratory(Strict):
    """A specimen in the loop.

    Attributes
    ----------
    mode : "rt" is a test in real time; in "pd" (pseudo-dynamic) the actuator moves at `speed`,
        and the time of the specimen is longer. With both, every combination is run twice.
    speed : speed of the actuator in "pd" [mm/s], in [1e-3, 1e4].
    delay : delay of the actuator [s], in [0, 1].
    force_noise : standard deviation of the measured force [kN], in [0, 1e5].
    seed : seed of the noise.
    compensation : order of the polynomial that extrapolates the command by the delay (Horiuchi
        et al., 1999), in [0, 4]; 0 is no compensation, 3 is usual.
    specimen : address of a specimen or program that takes the place of the modelled bearing,
        tcp://HOST:PORT. It has its own delay; `delay` is for `compensation` only.
    time_out : largest time in which the specimen answers [s], in [0.001, 1e5].
    force_limit : largest measured force of the specimen [kN], in [0.001, 1e6]; the test stops.
    displacement_limit : largest displacement of the specimen [mm], in [0.001, 1e5], likewise.
    """

    mode: Annotated[tuple[Mode, ...], ONE_OR_SEVERAL, Field(min_length=1)] = ("rt",)
    speed: Annotated[float, in_unit("mm/s"), Field(ge=1e-3, le=1e4)] = PSEUDO_DYNAMIC_SPEED
    delay: Annotated[float, in_unit("s"), Field(ge=0, le=1)] = 0.0
    force_noise: Annotated[float, in_unit("kN"), Field(ge=0, le=1e5)] = 0.0
    seed: Annotated[int, Field(ge=0)] = 0
    compensation: Annotated[int, Field(ge=0, le=4)] = 0
    specimen: str | None = None
    time_out: Annotated[float, in_unit("s"), Field(ge=1e-3, le=1e5)] = 10.0
    force_limit: Annotated[float, in_unit("kN"), Field(ge=1e-3, le=1e6)] | None = None
    displacement_limit: Annotated[float, in_unit("mm"), Field(ge=1e-3, le=1e5)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        limits = ("force_limit", "displacement_limit") if "specimen" not in values else ()
        faults = [f"{key}: needs a specimen" for key in limits if key in values]
        if values.get("compensation") and "delay" not in values:
            faults.append("compensation: requires delay")
        return faults

    @field_validator("specimen")
    @classmethod
    def _address(cls, specimen: str | None) -> str | None:
        if specimen is not None:
            read_address(specimen)
        return specimen

    @field_validator("mode")
    @classmethod
    def _mode_once(cls, mode: tuple[Mode, ...]) -> tuple[Mode, ...]:
        if len(set(mode)) < len(mode):
            raise ValueError("one is given more than once")
        return mode

    @property
    def _needs_one_step(self) -> bool:
        """Whether the specimen must be moved once a step."""
        imperfect = self.delay > 0.0 or self.force_noise > 0.0
        return imperfect or self.specimen is not None or "pd" in self.mode


class Stepping(Strict):
    """How the structure is integrated in time.

    Attributes
    ----------
    dt : largest time step [s], in [1e-6, 0.1].
    method : time integration: "average-acceleration", "linear-acceleration" or
        "predictor-corrector" (default of a hybrid test).
    mass : mass matrix: "consistent" or "published".
    damping : kind of damping: "modal", "rayleigh", "element", "none", "source" or
        "source-with-bearings"; by default that of the structure.
    """

    dt: Annotated[float, in_unit("s"), Field(ge=1e-6, le=0.1)] = 0.005
    method: Method = "average-acceleration"
    mass: MassModel = "consistent"
    damping: DampingKind | None = None


AxialLevel = Literal["off", "dead", "overturning", "vertical"]


class EarthquakeAnalysis(ModelOptions, Stepping):
    """How to compute, and what to keep; options of lead do not concern a bearing without lead.

    Attributes
    ----------
    keep_every : keep every n-th step of the histories.
    keep : temperatures: "rubber", and "cells" for those through the height.
    components : horizontal components of the ground motion that act together on a structure in
        plan, 1 or 2; 2 by default there. With 1 each direction is analysed on its own, without
        twist.
    axial : axial forces of bearings that act on the shear force, of lines with a table `axial`:
        "off" (default), "dead" (constant), "overturning" (by the transverse inertia too) or
        "vertical" (and by the vertical ground motion).
    axial_factor : what the part of the axial force in the shear force counts on: "overlap"
        (default) of top and bottom, or "potential", the form that has an energy.
    """

    keep_every: Annotated[int, Field(ge=1)] = 2
    keep: tuple[Kept, ...] = ("rubber",)
    components: Annotated[int, Field(ge=1, le=2)] | None = None
    axial: AxialLevel | None = None  # None: off
    axial_factor: AxialFactor | None = None  # None: overlap

    @property
    def has_axial(self) -> bool:
        """Whether axial forces act on the shear force."""
        return self.axial not in (None, "off")

    @field_validator("keep")
    @classmethod
    def _with_rubber(cls, keep: tuple[str, ...]) -> tuple[str, ...]:
        if "rubber" not in keep:
            raise ValueError('tables and warnings need "rubber"')
        return keep


class FurtherAnalyses(Strict):
    """What is analysed besides the runs of a case; neither changes them.

    Attributes
    ----------
    compare : compare the result with earlier models; for a path, with a test on a line.
    bands : also analyse what tests do not decide: the rate dependence above their rates, and small
        loops.
    compare_components : compare two horizontal components that act together with one at a time.
    """

    compare: bool | None = None
    bands: bool | None = None
    compare_components: bool | None = None


class EarthquakeInput(Strict):
    """Every combination of bearing, motion, ambient temperature and mode is one run.

    Attributes
    ----------
    command : "bridge", or "hybrid" with a specimen in the loop.
    structure : structure on bearings: library name, TOML file, or table.
    bearings, motions : one or several: library name, file, or table.
    ambient : ambient temperature, also that of the bearings at the start [degC], in [-100, 100].
    weather : file of the air temperature until the earthquake (a table or EPW), instead of
        `ambient`. Faces and sides of the bearings then have other defaults.
    duration : largest duration of the motions [s], in [0.001, 1e6]; by default their full length.
    analysis : how to compute, and what to keep.
    laboratory : of a specimen in the loop.
    initial_state : where an earlier test left the bearing; of one bearing that is not bilinear.
        `initial_result` of a file becomes it.
    lines : bearing lines with their own bearing, ambient temperature, axial force or count.
    sources : of the numbers of bearings, structure and rig, by name and dotted key, where their
        own files have some;
        for documents only.
    rig : test rig (name or file); a warning names the limits that a run exceeds.
    axial_force : axial force on one bearing [kN], positive in compression, in [-1e6, 1e6], for
        checks of stress and critical load.
    """

    command: Command
    structure: Structure
    bearings: Annotated[list[Device], Field(min_length=1, max_length=MOST_OF["bearings"])]
    motions: Annotated[list[Motion], Field(min_length=1, max_length=MOST_OF["motions"])]
    ambient: Annotated[Ambients, Field(min_length=1, max_length=MOST_OF["ambient"])]
    weather: Annotated[str, Field(min_length=1)] | None = None
    duration: Annotated[float, in_unit("s"), Field(ge=1e-3, le=1e6)] | None = None
    analysis: EarthquakeAnalysis = EarthquakeAnalysis()
    laboratory: Laboratory | None = None
    initial_state: SpecimenState | None = None
    lines: Annotated[tuple[OnLine, ...], Field(max_length=40)] = ()
    rig: Rig | None = None
    axial_force: AxialForce | None = None
    sources: dict[str, dict[str, str]] | None = None


class EarthquakeCase(FurtherAnalyses, CodeChecks, EarthquakeInput):
    """The runs of an earthquake analysis, the checks of its bearings, and further analyses."""

    @property
    def climates(self) -> int:
        """Number of temperatures that a motion is met at."""
        return len(self.ambient) if self.weather is None else 1

    @property
    def modes(self) -> tuple[str, ...]:
        """Modes of the laboratory, each a separate run; one without a name if there is none."""
        return self.laboratory.mode if self.laboratory is not None else ("",)

    @property
    def components(self) -> int:
        """Number of horizontal components of the ground motion that act together."""
        return self.analysis.components or (2 if self.structure.plan else 1)

    @property
    def directions(self) -> tuple[str, ...]:
        """Directions that are analysed on their own, each a separate run; one without a name."""
        return ("x", "y") if self.structure.plan and self.components == 1 else ("",)

    @property
    def specimen(self) -> str | None:
        """Address of a specimen outside; None where all bearings are calculated."""
        return None if self.laboratory is None else self.laboratory.specimen

    def axial_forces(self) -> dict[str, float]:
        """Return the axial force on one bearing of each line that has one, by line [kN]."""
        line_forces = {
            line.name: max(line.axial.dead_load)
            for line in self.structure.bearings
            if line.axial is not None and self.axial_force is None
        }
        line_forces |= {
            item.line: item.axial_force for item in self.lines if item.axial_force is not None
        }
        if self.axial_force is None:
            return line_forces
        return {
            line.name: line_forces.get(line.name, self.axial_force)
            for line in self.structure.bearings
        }

    @property
    def reported_line_number(self) -> int:
        """Number of the bearing line that histories and the table of peaks are about."""
        lines_with_bearing = [item.line for item in self.lines if item.bearing is not None]
        return reported_line(self.structure, lines_with_bearing)

    def to_toml(self) -> str:
        """Return the case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self, without="" if self.weather is None else "ambient")

    def with_state(self, state: RubberState) -> "EarthquakeCase":
        """Return the case with the rubber of all bearings in a state."""
        lines = tuple(item.model_copy(update={"state": None}) for item in self.lines)
        analysis = self.analysis.model_copy(update={"state": state})
        return self.model_copy(update={"analysis": analysis, "lines": lines})

    def faults(self) -> list[str]:
        """What the parts do to each other."""
        faults = []
        names = [bearing.name for bearing in self.bearings]
        duplicates = {n for n in names if names.count(n) > 1}
        faults += [f'bearings: "{n}" is given more than once' for n in duplicates]
        if self.weather is not None:
            faults += _weather_faults(self.weather, "weather")
        faults += _lines_faults(self.lines, self.structure)
        if self.initial_state is not None:
            faults += self._misfits_of_state()
        faults += self.code_faults(of_bridge=self.command == "bridge")
        if self.bands and self.specimen is not None:
            faults.append("bands: a specimen outside has no other law")
        # The other methods try a step several times; a real specimen can be moved once only, and
        # errors of the actuator are those of one move.
        repeats_steps = self.analysis.method != "predictor-corrector"
        if repeats_steps and self.laboratory is not None and self.laboratory._needs_one_step:
            faults.append(
                "laboratory: delay, force_noise, specimen and mode pd need analysis.method = "
                '"predictor-corrector", which moves the specimen once per step'
            )
        runs = [len(self.bearings), len(self.motions), self.climates, len(self.modes)]
        if self.specimen is not None and max(runs) > 1:
            faults.append(
                "laboratory.specimen: a specimen is tested once; give one bearing, one motion, one "
                "ambient temperature and one mode"
            )
        faults += self._plan_faults() if self.components > 1 else []
        faults += self._axial_faults()
        if self.structure.device_list and not repeats_steps:
            faults.append(f'analysis.method = "predictor-corrector": {NO_VELOCITY}')
        for bearing in self._all_bearings():
            if isinstance(bearing, Bearing):
                misfits = self.analysis.settled(bearing).misfits(bearing)
                faults += [f"analysis.{text}" for text in misfits]
        for item in self.lines:
            faults += [f"lines, {item.line}: {text}" for text in self._line_state_faults(item)]
        return faults

    def _axial_faults(self) -> list[str]:
        """Return why axial forces cannot act on the shear force."""
        analysis = self.analysis
        if not analysis.has_axial:
            if analysis.axial_factor is not None:
                return ['analysis.axial_factor: needs analysis.axial, such as "dead"']
            return []
        key = f'analysis.axial = "{analysis.axial}"'
        lines = [line for line in self.structure.bearings if line.axial is not None]
        faults = []
        if not lines:
            faults.append(
                f"{key}: no bearing line has a table axial with its dead_load; add it to the "
                "structure, or to lines of the case"
            )
        if analysis.method == "predictor-corrector" or self.command == "hybrid":
            faults.append(f"{key}: not in a hybrid test, whose rig has the vertical load")
        if self.initial_state is not None:
            faults.append(f"{key}: not with initial_state or initial_result")
        if analysis.model == "bilinear" or any(
            isinstance(bearing, BilinearBearing) for bearing in self._all_bearings()
        ):
            faults.append(f"{key}: a bilinear bearing has no plan; give layered bearings only")
        if analysis.axial != "dead" and len(self.directions) > 1:
            faults.append(f"{key}: needs both components in plan; use components = 2")
        if analysis.axial == "vertical":
            without = [motion.title for motion in self.motions if not motion.has_vertical]
            faults += [
                f'{key}: the motion "{title}" has no vertical record; give it the key vertical'
                for title in without
            ]
        return faults + [
            f"bearings, {line.name}: axial.{text}"
            for line in lines
            for text in axial_table_faults(self.structure, line, str(analysis.axial))
        ]

    def _line_state_faults(self, item: OnLine) -> list[str]:
        """Return why the bearings of a line cannot have the state of rubber that it states."""
        if item.state is None:
            return []
        if self.initial_state is not None:
            return ["state: cannot be combined with initial_state"]
        if isinstance(item.bearing, BilinearBearing):
            return [f'state: the bilinear bearing "{item.bearing.name}" has no rubber; omit it']
        return self.analysis.misfit_of_state(item.state)

    def _all_bearings(self) -> list[Device]:
        bearings = [*self.bearings, *(item.bearing for item in self.lines)]
        return list({b.name: b for b in bearings if b is not None}.values())

    def _plan_faults(self) -> list[str]:
        """Return what cannot be combined with two components of the ground motion."""
        faults = []
        if not self.structure.plan:
            faults.append(f'two require plan = true in the structure "{self.structure.name}"')
        if self.analysis.method == "predictor-corrector":
            faults.append('analysis.method = "predictor-corrector" allows one')
        faults += [
            fault
            for bearing in self._all_bearings()
            if isinstance(bearing, Bearing) and self.analysis.model != "bilinear"
            for fault in line_only_faults(bearing, build_model(bearing, self.analysis).constants)
        ]
        return [f"components: {text}" for text in dict.fromkeys(faults)]

    def _misfits_of_state(self) -> list[str]:
        """Whether an earlier test can have left the bearing so."""
        assert self.initial_state is not None
        bearing = self.bearings[0]
        if len(self.bearings) > 1 or not isinstance(bearing, Bearing):
            return ["initial_state: requires a single, layered bearing"]
        if self.weather is not None or self.analysis.model == "bilinear":
            return ["initial_state: cannot be combined with weather or the bilinear model"]
        if self.lines:
            return ["initial_state: cannot be combined with lines"]
        constants = build_model(bearing, self.analysis).constants
        fault = misfit(self.initial_state, constants, self.components)
        return [f"initial_state: {fault}"] if fault else []

    def count_steps(self, motion: GroundMotion | MotionPair) -> tuple[int, float]:
        """Return the number of steps of a motion, and their length [s], which divides its own."""
        # 1e-9: a quotient of 2 that is rounded up to more than 2 is not three steps.
        dt = motion.dt / max(1, math.ceil(motion.dt / self.analysis.dt - 1e-9))
        length = motion.duration if self.duration is None else min(self.duration, motion.duration)
        return round(length / dt), dt

    def motion_faults(self, motions: list[GroundMotion]) -> list[str]:
        """Return faults of a duration without a step, and of motions that only act across."""
        faults = []
        counts = [self.count_steps(motion)[0] for motion in motions]
        if self.duration is not None and 0 in counts:
            faults += [f"duration = {self.duration:g} s is shorter than a step; see analysis.dt"]
        for settings, motion in zip(self.motions, motions, strict=False):
            if settings.angle and not self.structure.plan and not motion.acceleration.any():
                faults.append(
                    f'motions: "{motion.name}" acts across the bridge, but the structure '
                    "moves only along it (plan = true adds the other direction)"
                )
        return faults


def make_earthquake_case(
    table: dict[str, Any], where: str, folder: Path = Path(), **overrides: Any
) -> EarthquakeCase:
    """Check a case from a table with `command` (paths are relative to `folder`) and overrides.

    `overrides` replace values of the table and of its `analysis`; None leaves them. `fixed_base`
    leaves out the springs of foundations.
    """
    table = dict(table)
    command = table.setdefault("command", "bridge")
    if not isinstance(command, str) or command not in DEFAULTS:
        raise InputError(f'command = {command!r}: must be "bridge" or "hybrid"', where)
    # A keyword for one replaces the other one of the file, since a case has only one of them.
    for key, replaced in (("weather", "ambient"), ("ambient", "weather")):
        if overrides.get(key) is not None and overrides.get(replaced) is None:
            table.pop(replaced, None)
    # Keys of the laboratory are replaced one by one: those that are not given stay as in the file.
    lab = overrides.get("laboratory")
    if not (isinstance(lab, dict) and lab.get("specimen")):
        refuse_remote(table, where)
    if isinstance(lab, dict) and isinstance(table.get("laboratory", {}), dict):
        overrides["laboratory"] = overridden(table.get("laboratory", {}), lab, Laboratory)
    table, replacements, faults = load_all(table, overrides, LOADERS, folder)
    table = overridden(table, replacements, EarthquakeCase, {"analysis": EarthquakeAnalysis})
    fixed = table.pop("fixed_base", False)
    if message := too_many(table):  # before loading any of them
        raise InputError(message, where)
    added_faults, motions = _settle(table, command, folder)
    faults += added_faults
    if not isinstance(fixed, bool):
        faults.append(f"fixed_base = {fixed!r}: must be true or false")
    added_faults, earlier = settle_start(table, START_KEYS)
    faults += added_faults
    case = read_case(EarthquakeCase, table, where, faults)
    try:
        lines, structure = _into_structure(case.lines, case.structure)
        structure = fixed_base(structure) if fixed is True else structure
    except InputError as error:
        raise InputError(error.problems, where) from None
    case = case.model_copy(update={"lines": lines, "structure": structure})
    if earlier is not None:
        bearing = case.bearings[0]
        if len(case.bearings) > 1 or not isinstance(bearing, Bearing):
            raise InputError("initial_result: requires a single, layered bearing", where)
        state = left_by(earlier, bearing, case.ambient, where)
        case = case.model_copy(update={"initial_state": state})
    if faults := [*case.faults(), *case.motion_faults(motions)]:
        raise InputError(faults, where)
    devices = [*case.bearings, *(line.bearing for line in case.lines)]
    sourced: list[tuple[Library, Sourced]] = [(STRUCTURES, case.structure)]
    for device in devices:
        if device is not None:
            sourced.append((BEARINGS if isinstance(device, Bearing) else BILINEAR, device))
    sourced += [(RIGS, case.rig)] if case.rig else []
    return case.model_copy(update={"sources": sources_to_keep(sourced, case.sources)})


def load_earthquake_case(path: str | Path, **overrides: Any) -> EarthquakeCase:
    """Read a case from TOML; overrides as of `make_earthquake_case`."""
    return make_earthquake_case(case_table(Path(path)), str(path), Path(path).parent, **overrides)


def list_bearing_tables(case: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the bearings of a resolved case and of its lines, each once."""
    tables = {str(table["name"]): table for table in case["bearings"]}
    for line in case.get("lines", []):
        if isinstance(line.get("bearing"), Mapping):
            tables.setdefault(str(line["bearing"]["name"]), line["bearing"])
    return list(tables.values())


def in_weather(table: Mapping[str, Any]) -> bool:
    """Return whether bearings of a case, as a table, follow a weather before the earthquake."""
    lines = table.get("lines")
    parts = [table, *(lines if isinstance(lines, list | tuple) else [])]
    return any(isinstance(part, Mapping) and part.get("weather") is not None for part in parts)


def settle_surroundings(table: dict[str, Any]) -> None:
    """Fill in the options of faces and side of the bearings in the weather, unless they are set."""
    analysis = table.get("analysis", {})
    if isinstance(analysis, dict):
        table["analysis"] = outdoors()[0] | analysis


def _settle(
    table: dict[str, Any], command: str, folder: Path
) -> tuple[list[str], list[GroundMotion]]:
    """Fill in defaults and load what has a name; return what is wrong, and the motions."""
    faults: list[str] = []
    if "ambient" in table and table.get("weather") is not None:
        faults.append("give ambient or weather, not both")
    if isinstance(table.get("weather"), str):
        absolute(table, "weather", folder)
        table.setdefault("ambient", ["0 degC"])  # not used
    # Before defaults are filled in, since the weather has other ones.
    if in_weather(table):
        settle_surroundings(table)
    absolute(table, "initial_result", folder)
    faults += _load_line_bearings(table, folder)
    defaults = {key: value for key, value in DEFAULTS[command].items() if key not in table}
    faults += [fault for key, load in LOADERS.items() for fault in load_things(defaults, key, load)]
    table |= defaults
    if command == "hybrid":
        table.setdefault("laboratory", {})
        if isinstance(analysis := table.get("analysis", {}), dict):
            table["analysis"] = {"method": "predictor-corrector", **analysis}
    for key in ("bearings", "motions", "ambient"):
        if not isinstance(table[key], list | tuple):
            table[key] = [table[key]]
    table["motions"], motions, motion_faults = settle_motions(table["motions"], folder)
    return [*faults, *motion_faults], motions
