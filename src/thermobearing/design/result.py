"""Results: a design, a comparison of bounds with the model, factors of temperature."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.sources import is_never_tested
from thermobearing.bearing.state import RubberState, has_excess, states_table
from thermobearing.border.lazy import pd
from thermobearing.border.library import data_path
from thermobearing.border.text_file import file_names
from thermobearing.border.toml import read_toml, to_table, to_toml
from thermobearing.climate.site import Site
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import post_yield_ratio
from thermobearing.cyclic.result import Result as CyclicResult
from thermobearing.design import codes
from thermobearing.design.bounds import BOUNDS_NOTE, bound_models, opensees_text, virgin_bound
from thermobearing.design.case import DesignCase, make_design_case
from thermobearing.design.peaks import (
    coldest_sentences,
    envelope,
    few_motions,
    peak_rule,
    state_sentences,
)
from thermobearing.design.sizing import EqualBearing, Round, third_cycle
from thermobearing.design.tables import (
    bounds_sentences,
    code_sentences,
    demands_tables,
    design_checks_table,
    design_tables,
    factor_tables,
)
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.checks import Check
from thermobearing.quantities.governing import largest_by
from thermobearing.quantities.tables import Table
from thermobearing.quantities.warned import one_per_cause
from thermobearing.results import directory as files
from thermobearing.results.base import Result
from thermobearing.results.ranges import (
    Row,
    compare_with_tests,
    outside_tests,
    rate_note,
)
from thermobearing.results.writing import write_csv

VIRGIN = RubberState(rubber="virgin")
USABLE = ("converged", "two_sizes")  # outcomes of a design
ENOUGH = 0.10  # of the displacement: "no more than 10 %" (6.2.2)


def _beyond_tests(tests: Mapping[str, tuple[list[Row], Any, bool]]) -> list[str]:
    """Return a warning for each cause: what left the tests.

    `tests` has by bearing its rows, its ranges, and whether it was never tested.
    """
    return one_per_cause(
        warning
        for name, (rows, ranges, never) in tests.items()
        for warning in outside_tests(name, rows, ranges, skip=("strain_rate",), never_tested=never)
    )


def _no_rows() -> "pd.DataFrame":
    """Return an empty table; naming the class in its place would import pandas with this module."""
    return pd.DataFrame()


@dataclass(frozen=True, repr=False, kw_only=True)
class Design(Result):
    """The result of a design.

    Attributes
    ----------
    case : the input.
    rounds : one entry for each group of lines in every round.
    outcome : "converged", "two_sizes" (the larger of two that alternate), or why it failed.
    sentence : the outcome in words.
    checks : checks of the adopted round, the governing one of each kind first.
    bearings : bilinear bearings of the adopted round, one for each group.
    study : dynamic analyses of the adopted round.
    equal : layered bearings scaled to the stiffness of each group in that round.
    chosen : number of the adopted round; the last by default.
    temperatures : peaks of the layered bearings at every temperature; see `collect_peaks`.
    virgin : the same with virgin rubber, which bounds forces and piers.
    """

    title: ClassVar[str] = "Design"
    _figures: ClassVar[str] = "DesignFigures"

    case: DesignCase
    rounds: list[Round]
    outcome: str
    sentence: str
    checks: list[Check]
    bearings: list[BilinearBearing]
    study: EarthquakeResult
    equal: list[EqualBearing] = field(default_factory=list)
    chosen: int = 0
    temperatures: "pd.DataFrame" = field(default_factory=_no_rows)
    virgin: "pd.DataFrame" = field(default_factory=_no_rows)

    @property
    def taken(self) -> list[Round]:
        """The rounds of the turn that was taken, in the order of the groups."""
        chosen = self.chosen or self.rounds[-1].number
        return [turn for turn in self.rounds if turn.number == chosen]

    @property
    def last(self) -> Round:
        """The round that was taken; of several groups the one with the largest strain."""
        return largest_by(self.taken, lambda turn: turn.found / turn.size.total_rubber_thickness)

    @property
    def usable(self) -> bool:
        """Whether there is a design."""
        return self.outcome in USABLE

    @property
    def first_within(self) -> int | None:
        """Number of the first turn in which all groups are within the 10 % of Shen (2023)."""
        beyond = {turn.number for turn in self.rounds if abs(turn.difference) > ENOUGH}
        return next((r.number for r in self.rounds if r.number not in beyond), None)

    @property
    def table(self) -> "pd.DataFrame":
        """One row per round and group."""
        return pd.DataFrame([turn.row() for turn in self.rounds])

    @property
    def tested_range(self) -> "pd.DataFrame":
        """What the last round asks of the curves, and equal bearings of their tests.

        Those stand for the design displacement, and for every run at every temperature.
        """
        rows = self.study.tested_range.to_dict("records")
        for item in self.equal:
            reached = {"strain": item.displacement / item.bearing.total_rubber_thickness}
            run = f"{item.bearing.name}, {item.displacement:.0f} mm"
            rows += compare_with_tests(run, reached, calibration_ranges(item.bearing))
        return pd.DataFrame(rows + list(self.temperatures.attrs.get("tested_range", [])))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        rows = self.tested_range.to_dict("records")
        bearings: list[Bearing | BilinearBearing] = [*self.bearings]
        bearings += [item.bearing for item in self.equal]
        bearings_by_name = {item.name: item for item in bearings}  # some share a size
        tests = {
            name: (
                [row for row in rows if str(row["run"]).startswith(f"{name}, ")],
                calibration_ranges(bearing),
                is_never_tested(bearing.sources),
            )
            for name, bearing in bearings_by_name.items()
        }
        return [*few_motions(self.case.motions, self.case.peaks), *_beyond_tests(tests)]

    @property
    def _sheet(self) -> list[dict[str, Any]]:
        """The checks with their verdicts."""
        omitted = {"of_model"} | (
            {"part"} if not any(check.part for check in self.checks) else set()
        )
        rows = [asdict(check) | {"verdict": check.verdict} for check in self.checks]
        return [{k: v for k, v in row.items() if k not in omitted} for row in rows]

    @cached_property
    def loops(self) -> dict[str, dict[str, tuple[Floats, Floats]]]:
        """Closed loops [mm, kN] at the design displacement, by group and by bearing.

        Of the bilinear bearing, and of the layered ones their third cycle, with heating.
        """
        by_group = {}
        for turn, bearing in zip(self.taken, self.bearings, strict=True):
            # Branches k2 x ± q; unloading with k1 from (u, k2 u + q) meets the lower one at the
            # knee.
            u, q, k1, k2 = turn.assumed, turn.strength, turn.initial, turn.post_yield
            knee = u - 2.0 * q / (k1 - k2)
            x = np.array([u, knee, -u, -knee, u])
            force = np.array([q + k2 * u, k2 * knee - q, -q - k2 * u, q - k2 * knee, q + k2 * u])
            layered_bearings = [item.bearing for item in self.equal if item.group == turn.group]
            loops = {f"{bearing.name} (bilinear)": (x, force)}
            by_group[turn.group] = loops | {
                layered.name: third_cycle(layered, u) for layered in layered_bearings
            }
        return by_group

    def tables(self) -> dict[str, Table]:
        """Return rounds, calculation sheet, layered bearings, and their peaks by temperature."""
        summary = self.summary()
        later_tables = design_tables(summary)
        rounds = later_tables.pop("rounds")
        return {"rounds": rounds, "checks": design_checks_table(summary), **later_tables}

    def notes(self) -> list[str]:
        """Return the verdict, the rule for peaks, the published design, and the coldest day."""
        rule, sentences = peak_rule(self.case.peaks), [self.sentence]
        sentences.append(f"Peaks are {rule.says}; {rule.source}{'*' * rule.unverified}.")
        if self.first_within is not None:
            sentences.append(f"Round {self.first_within} was the first within {ENOUGH:.0%}.")
        printed = make_design_case({}, "default")
        keys = {"structure", "compound", "compound_kind", "weight"}
        if self.case.model_dump(include=keys) == printed.model_dump(include=keys):
            sentences.append(_published_design())
        sentences += coldest_sentences(self.temperatures)
        sentences += state_sentences(self.temperatures, self.virgin)
        starred = rule.unverified or any(check.unverified for check in self.checks)
        return [*sentences, codes.FOOTNOTE] if starred else sentences

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        published = read_toml(data_path("design", "source.toml"))
        names = [bearing.name for bearing in self.bearings]
        return {
            "command": "design",
            "structure": self.case.structure.name,
            "bearing": names[0] if len(names) == 1 else names,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "sentence": self.sentence,
            "warnings": self.warnings,
            **self._limits_summary(),
            "first_within_10_percent": self.first_within,
            "rounds": [turn.row() for turn in self.rounds],
            "chosen_round": self.taken[0].number,
            "peaks": peak_rule(self.case.peaks).model_dump(),
            "checks": self._sheet,
            "temperatures": self.temperatures.to_dict("records"),
            "envelope": envelope(self.temperatures).to_dict("records"),
            "coldest_day": coldest_sentences(self.temperatures),
            "virgin": self.virgin.to_dict("records"),
            "both_states": state_sentences(self.temperatures, self.virgin),
            "equal": [
                {
                    "name": item.bearing.name,
                    **({"group": item.group} if item.group else {}),
                    "K_eq_kN_mm": item.stiffness,
                    "h_eq": item.damping,
                }
                for item in self.equal
            ],
            "source": {"citation": published["citation"], **published["bearing"]},
        }

    def _write(self, folder: Path) -> None:
        (folder / files.RESOLVED).write_text(self.case.to_toml(), encoding="utf-8")
        write_csv(folder / files.ROUNDS, self.table)
        write_csv(folder / files.CHECKS, pd.DataFrame(self._sheet))
        if len(self.temperatures):
            write_csv(folder / files.TEMPERATURES, self.temperatures)
        if len(self.virgin):
            write_csv(folder / files.VIRGIN, self.virgin)
        (folder / files.BEARINGS).mkdir()
        bearings = {bearing.name: to_toml(bearing) for bearing in self.bearings}
        bearings |= {item.bearing.name: to_toml(item.bearing) for item in self.equal}
        for name, text in zip(file_names(bearings), bearings.values(), strict=True):
            (folder / files.BEARINGS / f"{name}.toml").write_text(text, encoding="utf-8")


def _published_design() -> str:
    """Return the design of Shen (2023) in a sentence."""
    published = read_toml(data_path("design", "source.toml"))
    bearing, details = published["bearing"], published["more"]
    hdr, lhdr = details["equal_K_B_kN_mm"]
    return (
        f"Shen (2023), Tables 6.1 and 6.3: u_B {bearing['u_B_mm']:g} mm, "
        f"{bearing['side_mm']:g} mm, {bearing['layers']}x{details['layer_thickness_mm']:g}, K_B "
        f"{bearing['K_B_kN_mm']:.3f} kN/mm, Q_d {bearing['Q_d_kN']:g} kN; equal HDR and LHDR "
        f"bearings {details['equal_side_mm']:g} mm, "
        f"{details['equal_layers']}x{details['equal_layer_thickness_mm']:g}, K_B {hdr:g} and "
        f"{lhdr:g} kN/mm. The motions of that design are not public; the displacement "
        "therefore differs."
    )


@dataclass(frozen=True, repr=False)
class BoundsReport(Result):
    """Bounding analyses compared with the coupled model: `bounds_study` by name of the bearing."""

    title: ClassVar[str] = "Bounds analysis"
    _figures: ClassVar[str] = "BoundsFigures"

    studies: "dict[str, pd.DataFrame]"

    def _attrs(self, name: str) -> list[Any]:
        """Return what the tables of all bearings hold in a list of that name."""
        return [item for t in self.studies.values() for item in t.attrs.get(name, [])]

    @property
    def table(self) -> "pd.DataFrame":
        """All tables below each other."""
        studies = self.studies.items()
        return pd.concat([t.assign(bearing=name, structure=self.structure) for name, t in studies])

    @property
    def outcome(self) -> str:
        """Completed, or what ended a run early."""
        return next(iter(self._attrs("ended")), "completed")

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try."""
        return next(iter(self._attrs("sentences")), "")

    @property
    def tested_range(self) -> "pd.DataFrame":
        """What the coupled model asks of the range that each bearing was tested in."""
        return pd.DataFrame(self._attrs("tested_range"))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        studies = self.studies.items()
        return _beyond_tests(
            {
                name: (
                    table.attrs.get("tested_range", []),
                    *table.attrs.get("ranges", (None, False)),
                )
                for name, table in studies
            }
        )

    @property
    def structure(self) -> str:
        """What the bearings stand on."""
        return next((str(t.attrs.get("structure", "")) for t in self.studies.values()), "")

    @property
    def _states(self) -> dict[str, Any]:
        """States of the rubber, by bearing."""
        tables = self.studies.values()
        return {k: row for t in tables for k, row in t.attrs.get("rubber_state", {}).items()}

    def tables(self) -> dict[str, Table]:
        """Return the demands of the bounds and of the coupled model, in both states of rubber."""
        return demands_tables(self.summary())

    def notes(self) -> list[str]:
        """Return how many demands are unsafe, and the least safe one."""
        return bounds_sentences(self.summary())

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        return {
            "command": "bounds",
            "structure": self.structure,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "warnings": self.warnings,
            **self._limits_summary(),
            "sentence": self.sentence,
            "inputs": {name: table.attrs.get("inputs") for name, table in self.studies.items()},
            "rows": {name: table.to_dict("records") for name, table in self.studies.items()},
            "rubber_state": self._states,
        }

    def _write(self, folder: Path) -> None:
        write_csv(folder / files.TABLE, self.table)


