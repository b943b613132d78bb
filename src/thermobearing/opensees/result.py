"""The result of served bearings: histories, extremes, energy balance, files."""

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

import thermobearing
from thermobearing.bearing.exposure import describe_all, exposure_attribute, exposures
from thermobearing.bearing.model import calibration_ranges
from thermobearing.bearing.sources import is_never_tested
from thermobearing.bearing.state import describe_states, state_attribute, states_table
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd, xr
from thermobearing.core.records import Floats
from thermobearing.cyclic.dataset import depth_attributes, stack_labels, stacked
from thermobearing.cyclic.tables import energy_table
from thermobearing.model.axial import (
    BOLTED,
    DOWELLED,
    AxialPeak,
    axial_peaks,
    unstable_warning,
    uplift_warning,
)
from thermobearing.model.checks import axial_checks, check_rows, failed_checks
from thermobearing.model.constants import LAW_RANGE, outside_law
from thermobearing.model.earlier import BLIND
from thermobearing.model.options import build_model
from thermobearing.model.outcomes import AXIAL_SENTENCES, SENTENCES, UNSTABLE
from thermobearing.opensees.axial import axial_columns
from thermobearing.opensees.case import ServedCase
from thermobearing.opensees.element import CONNECTION_FAILED
from thermobearing.opensees.recording import Served
from thermobearing.quantities.register import quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.validity import VALID_UNTIL, with_invalid_marked
from thermobearing.quantities.warned import UNUSABLE, Warned
from thermobearing.reported import bearing_check_tables
from thermobearing.results.base import DatasetResult
from thermobearing.results.directory import DATASET, RESOLVED, TABLE
from thermobearing.results.metrics import BALANCE, balance_row, loop_energy, relative_residual
from thermobearing.results.ranges import Row, compare_with_tests, outside_tests, reached_by
from thermobearing.results.writing import (
    as_attribute,
    labelled_dataset,
    warnings_attributes,
    without_rounding,
    write_csv,
    write_dataset,
)

RECOVERABLE = "recoverable"
BEARING = ("tag", "pair", "run")  # what the histories of one bearing have in common
NODE_HISTORIES = ("displacement", "force", "shortening", "axial_force")
AXIAL_WORKS = ("lent", "axial_work", "axial_stored")
NODE_WORKS = "Work of the nodes on one bearing of each element"
NODE_WORKS_NOTE = (
    "Work of the nodes = work in - lent + vertical work. The vertical work is stored in "
    "compression, lent to the shear, or lost in tension, but for terms of first order in the step."
)
AXES = "xyz"  # of the degrees of freedom 1, 2 and 3
FAILED_SENTENCE = "An element could not be served to the end: see the warnings."
COLUMNS = (
    "element",
    "direction",
    "ambient_degC",
    "strain_max",
    quantity("bearing_force_max_kN", head="Largest force"),
    "axial_force_min_kN",
    "critical_share",
    "cavitation_share",
    "uplift_mm",
    VALID_UNTIL,
    "energy_kN_mm",
    "rubber_highest_degC",
    "lead_highest_degC",
    "steps",
)


INVALID = ("strain_max", "bearing_force_max_kN", "energy_kN_mm")  # after a bearing is unstable


