"""Result of a sequence: results of its parts, a table, a figure."""

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing
from thermobearing.bearing.state import state_attribute, states_table
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.opener import is_file
from thermobearing.cyclic.result import Result as CyclicResult
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.outcomes import INTERRUPTED, SENTENCES
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.warned import as_warned, one_per_cause
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import FIGURES, PARTS, RESOLVED, TABLE
from thermobearing.results.ranges import MARKED, TESTED
from thermobearing.results.saved import read_dataset
from thermobearing.results.writing import write_csv
from thermobearing.sequences.case import HybridPart, SequenceCase, load_sequence_case

PartResult = CyclicResult | EarthquakeResult
COLUMNS: tuple[str | Quantity, ...] = (
    "part",
    "kind",
    "ambient_degC",
    quantity("duration_s", head="Duration"),
    "displacement_end_mm",
    quantity("displacement_max_mm", head="Displacement"),
    "strain_max",
    "force_start_kN",
    quantity("force_max_kN", head="Largest force", form=".1f"),
    "force_min_kN",
    "energy_kN_mm",
)


@checked
class SequenceResult(Result):
    """The result of a sequence of tests on one specimen.

    Attributes
    ----------
    case : the input.
    parts : a `Result` of each cyclic part and rest, an `EarthquakeResult` of each hybrid one; only
        the parts that were run.
    interrupted : whether the user stopped it.
    """

    _figures = "SequenceFigures"

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
        """The result in a line."""
        count = f"{len(self.parts)} parts"
        return f"{self.case.name}: {self.case.bearing.name}, {count}, {self.outcome}"

    @property
    def _ended(self) -> PartResult | None:
        return next((part for part in self.parts if part.outcome != COMPLETED), None)

    @property
    def outcome(self) -> str:
        """Outcome: "completed", or the outcome of the part that ended early."""
        if self.interrupted:
            return INTERRUPTED
        return self._ended.outcome if self._ended else COMPLETED

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try."""
        return self._ended.sentence if self._ended else SENTENCES[self.outcome]

    @property
    def warnings(self) -> list[str]:
        """Warnings of the parts; one that several parts have names them all."""
        labels: dict[str, list[str]] = {}
        for k, part in enumerate(self.parts):
            for text in part.warnings:
                labels.setdefault(text, []).append(self.case.label(k))
        return one_per_cause(
            as_warned(text).about(", ".join(names)) for text, names in labels.items()
        )

    def history(self, number: int) -> "pd.DataFrame":
        """Return the time [s], displacement [mm], force [kN] and temperatures [degC] of a part.

        The time of a hybrid part is that of the earthquake, not of the actuator.
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

    @cached_property
    def table(self) -> "pd.DataFrame":
        """One row per part: temperatures at start and end, largest responses, outcome."""
        rows = []
        for number, part in enumerate(self.parts):
            history, case_part = self.history(number), self.case.parts[number]
            ambient = self.case.ambient if case_part.ambient is None else case_part.ambient
            first, last = history.iloc[0], history.iloc[-1]
            energy = part.energy.iloc[0].rename(lambda name: name.removeprefix("bearing_"))
            row: dict[str, Any] = {
                "part": self.case.label(number),
                "kind": case_part.part,
                "ambient_degC": ambient,
                "outcome": part.outcome,
                "duration_s": last["time_s"],
                "displacement_max_mm": history["displacement_mm"].abs().max(),
                "force_max_kN": history["force_kN"].max(),
                "force_min_kN": history["force_kN"].min(),
                "energy_kN_mm": energy["work_in_kN_mm"],
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
    def rig(self) -> "pd.DataFrame":
        """Use of each limit of the rig by each part; empty without a rig."""
        return self._tables_of_parts("rig")

    @property
    def tested_range(self) -> "pd.DataFrame":
        """Use of the calibration range of the bearing by each part; empty if not given."""
        return self._tables_of_parts("tested_range")

    def _tables_of_parts(self, name: str) -> "pd.DataFrame":
        """Return a table of all parts, one after the other, with the part of each row."""
        tables = {self.case.label(k): getattr(part, name) for k, part in enumerate(self.parts)}
        filled: dict[str, pd.DataFrame] = {
            key: table for key, table in tables.items() if len(table)
        }
        if not filled:
            return pd.DataFrame()
        return pd.concat(filled, names=["part"]).reset_index("part").reset_index(drop=True)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        bearing = self.case.bearing
        return {
            "command": "sequence",
            "name": self.case.name,
            "bearing": bearing.name,
            "scheme": self.case.analysis.scheme,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "warnings": self.warnings,
            **self._limits_summary(),
            **state_attribute(states_table({bearing.name: (bearing, self.case.analysis.state)})),
            "parts": self.table.to_dict("records"),
        }

    def tables(self) -> dict[str, Table]:
        """Return tables of the largest responses of parts, and of their temperatures."""
        return {"parts": _parts_table(self)} if self.parts else {}

    def _write(self, folder: Path) -> None:
        (folder / RESOLVED).write_text(self.case.to_toml(), encoding="utf-8")
        write_csv(folder / TABLE, self.table)
        for number, part in enumerate(self.parts):
            part.save(folder / PARTS / self.case.label(number), figures=False)

    def _draw(self, folder: Path) -> None:
        for number, part in enumerate(self.parts):
            part.plot.save_all(folder / PARTS / self.case.label(number) / FIGURES)
        if self.parts:
            super()._draw(folder)


def _passed(table: "pd.DataFrame") -> str:
    """Return the names of the limits that a part exceeds."""
    return " ".join(table["limit"][table["outside"]]) if len(table) else ""


def _parts_table(result: SequenceResult) -> Table:
    rubber = result.case.bearing.total_rubber_thickness
    frame = result.table.assign(strain_max=lambda rows: rows["displacement_max_mm"] / rubber)
    names = [n.removesuffix("_start_degC") for n in map(str, frame) if n.endswith("_start_degC")]
    layers = [name for name in names if name.startswith("rubber")]
    stems = {layers[-1]: "Inner rubber"} if layers else {}
    stems |= {"lead": "Lead"} if "lead" in names else {}
    columns = list(COLUMNS)
    for stem, words in stems.items():
        for end, head in (("start", f"{words}: start"), ("end", "end")):
            columns.append(Quantity(head, "°C", ".1f", f"{stem}_{end}_degC"))
    if (frame["outcome"] != COMPLETED).any():
        frame["outcome"] = frame["outcome"].str.replace("_", " ")
        columns.append(quantity("outcome", head="Ended"))
    places = {"ambient": "ambient_degC", "strain": "strain_max"}
    if "lead" in stems:
        places["lead_temperature"] = "lead_end_degC"
    limits = [str(text).split() for text in frame["beyond_tested"]]
    marked = {name: [limit in row for row in limits] for limit, name in places.items()}
    unmarked_limits = {limit for row in limits for limit in row if limit not in places}
    marked["part"] = [bool(set(row) & unmarked_limits) for row in limits]
    note = ""
    if any(limits):
        # Limits without a column in this table are marked at the name of the part.
        names_of_part = ", ".join(sorted(TESTED[limit][1] for limit in unmarked_limits))
        note = f"{MARKED} (a part: {names_of_part})." if names_of_part else f"{MARKED}."
    caption = "Parts of the sequence"
    return make_table(frame, columns, caption, marked=marked, note=note)


def load_sequence(path: str | Path) -> SequenceResult:
    """Return a saved sequence; InputError where there is no readable one."""
    folder = Path(path)
    if not is_file(folder / RESOLVED):
        raise InputError("is not a result of a sequence: no case.resolved.toml", str(folder))
    case = load_sequence_case(folder / RESOLVED)
    parts: list[PartResult] = []
    for number, part in enumerate(case.parts):
        hybrid = isinstance(part, HybridPart)
        if (part_folder := folder / PARTS / case.label(number)).is_dir():
            data = read_dataset(part_folder, ("structure",) if hybrid else ("segments",))
            parts.append(EarthquakeResult(data) if hybrid else CyclicResult(data))
    ended_early = bool(parts) and parts[-1].outcome != COMPLETED
    return SequenceResult(case, parts, interrupted=len(parts) < len(case.parts) and not ended_early)
