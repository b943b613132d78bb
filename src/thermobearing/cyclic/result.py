"""What `run` returns: the labelled dataset, with the numbers and pictures engineers ask for."""

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from thermobearing.border.deprecated import renamed
from thermobearing.border.showing import Shown, table_html
from thermobearing.results.metrics import (
    LEAST_WARMING,
    CycleMeasures,
    find_cycles,
    measure_cycle,
    relative_residual,
)
from thermobearing.results.ranges import largest_tested
from thermobearing.results.selection import chosen_runs, selected
from thermobearing.results.writing import (
    compared_rows,
    exposure_summary,
    from_attribute,
    limits_summary,
)

if TYPE_CHECKING:
    from thermobearing.cyclic.figures import Figures

Floats = NDArray[np.float64]
UNITS = {"_kN_mm": "kN mm", "_kN": "kN", "_MPa": "MPa", "_degC": "degC"}
LABELS = ("ambient", "strain", "cycle")


def find_unit(column: str) -> str:
    """Unit of a column of `Result.cycles`, from its name.

    Examples
    --------
    >>> find_unit("K_eq_kN_mm"), find_unit("energy_kN_mm"), find_unit("h_eq")
    ('kN/mm', 'kN mm', '1')
    """
    if column.endswith(("stiffness_kN_mm", "K_eq_kN_mm")):
        return "kN/mm"
    return next((unit for end, unit in UNITS.items() if column.endswith(end)), "1")


def _measures_dataset(cycles: pd.DataFrame, *, recorded: bool) -> xr.Dataset:
    """Columns of `Result.cycles` as variables over ambient temperature, strain and cycle.

    Where a strain comes twice, and in `recorded` histories, whose cycles have each their own, the
    dimensions are ambient temperature and `number` of the cycle in the test.
    """
    table = cycles.rename(columns={"ambient_degC": "ambient", "amplitude_strain": "strain"})
    labels = list(LABELS)
    if not len(table):
        return xr.Dataset()
    if recorded or table.duplicated(labels).any():
        table["number"] = table.groupby("ambient").cumcount() + 1
        labels = ["ambient", "number"]
    found = table.set_index(labels).to_xarray()
    for name in found.variables:
        found[name].attrs["units"] = find_unit(str(name))
    found["ambient"].attrs["units"] = "degC"
    return found


def _cycle_summary(row: dict[Any, Any]) -> dict[str, Any]:
    """One cycle of summary.json from a row of `Result.cycles`."""
    rubber = [float(value) for key, value in row.items() if str(key).startswith("rubber")]
    plain = {
        str(key): value
        for key, value in row.items()
        if key != "ambient_degC" and not str(key).startswith("rubber")
    }
    return {"lead_degC": None} | plain | {"rubber_degC": rubber}


Ints = NDArray[np.int64]
CYCLES = "closed_cycle"  # dimension of the measures in a file, and the beginning of their names


