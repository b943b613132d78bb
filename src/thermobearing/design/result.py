"""Results: a design, a comparison of bounds with the model, factors of temperature."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pandas as pd

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.border.library import data_path
from thermobearing.border.text_file import file_names
from thermobearing.border.toml import read_toml, to_table, to_toml
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import post_yield_ratio
from thermobearing.cyclic.result import Result as CyclicResult
from thermobearing.design.bounds import (
    BOUNDS_NOTE,
    BoundModel,
    bound_models,
    bounds_table,
    opensees_text,
    paragraph,
)
from thermobearing.design.case import DesignCase
from thermobearing.design.factors import coldest_factors, published_codes, published_tables
from thermobearing.design.peaks import coldest_sentences, envelope, few_motions, peak_rule
from thermobearing.design.sizing import Check, EqualBearing, Round, third_cycle
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import directory as files
from thermobearing.results.base import Result
from thermobearing.results.ranges import (
    Row,
    asked_of_tests,
    one_per_cause,
    outside_tests,
)
from thermobearing.results.writing import write_csv


def _beyond_tests(tests: Mapping[str, tuple[list[Row], Any]]) -> list[str]:
    """Return a warning for each cause: what left the tests, by bearing its rows and ranges."""
    said: list[tuple[str, str]] = []
    for name, (rows, ranges) in tests.items():
        outside = outside_tests(name, rows, ranges, skip=("strain_rate",))
        said += [(name, text.removeprefix(f"{name}: ")) for text in outside]
    return one_per_cause(said)


USABLE = ("converged", "two_sizes")  # outcomes of a design
ENOUGH = 0.10  # of the displacement: "no more than 10 %" (6.2.2)


@cache
def source_design() -> dict[str, Any]:
    """Return the design of the source: citation, its bearing, and more about it."""
    return read_toml(data_path("design", "source.toml"))


@dataclass(frozen=True, repr=False, kw_only=True)
class Design(Result):
    """What the loop came to.

    Attributes
    ----------
    case : what was to be designed.
    rounds : of every turn one for each group of lines.
    outcome : "converged", "two_sizes" (the safer of two that alternate was taken), or why not.
    sentence : the same for people.
    checks : the calculation sheet of the turn that was taken, of each kind the governing first.
    bearings : bilinear bearings of that turn, one for each group.
    study : its dynamic analyses.
    equal : layered bearings scaled to the stiffness of each group in that turn.
    chosen : number of the turn that was taken; the last by default.
    temperatures : what the layered bearings do at every temperature; see `judged`.
    """

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
    temperatures: pd.DataFrame = field(default_factory=pd.DataFrame)

    @property
    def taken(self) -> list[Round]:
        """The rounds of the turn that was taken, in the order of the groups."""
        chosen = self.chosen or self.rounds[-1].number
        return [turn for turn in self.rounds if turn.number == chosen]

    @property
    def last(self) -> Round:
        """The round that was taken; of several groups the one with the largest strain."""
        return max(self.taken, key=lambda turn: turn.found / turn.size.total_rubber_thickness)

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
    def table(self) -> pd.DataFrame:
        """One row per round and group."""
        return pd.DataFrame([turn.row() for turn in self.rounds])

    @property
    def tested_range(self) -> pd.DataFrame:
        """What the last round asks of the curves, and equal bearings of their tests.

        Those stand for the design displacement, and for every run at every temperature.
        """
        rows = self.study.tested_range.to_dict("records")
        for item in self.equal:
            bearing, far = item.bearing, item.displacement
            reached = {"strain": far / bearing.total_rubber_thickness}
            run = f"{bearing.name}, {far:.0f} mm"
            rows += asked_of_tests(run, reached, calibration_ranges(bearing))
        return pd.DataFrame(rows + list(self.temperatures.attrs.get("tested_range", [])))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        rows = self.tested_range.to_dict("records")
        every: list[Bearing | BilinearBearing] = [
            *self.bearings,
            *(item.bearing for item in self.equal),
        ]
        tests = {
            name: (
                [row for row in rows if str(row["run"]).startswith(f"{name}, ")],
                calibration_ranges(bearing),
            )
            for name, bearing in {one.name: one for one in every}.items()  # some share a size
        }
        return [*few_motions(self.case.motions, self.case.peaks), *_beyond_tests(tests)]

    @property
    def sheet(self) -> list[dict[str, Any]]:
        """The checks with their verdicts."""
        several = any(check.part for check in self.checks)
        rows = [asdict(check) | {"verdict": check.verdict} for check in self.checks]
        return [{k: v for k, v in row.items() if several or k != "part"} for row in rows]

    @cached_property
    def loops(self) -> dict[str, dict[str, tuple[Floats, Floats]]]:
        """Closed loops [mm, kN] at the design displacement, by group and by bearing.

        Of the bilinear bearing, and of the layered ones their third cycle, with heating.
        """
        found = {}
        for turn, bearing in zip(self.taken, self.bearings, strict=True):
            u, q, k1, k2 = turn.assumed, turn.strength, turn.initial, turn.post_yield
            knee = u - 2.0 * q / (k1 - k2)
            x = np.array([u, knee, -u, -knee, u])
            force = np.array([q + k2 * u, k2 * knee - q, -q - k2 * u, q - k2 * knee, q + k2 * u])
            mine = [item.bearing for item in self.equal if item.group == turn.group]
            loops = {f"{bearing.name} (bilinear)": (x, force)}
            found[turn.group] = loops | {one.name: third_cycle(one, u) for one in mine}
        return found

    def show(self) -> None:
        """Print what the command prints."""
        self._view("output").print_design(self)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        source, names = source_design(), [bearing.name for bearing in self.bearings]
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
            "checks": self.sheet,
            "temperatures": self.temperatures.to_dict("records"),
            "envelope": envelope(self.temperatures).to_dict("records"),
            "coldest_day": coldest_sentences(self.temperatures),
            "equal": [
                {
                    "name": item.bearing.name,
                    **({"group": item.group} if item.group else {}),
                    "K_eq_kN_mm": item.stiffness,
                    "h_eq": item.damping,
                }
                for item in self.equal
            ],
            "source": {"citation": source["citation"], **source["bearing"]},
        }

    def _write(self, folder: Path) -> None:
        (folder / files.RESOLVED).write_text(self.case.to_toml(), encoding="utf-8")
        write_csv(folder / files.ROUNDS, self.table)
        write_csv(folder / files.CHECKS, pd.DataFrame(self.sheet))
        if len(self.temperatures):
            write_csv(folder / files.TEMPERATURES, self.temperatures)
        (folder / files.BEARINGS).mkdir()
        bearings = {bearing.name: to_toml(bearing) for bearing in self.bearings}
        bearings |= {item.bearing.name: to_toml(item.bearing) for item in self.equal}
        for name, text in zip(file_names(bearings), bearings.values(), strict=True):
            (folder / files.BEARINGS / f"{name}.toml").write_text(text, encoding="utf-8")


@dataclass(frozen=True, repr=False)
class BoundsReport(Result):
    """Bounding analyses compared with the coupled model, for some bearings.

    Attributes
    ----------
    studies : tables of `bounds_study`, by name of the bearing.
    """

    _figures: ClassVar[str] = "BoundsFigures"

    studies: dict[str, pd.DataFrame]

    @property
    def table(self) -> pd.DataFrame:
        """All tables below each other."""
        own = self.studies.items()
        return pd.concat([t.assign(bearing=name, structure=self.structure) for name, t in own])

    @property
    def outcome(self) -> str:
        """Completed, or what ended a run early."""
        ended = [name for t in self.studies.values() for name in t.attrs.get("ended", [])]
        return ended[0] if ended else "completed"

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try."""
        said = [text for t in self.studies.values() for text in t.attrs.get("sentences", [])]
        return said[0] if said else ""

    @property
    def tested_range(self) -> pd.DataFrame:
        """What the coupled model asks of the range that each bearing was tested in."""
        found = [table.attrs.get("tested_range", []) for table in self.studies.values()]
        return pd.DataFrame([row for rows in found for row in rows])

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        return _beyond_tests(
            {
                name: (table.attrs.get("tested_range", []), table.attrs.get("ranges"))
                for name, table in self.studies.items()
            }
        )

    @property
    def structure(self) -> str:
        """What the bearings stand on."""
        names = [str(table.attrs.get("structure", "")) for table in self.studies.values()]
        return names[0] if names else ""

    @property
    def paragraphs(self) -> dict[str, str]:
        """The result in words, by name of the bearing."""
        return {name: paragraph(table, name) for name, table in self.studies.items()}

    def show(self) -> None:
        """Print what the command prints."""
        self._view("output").print_bounds(self)

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
            "paragraphs": self.paragraphs,
            "rows": {name: table.to_dict("records") for name, table in self.studies.items()},
        }

    def _write(self, folder: Path) -> None:
        write_csv(folder / files.TABLE, self.table)


