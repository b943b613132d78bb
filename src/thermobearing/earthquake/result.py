"""The result of an analysis of earthquakes: histories, peaks, energy balances, files."""

import re
import tomllib
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from thermobearing.bearing.undecided import band_sentences
from thermobearing.border.arguments import checked
from thermobearing.border.lazy import pd, xr
from thermobearing.core.records import Floats
from thermobearing.cyclic.protocol import LARGEST_STRAIN
from thermobearing.earthquake import earlier, measures, tables
from thermobearing.earthquake.axial import with_validity
from thermobearing.earthquake.measures import DIRECTION, signed_peak
from thermobearing.earthquake.properties import written
from thermobearing.earthquake.properties.bridge import nominal_note
from thermobearing.earthquake.properties.energy import energy_of_warmest
from thermobearing.model.limits import CODE_KEYS
from thermobearing.model.outcomes import NOT_PHYSICAL
from thermobearing.quantities.governing import place_of_largest, places_of_largest
from thermobearing.quantities.register import quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.warned import ASSUMED, Warned
from thermobearing.quantities.words import joined
from thermobearing.results import directory
from thermobearing.results.base import DatasetResult
from thermobearing.results.metrics import BALANCE
from thermobearing.results.ranges import limits_passed, rate_note
from thermobearing.results.screen import print_warnings, say, show_table
from thermobearing.results.selection import chosen_runs, gridded, selected
from thermobearing.results.writing import without_rounding, write_csv, write_dataset
from thermobearing.structure.fields import GROUND

STILL = 1e-9  # of the largest strain: what moves by less only rounds
STRAIN = "bearing_strain_max"  # column of the table of runs
SHOWN_MODES = 8  # natural periods on the console
COMPONENTS = "components"  # attribute of a dataset: rows that compare two components with one
BANDS = "bands"  # likewise: what tests do not decide
BANDED_WORDS = {  # in sentences
    "bearing_strain_max": "displacement",
    "bearing_force_max_kN": "force",
    "bearing_energy_kN_mm": "energy",
    "pier_displacement_max_mm": "pier displacement",
}
LABELS = ("bearing", "motion", "ambient", "mode", DIRECTION)  # of a run
RUN = dict(zip(LABELS, measures.KEYS, strict=True))
UNIT = re.compile(r"((?:_mm|_kN|_m_s2|_kN_m|_rad)?)$")  # at the end of the name of a column


