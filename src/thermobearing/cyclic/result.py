"""The result of a displacement-controlled test: measures of cycles, energy balance, files."""

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.lazy import pd, xr
from thermobearing.core.records import Floats
from thermobearing.model.outcomes import PASSED_LIMITS
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.validity import VALID_UNTIL
from thermobearing.results.base import DatasetResult
from thermobearing.results.directory import (
    COMPARISON,
    CYCLE_TABLE,
    DATASET,
    HISTORY,
    RESOLVED,
)
from thermobearing.results.metrics import (
    BALANCE,
    balance_row,
    find_cycles,
    loop_energy,
    measure_cycle,
)
from thermobearing.results.screen import print_warnings, say, show_table
from thermobearing.results.selection import chosen_runs, selected
from thermobearing.results.sums import sum_of_products
from thermobearing.results.writing import (
    DIGITS,
    from_attribute,
    without_formulas,
    without_rounding,
    write_csv,
    write_dataset,
)

CYCLES = "closed_cycle"  # dimension of the measures in a file, and the beginning of their names
COMPONENT = "component"  # dimension of displacements and forces in a plane
AT_PEAK = 1.0 - 1e-6  # of the largest displacement in a plane: a circle has many of them
CSV_BLOCK = 50_000  # rows formatted at a time
STRAIN_DIGITS = 12  # decimals of a strain as a coordinate: less is rounding
SMALL_MISMATCH = 1e-3  # of the peak force: smaller differences of layers are not mentioned
# Heads of a history and names in its dataset; those of layers are after them.
HEADS = {
    "displacement_mm": "displacement",
    "force_kN": "force",
    "stress_MPa": "stress",
    "strain": "strain",
}


def run_name(ambient: float) -> str:
    """Return what a run at an ambient temperature [degC] is called in sentences."""
    return f"the run at {ambient:g} degC"


def column_quantity(name: str) -> Quantity:
    """Return the quantity of a column of `Result.cycles`."""
    if name.startswith("rubber"):
        number = name.removeprefix("rubber").removesuffix("_degC")
        return quantity("rubber_degC", name=name, head=f"Layer {number}")
    return quantity(name)


