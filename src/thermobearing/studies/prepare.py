"""From a row of a plan to what `run_task` takes; whatever rows share is made once."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from thermobearing.core.records import Floats
from thermobearing.earthquake.run import build_device, build_shaking, lines_of
from thermobearing.earthquake.task import Device, Shaking, Task
from thermobearing.structure.run import Prepared, prepare_structure
from thermobearing.studies.columns import AMBIENT, THINGS, columns_of
from thermobearing.studies.record import Study


@dataclass(frozen=True)
class RunInput:
    """One run, ready.

    Attributes
    ----------
    run, id, seed : of its row in the plan.
    task : what `earthquake.run.run_task` takes: prepared structure, device, ground motion at the
        steps, air, bearing lines, case.
    """

    run: int
    id: str
    seed: int
    task: Task


class Preparer:
    """Makes the runs of a study ready, one after the other.

    Structures, bearings as models, motions on the time step: what rows have in common is made when
    it is first asked for, and kept. For one process; a study is small to send to another.

    Parameters
    ----------
    study : from `load_study` or `make_study`.

    Examples
    --------
    >>> from thermobearing.studies.case import make_study
    >>> from thermobearing.studies.designs import plan
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> study = make_study({"kind": "study", "name": "p1", "factors": factors}, "example")
    >>> row = plan(study).to_dict("records")[0]
    >>> Preparer(study).run_input(row).task.ambient
    0.0
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        things = [column for column in columns_of(study) if column.name in THINGS]
        self._places = {
            column.name: {str(name): k for k, name in enumerate(column.levels)} for column in things
        }
        self._prepared: dict[int, Prepared] = {}
        self._devices: dict[int, Device] = {}
        self._shakings: dict[int, Shaking] = {}

    def run_input(self, row: Mapping[str, Any]) -> RunInput:
        """What a run needs.

        Parameters
        ----------
        row : of the plan, by column: one of `plan(study).to_dict("records")`.
        """
        structure, bearing, motion = (self._places[name][str(row[name])] for name in THINGS)
        air = float(row[AMBIENT])
        device, prepared = self._device(bearing), self._structure(structure)
        case = self.study.case.model_copy(
            update={
                "structure": prepared.structure,
                "bearings": [device.bearing],
                "motions": [self.study.factors.motion.levels[motion]],
                "ambient": [air],
            }
        )
        task = Task(
            prepared=prepared,
            device=device,
            shaking=self._shaking(motion, float(row["scale"])),
            ambient=air,
            lines=lines_of(case, device, self._own(), air, None),
            case=case,
            mode=case.modes[0],
        )
        return RunInput(int(row["run"]), str(row["id"]), int(row["seed"]), task)

    def _structure(self, place: int) -> Prepared:
        """A structure with its matrices, modes and damping."""
        if place not in self._prepared:
            analysis = self.study.case.analysis
            structure = self.study.factors.structure.levels[place]
            self._prepared[place] = prepare_structure(structure, analysis.mass, analysis.damping)
        return self._prepared[place]

    def _device(self, place: int) -> Device:
        """A bearing as the coupled step wants it."""
        if place not in self._devices:
            bearing = self.study.factors.bearing.levels[place]
            self._devices[place] = build_device(self.study.case, bearing)
        return self._devices[place]

    def _own(self) -> list[Device | None]:
        """Devices of lines that have a bearing of their own."""
        return [
            None if line.bearing is None else build_device(self.study.case, line.bearing)
            for line in self.study.case.lines
        ]

    def _shaking(self, place: int, scale: float) -> Shaking:
        """A motion on the time step, scaled."""
        if place not in self._shakings:
            level = self.study.factors.motion.levels[place]
            case = self.study.case.model_copy(update={"motions": [level]})
            self._shakings[place] = build_shaking(case, 0, level.load())
        whole = self._shakings[place]
        ground: Floats = scale * whole.ground
        return Shaking(whole.motion, whole.dt, ground)