@checked
class EarthquakeResult(DatasetResult):
    """Runs of one analysis: every combination of bearing, motion, ambient temperature and mode.

    Attributes
    ----------
    dataset : xarray.Dataset
        Dimension `run` with the coordinates bearing, motion, ambient and mode, `step` (padded
        with NaN), `layer`; every variable has its unit. With two components of the ground motion,
        vectors have the dimension `direction`: x, y and resultant. Runs of a structure in plan
        with one component have `direction` as a coordinate.
    compared : dict of EarthquakeResult
        Results of the same analysis by model, from `compare_models`, shown and saved with it.
    one_component : EarthquakeResult, optional
        The same with one component at a time, from `compare_components`; not saved.
    """

    _figures = "EarthquakeFigures"

    def __init__(
        self, dataset: "xr.Dataset", compared: "dict[str, EarthquakeResult] | None" = None
    ) -> None:
        self.dataset = dataset
        self.compared = compared or {}
        self.one_component: EarthquakeResult | None = None

    @property
    def sentence(self) -> str:
        """The meaning of the outcome, and what to try; of a bearing that tears, which it is."""
        table = self.table
        torn = table[(table["outcome"] == NOT_PHYSICAL) & (table[STRAIN] > LARGEST_STRAIN)]
        if self.outcome != NOT_PHYSICAL or not len(torn):
            return super().sentence
        run = int(torn.index[place_of_largest(torn[STRAIN])])
        place = self.run_names[run]
        if self.has_parts:
            bearing, line = str(table["bearing"][run]), str(table["strain_line"][run])
            place = written.place_in_words(self.line_bearings, place, bearing, "line", line)
        return (
            f"A bearing was strained to {100.0 * table[STRAIN][run]:.0f} % ({place}), beyond "
            f"{100.0 * LARGEST_STRAIN:g} %, where it tears. The "
            "motion is too strong for it: check the factor and the unit of the motion, the masses "
            "and the bearing."
        )

    @property
    def headline(self) -> str:
        """Return the structure, the number of runs and the outcome in a line."""
        counts = [len(set(self.dataset[name].values.tolist())) for name in LABELS[:3]]
        bearings, motions, temperatures = counts
        return (
            f"Earthquake analysis of {self.dataset.attrs['structure']}: {self.runs} runs (bearings "
            f"{bearings}, motions {motions}, temperatures {temperatures}), {self.outcome}"
        )

    def sel(self, **chosen: Any) -> "EarthquakeResult":
        """Return the runs with some labels.

        Parameters
        ----------
        **chosen
            Of bearing, motion, ambient [degC] and mode: a value, or several in a list. Of
            a structure in plan `direction` too: "x", "y" or, with two components, "resultant".

        Raises
        ------
        InputError
            No such label, or no run with it.

        Examples
        --------
        >>> import thermobearing as tb
        >>> found = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=2)
        >>> found.sel(bearing="shen-hdr-bridge", ambient=-20).runs
        1
        """
        data = self.dataset
        if self.in_plan and DIRECTION in chosen:
            labels = {DIRECTION: data[DIRECTION].values}
            direction = {DIRECTION: chosen.pop(DIRECTION)}
            place = chosen_runs(labels, direction)[0]
            data = data.isel({DIRECTION: place}, drop=True).assign_attrs(direction)
        elif DIRECTION in chosen:
            end = f"@{chosen[DIRECTION]}"  # of attributes of a direction that is not the first
            direction_attributes = {
                k.removesuffix(end): v for k, v in data.attrs.items() if k.endswith(end)
            }
            data = data.assign_attrs(direction_attributes | {DIRECTION: chosen[DIRECTION]})
        if not chosen:
            return EarthquakeResult(data)
        labels = {name: data[name].values for name in LABELS if name in data.coords}
        runs = chosen_runs(labels, chosen)
        return EarthquakeResult(selected(data, "run", runs, measures.row_names(self)))

    def to_dataset(self) -> "xr.Dataset":
        """Return the dataset with bearing, motion and ambient temperature as dimensions.

        With both modes of a laboratory also mode. A combination without a run is NaN.

        Returns
        -------
        xarray.Dataset

        Examples
        --------
        >>> import thermobearing as tb
        >>> found = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=2)
        >>> found.to_dataset()["bearing_force_max"].dims
        ('bearing', 'motion', 'ambient')
        """
        has_both_modes = len(set(self.modes)) > 1
        return gridded(
            self.dataset, [name for name in self._labels if name != "mode" or has_both_modes]
        )

    @property
    def runs(self) -> int:
        """Number of runs."""
        return int(self.dataset.sizes["run"])

    @property
    def modes(self) -> list[str]:
        """Mode of the laboratory of each run; empty without one."""
        return [str(mode) for mode in self.dataset["mode"].values]

    @property
    def components(self) -> "pd.DataFrame":
        """Peaks with two components of the ground motion over those with one at a time, if known.

        One row per run, quantity and combination of the unidirectional peaks: x, y, the larger
        one, 100 % of one with 30 % of the other (rule), the root of the sum of squares (srss).
        """
        return self._rows(COMPONENTS)

    @property
    def bands(self) -> "pd.DataFrame":
        """What tests do not decide, if it was analysed: how much it changes peaks and energy.

        One row per bearing, ambient temperature, `undecided` ("rate", "small loops") and quantity,
        with the `lowest` and `highest` relative change over the motions.
        """
        return self._rows(BANDS)

    @property
    def in_plan(self) -> bool:
        """Whether two components of the ground motion act together: vectors have directions."""
        return DIRECTION in self.dataset.dims

    @property
    def directions(self) -> list[str]:
        """Directions whose runs or components `sel` gives; empty for a structure in one."""
        data = self.dataset
        if DIRECTION in data.attrs or DIRECTION not in data.coords:
            return []
        names = data[DIRECTION].values.tolist()
        return list(dict.fromkeys(name for name in names if name != measures.RESULTANT))

    def moves_along(self, direction: str) -> bool:
        """Return whether bearings move in a direction of a structure in plan by more than rounding.

        With one component of the ground motion a symmetric structure does not.
        """
        if not self.in_plan:
            return True
        along, resultant = (
            float(np.nanmax(self.sel(direction=name).table[STRAIN], initial=0.0))
            for name in (direction, measures.RESULTANT)
        )
        return along > STILL * resultant

    @property
    def resultant(self) -> "EarthquakeResult":
        """The result with the resultants of all vectors; without a plan the result itself."""
        return self.sel(direction=measures.RESULTANT) if self.in_plan else self

    @property
    def _labels(self) -> list[str]:
        """Names of the labels of a run."""
        data = self.dataset
        labels = [name for name in LABELS if name in data.coords and data[name].dims == ("run",)]
        return [name for name in labels if name != "mode" or any(self.modes)]

    @property
    def has_parts(self) -> bool:
        """Whether there are several lines or piers, each with its rows."""
        return "line" in self.dataset.coords

    @property
    def has_pier(self) -> bool:
        """Whether the bearings stand on a pier, not on the ground."""
        return str(self.dataset.attrs["pier"]) != GROUND

    @property
    def part_kinds(self) -> tuple[str, ...]:
        """Parts with rows: "line" and "pier", or "line" alone for a deck on the ground."""
        return ("line", "pier") if self.has_pier else ("line",)

    @property
    def run_names(self) -> list[str]:
        """Name of each run in sentences and tables."""
        columns = [self.dataset[name].values.tolist() for name in self._labels]
        return [measures.run_name(*labels) for labels in zip(*columns, strict=True)]

    @property
    def table(self) -> "pd.DataFrame":
        """One row per run: bearing, motion, ambient temperature, mode, outcome, peaks.

        Peaks of bearings and piers are the largest of all lines and piers; where there are
        several, `strain_line`, `force_line`, `displacement_pier` and `ductility_pier` name the
        one that governs, and `lines` and `piers` hold a row for each. The largest loop is that
        of the line in ``dataset.attrs["line"]``. The mode is that of the laboratory; without one
        there is no such column. `energy_of_warmest` is the bearing's energy over that of the same
        line at the warmest temperature (NaN where lines have several kinds), `damping_of_input` the
        share of the energy that viscous damping takes from the input, `beyond_rig`
        the limits of the rig that the run exceeds, if a rig is named, `beyond_tested` the
        quantities in which it leaves the calibration range of its bearing.
        """
        return self._table.copy()

    @cached_property
    def _table(self) -> "pd.DataFrame":
        """The table of runs, which is made once: saving a result reads it a dozen times."""
        data = self.resultant.dataset
        frame = pd.DataFrame({RUN[name]: data[name].values for name in self._labels})
        frame["outcome"] = data["outcome"].values
        for name in measures.COLUMNS:
            frame[name] = data[quantity(name).variable].values
            if name.startswith("pier_") and not self.has_pier:
                frame[name] = np.nan
        for name, (part, peak) in measures.PLACES.items() if self.has_parts else ():
            if part == "pier_part" and not self.has_pier:
                continue
            # NaN is a part without the quantity, such as a pier without a hinge.
            sizes = np.abs(data[peak].values)
            names = data[part].values[places_of_largest(sizes)]
            frame[name] = np.where(np.isnan(sizes).all(axis=1), "", names)
        by_line = data["line_energy_end"].values if self.has_parts else None
        frame["energy_of_warmest"] = energy_of_warmest(frame, by_line, self.line_bearings)
        energy = self.energy
        frame["damping_of_input"] = measures.damping_share(
            energy["damping_kN_mm"], energy["input_kN_mm"]
        )
        for name in measures.LOOP:
            frame[name] = data[quantity(name).variable].values
        if len(self.rig):
            frame["beyond_rig"] = limits_passed(self.rig.to_dict("records"), self.run_names)
        frame["beyond_tested"] = measures.beyond_tested(self)
        return with_validity(frame, self)

    @property
    def largest_loops(self) -> "pd.DataFrame":
        """The largest loop of one bearing in each run; NaN where none is closed.

        The loop holds the largest displacement, to either side, and begins and ends at zero
        displacement: its extreme forces F+, F- and displacements D+, D-,
        ``K_eq = (|F+| + |F-|)/(|D+| + |D-|)``, h_eq and G_e (Eq. 3.1, 3.2; a bilinear bearing
        has no G_e), energy, and when it begins and ends [s].
        """
        table = self.table
        keys = [name for name in RUN.values() if name in table]
        frame = table[[*keys, *measures.LOOP]]
        frame = frame.rename(columns=lambda name: name.removeprefix("loop_"))
        frame["start_s"] = self.resultant["loop_start"].values
        frame["end_s"] = self.resultant["loop_end"].values
        return frame

    @property
    def modes_table(self) -> "pd.DataFrame":
        """Real-time tests compared with pseudo-dynamic ones; empty unless both were run."""
        return tables.modes_frame(self)

    @property
    def lines(self) -> "pd.DataFrame":
        """One row per run and bearing line: bearing, count, ambient temperature, peaks.

        `force_max_kN` and `energy_kN_mm` are of one modelled bearing, `total_force_max_kN` of all
        bearings of the line in the structure. Empty where there are one line and one pier.
        """
        return self._parts("line", measures.LINES)

    @property
    def axial(self) -> "pd.DataFrame":
        """One row per run and line whose axial forces act: shares of the critical load, tension."""
        return self._rows("axial")

    @property
    def devices(self) -> "pd.DataFrame":
        """One row per run and device: largest force, stroke and speed, energy."""
        return self._rows("devices")

    @cached_property
    def line_bearings(self) -> dict[str, dict[str, str]]:
        """The bearing of each line, by the bearing of the analysis; empty where all have it."""
        lines = self.lines
        if not len(lines) or (lines["line_bearing"] == lines["bearing"]).all():
            return {}
        pairs = lines.drop_duplicates(["bearing", "line"])
        return {
            str(bearing): dict(zip(group["line"], group["line_bearing"], strict=True))
            for bearing, group in pairs.groupby("bearing", sort=False)
        }

    @cached_property
    def bearing_labels(self) -> dict[str, str]:
        """Names of the bearings of the analysis, each with those of lines that have another.

        Such as "abut-hdr on A1 and A2, pier-lead on the other lines".
        """
        labels = {str(name): str(name) for name in self.dataset["bearing"].values}
        for name, bearings in self.line_bearings.items():
            lines_by_bearing: dict[str, list[str]] = {}
            for line in (line for line, bearing in bearings.items() if bearing != name):
                lines_by_bearing.setdefault(bearings[line], []).append(line)
            parts = [f"{bearing} on {joined(lines)}" for bearing, lines in lines_by_bearing.items()]
            others = [f"{name} on the other lines"] if name in bearings.values() else []
            labels[name] = ", ".join([*parts, *others])
        return labels

    @property
    def piers(self) -> "pd.DataFrame":
        """One row per run and pier: displacement, ductility of its hinge, moment; likewise."""
        return self._parts("pier_part", measures.PIERS) if self.has_pier else pd.DataFrame()

    def by_direction(self, name: Literal["table", "lines", "piers"] = "table") -> "pd.DataFrame":
        """Return a table with a row for each direction and the resultant of a run, line or pier.

        Parameters
        ----------
        name : {"table", "lines", "piers"}
            Without two components of the ground motion it is the
            table itself.

        Returns
        -------
        pandas.DataFrame
        """
        if not self.in_plan:
            return pd.DataFrame(getattr(self, name))
        parts = []
        for direction in measures.DIRECTIONS:
            frame = getattr(self.sel(direction=direction), name)
            if len(frame):
                frame.insert(len(self._labels), DIRECTION, direction)
                parts.append(frame)
        return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()

    def _parts(self, dimension: str, columns: dict[str, str]) -> "pd.DataFrame":
        if not self.has_parts:
            return pd.DataFrame()
        data = self.resultant.dataset
        frame = pd.DataFrame(
            {RUN[key]: data[key].values[run] for key in self._labels}
            | {dimension.removesuffix("_part"): str(part)}
            | {column: data[name].values[run, k] for column, name in columns.items()}
            for run in range(self.runs)
            for k, part in enumerate(data[dimension].values)
        )
        return with_validity(frame, self)

    @property
    def warnings(self) -> list[str]:
        """Warnings about the validity of the result."""
        messages = super().warnings + measures.actuator_warnings(self.energy)
        # The damping of the structure is an assumption of the report; one that was chosen for this
        # analysis is a decision of the reader, whom a warning reaches.
        chosen = tomllib.loads(str(self.dataset.attrs["case"]))["analysis"].get("damping")
        if chosen and (text := self.damping_note):
            messages.append(Warned(text, "viscous_damping", ASSUMED))
        return messages

    @property
    def damping_note(self) -> str:
        """What runs owe to viscous damping, as a sentence; empty where it takes little."""
        shares = self.table["damping_of_input"].to_numpy(dtype=float)
        return measures.damping_sentence(shares, str(self.dataset.attrs["damping"]))

    def tested_to(self, runs: Sequence[int], limit: str) -> float:
        """Return the largest tested value that some runs exceed on the line shown; or infinity."""
        return measures.tested_to(self, runs, limit)

    @property
    def energy(self) -> "pd.DataFrame":
        """Energy balances of the structure and of one bearing at the end of each run [kN mm].

        `structure_residual`: input less all other energies of the structure (of the actuator in a
        laboratory, whose delay and force error take work, too), over the input.
        `mechanical_residual`, `thermal_residual`: of the bearing, over the largest of its work,
        heat stored and heat lost. They are relative to at least 1e-6 kN mm, the thermal one to at
        least 1 kN mm, see `metrics.energy_balance`.
        """
        return self._energy.copy()

    @cached_property
    def _energy(self) -> "pd.DataFrame":
        data = self.dataset
        energies = [name for name in measures.STRUCTURE if f"energy_{name}" in data]
        frame = pd.DataFrame({f"{name}_kN_mm": data[f"energy_{name}"].values for name in energies})
        names = [f"energy_{name}" for name in energies]
        names += [f"heat_{name}" for name in BALANCE]
        residuals = measures.compute_residuals({name: data[name].values for name in names})
        frame["structure_residual"] = residuals.pop("structure_residual")
        for name in BALANCE:
            frame[f"bearing_{name}_kN_mm"] = data[f"heat_{name}"].values
        return frame.assign(**residuals)

    def history(self, run: int) -> "pd.DataFrame":
        """Return the main histories of one run, one row a kept step.

        The displacement of the deck is relative to the ground; accelerations are absolute unless
        they are said to be relative. A body that is neither deck nor pier has its own column;
        on the ground there are no columns of a pier.

        Parameters
        ----------
        run : int
            Its number, from 0.

        Returns
        -------
        pandas.DataFrame
        """
        self._check_run(run, "run")
        if self.in_plan:
            return self._plan_history(run)
        data = self.dataset.isel(run=run)
        count = int(np.isfinite(data["time"].values).sum())
        frame = pd.DataFrame(
            {name: data[key].values[:count] for name, key in measures.HISTORY.items()}
        )
        if not self.has_pier:
            frame = frame.drop(columns=[n for n in frame if str(n).startswith("pier_")])
        absolute, ground = frame["deck_acceleration_m_s2"], frame["ground_m_s2"]
        place = list(frame.columns).index("deck_acceleration_m_s2")
        frame.insert(place, "deck_relative_acceleration_m_s2", absolute - ground)
        for k, body in enumerate(data["body"].values):
            if str(body) not in {str(data.attrs[part]) for part in ("deck", "pier")}:
                frame[f"{body}_acceleration_m_s2"] = data["body_acceleration"].values[:count, k]
        for name, (dimension, column) in measures.PART_HISTORIES.items() if self.has_parts else ():
            for k, part in enumerate(data[dimension].values):
                values = data[name].values[:count, k]
                if np.isfinite(values).any() and part != GROUND:
                    frame[f"{part}_{column}"] = values
        for k in range(data.sizes["layer"]):
            frame[f"rubber{k + 1}_degC"] = data["rubber_temperature"].values[:count, k]
        return frame

    def _plan_history(self, run: int) -> "pd.DataFrame":
        """Return the history of a run with a column for each component of a vector."""
        frames = {name: self.sel(direction=name).history(run) for name in self.directions}
        first = next(iter(frames.values()))
        columns = {}
        for name in map(str, first):
            if name in measures.SCALARS or name.endswith("_degC"):
                columns[name] = first[name]
                continue
            # "force_kN" becomes "force_x_kN".
            for direction, frame in frames.items():
                columns[UNIT.sub(rf"_{direction}\1", name, count=1)] = frame[name]
        return pd.DataFrame(columns)

    def places(self, run: int) -> dict[str, Floats]:
        """Return the temperatures of the outer and innermost rubber layer and of the lead [degC].

        One value a kept step; NaN where the bearing has no such thing.
        """
        self._check_run(run, "run")
        data = self.dataset.isel(run=run)
        kept = np.isfinite(data["time"].values)
        rubber = data["rubber_temperature"].values[kept].astype(float)
        # Runs are padded to the layers of the bearing that has most. Half a stack ends with the
        # innermost layer; a whole one has it in the middle.
        layers = int(np.isfinite(rubber[0]).sum())
        half = bool(self.dataset.attrs.get("half_stack", 1))
        none = np.full(len(rubber), np.nan)
        return {
            "outer layer": rubber[:, 0] if layers else none,
            "inner layer": rubber[:, layers - 1 if half else layers // 2] if layers else none,
            "lead": data["lead_temperature"].values[kept].astype(float),
        }

    def rises(self, run: int) -> dict[str, float]:
        """Return the largest rise of each of `places` over the start [K]; NaN without it."""
        rises = {}
        for place, values in self.places(run).items():
            is_complete = np.isfinite(values).all()
            rise = float((values - values[0]).max()) if is_complete else np.nan
            rises[place.replace(" ", "_")] = rise
        return rises

    def hottest(self, run: int) -> dict[str, float]:
        """Return the highest temperature of rubber layers and lead in any line; NaN without."""
        self._check_run(run, "run")
        data = self.dataset
        if self.has_parts:
            peaks = {name: data[f"line_{name}_temperature_max"][run] for name in ("rubber", "lead")}
            return {name: float(values.max()) for name, values in peaks.items()}
        temperatures = {
            name: data[f"{name}_temperature"].values[run] for name in ("rubber", "lead")
        }
        finite = {name: values[np.isfinite(values)] for name, values in temperatures.items()}
        return {
            name: float(values.max()) if len(values) else np.nan for name, values in finite.items()
        }

    def largest_rises(self) -> "pd.DataFrame":
        """Return the largest rise of rubber and lead in any line of each run [K]; NaN without."""
        names = {name: f"{name}_rise_K" for name in ("rubber", "lead")}
        if self.has_parts:
            of_lines = {n: self.dataset[f"line_{n}_rise_max"].values for n in names}
            return pd.DataFrame({names[n]: signed_peak(values) for n, values in of_lines.items()})
        rises = [self.rises(run) for run in range(self.runs)]
        rubber = [max(rise["outer_layer"], rise["inner_layer"]) for rise in rises]
        return pd.DataFrame({names["rubber"]: rubber, names["lead"]: [r["lead"] for r in rises]})

    def tables(self) -> dict[str, Table]:
        """Return the tables of a report by name; the console prints some of them."""
        return tables.make_tables(self)

    def notes(self) -> list[str]:
        """Return sentences on the energy balance, the damping of the structure and strain rates."""
        sentences = []
        if self.runs:
            worst = float(self.energy["structure_residual"].abs().max())
            text = quantity("structure_residual").text(worst)
            sentences.append(f"Energy balance: the largest residual is {text} of the input.")
        remarks = self.damping_note, rate_note(measures.tested_rows(self))
        sentences += [text for text in remarks if text and text not in self.warnings]
        return sentences + band_sentences(self.bands.to_dict("records"), BANDED_WORDS)

    def show(self) -> None:
        """Print periods and damping, peaks, earlier models, the energy balance and warnings."""
        attrs = self.dataset.attrs
        title = ": ".join(dict.fromkeys([attrs["structure"], attrs["title"]]))
        say(f"{title} ({attrs['mass']} mass, {attrs['method']})", "bold")
        modes, remark = _numbers(attrs.get("periods_s", [])), ""
        if len(modes) > SHOWN_MODES:
            remark = f", the longest {SHOWN_MODES} of {len(modes)}"
        periods = ", ".join(f"{value:.3f}" for value in modes[:SHOWN_MODES])
        damped = _numbers(attrs.get("damping_ratios", []))[:SHOWN_MODES]
        ratios = ", ".join(f"{value:.1%}" for value in damped)
        direction = "" if self.in_plan or not self.directions else f" along {self.directions[0]}"
        if modes:
            say(f"periods{direction} {periods} s{remark}, {nominal_note(self)}")
        say(f"viscous damping {attrs['damping']}: ratios of these modes {ratios}")
        if "surroundings" in attrs:
            say(attrs["surroundings"])
        if self.runs:
            for table in tables.console_tables(self):
                show_table(table)
        if self.compared:
            rows = earlier.comparison_table(self.compared)
            show_table(tables.errors_table(rows))
            say(earlier.verdict(rows))
            for row in rows[rows["outcome"] != "completed"].to_dict("records"):
                run_text = measures.run_name(row["bearing"], row["motion"], row["ambient_degC"], "")
                text = f"{row['model']} ended early ({run_text}): {row['outcome']}"
                say(f"{text}; its errors are those until then", "yellow")
        for note in self.notes():
            say(note)
        print_warnings(self.warnings)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json; energies of one bearing and of the structure."""
        attrs, table, energy = self.dataset.attrs, self.table, self.energy
        runs, mismatch = [], self.dataset["layer_force_mismatch_max"].values
        parts = {"lines": self.lines, "piers": self.piers, "devices": self.devices}
        for run in range(self.runs):
            rubber = self.dataset["rubber_temperature"].values[run]
            layers = [float(np.nanmax(column)) for column in rubber.T if np.isfinite(column).any()]
            lead = self.hottest(run)["lead"]
            row = _plain(table.iloc[run].to_dict()) | {
                "rubber_degC_max": layers,
                "lead_degC_max": None if np.isnan(lead) else lead,  # JSON has no NaN
                "layer_force_mismatch_max_kN": float(mismatch[run]),
                "energy": _plain(energy.iloc[run].to_dict()),
            }
            for name, rows in parts.items():
                if len(rows):
                    count = len(rows) // self.runs  # every run has the same parts, in order
                    run_rows = rows.iloc[run * count : (run + 1) * count]
                    row[name] = [_plain(part_row) for part_row in run_rows.to_dict("records")]
            runs.append(row)
        names = list(dict.fromkeys(str(name) for name in self.dataset["bearing"].values))
        compared: dict[str, Any] = {}
        if self.compared:
            compared["verdict"] = earlier.verdict(earlier.comparison_table(self.compared))
        if len(self.components):
            rows = tables.components_summary(self.components)
            compared["two_components_over_one"] = rows.to_dict("records")
        if len(self.bands):
            compared[BANDS] = self.bands.to_dict("records")
        case = tomllib.loads(str(attrs["case"]))
        return {
            "command": attrs["command"],
            "bearing": names[0] if len(names) == 1 else names,
            **{key: attrs[key] for key in ("structure", "mass", "method", "scheme", "version")},
            "outcome": self.outcome,
            "warnings": self.warnings,
            **{key: case[key] for key in CODE_KEYS if key in case},
            **self._limits_summary(),
            "periods_s": _numbers(attrs.get("periods_s", [])),
            "damping": attrs["damping"],
            **{key: attrs[key] for key in ("surroundings",) if key in attrs},
            "damping_ratios": _numbers(attrs.get("damping_ratios", [])),
            "initial_periods_s": {n: _numbers(attrs[f"initial_periods_s:{n}"]) for n in names},
            "largest": tables.governing_runs(self).to_dict("records"),
            "runs": without_rounding(runs),
            **compared,
        }

    def _write(self, folder: Path) -> None:
        (folder / directory.RESOLVED).write_text(self.dataset.attrs["case"], encoding="utf-8")
        table = written.with_governing_bearings(self.table, self.line_bearings)
        write_csv(folder / directory.TABLE, table)
        frames = {directory.MODES: self.modes_table, directory.AXIAL: self.axial}
        if self.in_plan:
            frames[directory.DIRECTIONS] = self.by_direction()
        frames[directory.COMPONENTS] = self.components
        frames[directory.BANDS] = self.bands
        frames[directory.ROTATION] = tables.rotation_measures_frame(self)
        frames[directory.LINES] = written.with_own_bearing(self.by_direction("lines"))
        frames[directory.PIERS] = self.by_direction("piers")
        if self.compared:
            frames[directory.COMPARISON] = earlier.comparison_table(self.compared)
        for name, frame in frames.items():
            if len(frame):
                write_csv(folder / name, frame)
        self._write_histories(folder / directory.HISTORY)
        write_dataset(self.dataset, folder / directory.DATASET)

    def _write_histories(self, path: Path) -> None:
        keys = {RUN[name]: self.dataset[name].values for name in self._labels}
        for run in range(self.runs):
            frame = self.history(run)
            for place, (name, values) in enumerate(keys.items()):
                frame.insert(place, name, values[run])
            write_csv(path, frame, below=run > 0)


def _numbers(attribute: Any) -> list[float]:
    """Return an attribute that is a list; netCDF gives a list of one back as a number."""
    return [float(value) for value in np.atleast_1d(attribute)]


def _plain(row: dict[Any, Any]) -> dict[str, Any]:
    return {str(k): v.item() if hasattr(v, "item") else v for k, v in row.items()}