@checked
class Result(DatasetResult):
    """Outcome of an analysis at one or several ambient temperatures.

    Its `dataset` has named dimensions and a unit on every variable; `result["force"]` is
    `result.dataset["force"]`. It is labelled at its first use, which takes as long as a
    short run. `compared` holds the results of the same test by other models, by name, this one
    first; it is empty unless they were run.

    Parameters
    ----------
    dataset : xarray.Dataset or callable
        The dataset, or the function that creates it at its first use.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
    >>> result = tb.run(tb.load_bearing("shen-hdr-specimen"), test, ambient=23)
    >>> result["force"].attrs["units"]
    'kN'
    """

    _figures = "Figures"
    compared: Mapping[str, "Result"] = {}

    def __init__(self, dataset: "xr.Dataset | Callable[[], xr.Dataset]") -> None:
        self._source = dataset

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """Histories and provenance."""
        labelled = self._source() if callable(self._source) else self._source
        self._source = labelled  # releases the runs that it was made of
        return labelled

    @property
    def headline(self) -> str:
        """Return the type and outcome of the result in a line."""
        ambient = ", ".join(f"{t:g}" for t in self.dataset["ambient"].values)
        steps = int(self.dataset["steps"].sum())
        return (
            f"Cyclic test of {self.dataset.attrs['bearing']} at {ambient} degC: {steps} steps, "
            f"{len(self.cycles)} cycles, {self.outcome}"
        )

    table = property(lambda self: self.cycles, doc="The measures of the closed cycles.")

    def sel(self, *, ambient: float | list[float]) -> "Result":
        """Return the runs at some ambient temperatures.

        Parameters
        ----------
        ambient : float or list of float
            One or several temperatures [degC].

        Raises
        ------
        InputError
            No run at such a temperature.

        Examples
        --------
        >>> import thermobearing as tb
        >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
        >>> result = tb.run("shen-hdr-specimen", test, ambient=[-20, 23])
        >>> result.sel(ambient=-20)["ambient"].values
        array([-20.])
        """
        data = self.dataset
        runs = chosen_runs({"ambient": data["ambient"].values}, {"ambient": ambient})
        chosen = selected(data, "ambient", runs, [{run_name(t)} for t in data["ambient"].values])
        if CYCLES in chosen.dims:
            in_selection = np.isin(data[f"{CYCLES}_ambient_degC"].values, chosen["ambient"].values)
            chosen = chosen.isel({CYCLES: np.flatnonzero(in_selection)})
        return Result(chosen)

    def to_dataset(self) -> "xr.Dataset":
        """Return the measures of `cycles` over ambient temperature, strain and cycle.

        Where a strain comes twice, and in recorded histories, the dimensions are ambient
        temperature and number of the cycle. The histories are in `dataset`.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5, 1.0], cycles=2))
        >>> result.to_dataset()["h_eq"].dims
        ('ambient', 'strain', 'cycle')
        """
        if not len(self.cycles):
            return xr.Dataset()
        short = {"ambient_degC": "ambient", "amplitude_strain": "strain"}
        attributes = {short.get(n, n): column_quantity(n).attributes for n in map(str, self.cycles)}
        table, labels = self.cycles.rename(columns=short), ["ambient", "strain", "cycle"]
        # Bearings of other thickness have the strain of a test but for rounding: one coordinate.
        table["strain"] = table["strain"].round(STRAIN_DIGITS)
        recorded = any(segment["kind"] == "recorded" for segment in self.segments)
        if recorded or table.duplicated(labels).any():
            table["number"] = table.groupby("ambient").cumcount() + 1
            labels = ["ambient", "number"]
        dataset = table.set_index(labels).to_xarray()
        for name in dataset.variables:
            dataset[name].attrs |= attributes.get(str(name), {"units": "1"})
        return dataset

    @cached_property
    def segments(self) -> list[dict[str, Any]]:
        """Kind, label and amplitude of each step of the test."""
        return list(from_attribute(self.dataset, "segments"))

    @property
    def has_lead(self) -> bool:
        """Whether the bearing has lead cores."""
        return float(self.dataset.attrs["lead_capacity_kN_mm_per_K"]) > 0.0

    def tested_to(self, run: int, limit: str) -> float:
        """Return the largest tested value of a quantity that a run exceeds; else infinity."""
        self._check_run(run, "ambient")
        return self.largest_tested(run_name(float(self.dataset["ambient"].values[run])), limit)

    @property
    def in_plane(self) -> bool:
        """Whether the bearing moves in a plane: displacements and forces have components."""
        return COMPONENT in self.dataset.dims

    def magnitude(self, name: str) -> Floats:
        """Return the size of a displacement, force, strain or stress, [ambient, time]."""
        values: Floats = self[name].values
        return np.linalg.norm(values, axis=-1) if self.in_plane else np.abs(values)

    def time(self, run: int) -> Floats:
        """Return the times of the kept steps of a run [s]."""
        self._check_run(run, "ambient")
        if "clock" in self.dataset:
            return np.asarray(self.dataset["clock"].values[run])
        return np.asarray(self.dataset["time"].values)

    def _cycle_rows(self, run: int) -> Iterator[tuple[int, int, slice]]:
        """Yield (segment, cycle, rows from the closing point of the cycle before) of a run."""
        names = ("segment", "cycle", "displacement")
        segment, cycle, x = (self.dataset[name].values[run] for name in names)
        x = x[:, 0] if self.in_plane else x
        completed = self.dataset["outcome"].values[run] in ("completed", *PASSED_LIMITS)
        # Numbers of segments and cycles only grow, up to the padding of -1.
        parts = np.searchsorted(segment[segment >= 0], np.arange(len(self.segments) + 1))
        for number, (first, end) in enumerate(pairwise(parts.tolist())):
            kind = self.segments[number]["kind"]
            if first < end and kind == "recorded":
                first = max(first - 1, 0)
                for k, (a, b) in enumerate(find_cycles(x[first:end]), 1):
                    yield number, k, slice(first + a, first + b + 1)
            elif first < end and kind in ("cycles", "path"):
                numbers = np.arange(1, int(cycle[end - 1]) + 2)
                ends = first + np.searchsorted(cycle[first:end], numbers)
                for k, (a, b) in enumerate(pairwise(ends.tolist()), 1):
                    # The last cycle of a run that ended early may be cut off on its way. One on a
                    # line is closed when it is back at zero from the negative side; a turn in the
                    # plane, when something follows it.
                    if kind == "cycles":
                        closed = a < b and x[b - 1] == 0.0 and x[a:b].min() < 0.0
                    else:
                        closed = a < b and (completed or b < parts[-1])
                    if closed:
                        yield number, k, slice(a - 1, b)

    @cached_property
    def cycles(self) -> "pd.DataFrame":
        """One row per closed cycle: amplitude, G_eq, K_eq, h_eq, energy, strength, temperatures.

        Temperatures are those at the end of the cycle; `rubber1_degC` is the outer layer. Of turns
        in a plane the measures are those of the resultant, and energy, stiffness and largest force
        of each component follow. Where the axial force exceeds the critical load, `valid_until_s`
        is when, in rows of cycles that end later; these are no results.
        """
        data, attrs = self.dataset, self.dataset.attrs
        if CYCLES in data.dims:  # measured before the history was thinned
            stored = [str(name) for name in data if str(name).startswith(f"{CYCLES}_")]
            return pd.DataFrame({n.removeprefix(f"{CYCLES}_"): data[n].values for n in stored})
        x, f, work = (data[name].values for name in ("displacement", "force", "work_in"))
        area, rubber = attrs["area_mm2"], attrs["total_rubber_thickness_mm"]
        stress = 1e3 / area
        rows: list[dict[str, Any]] = []
        for run, ambient in enumerate(data["ambient"].values):
            for number, k, where in self._cycle_rows(run):
                last = where.stop - 1
                energy = float(work[run, last] - work[run, where.start])  # in all steps
                step = self.segments[number]
                imposed = step["amplitude_strain"] if step["kind"] != "recorded" else None
                row = {"ambient_degC": float(ambient), "amplitude_strain": imposed, "cycle": k}
                if self.in_plane:
                    row |= _plane_measures(x[run, where], f[run, where], energy)
                    largest = row.pop("amplitude_mm")
                    row["G_eq_MPa"] = row["K_eq_kN_mm"] * rubber * stress
                    row["stress_max_MPa"] = row["peak_force_kN"] * stress
                    if "local_strain" in data:  # not in files of earlier versions
                        row["local_strain"] = float(data["local_strain"].values[run, where].max())
                else:
                    size = {"area": area, "total_rubber_thickness": rubber}
                    m = measure_cycle(x[run, where], f[run, where], **size, work=energy)
                    largest = m.amplitude_mm
                    row |= {
                        "G_eq_MPa": m.G_eq_MPa,
                        "K_eq_kN_mm": m.stiffness_kN_mm,
                        "h_eq": m.h_eq,
                        "stress_max_MPa": m.force_max_kN * stress,
                        "stress_min_MPa": m.force_min_kN * stress,
                        "energy_kN_mm": m.energy_kN_mm,
                        "characteristic_strength_kN": m.characteristic_strength_kN,
                        "post_yield_stiffness_kN_mm": m.post_yield_stiffness_kN_mm,
                    }
                if VALID_UNTIL in data:
                    first = float(data[VALID_UNTIL].values[run])
                    row[VALID_UNTIL] = first if self.time(run)[last] >= first else np.nan
                if imposed is None:
                    row["amplitude_strain"] = largest / rubber
                if "rubber_temperature" in data:
                    layers = data["rubber_temperature"].values[run, last]
                    row |= {f"rubber{j}_degC": value for j, value in enumerate(layers, 1)}
                    if self.has_lead:
                        row["lead_degC"] = data["lead_temperature"].values[run, last]
                rows.append(row)
        return pd.DataFrame(rows)

    @cached_property
    def energy(self) -> "pd.DataFrame":
        """Energy balance at the end of each run [kN mm], one row per ambient temperature.

        `mechanical_residual` is (work in - heat released - recoverable) and
        `thermal_residual` (heat released - stored - lost), both over the largest of work, heat
        stored and heat lost; at least over 1e-6 kN mm (mechanical), and over what warms the
        bearing by 1e-4 K (thermal), see `metrics.energy_balance`. All since the start of the
        test: what an earlier one left in the bearing does not count.
        """
        data = self.dataset
        capacity = np.asarray(from_attribute(data, "heat_capacity_kN_mm_per_K"))
        lead_capacity = float(data.attrs["lead_capacity_kN_mm_per_K"])
        rows = []
        for run, ambient in enumerate(data["ambient"].values):
            last = int(np.flatnonzero(data["segment"].values[run] >= 0)[-1])
            energies = {
                name: float(data[name].values[run, last])
                for name in BALANCE
                if name != "heat_stored"
            }
            energies["recoverable"] -= float(data["recoverable"].values[run, 0])  # of earlier tests
            temperature_rise = (
                data["final_temperature"].values[run] - data["initial_temperature"].values[run]
            )
            stored = sum_of_products(capacity, temperature_rise)
            if self.has_lead:
                lead = data["lead_temperature"].values[run]
                stored += lead_capacity * (float(lead[last]) - float(lead[0]))
            total = float(capacity.sum()) + lead_capacity
            row = balance_row(energies | {"heat_stored": stored}, capacity=total)
            rows.append({"ambient_degC": float(ambient), **row})
        return pd.DataFrame(rows)

    def tables(self) -> dict[str, Table]:
        """Return tables for readers: cycles, energy balance, and other models if they were run."""
        return dict(self._view("tables").result_tables(self))

    def show_briefly(self) -> None:
        """Print title, warnings and the cycle that standards measure; a short test as `show`."""
        table = self._view("tables").measured_cycle_table(self)
        if table is None:
            self.show()
            return
        say(self.headline, "bold")
        print_warnings(self.warnings)
        show_table(table)

    def notes(self) -> list[str]:
        """Return sentences on softened layers and on other models that ended early."""
        data, sentences = self.dataset, []
        names = ("ambient", "force", "softened_steps", "layer_force_mismatch_max")
        for ambient, force, softened, mismatch in zip(
            *(data[n].values for n in names), strict=True
        ):
            peak = float(np.nanmax(np.abs(force), initial=0.0))
            if softened and mismatch > SMALL_MISMATCH * peak:
                missing = quantity("layer_force_mismatch_max", form=".2g").text(mismatch)
                sentences.append(
                    f"at {ambient:g} degC: where the published law softens, the force differs from "
                    f"it by up to {missing} kN ({100.0 * mismatch / peak:.1f} % of the peak)"
                )
        for name, model_result in self.compared.items():
            outcomes = zip(
                model_result["ambient"].values, model_result["outcome"].values, strict=True
            )
            sentences += [
                f"{name} at {ambient:g} degC ended early ({end}); its errors are those until then"
                for ambient, end in outcomes
                if end != "completed"
            ]
        return sentences

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json; see docs/files.md."""
        attrs, runs = self.dataset.attrs, range(self.dataset.sizes["ambient"])
        return {
            **{key: attrs[key] for key in ("command", "bearing", "scheme", "version")},
            "outcome": self.outcome,
            "warnings": self.warnings,
            **self._limits_summary(),
            "runs": without_rounding([self._run_summary(run) for run in runs]),
        }

    def _run_summary(self, run: int) -> dict[str, Any]:
        data, sentences = self.dataset, from_attribute(self.dataset, "sentences")
        ambient, outcome = float(data["ambient"].values[run]), str(data["outcome"].values[run])
        softened = int(data["softened_steps"].values[run])
        sharing = "softened_layers" if softened else "equal_layer_forces"
        cycles, energy = [], self.energy.iloc[run].drop("ambient_degC")
        for row in self.cycles.to_dict("records"):
            if row.pop("ambient_degC") == ambient:
                layers = [row.pop(name) for name in list(row) if str(name).startswith("rubber")]
                cycles.append({"lead_degC": None} | row | {"rubber_degC": layers})
        return {
            "ambient_degC": ambient,
            "outcome": outcome,
            "outcome_sentence": sentences[outcome],
            "layer_force_mismatch_max_kN": float(data["layer_force_mismatch_max"].values[run]),
            "series_sharing": {
                "outcome": sharing,
                "sentence": sentences[sharing],
                "softened_steps": softened,
                "steps": int(data["steps"].values[run]),
            },
            "cycles": cycles,
            "energy": {name: float(value) for name, value in energy.items()},
        }

    def _write(self, folder: Path) -> None:
        """Write case, history.csv, result.nc, cycles.csv, and comparison.csv with other models."""
        (folder / RESOLVED).write_text(self.dataset.attrs["case"], encoding="utf-8")
        written = self._view("dataset").written_part(self)
        with (folder / HISTORY).open("w", encoding="utf-8") as file:
            file.writelines(_history_blocks(written))
        write_dataset(written.dataset, folder / DATASET)
        if len(self.cycles):
            write_csv(folder / CYCLE_TABLE, self.cycles)
        if self.compared:
            table = self._view("comparison").comparison_table(self.compared)
            without_formulas(table).to_csv(folder / COMPARISON, index=False)


def _plane_measures(x: Floats, f: Floats, work: float) -> dict[str, float]:
    """Return the measures of a turn in a plane, of displacements [mm] and forces [kN], [rows, 2].

    The stiffness is that of the force along the largest displacement over this displacement (the
    mean where the path has many largest ones). The damping ratio is the work [kN mm] over 4 pi
    times the elastic energy at the largest displacement, as on a line.
    """
    distance = np.linalg.norm(x, axis=1)
    largest = float(distance.max())
    peak = distance >= AT_PEAK * largest
    stiffness = float(np.mean(np.sum(f[peak] * x[peak], axis=1))) / largest**2
    measures = {
        "amplitude_mm": largest,
        "G_eq_MPa": 0.0,
        "K_eq_kN_mm": stiffness,
        "h_eq": work / (2.0 * np.pi * stiffness * largest**2),
        "stress_max_MPa": 0.0,
        "energy_kN_mm": work,
        "peak_force_kN": float(np.linalg.norm(f, axis=1).max()),
    }
    for name, displacement, force in zip(("x", "y"), x.T, f.T, strict=True):
        measures[f"energy_{name}_kN_mm"] = loop_energy(displacement, force)
        measures[f"peak_force_{name}_kN"] = float(np.abs(force).max())
        span = float(np.ptp(displacement))
        measures[f"K_eq_{name}_kN_mm"] = float(np.ptp(force)) / span if span > 0.0 else np.nan
    return measures


def _history_blocks(result: Result) -> Iterator[str]:
    """Yield the text of history.csv in blocks: one row per kept step and ambient temperature."""
    last = "" if result.has_lead else ","  # lead_degC stays empty where the bearing has no lead
    names = [*history_columns(result, 0), *(["lead_degC"] if last else [])]
    yield ",".join(["ambient_degC", *names]) + "\n"
    for run, ambient in enumerate(result.dataset["ambient"].values):
        columns = list(history_columns(result, run).values())
        # Long after the start, steps are short: nine digits of time.
        line = f"{ambient:.9g},%.9g," + ",".join([DIGITS] * (len(columns) - 1)) + last + "\n"
        for first in range(0, len(columns[0]), CSV_BLOCK):
            block = np.column_stack([column[first : first + CSV_BLOCK] for column in columns])
            yield (line * len(block)) % tuple(block.ravel().tolist())


def history_columns(result: Result, run: int) -> dict[str, Floats]:
    """Return the columns of the history of one run by their heads in history.csv."""
    data = result.dataset
    count = int((data["segment"].values[run] >= 0).sum())
    columns = {"time_s": result.time(run)[:count]}
    for head, name in HEADS.items():
        values = data[name].values[run, :count]
        heads = (
            [head.replace(name, f"{name}_{c}") for c in ("x", "y")] if result.in_plane else [head]
        )
        columns |= dict(zip(heads, np.atleast_2d(values.T), strict=True))
    if "rubber_temperature" in data:
        layers = data["rubber_temperature"].values[run, :count].T
        columns |= {f"rubber{j}_degC": layer for j, layer in enumerate(layers, 1)}
    if result.has_lead:
        columns["lead_degC"] = data["lead_temperature"].values[run, :count]
    return columns
