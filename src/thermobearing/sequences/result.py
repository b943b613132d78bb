"""What a sequence left behind: the results of its parts, one table, one figure."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import thermobearing
from thermobearing.border.deprecated import renamed
from thermobearing.border.showing import Shown
from thermobearing.cyclic.result import Result
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.outcomes import INTERRUPTED, SENTENCES
from thermobearing.results.ranges import one_per_cause
from thermobearing.results.writing import limits_summary
from thermobearing.sequences.case import SequenceCase

if TYPE_CHECKING:
    from thermobearing.sequences.output import SequenceFigures

PartResult = Result | EarthquakeResult


class SequenceResult(Shown):
    """Parts one after the other on one specimen.

    Attributes
    ----------
    case : what was asked for.
    parts : a `Result` of each cyclic part and rest, an `EarthquakeResult` of each hybrid one; as
        far as they came.
    interrupted : whether somebody stopped it.
    """

    def __init__(
        self, case: SequenceCase, parts: list[PartResult], *, interrupted: bool = False
    ) -> None:
        self.case = case
        self.parts = parts
        self.interrupted = interrupted

    def __getitem__(self, number: int) -> PartResult:
        return self.parts[number]

    @property
    def headline(self) -> str:
        """What it is, in a line."""
        name = self.case.bearing.name
        return f"SequenceResult of {name}: {len(self.parts)} parts, {self.outcome}"

    def show(self) -> None:
        """Print the tables that the command prints."""
        from thermobearing.sequences.output import print_sequence

        print_sequence(self)

    @property
    def outcome(self) -> str:
        """Completed, or what ended a part early."""
        if self.interrupted:
            return INTERRUPTED
        ended = [part.outcome for part in self.parts if part.outcome != "completed"]
        return ended[0] if ended else "completed"

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try."""
        ended = [part.sentence for part in self.parts if part.outcome != "completed"]
        return ended[0] if ended else SENTENCES[self.outcome]

    @property
    def warnings(self) -> list[str]:
        """Sentences of the parts that a reader must know."""
        parts = enumerate(self.parts)
        return one_per_cause((self.case.label(k), w) for k, part in parts for w in part.warnings)

    def history(self, number: int) -> pd.DataFrame:
        """Time [s], displacement [mm], force [kN] and temperatures [degC] of a part.

        The time of a hybrid part is that of the earthquake, whatever its actuator takes.
        """
        part = self.parts[number]
        data = part.dataset
        if isinstance(part, EarthquakeResult):
            rows = np.isfinite(data["time"].values[0])
            names = {"displacement_mm": "bearing_displacement", "force_kN": "bearing_force"}
            time = data["time"].values[0]
        else:
            rows = data["segment"].values[0] >= 0
            names = {"displacement_mm": "displacement", "force_kN": "force"}
            time = part.time(0)
        frame = {"time_s": time[rows]}
        frame |= {name: data[key].values[0, rows] for name, key in names.items()}
        if "rubber_temperature" in data:
            columns = data["rubber_temperature"].values[0, rows].T
            frame |= {f"rubber{j}_degC": column for j, column in enumerate(columns, 1)}
        if self.case.bearing.lead is not None and "lead_temperature" in data:
            frame["lead_degC"] = data["lead_temperature"].values[0, rows]
        return pd.DataFrame(frame)

    @property
    def table(self) -> pd.DataFrame:
        """One row per part: where it began and ended, what it reached, how it ended."""
        rows = []
        for number, part in enumerate(self.parts):
            history, spec = self.history(number), self.case.parts[number]
            first, last = history.iloc[0], history.iloc[-1]
            energy = part.energy.iloc[0]
            work = "bearing_work_in_kN_mm" if "bearing_work_in_kN_mm" in energy else "work_in_kN_mm"
            air = self.case.ambient if spec.ambient is None else spec.ambient
            row: dict[str, Any] = {
                "part": self.case.label(number),
                "kind": spec.part,
                "ambient_degC": air,
                "outcome": part.outcome,
                "duration_s": last["time_s"],
                "displacement_max_mm": history["displacement_mm"].abs().max(),
                "force_max_kN": history["force_kN"].max(),
                "force_min_kN": history["force_kN"].min(),
                "energy_kN_mm": energy[work],
            }
            degrees = [str(name) for name in history if str(name).endswith("_degC")]
            for name in ["displacement_mm", "force_kN", *degrees]:
                stem, unit = name.rsplit("_", 1)
                row |= {f"{stem}_start_{unit}": first[name], f"{stem}_end_{unit}": last[name]}
            if self.case.rig is not None:
                row["beyond_rig"] = _passed(part.rig)
            row["beyond_tested"] = _passed(part.tested_range)
            rows.append(row)
        return pd.DataFrame(rows)

    @property
    def rig(self) -> pd.DataFrame:
        """What each part asks of each limit of the rig; empty without a rig."""
        return self._of_parts([part.rig for part in self.parts])

    @property
    def tested_range(self) -> pd.DataFrame:
        """What each part asks of the range that the bearing was tested in; empty if not given."""
        return self._of_parts([part.tested_range for part in self.parts])

    def _of_parts(self, tables: list[pd.DataFrame]) -> pd.DataFrame:
        """Tables of the parts below each other, with the part that each row belongs to."""
        found = []
        for number, table in enumerate(tables):
            if len(table):
                table.insert(0, "part", self.case.label(number))
                found.append(table)
        return pd.concat(found, ignore_index=True) if found else pd.DataFrame()

    def summary(self) -> dict[str, Any]:
        """What summary.json says."""
        rows = self.table.to_dict("records")
        return {
            "command": "sequence",
            "name": self.case.name,
            "bearing": self.case.bearing.name,
            "scheme": self.case.analysis.scheme,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "warnings": self.warnings,
            **limits_summary(self.rig, self.tested_range),
            "parts": [
                {str(k): getattr(v, "item", lambda v=v: v)() for k, v in r.items()} for r in rows
            ],
        }

    @property
    def plot(self) -> "SequenceFigures":
        """Figures: `result.plot.sequence()`."""
        from thermobearing.sequences.output import SequenceFigures

        return SequenceFigures(self)

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write a result directory with a folder of each part; see docs/files.md."""
        from thermobearing.sequences.output import save_sequence

        return save_sequence(self, Path(directory), overwrite=overwrite, figures=figures)


def _passed(table: pd.DataFrame) -> str:
    """Names of the limits that a part passes."""
    return " ".join(table["limit"][table["passed"]]) if len(table) else ""
