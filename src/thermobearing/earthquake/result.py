"""A study of a structure in earthquakes: histories, peaks, energy books, tables."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from thermobearing.border.deprecated import renamed
from thermobearing.border.showing import Shown
from thermobearing.core.records import Floats
from thermobearing.earthquake.measures import (
    BEARING,
    COLUMNS,
    ENERGY,
    HEAT,
    HISTORY,
    LABELS,
    LOOP_COLUMNS,
    PLACES,
    STRUCTURE,
    compute_residuals,
)
from thermobearing.earthquake.parts import LINES, PIERS, governing_runs, parts_columns, parts_table
from thermobearing.results.metrics import LEAST_ENERGY
from thermobearing.results.ranges import largest_tested, limits_passed
from thermobearing.results.selection import chosen_runs, gridded, selected
from thermobearing.results.writing import (
    compared_rows,
    exposure_summary,
    from_attribute,
    limits_summary,
)

if TYPE_CHECKING:
    from thermobearing.earthquake.figures import EarthquakeFigures

# Of the input. In the default study, bearings of runs below it move 13 to 19 % farther without
# viscous damping, those of runs above it 12 to 200 %: there the assumed ratios count as much as
# the bearing.
LARGEST_DAMPING_SHARE = 0.25
# Of the input, either way: a delay of 5 ms comes to 3 % in the default hybrid test.
LARGEST_ACTUATOR_SHARE = 0.05


class EarthquakeResult(Shown):
    """Runs of one study.

    Attributes
    ----------
    dataset : xarray Dataset; dimension `run` with the coordinates bearing, motion and ambient,
        `step` (padded with NaN), `layer`; every variable says its unit.
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self.dataset = dataset

    def __getitem__(self, name: str) -> xr.DataArray:
        return self.dataset[name]

    @property
    def headline(self) -> str:
        """What it is, in a line."""
        counts = [len(set(self.dataset[name].values.tolist())) for name in LABELS[:3]]
        return (
            f"EarthquakeResult of {self.dataset.attrs['structure']}: {self.runs} runs (bearings "
            f"{counts[0]}, motions {counts[1]}, temperatures {counts[2]}), {self.outcome}"
        )

    def show(self) -> None:
        """Print the tables that the command prints."""
        from thermobearing.earthquake.output import print_study

        print_study(self)

    def sel(self, **chosen: Any) -> "EarthquakeResult":
        """The runs with some labels.

        Parameters
        ----------
        chosen : of bearing, motion, ambient [degC] and mode: a value, or several in a list.

        Raises
        ------
        InputError : no such label, or no run with it.

        Examples
        --------
        >>> import thermobearing as tb
        >>> study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=2)
        >>> study.sel(bearing="shen-hdr-bridge", ambient=-20).runs
        1
        """
        data = self.dataset
        labels = {name: data[name].values for name in LABELS if name in data.coords}
        return EarthquakeResult(selected(data, "run", chosen_runs(labels, chosen), self.run_names))

    def to_dataset(self) -> xr.Dataset:
        """The dataset with bearing, motion and ambient temperature as dimensions.

        With both modes of a laboratory also mode. A combination without a run is NaN.

        Examples
        --------
        >>> import thermobearing as tb
        >>> study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=2)
        >>> study.to_dataset()["bearing_force_max"].dims
        ('bearing', 'motion', 'ambient')
        """
        both = len(set(self.modes)) > 1
        return gridded(self.dataset, [name for name in LABELS if name != "mode" or both])

    @property
    def runs(self) -> int:
        """Number of runs."""
        return int(self.dataset.sizes["run"])

    @property
    def modes(self) -> list[str]:
        """Mode of the laboratory of each run; empty without one."""
        if "mode" not in self.dataset.coords:  # results of 0.1
            return [str(self.dataset.attrs.get("mode", ""))] * self.runs
        return [str(mode) for mode in self.dataset["mode"].values]

    @property
    def modes_table(self) -> pd.DataFrame:
        """Real time over pseudo-dynamic, where both were run (earthquake/modes.py)."""
        from thermobearing.earthquake.modes import modes_table

        return modes_table(self)

    @property
    def outcome(self) -> str:
        """Completed, or what ended a run early."""
        if self.dataset.attrs["interrupted"]:
            return "interrupted"
        ended = [str(v) for v in self.dataset["outcome"].values if v != "completed"]
        return ended[0] if ended else "completed"

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try."""
        return str(from_attribute(self.dataset, "sentences").get(self.outcome, ""))

    @property
    def table(self) -> pd.DataFrame:
        """One row per run: bearing, motion, ambient temperature, mode, outcome, peaks.

        Peaks of bearings and piers are the largest of all lines and piers; where there are
        several, `strain_line`, `force_line`, `displacement_pier` and `ductility_pier` name the
        one that governs, and `lines` and `piers` hold a row for each. The largest loop is that
        of the line in ``dataset.attrs["line"]``. The mode is that of the laboratory; without one
        there is no such column. `energy_of_warmest` is the bearing's energy over that at the
        warmest temperature of the same bearing, motion and mode, `damping_of_input` the
        share of the energy that viscous damping takes from the input, `beyond_rig`
        what the run asks too much of, if a rig is named, `beyond_tested` the quantities in which
        it leaves the tested range of its bearing.
        """
        frame = pd.DataFrame(
            {
                "bearing": self.dataset["bearing"].values,
                "motion": self.dataset["motion"].values,
                "ambient_degC": self.dataset["ambient"].values,
                **({"mode": self.modes} if any(self.modes) else {}),
                "outcome": self.dataset["outcome"].values,
            }
        )
        for name, (variable, factor) in COLUMNS.items():
            if variable in self.dataset:  # results of 0.1 have fewer
                frame[name] = factor * self.dataset[variable].values
        for name, (part, peak) in PLACES.items() if "line" in self.dataset.coords else ():
            sizes = np.nan_to_num(np.abs(self.dataset[peak].values), nan=-1.0)
            names = self.dataset[part].values[sizes.argmax(axis=1)]
            frame[name] = np.where(sizes.max(axis=1) < 0.0, "", names)
        same = [name for name in ("bearing", "motion", "mode") if name in frame]
        sorted_ = frame.sort_values("ambient_degC")
        warmest = sorted_.groupby(same, sort=False)["bearing_energy_kN_mm"].transform("last")
        frame["energy_of_warmest"] = frame["bearing_energy_kN_mm"] / warmest.loc[frame.index]
        energy = self.energy
        given = energy["input_kN_mm"].clip(lower=LEAST_ENERGY)
        frame["damping_of_input"] = energy["damping_kN_mm"] / given
        for name, variable in LOOP_COLUMNS.items():
            if variable in self.dataset:
                frame[name] = self.dataset[variable].values
        if len(self.rig):
            frame["beyond_rig"] = limits_passed(self.rig.to_dict("records"), self.run_names)
        frame["beyond_tested"] = limits_passed(self.tested_range.to_dict("records"), self.run_names)
        return frame

    @property
    def largest_loops(self) -> pd.DataFrame:
        """The largest loop of one bearing in each run; NaN where none is closed.

        The loop holds the largest displacement, to either side, and begins and ends at zero
        displacement, see results/largest_loop.py: its extreme forces F+, F- and displacements D+,
        D-, ``K_eq = (|F+| + |F-|)/(|D+| + |D-|)``, h_eq and G_e (Eq. 3.1, 3.2; a bilinear bearing
        has no G_e), energy, and when it begins and ends [s].
        """
        table = self.table
        told = [name for name in ("bearing", "motion", "ambient_degC", "mode") if name in table]
        frame = table[[*told, *LOOP_COLUMNS]].rename(
            columns=lambda name: name.removeprefix("loop_")
        )
        frame["start_s"] = self.dataset["loop_start"].values
        frame["end_s"] = self.dataset["loop_end"].values
        return frame

    @property
    def lines(self) -> pd.DataFrame:
        """One row per run and bearing line: bearing, count, air, peaks; empty with one of all.

        `force_max_kN` and `energy_kN_mm` are of one modelled bearing, `total_force_max_kN` of all
        bearings of the line in the structure.
        """
        return parts_table(self.dataset, "line", LINES)

    @property
    def piers(self) -> pd.DataFrame:
        """One row per run and pier: displacement, ductility of its own hinge, moment; likewise."""
        return parts_table(self.dataset, "pier_part", PIERS)

    @property
    def warnings(self) -> list[str]:
        """What a reader must know before using the numbers."""
        told = "warnings" in self.dataset.attrs  # results of 0.1 have none
        said = list(from_attribute(self.dataset, "warnings")) if told else []
        if "energy_actuator" in self.dataset:
            energy = self.energy
            ratios = energy["actuator_kN_mm"] / energy["input_kN_mm"].clip(lower=LEAST_ENERGY)
            worst = float(ratios.iloc[ratios.abs().argmax()]) if len(ratios) else 0.0
            if abs(worst) > LARGEST_ACTUATOR_SHARE:
                does, damped = ("take", "more") if worst > 0.0 else ("feed", "less")
                said.append(
                    f"delay and force error of the actuator {does} up to {abs(worst):.0%} of the "
                    f"input energy: the structure is {damped} damped than with an ideal actuator"
                )
        shares = self.table["damping_of_input"].to_numpy()
        much, kind = shares > LARGEST_DAMPING_SHARE, self.dataset.attrs["damping"]
        if not much.any():
            return said
        return [
            *said,
            f"viscous damping ({kind}) takes more than {LARGEST_DAMPING_SHARE:.0%} of the input "
            f"energy in {much.sum()} of {len(shares)} runs, at most {shares.max():.0%}: there the "
            "results rest on the assumed damping ratios as much as on the bearings; compare "
            'damping = "none"',
        ]

    @property
    def rig(self) -> pd.DataFrame:
        """What each run asks of each limit of the rig, and whether it passes it; empty without."""
        return compared_rows(self.dataset, "rig")

    @property
    def tested_range(self) -> pd.DataFrame:
        """What each run asks of the range that its bearing was tested in, where that is given."""
        return compared_rows(self.dataset, "tested_range")

    def tested_to(self, runs: Sequence[int], limit: str) -> float:
        """Largest tested value of a quantity that one of some runs goes beyond; else infinite."""
        rows, names = self.tested_range.to_dict("records"), self.run_names
        return min((largest_tested(rows, names[run], limit) for run in runs), default=np.inf)

    @property
    def run_names(self) -> list[str]:
        """What each run is called in sentences and tables."""
        names = ("bearing", "motion", "ambient")
        told = zip(*(self.dataset[name].values for name in names), self.modes, strict=True)
        return [run_name(str(b), str(m), float(air), mode) for b, m, air, mode in told]

    @property
    def energy(self) -> pd.DataFrame:
        """Energy books of the structure and of one bearing at the end of each run [kN mm].

        `structure_residual`: (input - kinetic - damping - springs - hinges - bearings - actuator) /
        input; the actuator, whose delay and force error take work, is that of a laboratory.
        `mechanical_residual`, `thermal_residual`: of the bearing, over its work (the thermal one
        over its heat stored or lost where that is more). They are relative to at least 1e-6 kN mm,
        the thermal one to at least 1 kN mm, see `metrics.relative_residual`.
        """
        data = self.dataset
        known = [n for n in STRUCTURE if f"energy_{n}" in data]
        frame = pd.DataFrame({f"{n}_kN_mm": data[f"energy_{n}"].values for n in known})
        books = [str(name) for name in data if str(name).startswith((ENERGY, HEAT))]
        residuals = compute_residuals({name: data[name].values for name in books})
        frame["structure_residual"] = residuals.pop("structure_residual")
        for name in BEARING:
            frame[f"bearing_{name}_kN_mm"] = data[f"heat_{name}"].values
        return frame.assign(**residuals)

    def history(self, run: int) -> pd.DataFrame:
        """Main histories of one run, one row a kept step.

        The displacement of the deck is relative to the ground; accelerations are absolute unless
        they are said to be relative. A body that is neither deck nor pier has its own column.
        """
        data = self.dataset.isel(run=run)
        count = int(np.isfinite(data["time"].values).sum())
        frame = pd.DataFrame(
            {name: data[key].values[:count] for name, key in HISTORY.items() if key in data}
        )
        absolute, ground = frame["deck_acceleration_m_s2"], frame["ground_m_s2"]
        place = list(frame.columns).index("deck_acceleration_m_s2")
        frame.insert(place, "deck_relative_acceleration_m_s2", absolute - ground)
        if "body" in data.coords:
            told = {str(data.attrs[part]) for part in ("deck", "pier")}
            for k, body in enumerate(data["body"].values):
                if str(body) not in told:
                    values = data["body_acceleration"].values[:count, k]
                    frame[f"{body}_acceleration_m_s2"] = values
        for column, values in parts_columns(data, count).items():
            frame[column] = values
        for k in range(data.sizes["layer"]):
            frame[f"rubber{k + 1}_degC"] = data["rubber_temperature"].values[:count, k]
        return frame

    def places(self, run: int) -> dict[str, Floats]:
        """Temperature of the outer and the innermost rubber layer and of the lead [degC].

        One value a kept step; NaN where the bearing has no such thing.
        """
        data = self.dataset.isel(run=run)
        told = np.isfinite(data["time"].values)
        rubber = data["rubber_temperature"].values[told].astype(float)
        layers = int(np.isfinite(rubber[0]).sum())
        half = bool(self.dataset.attrs.get("half_stack", 1))
        none = np.full(len(rubber), np.nan)
        return {
            "outer layer": rubber[:, 0] if layers else none,
            "inner layer": rubber[:, layers - 1 if half else layers // 2] if layers else none,
            "lead": data["lead_temperature"].values[told].astype(float),
        }

    def rises(self, run: int) -> dict[str, float]:
        """Largest rise of each of `places` over the start [K]; NaN without such a thing."""
        found = {}
        for place, values in self.places(run).items():
            known = np.isfinite(values).all()
            found[place.replace(" ", "_")] = float((values - values[0]).max()) if known else np.nan
        return found

    def hottest(self, run: int) -> dict[str, float]:
        """Highest temperature of rubber layers and lead in any line [degC]; NaN without one."""
        data = self.dataset
        found = {}
        if "line" in data.coords:
            return {
                place: float(data[f"line_{place}_temperature_max"][run].max())
                for place in ("rubber", "lead")
            }
        for place, name in (("rubber", "rubber_temperature"), ("lead", "lead_temperature")):
            values = data[name].values[run]
            known = np.isfinite(values)
            found[place] = float(values[known].max()) if known.any() else np.nan
        return found

    def summary(self) -> dict[str, Any]:
        """What summary.json says; energies of one bearing and of the whole structure."""
        attrs, table, energy = self.dataset.attrs, self.table, self.energy
        runs = []
        parts = {"lines": self.lines, "piers": self.piers}
        for run in range(self.runs):
            rubber = self.dataset["rubber_temperature"].values[run]
            layers = [float(np.nanmax(column)) for column in rubber.T if np.isfinite(column).any()]
            row = {str(k): _plain(v) for k, v in table.iloc[run].items()}
            row["rubber_degC_max"] = layers
            row["lead_degC_max"] = lead if (lead := self.hottest(run)["lead"]) == lead else None
            row["layer_force_mismatch_max_kN"] = _plain(
                self.dataset["layer_force_mismatch_max"].values[run]
            )
            row["energy"] = {str(k): _plain(v) for k, v in energy.iloc[run].items()}
            for name, table_ in parts.items():
                if len(table_):
                    each = len(table_) // self.runs
                    mine = table_.iloc[run * each : (run + 1) * each].to_dict("records")
                    row[name] = [{str(k): _plain(v) for k, v in one.items()} for one in mine]
            runs.append(row)
        names = list(dict.fromkeys(str(name) for name in self.dataset["bearing"].values))
        return {
            "command": attrs["command"],
            "bearing": names[0] if len(names) == 1 else names,
            "structure": attrs["structure"],
            "mass": attrs["mass"],
            "method": attrs["method"],
            "scheme": attrs["scheme"],
            "version": attrs["version"],
            "outcome": self.outcome,
            "warnings": self.warnings,
            **limits_summary(self.rig, self.tested_range),
            **exposure_summary(self.dataset),
            "periods_s": _numbers(attrs.get("periods_s", [])),
            "damping": attrs["damping"],
            **{key: attrs[key] for key in ("surroundings",) if key in attrs},
            "damping_ratios": _numbers(attrs.get("damping_ratios", [])),
            "initial_periods_s": {n: _numbers(attrs[f"initial_periods_s:{n}"]) for n in names},
            "largest": governing_runs(self).to_dict("records"),
            "runs": runs,
        }

    @property
    def plot(self) -> "EarthquakeFigures":
        """Figures of the study."""
        from thermobearing.earthquake.figures import EarthquakeFigures

        return EarthquakeFigures(self)

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write a result directory; see docs/files.md."""
        from thermobearing.earthquake.output import save_earthquake

        return save_earthquake(self, Path(directory), overwrite=overwrite, figures=figures)


def run_name(bearing: str, motion: str, ambient: float, mode: str) -> str:
    """What a run is called: bearing, motion, air and mode of the laboratory, as far as they are."""
    return ", ".join(part for part in (bearing, motion, f"{ambient:g} degC", mode) if part)


def _numbers(attribute: Any) -> list[float]:
    """An attribute that is a list; netCDF gives a list of one back as a number."""
    return [float(value) for value in np.atleast_1d(attribute)]


def _plain(value: Any) -> Any:
    """A Python number or text."""
    return value.item() if hasattr(value, "item") else value