class ServedResult(DatasetResult):
    """The result of bearings that were elements of an OpenSees model.

    Attributes
    ----------
    dataset : xarray.Dataset
        Dimensions: `element` (a bearing in a direction, from the start or a reset to the end),
        `step` (committed steps; shorter histories are padded with NaN), `layer` and `cell`.
        `clock` is the time of the bearing, `model_time` that of the model. All values are those of
        one bearing, in kN, mm, s and degC.
    """

    title: ClassVar[str] = "Bearings served to OpenSees"
    _figures = "ServedFigures"

    def __init__(self, dataset: "xr.Dataset") -> None:
        self.dataset = dataset

    @classmethod
    def of(
        cls,
        case: ServedCase,
        histories: Sequence[Served],
        problems: Sequence[str] = (),
        notes: Sequence[str] = (),
    ) -> Self:
        """Return the result of a case, with problems and notes of the server as warnings."""
        if not histories:
            raise InputError(
                "no element has been connected: pass line.element(...) to ops.element, or connect "
                "a genericClient element to the port",
                "results()",
            )
        unserved = [Warned(text, "not_served", UNUSABLE) for text in problems]
        result = cls(_dataset(case, histories, [*unserved, *notes]))
        result.dataset.attrs["connection_failed"] = int(bool(problems))
        return result

    @property
    def outcome(self) -> str:
        """The outcome: "completed", "connection_failed", "interrupted", or why a step failed."""
        failed = self.dataset.attrs["connection_failed"]
        return CONNECTION_FAILED if failed else str(super().outcome)

    @property
    def headline(self) -> str:
        """Bearing, number of elements and outcome in a line."""
        data = self.dataset
        count = len(set(data["tag"].values.tolist()))
        elements = f"{count} elements" if count > 1 else "1 element"
        bearing, steps = data.attrs["bearing"], int(data["steps"].values.sum())
        return f"{self.title}: {bearing}, {elements}, {steps} steps, {self.outcome}"

    @property
    def runs(self) -> int:
        """Number of histories."""
        return int(self.dataset.sizes["element"])

    def time(self, run: int) -> Floats:
        """Return the clock of a bearing at its committed steps [s]."""
        clock: Floats = self.dataset["clock"].values[run]
        return clock[np.isfinite(clock)]

    def history(self, run: int) -> "pd.DataFrame":
        """Return times [s], displacement [mm], force [kN] and temperatures [degC] of a bearing."""
        data, rows = self.dataset.isel(element=run), len(self.time(run))
        names = {"time_s": "clock", "model_time_s": "model_time"}
        names |= {"displacement_mm": "displacement", "force_kN": "force"}
        frame = {head: data[name].values[:rows] for head, name in names.items()}
        layers = data["rubber_temperature"].values[:rows].T
        frame |= {f"rubber{j}_degC": values for j, values in enumerate(layers, 1)}
        if self.has_lead:
            frame["lead_degC"] = data["lead_temperature"].values[:rows]
        return pd.DataFrame(frame)

    @property
    def has_lead(self) -> bool:
        """Whether the bearing has lead cores."""
        return bool(self.dataset.attrs["has_lead"])

    @cached_property
    def table(self) -> "pd.DataFrame":
        """One row per history: extremes, energy, temperatures at the end and at most."""
        data, rows = self.dataset, []
        rubber = float(data.attrs["total_rubber_thickness_mm"])
        for run, name in enumerate(data["element"].values):
            history = self.history(run)
            layers = history.filter(regex=r"^rubber\d").to_numpy()
            displacement_max = float(history["displacement_mm"].abs().max())
            row = {
                "element": str(name),
                "direction": int(data["direction"].values[run]),
                "ambient_degC": float(data.attrs["ambient_degC"]),
                "outcome": str(data["outcome"].values[run]),
                "steps": int(data["steps"].values[run]),
                "displacement_max_mm": displacement_max,
                "strain_max": displacement_max / rubber,
                "bearing_force_max_kN": float(history["force_kN"].abs().max()),
                "energy_kN_mm": self.energy["work_in_kN_mm"][run],
                "rubber_highest_degC": float(layers.max()),
                "rubber_end_degC": float(layers[-1].max()),
            }
            row |= self._axial_extremes(run)
            if self.has_lead:
                row["lead_highest_degC"] = float(history["lead_degC"].max())
                row["lead_end_degC"] = float(history["lead_degC"].iloc[-1])
            rows.append(row)
        return pd.DataFrame(rows)

    def _axial_extremes(self, run: int) -> dict[str, float]:
        """Return what the axial force of a history reaches; nothing where it does not act."""
        if "axial_force" not in self.dataset:
            return {}
        rows, data = len(self.time(run)), self.dataset.isel(element=run)
        axial = {name: data[name].values[:rows] for name in axial_columns() if name in data}
        # Beyond cavitation the force hardly rises, so that the extension says how far it goes.
        extension = -axial["shortening"] * axial["vertical_stiffness"] / axial["cavitation_force"]
        dowelled = self.dataset.attrs["joint"] == DOWELLED
        extremes = {
            "axial_force_min_kN": float(axial["axial_force"].min()),
            "critical_share": float((axial["axial_force"] / axial["critical_load"]).max()),
            "cavitation_share": 0.0 if dowelled else float(extension.max(initial=0.0)),
            "uplift_mm": float(-axial["shortening"].min(initial=0.0)) if dowelled else 0.0,
        }
        valid_until = self.dataset[VALID_UNTIL].values
        if np.isfinite(valid_until).any():
            extremes[VALID_UNTIL] = float(valid_until[run])
        return extremes

    @cached_property
    def energy(self) -> "pd.DataFrame":
        """Energy balance at the end of each history [kN mm], as of a cyclic test."""
        data, rows = self.dataset, []
        capacity = float(data.attrs["heat_capacity_kN_mm_per_K"])
        for run, name in enumerate(data["element"].values):
            last = len(self.time(run)) - 1
            energies = {key: float(data[key].values[run, last]) for key in BALANCE}
            # Energy that an earlier analysis left in the rubber was not put in by this one.
            energies[RECOVERABLE] -= float(data[RECOVERABLE].values[run, 0])
            row = {"element": str(name), **balance_row(energies, capacity=capacity)}
            rows.append(row | self._node_works(run, energies["work_in"]))
        return pd.DataFrame(rows)

    def _node_works(self, run: int, work_in: float) -> dict[str, float]:
        """Return the works of the nodes of a bearing whose axial force acts; else nothing."""
        if "axial_work" not in self.dataset:  # nor do earlier results have it
            return {}
        data, rows = self.dataset, len(self.time(run))
        # The other direction of the same bearing has the same works.
        same = np.all([data[name].values == data[name].values[run] for name in BEARING], axis=0)
        histories = {name: data[name].values[:, :rows] for name in NODE_HISTORIES}
        work = sum(
            loop_energy(histories["displacement"][k], histories["force"][k])
            for k in np.flatnonzero(same)
        )
        work += loop_energy(histories["shortening"][run], histories["axial_force"][run])
        works = {name: float(data[name].values[run, rows - 1]) for name in AXIAL_WORKS}
        parts = work_in, works["lent"], works["axial_work"]
        missing = work - (work_in - works["lent"] + works["axial_work"])
        return {
            "node_work_kN_mm": work,
            **{f"{name}_kN_mm": value for name, value in works.items()},
            "element_residual": relative_residual(missing, parts),
        }

    def tables(self) -> dict[str, Table]:
        """Return the extremes of all elements, and their energy balance."""
        columns = [name for name in COLUMNS if not isinstance(name, str) or name in self.table]
        extremes = make_table(self.table, columns, "Extremes of one bearing of each element")
        extremes = with_invalid_marked(extremes, self.table, INVALID)
        checks = bearing_check_tables(self)
        return {"elements": extremes, **checks, **self.energy_tables()}

    def energy_tables(self) -> dict[str, Table]:
        """Return the energy balance of bearings, and of the nodes where axial forces act."""
        energy = self.energy
        if "node_work_kN_mm" not in energy:
            return {"energy": energy_table(energy)}
        names = [str(name) for name in energy]
        first = names.index("node_work_kN_mm")
        works = ["element", "work_in_kN_mm", *names[first:]]
        node_works = make_table(energy, works, NODE_WORKS, note=NODE_WORKS_NOTE)
        return {"energy": energy_table(energy[names[:first]]), "node_works": node_works}

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        attrs = self.dataset.attrs
        return {
            **{key: attrs[key] for key in ("command", "bearing", "scheme", "version")},
            "outcome": self.outcome,
            "warnings": self.warnings,
            **self._limits_summary(),
            "elements": self.table.to_dict("records"),
            "energy": without_rounding(self.energy.to_dict("records")),
        }

    def _write(self, folder: Path) -> None:
        (folder / RESOLVED).write_text(self.dataset.attrs["case"], encoding="utf-8")
        write_csv(folder / TABLE, self.table)
        write_dataset(self.dataset, folder / DATASET)