class Result(Shown):
    """Outcome of an analysis at one or several ambient temperatures.

    Its `dataset` has named dimensions and a unit on every variable; `result["force"]` is
    `result.dataset["force"]`.

    Parameters
    ----------
    dataset : the dataset, or what makes it when it is first asked for.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
    >>> result = tb.run(tb.load_bearing("shen-hdr-specimen"), test, ambient=23)
    >>> result["force"].attrs["units"]
    'kN'
    """

    def __init__(self, dataset: xr.Dataset | Callable[[], xr.Dataset]) -> None:
        self._given = dataset

    @cached_property
    def dataset(self) -> xr.Dataset:
        """Histories and provenance; labelled when first asked for, which takes as long as a run."""
        made = self._given() if callable(self._given) else self._given
        self._given = made  # what it was made of is not kept beside it
        return made

    def __getitem__(self, name: str) -> xr.DataArray:
        return self.dataset[name]

    @property
    def headline(self) -> str:
        """What it is, in a line."""
        ambient = ", ".join(f"{t:g}" for t in self.dataset["ambient"].values)
        steps = int(self.dataset["steps"].sum())
        return (
            f"Result of {self.bearing_name} at {ambient} degC: {steps} steps, "
            f"{len(self.cycles)} cycles, {self.outcome}"
        )

    def _repr_html_(self) -> str:
        return table_html(self.headline, self.cycles, self.warnings)

    def show(self) -> None:
        """Print the tables that the command prints: cycles and energy books of each run."""
        from thermobearing.cyclic.output import print_result

        print_result(self)

    def sel(self, *, ambient: float | list[float]) -> "Result":
        """The runs at some ambient temperatures.

        Parameters
        ----------
        ambient : one or several [degC].

        Raises
        ------
        InputError : no run at such a temperature.

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
        chosen = selected(data, "ambient", runs, [run_name(t) for t in data["ambient"].values])
        if CYCLES in data.dims:
            mine = np.isin(data[f"{CYCLES}_ambient_degC"].values, chosen["ambient"].values)
            chosen = chosen.isel({CYCLES: np.flatnonzero(mine)})
        return Result(chosen)

    def to_dataset(self) -> xr.Dataset:
        """The measures of `cycles` over ambient temperature, strain and cycle.

        Where a strain comes twice, and in recorded histories, over ambient temperature and the
        number of the cycle. The histories are in `dataset`.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5, 1.0], cycles=2))
        >>> result.to_dataset()["h_eq"].dims
        ('ambient', 'strain', 'cycle')
        """
        recorded = any(segment["kind"] == "recorded" for segment in self.segments)
        return _measures_dataset(self.cycles, recorded=recorded)

    @property
    def bearing_name(self) -> str:
        """Name of the bearing."""
        return str(self.dataset.attrs["bearing"])

    @cached_property
    def segments(self) -> list[dict[str, Any]]:
        """Kind, label and amplitude of each step of the test."""
        return list(from_attribute(self.dataset, "segments"))

    @property
    def outcome(self) -> str:
        """Name of what ended the first run that did not complete, else completed."""
        names = [str(name) for name in self.dataset["outcome"].values]
        return next((name for name in names if name != "completed"), "completed")

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try."""
        return str(from_attribute(self.dataset, "sentences").get(self.outcome, ""))

    @property
    def warnings(self) -> list[str]:
        """Sentences about accuracy that a user should read; empty when there is nothing."""
        return list(from_attribute(self.dataset, "warnings"))

    @property
    def rig(self) -> pd.DataFrame:
        """What each run asks of each limit of the rig, and whether it passes it; empty without."""
        return compared_rows(self.dataset, "rig")

    @property
    def tested_range(self) -> pd.DataFrame:
        """What each run asks of the range that the bearing was tested in; empty if not given."""
        return compared_rows(self.dataset, "tested_range")

    def tested_to(self, run: int, limit: str) -> float:
        """Largest tested value of a quantity that a run goes beyond; infinite where it does not."""
        name = run_name(float(self.dataset["ambient"].values[run]))
        return largest_tested(self.tested_range.to_dict("records"), name, limit)

    def time(self, run: int) -> Floats:
        """Times of the kept steps of a run [s]."""
        if "clock" in self.dataset:
            return np.asarray(self.dataset["clock"].values[run])
        return np.asarray(self.dataset["time"].values)

    def _cycle_rows(self, run: int) -> list[tuple[int, int, slice]]:
        """(segment, cycle, rows with the closing point of the cycle before) of a run."""
        segment = self.dataset["segment"].values[run]
        cycle = self.dataset["cycle"].values[run]
        x = self.dataset["displacement"].values[run]
        found: list[tuple[int, int, slice]] = []
        # Numbers of segments and cycles only grow, up to the padding of -1.
        parts = np.searchsorted(segment[segment >= 0], np.arange(len(self.segments) + 1))
        for number, (first, end) in enumerate(pairwise(parts.tolist())):
            if first == end:
                continue
            if self.segments[number]["kind"] == "recorded":
                first = max(first - 1, 0)
                found += [
                    (number, k, slice(first + a, first + b + 1))
                    for k, (a, b) in enumerate(find_cycles(x[first:end]), 1)
                ]
            elif self.segments[number]["kind"] == "cycles":
                numbers = np.arange(1, int(cycle[end - 1]) + 2)
                ends = first + np.searchsorted(cycle[first:end], numbers)
                for k, (a, b) in enumerate(pairwise(ends.tolist()), 1):
                    closed = a < b and x[b - 1] == 0.0 and x[a:b].min() < 0.0
                    if closed:  # else cut off on its way
                        found.append((number, k, slice(a - 1, b)))
        return found

    @cached_property
    def cycles(self) -> pd.DataFrame:
        """One row per closed cycle: amplitude, G_eq, K_eq, h_eq, energy, strength, temperatures.

        Temperatures are those at the end of the cycle; `rubber1_degC` is the outer layer.
        """
        if CYCLES in self.dataset.dims:  # measured before the history was thinned
            stored = [str(name) for name in self.dataset if str(name).startswith(f"{CYCLES}_")]
            columns = {n.removeprefix(f"{CYCLES}_"): self.dataset[n].values for n in stored}
            return pd.DataFrame(columns)
        attrs = self.dataset.attrs
        x, f, work = (self.dataset[name].values for name in ("displacement", "force", "work_in"))
        rows: list[dict[str, Any]] = []
        ends: list[tuple[int, int]] = []
        for run, ambient in enumerate(self.dataset["ambient"].values):
            for number, k, where in self._cycle_rows(run):
                ends.append((run, where.stop - 1))
                measures = measure_cycle(
                    x[run, where],
                    f[run, where],
                    area=attrs["area_mm2"],
                    total_rubber_thickness=attrs["total_rubber_thickness_mm"],
                    # from the books, which know every step and not only the kept ones
                    work=float(work[run, where.stop - 1] - work[run, where.start]),
                )
                rows.append(self._row(float(ambient), self.segments[number], k, measures))
        return pd.concat([pd.DataFrame(rows), pd.DataFrame(self._temperatures(ends))], axis=1)

    def _row(
        self, ambient: float, segment: dict[str, Any], cycle: int, m: CycleMeasures
    ) -> dict[str, Any]:
        stress = 1e3 / self.dataset.attrs["area_mm2"]
        rubber = self.dataset.attrs["total_rubber_thickness_mm"]
        return {
            "ambient_degC": ambient,
            "amplitude_strain": segment["amplitude_strain"]
            if segment["kind"] == "cycles"
            else m.amplitude_mm / rubber,
            "cycle": cycle,
            "G_eq_MPa": m.G_eq_MPa,
            "K_eq_kN_mm": m.stiffness_kN_mm,
            "h_eq": m.h_eq,
            "stress_max_MPa": m.force_max_kN * stress,
            "stress_min_MPa": m.force_min_kN * stress,
            "energy_kN_mm": m.energy_kN_mm,
            "characteristic_strength_kN": m.characteristic_strength_kN,
            "post_yield_stiffness_kN_mm": m.post_yield_stiffness_kN_mm,
        }

    def _temperatures(self, ends: list[tuple[int, int]]) -> dict[str, Floats]:
        """Of layers (if they were kept) and lead at kept steps (run, row)."""
        if "rubber_temperature" not in self.dataset or not ends:
            return {}
        runs, rows = np.array(ends).T
        values = self.dataset["rubber_temperature"].values[runs, rows]
        found = {f"rubber{j}_degC": column for j, column in enumerate(values.T, 1)}
        if self.has_lead:
            found["lead_degC"] = self.dataset["lead_temperature"].values[runs, rows]
        return found

    @cached_property
    def energy(self) -> pd.DataFrame:
        """Energy books at the end of each run [kN mm], one row per ambient temperature.

        `mechanical_residual` is (work in - heat released - recoverable) and
        `thermal_residual` (heat released - stored - lost), both over the largest of work, heat
        stored and heat lost; at least over 1e-6 kN mm (mechanical), and over what warms the
        bearing by 1e-4 K (thermal), see `metrics.relative_residual`. All since the start of the
        test: what an earlier one left in the bearing does not count.
        """
        data = self.dataset
        capacity = np.asarray(from_attribute(data, "heat_capacity_kN_mm_per_K"))
        rows = []
        for run, ambient in enumerate(data["ambient"].values):
            last = int(np.flatnonzero(data["segment"].values[run] >= 0)[-1])
            book = {
                name: float(data[name].values[run, last])
                for name in (
                    "work_in",
                    "heat_released",
                    "recoverable",
                    "heat_lost_ends",
                    "heat_lost_sides",
                )
            }
            warmer = data["final_temperature"].values[run] - data["initial_temperature"].values[run]
            stored = float(capacity @ warmer) + self._heat_in_lead(run, last)
            book["recoverable"] -= float(data["recoverable"].values[run, 0])  # of an earlier test
            lost = book["heat_lost_ends"] + book["heat_lost_sides"]
            energies = [book["work_in"], stored, lost]
            unbalanced = book["work_in"] - book["heat_released"] - book["recoverable"]
            least_heat = LEAST_WARMING * (float(capacity.sum()) + self._lead_capacity)
            rows.append(
                {
                    "ambient_degC": float(ambient),
                    "work_in_kN_mm": book["work_in"],
                    "heat_released_kN_mm": book["heat_released"],
                    "recoverable_kN_mm": book["recoverable"],
                    "heat_stored_kN_mm": stored,
                    "heat_lost_ends_kN_mm": book["heat_lost_ends"],
                    "heat_lost_sides_kN_mm": book["heat_lost_sides"],
                    "mechanical_residual": relative_residual(unbalanced, energies),
                    "thermal_residual": relative_residual(
                        book["heat_released"] - stored - lost, energies, least_heat
                    ),
                }
            )
        return pd.DataFrame(rows)

    def _heat_in_lead(self, run: int, last: int) -> float:
        """Heat stored in the lead since the start [kN mm], from its temperatures."""
        if "lead_temperature" not in self.dataset or not self.has_lead:
            return 0.0
        first = float(self.dataset["lead_temperature"].values[run, 0])
        final = float(self.dataset["lead_temperature"].values[run, last])
        return self._lead_capacity * (final - first)

    @property
    def _lead_capacity(self) -> float:
        """Heat capacity of all lead cores [kN mm/K]."""
        return float(self.dataset.attrs["lead_capacity_kN_mm_per_K"])

    @property
    def has_lead(self) -> bool:
        """Whether the bearing has lead cores."""
        return self._lead_capacity > 0.0

    def summary(self) -> dict[str, Any]:
        """The content of summary.json, see the interface description in docs/files.md."""
        attrs = self.dataset.attrs
        return {
            "command": attrs["command"],
            "bearing": attrs["bearing"],
            "scheme": attrs["scheme"],
            "version": attrs["version"],
            "outcome": self.outcome,
            "warnings": self.warnings,
            **limits_summary(self.rig, self.tested_range),
            **exposure_summary(self.dataset),
            "runs": [self._run_summary(run) for run in range(self.dataset.sizes["ambient"])],
        }

    def _run_summary(self, run: int) -> dict[str, Any]:
        data = self.dataset
        ambient = float(data["ambient"].values[run])
        outcome = str(data["outcome"].values[run])
        softened = int(data["softened_steps"].values[run])
        sharing = "softened_layers" if softened else "equal_layer_forces"
        sentences = from_attribute(data, "sentences")
        cycles = self.cycles
        mine = cycles[cycles["ambient_degC"] == ambient] if len(cycles) else cycles
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
            "cycles": [_cycle_summary(dict(row)) for row in mine.to_dict("records")],
            "energy": {
                key: float(value)
                for key, value in self.energy.iloc[run].items()
                if key != "ambient_degC"
            },
        }

    @cached_property
    def plot(self) -> "Figures":
        """Figures: `result.plot.loops()`, `.displacement()`, `.measures()`, ... ."""
        from thermobearing.cyclic.figures import Figures

        return Figures(self)

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write the result directory (summary, netCDF, CSV, resolved case, figures).

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.cyclic.output import save_result

        return save_result(self, Path(directory), overwrite=overwrite, figures=figures)


def run_name(ambient: float) -> str:
    """What a run is called in sentences."""
    return f"the run at {ambient:g} degC"