def _site_summary(site: Site) -> dict[str, Any]:
    """Return the statistics of a site, with their tables as records."""
    values = {entry.name: getattr(site, entry.name) for entry in fields(site)}
    return {
        name: value.to_dict("records") if isinstance(value, pd.DataFrame) else value
        for name, value in values.items()
    }


@dataclass(frozen=True, repr=False)
class FactorReport(Result):
    """Temperature factors of a bearing, and what follows from them."""

    title: ClassVar[str] = "Temperature factors"
    _figures: ClassVar[str] = "FactorFigures"

    bearings: list[Bearing]  # the first gives the values, all of them the bands
    table: "pd.DataFrame"  # from `temperature_factors`
    reference: float  # temperature [degC]
    motion: str  # of the tests, in words
    cycles: str
    sizes: "tuple[pd.DataFrame, dict[float, CyclicResult]] | None" = None  # from `scale_study`
    site: Site | None = None  # with its cold
    bands: "pd.DataFrame" = field(default_factory=_no_rows)  # from `rate_bands`
    state: RubberState | None = None  # of the rubber of `table`
    tables_by_state: "dict[str, pd.DataFrame]" = field(
        default_factory=dict
    )  # tables of tested, virgin rubber

    @property
    def name(self) -> str:
        """Of the bearing that gives the values."""
        return self.bearings[0].name

    @property
    def strain(self) -> float:
        """The largest strain, that of the bounds and the figure."""
        return float(self.table["strain"].max())

    @property
    def strength_share(self) -> float:
        """The share of Q_d in the peak force Q_d + K_d D, at the reference temperature."""
        displacement = self.strain * self.bearings[0].total_rubber_thickness
        return codes.strength_share(self.table, self.strain, self.reference, displacement)

    @property
    def tested_range(self) -> "pd.DataFrame":
        """What the runs of the first bearing ask of the range that it was tested in."""
        return pd.DataFrame(self.table.attrs.get("tested_range", []))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested range."""
        rows = self.table.attrs.get("tested_range", [])
        first = self.bearings[0]
        ranges, never = calibration_ranges(first), is_never_tested(first.sources)
        return [*outside_tests(self.name, rows, ranges, skip=("strain_rate",), never_tested=never)]

    @cached_property
    def _bounds(self) -> "pd.DataFrame":
        """Lower and upper bilinear model of tested rubber, and the upper one of virgin rubber."""
        first = self.bearings[0]
        conditions = self.strain, first.total_rubber_thickness, first.kind
        bounds = bound_models(self.tables_by_state.get("tested", self.table), *conditions)
        if len(self.states):
            bounds = pd.concat(
                [bounds, virgin_bound(self.tables_by_state["virgin"], *conditions)],
                ignore_index=True,
            )
        return bounds

    @cached_property
    def states(self) -> "pd.DataFrame":
        """First cycle of tested and of virgin rubber at each temperature, and virgin over tested.

        Empty if no excess of virgin rubber is known or assumed.
        """
        if not self.tables_by_state or not has_excess(self.bearings[0]):
            return pd.DataFrame()
        keys = ["strain", "ambient_degC", "quantity", "unit"]
        cycles = pd.DataFrame(
            {
                name: table[table["basis"] == "first"].set_index(keys)["value"]
                for name, table in self.tables_by_state.items()
            }
        )
        return cycles.assign(ratio=cycles["virgin"] / cycles["tested"]).reset_index()

    def tables(self) -> dict[str, Table]:
        """Return factors, their comparison with codes, bounds, and virgin over tested rubber."""
        return factor_tables(self.summary())

    def notes(self) -> list[str]:
        """Return the provisions of codes with their origin, and a note on strain rates."""
        rate = rate_note(self.table.attrs.get("tested_range", []))
        sentences = code_sentences(self.summary()["codes"])
        return [*sentences, rate] if rate else sentences

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        first = self.bearings[0]
        compared = codes.compare_with_codes(
            self.table, self.strain, first.kind, self.reference, self.strength_share
        )
        return {
            "command": "lambda",
            "bearing": self.name,
            "samples": len(self.bearings),
            "version": thermobearing.__version__,
            "outcome": "completed",
            "reference_degC": self.reference,
            "warnings": self.warnings,
            **self._limits_summary(),
            "motion": self.motion,
            "cycles": self.cycles,
            "inputs": {
                "bearing": to_table(first),
                "sources": first.sources,
                "others": [bearing.name for bearing in self.bearings[1:]],
            },
            "bounds": self._bounds.to_dict("records"),
            "bounds_note": BOUNDS_NOTE,
            "stiffness_ratio": post_yield_ratio(first.kind).model_dump(),
            "compared": compared,
            "makers": codes.compare_with_makers(
                self.table, self.strain, first.kind, self.reference
            ),
            "codes": [item.model_dump() for item in codes.published().codes],
            "reasons": codes.reasons(first, compared, self.strength_share),
            "factors": self.table.to_dict("records"),
            "lead_rises": self.table.attrs.get("lead_rises", []),
            "bands": self.bands.to_dict("records"),
            "state": None if self.state is None else self.state.describe(),
            "states": self.states.to_dict("records"),
            "rubber_state": states_table({self.name: (first, VIRGIN)}) if len(self.states) else {},
            "site": None if self.site is None else _site_summary(self.site),
            "published": [item.model_dump() for item in codes.tables_for(first.kind)],
        }

    def _write(self, folder: Path) -> None:
        write_csv(folder / files.FACTORS, self.table)
        write_csv(folder / files.BOUNDS, self._bounds)
        if len(self.states):
            write_csv(folder / files.STATES, self.states)
        for file, language in ((files.BOUNDS_TCL, "tcl"), (files.BOUNDS_PYTHON, "python")):
            text = opensees_text(self._bounds, self.name, language)
            (folder / file).write_text(text, encoding="utf-8")
        if self.sizes is not None:
            write_csv(folder / files.SCALE, self.sizes[0])