def _labels(histories: Sequence[Served]) -> list[str]:
    """Return a name for each history: its tag, and what distinguishes those of one tag."""
    several = {key: len({getattr(h, key) for h in histories}) > 1 for key in ("pair", "run")}
    several_directions = len({h.direction for h in histories}) > 1
    labels = []
    for history in histories:
        pair = f".{history.pair}" if several["pair"] else ""
        direction = f" {AXES[history.direction - 1]}" if several_directions else ""
        run = f", run {history.run}" if several["run"] else ""
        labels.append(f"{history.tag}{pair}{direction}{run}")
    return labels


def _dataset(
    case: ServedCase, histories: Sequence[Served], warnings: Sequence[str]
) -> "xr.Dataset":
    """Return the labelled dataset of histories."""
    model = build_model(case.bearing, case.analysis)
    stack = stack_labels(model)
    by_step, by_element = ("element", "step"), ("element",)
    data: dict[str, Any] = {"model_time": (by_step, stacked([h.time for h in histories]))}
    for name, unit, text in stack.response:
        values = stacked([h.response[name] for h in histories])
        data[name] = (by_step, values, {"units": unit, "long_name": text})
    if case.has_axial:
        for name, attributes in axial_columns().items():
            data[name] = (by_step, stacked([h.axial[name] for h in histories]), attributes)
        firsts = [peaks["analysis"].first for peaks in _axial_peaks(histories)]
        data[VALID_UNTIL] = (by_element, np.array(firsts))
    data["strain"] = (by_step, data["displacement"][1] / case.bearing.total_rubber_thickness)
    data["rubber_temperature"] = ((*by_step, "layer"), stacked([h.rubber for h in histories]))
    data["initial_temperature"] = (("element", "cell"), np.array([h.initial for h in histories]))
    data["final_temperature"] = (("element", "cell"), np.array([h.final for h in histories]))
    data["outcome"] = (by_element, np.array([h.outcome for h in histories], dtype=object))
    data["steps"] = (by_element, np.array([len(h.time) - 1 for h in histories]))
    coordinates: dict[str, Any] = {
        "element": (by_element, np.array(_labels(histories), dtype=object)),
        **{
            name: (by_element, np.array([getattr(h, name) for h in histories]))
            for name in ("tag", "pair", "direction", "run")
        },
        "layer": ("layer", np.arange(1, stack.layers + 1)),
        "cell": ("cell", np.arange(1, len(stack.depth) + 1)),
        "depth": ("cell", stack.depth, depth_attributes(model.stack.fold == 2)),
    }
    described = _attributes(case, model, histories, warnings)
    dataset = labelled_dataset(data, coordinates, described)
    for key, variable in dataset.variables.items():
        if not variable.attrs:
            variable.attrs = dict(quantity(str(key)).attributes)
    return dataset


