"""Cases of sequences of tests on one specimen: hybrid, cyclic, rests (Table 3.3)."""

import contextlib
import re
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field

from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.cases import absolute, load_all, load_things, read_case
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, in_unit, overridden
from thermobearing.border.title import case_table
from thermobearing.border.toml import to_toml
from thermobearing.cyclic import protocol
from thermobearing.cyclic.case import DEFAULT_BEARING, Analysis, Case, Rig, Temperature, load_rig
from thermobearing.earthquake.case import (
    DEFAULTS,
    EarthquakeAnalysis,
    EarthquakeCase,
    Laboratory,
    Stepping,
)
from thermobearing.earthquake.motions import Motion, settle_motions
from thermobearing.model.effort import too_much
from thermobearing.model.handover import SpecimenState
from thermobearing.model.options import ModelOptions
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.run import Method

MOST_PARTS = 50
LOADERS = {"bearing": load_bearing, "rig": load_rig}  # that a case names
SPECIMEN_KEYS = {"bearing", "bearings"}  # keys of the specimen, not of a part
Name = Annotated[str, Field(max_length=60)]


class Part(Strict):
    """Fields of all parts: a name for folders and tables; the ambient temperature if it differs."""

    name: Name = ""
    ambient: Temperature | None = None


class CyclicPart(Part):
    """Steps of a displacement-controlled test, as in a cyclic case."""

    part: Literal["cyclic"] = "cyclic"
    dt: Annotated[float, in_unit("s"), Field(ge=1e-6, le=10)] = 0.005
    steps: Annotated[list[protocol.Step], Field(min_length=1, max_length=10_000)]

    def test(self) -> protocol.CyclicTest:
        """Return the displacement test of the part."""
        return protocol.CyclicTest(name=self.name or "cyclic", dt=self.dt, steps=self.steps)


