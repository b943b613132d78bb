"""Results: a design, a comparison of bounds with the model, factors of temperature."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.border.deprecated import renamed
from thermobearing.border.library import data_path
from thermobearing.border.showing import Shown
from thermobearing.border.toml import read_toml, to_table
from thermobearing.cyclic.equivalent import post_yield_ratio
from thermobearing.cyclic.result import Result
from thermobearing.design.bounds import (
    BOUNDS_NOTE,
    BoundModel,
    bound_models,
    bounds_table,
    paragraph,
)
from thermobearing.design.case import DesignCase
from thermobearing.design.peaks import coldest_sentences, envelope, few_motions, peak_rule
from thermobearing.design.published import coldest_factors, published_codes, published_tables
from thermobearing.design.sizing import Check, EqualBearing, Round, third_cycle
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.ranges import (
    Row,
    asked_of_tests,
    list_rows,
    one_per_cause,
    outside_tests,
)
from thermobearing.results.writing import limits_summary

if TYPE_CHECKING:
    from thermobearing.design.figures import BoundsFigures, DesignFigures, FactorFigures

Floats = NDArray[np.float64]


def _asked_by_design(design: "Design") -> list[Row]:
    """Rows of `compared`: the last round against its curves, equal bearings against their tests.

    Those stand for the design displacement, and for every run at every temperature.
    """
    rows = list_rows(design.study.tested_range)
    for item in design.equal:
        bearing, far = item.bearing, item.displacement
        reached = {"strain": far / bearing.total_rubber_thickness}
        rows += asked_of_tests(
            f"{bearing.name}, {far:.0f} mm", reached, calibration_ranges(bearing)
        )
    return rows + list(design.temperatures.attrs.get("tested_range", []))


def _warnings_of_design(design: "Design") -> list[str]:
    """Sentences: what left the curves of the compound, or the tests of equal bearings."""
    rows = _asked_by_design(design)
    said: list[tuple[str, str]] = []
    bearings: list[Bearing | BilinearBearing] = [*design.bearings]
    bearings += [item.bearing for item in design.equal]
    for bearing in {one.name: one for one in bearings}.values():  # some groups share a size
        mine = [row for row in rows if str(row["run"]).startswith(f"{bearing.name}, ")]
        outside = outside_tests(
            bearing.name, mine, calibration_ranges(bearing), skip=("strain_rate",)
        )
        said += [(bearing.name, text.removeprefix(f"{bearing.name}: ")) for text in outside]
    return one_per_cause(said)


def _asked_by_bounds(tables: Mapping[str, pd.DataFrame]) -> list[Row]:
    """Rows of `compared` of the coupled model, of all bearings."""
    return [row for table in tables.values() for row in table.attrs.get("tested_range", [])]


def _warnings_of_bounds(tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Sentences: what the coupled model was not tested at, and runs that ended early."""
    said: list[tuple[str, str]] = []
    for name, table in tables.items():
        rows, ranges = table.attrs.get("tested_range", []), table.attrs.get("ranges")
        outside = outside_tests(name, rows, ranges, skip=("strain_rate",))
        said += [(name, text.removeprefix(f"{name}: ")) for text in outside]
    return one_per_cause(said)


USABLE = ("converged", "two_sizes")  # outcomes of a design
ENOUGH = 0.10  # of the displacement: "no more than 10 %" (6.2.2)


@cache
def source_design() -> dict[str, Any]:
    """The design of the source: citation, its bearing, and more about it.

    Returns
    -------
    dict : lengths [mm], forces [kN] and stiffnesses [kN/mm], as the names say.

    Examples
    --------
    >>> source_design()["bearing"]["u_B_mm"]
    178.0
    """
    return read_toml(data_path("design", "source.toml"))