def _axial_peaks(histories: Sequence[Served]) -> list[dict[str, AxialPeak]]:
    """Return the largest shares of the limits of the axial force in each history."""
    return [axial_peaks(history.response["clock"], history.axial) for history in histories]


def _outside_law(
    case: ServedCase, names: Sequence[str], histories: Sequence[Served]
) -> list[Warned]:
    """Return whether rubber left the range of its temperature law, where the model has one."""
    if case.analysis.model in BLIND:
        return []
    bearing = case.bearing
    runs = [
        (name, history.response["clock"], np.asarray(history.rubber))
        for name, history in zip(names, histories, strict=True)
    ]
    source = bearing.sources.get(LAW_RANGE, "")
    return outside_law(bearing.name, bearing.temperature_law, runs, source)


def _tested_rows(case: ServedCase, histories: Sequence[Served]) -> list[Row]:
    """Compare histories with the calibration range of the bearing."""
    bearing, rows = case.bearing, []
    for name, history in zip(_labels(histories), histories, strict=True):
        clock, x = history.response["clock"], history.response["displacement"]
        # Steps of the shortest duration, in which the model's time stands still, have no speed
        # that a test could be compared with.
        dt = np.maximum(np.diff(clock), np.finfo(float).tiny)
        speed = float((np.abs(np.diff(x)) / dt)[dt > 1e-5].max(initial=0.0))
        reached = reached_by(
            clock,
            x,
            speed,
            rubber=bearing.total_rubber_thickness,
            ambient=(case.ambient, case.ambient),
            lead=history.response["lead_temperature"] if bearing.lead else None,
        )
        rows += compare_with_tests(name, reached, calibration_ranges(bearing))
    return rows