class RestPart(Part):
    """A pause: for a time, or until every cell is `within` some kelvin of the ambient."""

    part: Literal["rest"] = "rest"
    duration: protocol.Seconds | None = None
    within: Annotated[float, in_unit("K"), Field(ge=1e-6, le=1000)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        return protocol.Rest._conflicts(values)

    def test(self) -> protocol.CyclicTest:
        """Return the displacement test of the part."""
        rest = protocol.Rest(duration=self.duration, within=self.within)
        return protocol.CyclicTest(name=self.name or "rest", steps=[rest])


class HybridPart(Part, Stepping):
    """One run of a hybrid test, as in an earthquake case with the command hybrid."""

    part: Literal["hybrid"] = "hybrid"
    motion: Motion
    structure: Structure
    duration: Annotated[float, in_unit("s"), Field(ge=1e-3, le=1e6)] | None = None
    laboratory: Laboratory = Laboratory()
    method: Method = "predictor-corrector"


AnyPart: TypeAlias = CyclicPart | RestPart | HybridPart


class SequenceAnalysis(ModelOptions):
    """Model of the specimen in every part; every n-th step of the histories is kept."""

    keep_every: Annotated[int, Field(ge=1)] = 1


class SequenceCase(Strict):
    """A sequence of parts on one specimen; each begins in the final state of the previous one.

    Attributes
    ----------
    command : "sequence".
    name : for titles.
    bearing : the specimen: a name, a TOML file, or a table.
    ambient : ambient temperature [degC], in [-100, 100]; a part may have its own. The specimen
        starts at that of the first part.
    parts : each a table with `part`, "hybrid", "cyclic" or "rest"; at most 50.
    between : action of the rig after each part: "unloaded" (default): it returns to zero force,
        where the instruments are zeroed, so that the next part starts from zero; "as-left": it
        holds the specimen at its displacement and force.
    rig : limits of the test rig, its name or file.
    analysis : how to model the specimen.
    """

    command: Literal["sequence"] = "sequence"
    name: Name = "sequence"
    bearing: Bearing
    ambient: Temperature
    parts: Annotated[
        list[Annotated[AnyPart, Field(discriminator="part")]],
        Field(min_length=1, max_length=MOST_PARTS),
    ]
    between: Literal["unloaded", "as-left"] = "unloaded"
    rig: Rig | None = None
    analysis: SequenceAnalysis = SequenceAnalysis()

    def to_toml(self) -> str:
        """Return the case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self)

    def label(self, number: int) -> str:
        """Return the number and name of a part, for folders and tables."""
        part = self.parts[number]
        name = re.sub(r"[^A-Za-z0-9+.]+", "-", part.name).strip("-.") or part.part
        return f"{number + 1:02d}-{name}"

    def whole_part(self, number: int, state: SpecimenState | None) -> Case | EarthquakeCase:
        """Return a part as a separate case that starts from a state; None: the virgin specimen."""
        part = self.parts[number]
        options = {name: getattr(self.analysis, name) for name in SequenceAnalysis.model_fields}
        common = {
            "ambient": [self.ambient if part.ambient is None else part.ambient],
            "rig": self.rig,
            "initial_state": state,
        }
        if isinstance(part, HybridPart):
            stepping = {name: getattr(part, name) for name in Stepping.model_fields}
            return EarthquakeCase(
                command="hybrid",
                structure=part.structure,
                bearings=[self.bearing],
                motions=[part.motion],
                duration=part.duration,
                laboratory=part.laboratory,
                analysis=EarthquakeAnalysis(**(options | stepping)),
                **common,
            )
        return Case(bearing=self.bearing, test=part.test(), analysis=Analysis(**options), **common)

    def faults(self) -> list[str]:
        """Return errors in the combination of parts and specimen."""
        messages = [f"analysis.{text}" for text in self.analysis.misfits(self.bearing)]
        rubber_thickness, displacement, total_steps = self.bearing.total_rubber_thickness, 0.0, 0.0
        displacement_known = True
        for number, part in enumerate(self.parts):
            if isinstance(part, HybridPart):
                messages += [f"parts[{number}]: {text}" for text in self._hybrid_faults(number)]
                # After unloading the instruments are zeroed: the next part starts from zero.
                displacement_known = self.between == "unloaded"
                continue
            test = part.test()
            moving = [step for step in test.steps if not isinstance(step, protocol.Rest)]
            if not displacement_known and moving and not isinstance(moving[0], protocol.Ramp):
                messages.append(
                    f"parts[{number}]: the displacement after a hybrid test is not known in "
                    "advance; begin with a ramp, such "
                    'as { step = "ramp", to = "0 mm", speed = "1 mm/s" }, or omit between'
                )
                displacement_known = True
            if test.in_plane:
                messages.append(
                    f"parts[{number}]: a path in the plane cannot be part of a sequence"
                )
                continue
            faults, steps = protocol.survey(test, rubber_thickness, displacement)
            messages += [f"parts[{number}].{text}" for text in faults]
            total_steps += steps
            displacement_known = displacement_known or bool(moving)
            if self.between == "as-left":
                displacement = _end_displacement(test, rubber_thickness, displacement)
        cells = len(self.analysis.build_stack(self.bearing).part)
        kept_steps = total_steps / self.analysis.keep_every
        return messages or too_much(total_steps, cells, kept_steps * 3 * cells)

    def _hybrid_faults(self, number: int) -> list[str]:
        """Return the errors of a hybrid part as a separate analysis."""
        case = self.whole_part(number, None)
        assert isinstance(case, EarthquakeCase)
        lines = len(case.structure.bearings)
        faults: list[str] = []
        if lines != 1:
            faults.append(f"the structure has {lines} bearing lines; it must have exactly one")
        return [*faults, *case.faults(), *case.motion_faults([case.motions[0].load()])]


def _end_displacement(
    test: protocol.CyclicTest, rubber_thickness: float, displacement: float
) -> float:
    """Return the displacement after a test that begins at `displacement` [mm]."""
    for step in test.steps:
        if isinstance(step, protocol.Ramp):
            displacement = step.target(rubber_thickness)
        elif isinstance(step, protocol.Cycles):
            displacement = 0.0
        elif isinstance(step, protocol.Recorded):
            with contextlib.suppress(InputError):  # reported by the survey
                displacement = float(step.points(None)[1][-1])
    return displacement


def make_sequence_case(
    table: dict[str, Any], where: str, folder: Path = Path(), **overrides: Any
) -> SequenceCase:
    """Check a case from a table, whose paths are relative to `folder`, and overrides by key."""
    table = {"ambient": "23 degC", "bearing": DEFAULT_BEARING} | table
    table, replacements, faults = load_all(table, overrides, LOADERS, folder)
    table = overridden(table, replacements, SequenceCase, {"analysis": SequenceAnalysis})
    if isinstance(table.get("parts"), list):
        table["parts"] = [
            _settle_part(faults, f"parts[{k}]", part, folder)
            for k, part in enumerate(table["parts"])
        ]
    case = read_case(SequenceCase, table, where, faults)
    if faults := case.faults():
        raise InputError(faults, where)
    return case.model_copy(update={"analysis": case.analysis.settled(case.bearing)})


def load_sequence_case(path: str | Path, **overrides: Any) -> SequenceCase:
    """Read a case from TOML; overrides as of `make_sequence_case`."""
    return make_sequence_case(case_table(Path(path)), str(path), Path(path).parent, **overrides)


def _settle_part(faults: list[str], key: str, part: Any, folder: Path) -> Any:
    """Return a part with defaults, its structure and motion loaded, its files absolute."""
    if not isinstance(part, dict):
        return part
    for name in sorted(SPECIMEN_KEYS & set(part)):
        faults.append(
            f"{key}.{name} = {part[name]!r}: all parts use the same specimen; give the bearing "
            "once, outside the parts, or run tests of other bearings separately"
        )
    part = {name: value for name, value in part.items() if name not in SPECIMEN_KEYS}
    steps = part.get("steps")
    for step in steps if isinstance(steps, list) else []:
        absolute(step, "file", folder)
    if part.get("part") != "hybrid":
        return part
    defaults = DEFAULTS["hybrid"]
    part = {"motion": defaults["motions"][0], "duration": defaults["duration"]} | part
    faults += load_things(part, "structure", load_structure, folder, before=f"{key}.")
    part.setdefault("structure", load_structure(defaults["structure"]))
    (motion, *rotated_motions), _, motion_faults = settle_motions(
        [part["motion"]], folder, f"{key}.motion"
    )
    faults += motion_faults
    if rotated_motions:
        faults.append(f"{key}.motion: has several angles; a test has one")
    return part | {"motion": motion}