@dataclass(frozen=True, repr=False)
class FactorReport(Result):
    """Temperature factors of a bearing, and what follows from them.

    Attributes
    ----------
    bearings : the first gives the values, all of them the bands.
    table : of `temperature_factors`.
    reference : temperature [degC].
    motion, cycles : how it was tested, for people.
    sizes : table and results of `scale_study`, if it was wanted.
    """

    _figures: ClassVar[str] = "FactorFigures"

    bearings: list[Bearing]
    table: pd.DataFrame
    reference: float
    motion: str
    cycles: str
    sizes: tuple[pd.DataFrame, dict[float, CyclicResult]] | None = None

    @property
    def name(self) -> str:
        """Of the bearing that gives the values."""
        return self.bearings[0].name

    @property
    def strain(self) -> float:
        """The largest strain, that of the bounds and the figure."""
        return float(self.table["strain"].max())

    @property
    def tested_range(self) -> pd.DataFrame:
        """What the runs of the first bearing ask of the range that it was tested in."""
        return pd.DataFrame(self.table.attrs.get("tested_range", []))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested range."""
        rows = self.table.attrs.get("tested_range", [])
        return outside_tests(self.name, rows, calibration_ranges(self.bearings[0]))

    @cached_property
    def bounds(self) -> list[BoundModel]:
        """Lower and upper bilinear model."""
        first = self.bearings[0]
        return bound_models(self.table, self.strain, first.total_rubber_thickness, first.kind)

    @property
    def coldest(self) -> list[str]:
        """What the coldest temperature makes of the bearing at the largest strain, in words."""
        return coldest_factors(self.table, self.strain)

    def show(self) -> None:
        """Print what the command prints."""
        self._view("output").print_factors(self)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
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
                "bearing": to_table(self.bearings[0]),
                "sources": self.bearings[0].sources,
                "others": [bearing.name for bearing in self.bearings[1:]],
            },
            "bounds": bounds_table(self.bounds).to_dict("records"),
            "bounds_note": BOUNDS_NOTE,
            "stiffness_ratio": post_yield_ratio(self.bearings[0].kind).model_dump(),
            "coldest_day": self.coldest,
            "codes": [item.model_dump() for item in published_codes()],
            "factors": self.table.to_dict("records"),
            "published": [item.model_dump() for item in published_tables()],
        }

    def _write(self, folder: Path) -> None:
        write_csv(folder / files.FACTORS, self.table)
        write_csv(folder / files.BOUNDS, bounds_table(self.bounds))
        for file, language in ((files.BOUNDS_TCL, "tcl"), (files.BOUNDS_PYTHON, "python")):
            text = opensees_text(self.bounds, self.name, language)
            (folder / file).write_text(text, encoding="utf-8")
        if self.sizes is not None:
            write_csv(folder / files.SCALE, self.sizes[0])
