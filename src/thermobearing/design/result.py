"""Results: a design, a comparison of bounds with the model, factors of temperature."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path, PurePath
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
from thermobearing.design import factors
from thermobearing.design.bounds import BOUNDS_NOTE, bound_models, opensees_text, paragraph
from thermobearing.design.case import DesignCase, bearing_weight, make_design_case
from thermobearing.design.peaks import (
    coldest_sentences,
    envelope,
    few_motions,
    of_group,
    peak_rule,
)
from thermobearing.design.sizing import Check, EqualBearing, Round, third_cycle
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import directory as files
from thermobearing.results.base import Result
from thermobearing.results.ranges import Row, asked_of_tests, one_per_cause, outside_tests
from thermobearing.results.screen import print_table, print_warnings, say
from thermobearing.results.writing import write_csv

USABLE = ("converged", "two_sizes")  # outcomes of a design
ENOUGH = 0.10  # of the displacement: "no more than 10 %" (6.2.2)
COLUMNS = {  # of the rounds on the console: head, width
    "round": 5,
    "u_B mm": 6,
    "bearing": 10,
    "K_B kN/mm": 9,
    "h_B": 6,
    "Q_d kN": 6,
    "found mm": 8,
    "differ": 6,
    "ductility": 9,
}


def _beyond_tests(tests: Mapping[str, tuple[list[Row], Any]]) -> list[str]:
    """Return a warning for each cause: what left the tests, by bearing its rows and ranges."""
    said: list[tuple[str, str]] = []
    for name, (rows, ranges) in tests.items():
        outside = outside_tests(name, rows, ranges, skip=("strain_rate",))
        said += [(name, text.removeprefix(f"{name}: ")) for text in outside]
    return one_per_cause(said)


def _line(cells: Mapping[str, str]) -> str:
    return " ".join(cell.rjust(COLUMNS[head]) for head, cell in cells.items())


def print_head(case: DesignCase) -> None:
    """Print what is designed, and the heads of the rounds."""
    names = ", ".join(PurePath(motion.name).name for motion in case.motions)
    rubber = f"{case.structure.name}, {case.compound_kind} {case.compound}, "
    loads = [f"{bearing_weight(case, group):.0f} kN a bearing" for group in case.groups]
    pairs = zip(case.line_groups or [], loads, strict=False)
    groups = "; ".join(f"group {group.name}: {load}" for group, load in pairs)
    say(f"{rubber}{groups or loads[0]}, motions {names}")
    say(_line({head: head for head in COLUMNS}), "bold")


def print_round(turn: Round) -> None:
    """Print a round in a line."""
    size = turn.size
    cells = (
        f"{turn.number}",
        f"{turn.assumed:.0f}",
        f"{size.side:g}, {size.layers}x{size.layer_thickness:g}",
        f"{turn.stiffness:.3f}",
        f"{turn.damping:.3f}",
        f"{turn.strength:.1f}",
        f"{turn.found:.0f}",
        f"{turn.difference:+.1%}",
        f"{turn.ductility:.2f}",
    )
    say(f"{_line(dict(zip(COLUMNS, cells, strict=True)))} {turn.group}".rstrip())


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
            reached = {"strain": item.displacement / item.bearing.total_rubber_thickness}
            run = f"{item.bearing.name}, {item.displacement:.0f} mm"
            rows += asked_of_tests(run, reached, calibration_ranges(item.bearing))
        return pd.DataFrame(rows + list(self.temperatures.attrs.get("tested_range", [])))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        rows = self.tested_range.to_dict("records")
        every: list[Bearing | BilinearBearing] = [*self.bearings]
        every += [item.bearing for item in self.equal]
        tests = {
            name: (
                [row for row in rows if str(row["run"]).startswith(f"{name}, ")],
                calibration_ranges(bearing),
            )
            for name, bearing in {one.name: one for one in every}.items()  # some share a size
        }
        return [*few_motions(self.case.motions, self.case.peaks), *_beyond_tests(tests)]

    @property
    def _sheet(self) -> list[dict[str, Any]]:
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
        """Print verdict, checks, the published design, layered bearings of equal stiffness."""
        say(self.sentence)
        rule = peak_rule(self.case.peaks)
        say(f"Peaks are {rule.says}; {rule.source}{factors.marked(rule)}.")
        if self.first_within is not None:
            say(f"Round {self.first_within} was the first within the 10 % of the printed loop.")
        self._print_checks()
        printed = make_design_case({}, "default")
        keys = {"structure", "compound", "compound_kind", "weight"}
        if self.case.model_dump(include=keys) == printed.model_dump(include=keys):
            say(f"\n{_published_design()}")
        for item in self.equal:
            name = of_group(item.bearing.name, item.group)
            say(
                f"equal K_B: {name}, K_eq {item.stiffness:.3f} kN/mm, "
                f"h_eq {item.damping:.3f} at 23 degC without heating"
            )
        for sentence in coldest_sentences(self.temperatures):
            say(sentence)
        if rule.unverified or any(check.unverified for check in self.checks):
            say(factors.FOOTNOTE)
        print_warnings(self.warnings)

    def _print_checks(self) -> None:
        """Print the calculation sheet."""
        several = any(check.part for check in self.checks)
        rows = []
        for check in self.checks:
            unit = "" if check.unit == "1" else f" {check.unit}"
            limit = f"{'>=' if check.least else '<='} {check.limit:g}{unit}"
            source = check.source + factors.marked(check)
            cells = (f"{check.value:.3g}{unit}", limit, check.verdict, source)
            rows.append((check.what, *[check.part] * several, *cells))
        styles = ["" if check.passed else "bold red" for check in self.checks]
        heads = ("checks", *["of"] * several, "value", "limit", "verdict", "source of the limit")
        print_table(heads, rows, title=" ", styles=styles)

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
        (folder / files.BEARINGS).mkdir()
        bearings = {bearing.name: to_toml(bearing) for bearing in self.bearings}
        bearings |= {item.bearing.name: to_toml(item.bearing) for item in self.equal}
        for name, text in zip(file_names(bearings), bearings.values(), strict=True):
            (folder / files.BEARINGS / f"{name}.toml").write_text(text, encoding="utf-8")


def _published_design() -> str:
    """Return what Shen (2023) came to."""
    published = read_toml(data_path("design", "source.toml"))
    bearing, more = published["bearing"], published["more"]
    hdr, lhdr = more["equal_K_B_kN_mm"]
    return (
        f"source (Tables 6.1, 6.3): u_B {bearing['u_B_mm']:g} mm, {bearing['side_mm']:g} mm, "
        f"{bearing['layers']}x{more['layer_thickness_mm']:g}, "
        f"K_B {bearing['K_B_kN_mm']:.3f} kN/mm, "
        f"Q_d {bearing['Q_d_kN']:g} kN; equal HDR and LHDR bearings {more['equal_side_mm']:g} mm, "
        f"{more['equal_layers']}x{more['equal_layer_thickness_mm']:g}, K_B {hdr:g} and {lhdr:g} "
        "kN/mm. Its motions are not free to ship, so the displacement differs."
    )


@dataclass(frozen=True, repr=False)
class BoundsReport(Result):
    """Bounding analyses compared with the coupled model: `bounds_study` by name of the bearing."""

    _figures: ClassVar[str] = "BoundsFigures"

    studies: dict[str, pd.DataFrame]

    def _attrs(self, name: str) -> list[Any]:
        """Return what the tables of all bearings hold in a list of that name."""
        return [item for t in self.studies.values() for item in t.attrs.get(name, [])]

    @property
    def table(self) -> pd.DataFrame:
        """All tables below each other."""
        own = self.studies.items()
        return pd.concat([t.assign(bearing=name, structure=self.structure) for name, t in own])

    @property
    def outcome(self) -> str:
        """Completed, or what ended a run early."""
        return next(iter(self._attrs("ended")), "completed")

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try."""
        return next(iter(self._attrs("sentences")), "")

    @property
    def tested_range(self) -> pd.DataFrame:
        """What the coupled model asks of the range that each bearing was tested in."""
        return pd.DataFrame(self._attrs("tested_range"))

    @property
    def warnings(self) -> list[str]:
        """What a reader must know: what left the tested ranges."""
        own = self.studies.items()
        return _beyond_tests(
            {n: (t.attrs.get("tested_range", []), t.attrs.get("ranges")) for n, t in own}
        )

    @property
    def structure(self) -> str:
        """What the bearings stand on."""
        return next((str(t.attrs.get("structure", "")) for t in self.studies.values()), "")

    @property
    def paragraphs(self) -> dict[str, str]:
        """The result in words, by name of the bearing."""
        return {name: paragraph(table, name) for name, table in self.studies.items()}

    def show(self) -> None:
        """Print a paragraph for each bearing."""
        for text in self.paragraphs.values():
            say(text + "\n")
        print_warnings(self.warnings)

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

    The first of `bearings` gives the values of `table` (see `temperature_factors`), all of them the
    bands; `reference` [degC]; `motion` and `cycles` say how it was tested; `sizes` holds table and
    results of `scale_study`, if it was wanted.
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
    def _bounds(self) -> pd.DataFrame:
        """Lower and upper bilinear model."""
        first = self.bearings[0]
        return bound_models(self.table, self.strain, first.total_rubber_thickness, first.kind)

    def show(self) -> None:
        """Print factors of the largest strain, and the bounds."""
        others = len(self.bearings) - 1
        band = f" (values; figure and factors.csv have the band of it and {others} more)"
        say(
            f"{self.name}{band if others else ''}: {self.motion}, cycles {self.cycles}, "
            f"reference {self.reference:g} degC, strain {self.strain:.0%}"
        )
        self._print_factors()
        for row in self._bounds.to_dict("records"):
            say(
                f"{row['bound']} bound ({row['basis']} cycle, {row['ambient_degC']:g} degC): Q_d "
                f"{row['Q_d_kN']:.1f} kN, K_1 {row['K_1_kN_mm']:.2f}, "
                f"K_2 {row['K_2_kN_mm']:.3f} kN/mm"
            )
        ratio = post_yield_ratio(self.bearings[0].kind)
        say(f"K_2/K_1 {ratio.K_2_over_K_1:.3g}: {ratio.source}{factors.marked(ratio)}")
        say(BOUNDS_NOTE)
        for sentence in factors.coldest_factors(self.table, self.strain):
            say(sentence)
        for code in factors.published().codes:
            say(f"{code.code}: {code.says}{factors.marked(code)}")
        say("values of other sources: figure, and `published` in summary.json")
        say(factors.FOOTNOTE)
        print_warnings(self.warnings)

    def _print_factors(self) -> None:
        """Print factors at the largest strain, their band, and what they are made of."""
        rows = self.table[self.table["strain"] == self.strain]
        last, mean = (rows.loc[rows["basis"] == basis, "value"] for basis in ("heated", "mean"))
        if last.tolist() == mean.tolist():  # of one cycle: the same twice
            rows = rows[rows["basis"] != "mean"]
        _print_by_temperature(rows, "factor", [f"{value:.2f}" for value in rows["factor"]])
        if len(self.bearings) > 1:
            pairs = zip(rows["factor_low"], rows["factor_high"], strict=True)
            shown = [f"{low:.2f} to {high:.2f}" for low, high in pairs]
            _print_by_temperature(rows, f"5 to 95 % of {len(self.bearings)} bearings", shown)
        names = [
            quantity if unit == "1" else f"{quantity} {unit}"
            for quantity, unit in zip(rows["quantity"], rows["unit"], strict=True)
        ]
        shown = [f"{value:.4g}" for value in rows["value"]]
        _print_by_temperature(rows.assign(quantity=names), "value", shown)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        first = self.bearings[0]
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
            "coldest_day": factors.coldest_factors(self.table, self.strain),
            "codes": [item.model_dump() for item in factors.published().codes],
            "factors": self.table.to_dict("records"),
            "published": [item.model_dump() for item in factors.published().tables],
        }

    def _write(self, folder: Path) -> None:
        write_csv(folder / files.FACTORS, self.table)
        write_csv(folder / files.BOUNDS, self._bounds)
        for file, language in ((files.BOUNDS_TCL, "tcl"), (files.BOUNDS_PYTHON, "python")):
            text = opensees_text(self._bounds, self.name, language)
            (folder / file).write_text(text, encoding="utf-8")
        if self.sizes is not None:
            write_csv(folder / files.SCALE, self.sizes[0])


def _print_by_temperature(rows: pd.DataFrame, head: str, shown: list[str]) -> None:
    """Print a table: a row for each quantity and basis, a column for each temperature."""
    wide = rows.assign(shown=shown).pivot_table(
        index=["quantity", "basis"], columns="ambient_degC", values="shown", aggfunc="first"
    )
    keys = [key if isinstance(key, tuple) else (key, "") for key in wide.index]
    cells = [tuple(map(str, [*key, *row])) for key, row in zip(keys, wide.to_numpy(), strict=True)]
    print_table((head, "cycles", *(f"{value:g} degC" for value in wide.columns)), cells, keys=2)