def _axial_findings(
    case: ServedCase, histories: Sequence[Served]
) -> tuple[list[dict[str, Any]], list[Warned]]:
    """Return checks of axial forces as rows, and warnings of bearings that buckle or lift."""
    rows, warnings = [], []
    labelled = zip(_labels(histories), histories, _axial_peaks(histories), strict=True)
    for name, history, peaks in labelled:
        element = f"element {name}"
        rows += check_rows(element, case.bearing.name, axial_checks(peaks))
        if history.outcome == UNSTABLE:
            warnings.append(unstable_warning(element, peaks["analysis"]))
        shortening = history.axial["shortening"]
        if case.joint == DOWELLED and shortening.min() < 0.0:
            first = float(history.response["clock"][np.argmax(shortening < 0.0)])
            warnings.append(uplift_warning(f"{element} ", first, -float(shortening.min())))
    return rows, warnings


def _attributes(
    case: ServedCase, model: Any, histories: Sequence[Served], warnings: Sequence[str]
) -> dict[str, Any]:
    """Return provenance, warnings and the calibration range as attributes."""
    bearing, constants, names = case.bearing, model.constants, _labels(histories)
    ranges, rows = calibration_ranges(bearing), _tested_rows(case, histories)
    checks, of_axial = _axial_findings(case, histories) if case.has_axial else ([], [])
    factors = exposures([bearing], case.analysis.exposure)
    states = states_table({bearing.name: (bearing, case.analysis.state)})
    lead = constants.lead.cores * constants.lead.capacity if bearing.lead else 0.0
    attributes = {
        "title": f"{bearing.name} in OpenSees",
        "command": "serve",
        "bearing": bearing.name,
        **{key: getattr(model.options, key) for key in ("model", "scheme", "integrator")},
        "version": thermobearing.__version__,
        "case": case.to_toml(),
        "ambient_degC": case.ambient,
        "count": case.count,
        "area_mm2": bearing.area,
        "total_rubber_thickness_mm": bearing.total_rubber_thickness,
        "heat_capacity_kN_mm_per_K": float(constants.cells.capacity.sum() + lead),
        "has_lead": int(bearing.lead is not None),
        "half_stack": int(model.stack.fold == 2),
        **warnings_attributes(
            [
                *describe_all(factors),
                *describe_states(states),
                *_outside_law(case, names, histories),
                *failed_checks(checks),
                *of_axial,
                *outside_tests(
                    bearing.name, rows, ranges, never_tested=is_never_tested(bearing.sources)
                ),
                *warnings,
            ]
        ),
        **({"tested_range": rows} if rows else {}),
        **({"bearing_checks": checks, "joint": case.joint or BOLTED} if case.has_axial else {}),
        **exposure_attribute(factors),
        **state_attribute(states),
        "sentences": SENTENCES
        | (AXIAL_SENTENCES if case.has_axial else {})
        | {CONNECTION_FAILED: FAILED_SENTENCE},
    }
    return {key: as_attribute(value) for key, value in attributes.items()}