@dataclass(frozen=True, repr=False)
class Design(Shown):
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
        """What the last round asks of the curves, and equal bearings of their tests."""
        return pd.DataFrame(_asked_by_design(self))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        return [*few_motions(self.case.motions, self.case.peaks), *_warnings_of_design(self)]

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

    def summary(self) -> dict[str, Any]:
        """The content of summary.json."""
        source, names = source_design(), [bearing.name for bearing in self.bearings]
        return {
            "command": "design",
            "structure": self.case.structure.name,
            "bearing": names[0] if len(names) == 1 else names,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "sentence": self.sentence,
            "warnings": self.warnings,
            **limits_summary(pd.DataFrame(), self.tested_range),
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

    @property
    def plot(self) -> "DesignFigures":
        """Figures: `design.plot.rounds()`, `.equal()`."""
        from thermobearing.design.figures import DesignFigures

        return DesignFigures(self)

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write a result directory; see `save_design`.

        Parameters
        ----------
        directory, force, figures : as in `save_design`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.design.output import save_design

        return save_design(self, Path(directory), overwrite=overwrite, figures=figures)


@dataclass(frozen=True, repr=False)
class BoundsReport(Shown):
    """Bounding analyses beside the coupled model, for some bearings.

    Attributes
    ----------
    tables : of `bounds_study`, by name of the bearing.
    """

    tables: dict[str, pd.DataFrame]

    @property
    def table(self) -> pd.DataFrame:
        """All tables below each other."""
        return pd.concat(
            [
                table.assign(bearing=name, structure=self.structure)
                for name, table in self.tables.items()
            ]
        )

    @property
    def outcome(self) -> str:
        """Completed, or what ended a run early."""
        ended = [name for t in self.tables.values() for name in t.attrs.get("ended", [])]
        return ended[0] if ended else "completed"

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try."""
        said = [text for t in self.tables.values() for text in t.attrs.get("sentences", [])]
        return said[0] if said else ""

    @property
    def tested_range(self) -> pd.DataFrame:
        """What the coupled model asks of the range that each bearing was tested in."""
        return pd.DataFrame(_asked_by_bounds(self.tables))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        return _warnings_of_bounds(self.tables)

    @property
    def structure(self) -> str:
        """What the bearings stand on."""
        names = [str(table.attrs.get("structure", "")) for table in self.tables.values()]
        return names[0] if names else ""

    @property
    def paragraphs(self) -> dict[str, str]:
        """The result in words, by name of the bearing."""
        return {name: paragraph(table, name) for name, table in self.tables.items()}

    def summary(self) -> dict[str, Any]:
        """The content of summary.json."""
        return {
            "command": "bounds",
            "structure": self.structure,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "warnings": self.warnings,
            **limits_summary(pd.DataFrame(), self.tested_range),
            "sentence": self.sentence,
            "inputs": {name: table.attrs.get("inputs") for name, table in self.tables.items()},
            "paragraphs": self.paragraphs,
            "rows": {name: table.to_dict("records") for name, table in self.tables.items()},
        }

    @property
    def plot(self) -> "BoundsFigures":
        """Figures: `report.plot.demands(name)`."""
        from thermobearing.design.figures import BoundsFigures

        return BoundsFigures(self)

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write a result directory; see `save_bounds`.

        Parameters
        ----------
        directory, force, figures : as in `save_bounds`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.design.output import save_bounds

        return save_bounds(self, Path(directory), overwrite=overwrite, figures=figures)


@dataclass(frozen=True, repr=False)
class FactorReport(Shown):
    """Temperature factors of a bearing, and what follows from them.

    Attributes
    ----------
    bearings : the first gives the values, all of them the bands.
    table : of `temperature_factors`.
    reference : temperature [degC].
    motion, cycles : how it was tested, for people.
    sizes : table and results of `scale_study`, if it was wanted.
    """

    bearings: list[Bearing]
    table: pd.DataFrame
    reference: float
    motion: str
    cycles: str
    sizes: tuple[pd.DataFrame, dict[float, Result]] | None = None

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

    def summary(self) -> dict[str, Any]:
        """The content of summary.json."""
        return {
            "command": "lambda",
            "bearing": self.name,
            "samples": len(self.bearings),
            "version": thermobearing.__version__,
            "outcome": "completed",
            "reference_degC": self.reference,
            "warnings": self.warnings,
            **limits_summary(pd.DataFrame(), self.tested_range),
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

    @property
    def plot(self) -> "FactorFigures":
        """Figures: `report.plot.factors()`, `.sizes()`."""
        from thermobearing.design.figures import FactorFigures

        return FactorFigures(self)

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write a result directory; see `save_factors`.

        Parameters
        ----------
        directory, force, figures : as in `save_factors`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.design.output import save_factors

        return save_factors(self, Path(directory), overwrite=overwrite, figures=figures)
