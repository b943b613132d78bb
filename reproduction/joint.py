"""Which unprinted choices would make the statements of Shen (2023) true together, and how many.

Sets of choices (`data/joint.toml`) are computed, each statement is judged, and the sets are put in
order. A set that meets many statements is compatible with them: that is no proof that it was the
one of the dissertation. The motions are stand-ins with the spectra of its accelerograms.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import combinations, product
from typing import Annotated, Any, Literal, get_args

import numpy as np
import pandas as pd
from pydantic import Field

from reproduction.measures import compute_deck_stress, evaluate
from reproduction.runs import (
    AMBIENT,
    HDR,
    HDR_BRIDGE,
    HYBRID_PIER,
    LHDR,
    LHDR_BRIDGE,
    MODES,
    PIER,
    Runs,
    load_data,
    source_bearing,
)
from thermobearing.bearing.library import changed_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import Keep
from thermobearing.cyclic.equivalent import isothermal_cycle
from thermobearing.earthquake.analysis import bridge, hybrid
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.run import prepare_structure

Study = Literal["bridge", "hybrid"]
Set = Mapping[str, Any]
STEP, KEPT = 0.01, Keep(every=20)  # of the runs of the search [s]; of their histories
EIGHT = 8  # bearings of the hypothetical bridge, 3.4.1
SECONDS = 20.0  # of the hybrid test
PLAN = 1440.0  # side of the bearings that the specimen stands for, 3.4.1 [mm]
MOMENTS = (5.0, 10.0, 20.0)  # of the first layer, 3.4.4 [s]


class Choice(Strict):
    """What Shen (2023) leaves open; the first value is our default."""

    study: Study
    name: str
    values: Annotated[tuple[float | int | str, ...], Field(min_length=1)]
    means: str


class Statement(Strict):
    """A statement; it holds where all numbers of the measure stay between the limits."""

    study: Study
    name: str
    place: str
    says: str
    measure: str
    above: float | None = None
    below: float | None = None

    def holds(self, numbers: Floats) -> bool:
        """Return False where a number is missing."""
        low = -np.inf if self.above is None else self.above
        high = np.inf if self.below is None else self.below
        return bool(np.all((numbers > low) & (numbers < high)))


class Joint(Strict):
    """The file of both."""

    choice: tuple[Choice, ...]
    statement: tuple[Statement, ...]

    def sets(self, study: Study) -> list[dict[str, Any]]:
        """Return all combinations, the default one first."""
        chosen = [choice for choice in self.choice if choice.study == study]
        names = [choice.name for choice in chosen]
        return [dict(zip(names, v, strict=True)) for v in product(*(c.values for c in chosen))]

    def statements(self, study: Study) -> list[Statement]:
        """Return those of one study."""
        return [statement for statement in self.statement if statement.study == study]


@cache
def load_joint() -> Joint:
    """Return what is searched."""
    return load_data(Joint, "joint.toml")


def all_tables(_runs: Runs) -> dict[str, pd.DataFrame]:
    """Return sets of both studies, what each choice does, and statements that no set meets."""
    tables, joint = {}, load_joint()
    for study in get_args(Study):
        table = search(joint, study)
        tables[f"joint_{study}"] = table
        tables[f"joint_{study}_choices"] = weights(joint, study, table)
        tables[f"joint_{study}_conflicts"] = conflicts(joint, study, table)
    return tables


def search(joint: Joint, study: Study) -> pd.DataFrame:
    """Judge every set: the one that meets most first, of equal ones that nearest to the default.

    The table has a column for each choice, `met` and `of`, `changed` (choices away from the
    default), and of each statement whether it is met and its smallest and largest number; `why`
    says that a set could not be run.
    """
    maker = Bridges() if study == "bridge" else Hybrids()
    sets, statements = joint.sets(study), joint.statements(study)
    rows = []
    for chosen in sets:
        met, numbers, reason = judge_set(maker, chosen, statements)
        changed = sum(chosen[name] != sets[0][name] for name in chosen)
        counts = {"met": sum(met.values()), "of": len(met), "changed": changed}
        rows.append({**chosen, **counts, **met, **numbers, "why": reason})
    table = pd.DataFrame(rows)
    order = ["met", "changed"]
    return table.sort_values(order, ascending=[False, True], kind="stable", ignore_index=True)


def judge_set(
    maker: "Bridges | Hybrids", chosen: Set, statements: Sequence[Statement]
) -> tuple[dict[str, bool], dict[str, str], str]:
    """Return which statements a set meets, their numbers, and why it could not be run, if so."""
    try:
        names = maker.compute(chosen)
    except InputError as error:
        blank = {f"{statement.name}: numbers": "" for statement in statements}
        return {s.name: False for s in statements}, blank, " ".join(str(error).split())
    met, ranges = {}, {}
    for statement in statements:
        numbers = np.asarray(evaluate(statement.measure, names), float)
        met[statement.name] = statement.holds(numbers)
        low, high = float(numbers.min()), float(numbers.max())
        words = f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
        ranges[f"{statement.name}: numbers"] = words
    return met, ranges, ""


def conflicts(joint: Joint, study: Study, table: pd.DataFrame) -> pd.DataFrame:
    """Count the sets that meet each statement; and pairs that are met, but never in one set."""
    names = [statement.name for statement in joint.statements(study)]
    rows: list[dict[str, Any]] = [
        {"statement": name, "and": "", "met_by": int(table[name].sum()), "of": len(table)}
        for name in names
    ]
    for first, second in combinations(names, 2):
        compatible = (table[first] & table[second]).any()
        if not compatible and table[first].any() and table[second].any():
            rows.append({"statement": first, "and": second, "met_by": 0, "of": len(table)})
    return pd.DataFrame(rows)


def weights(joint: Joint, study: Study, table: pd.DataFrame) -> pd.DataFrame:
    """Return how much one choice alone changes the count of statements met: mean and most.

    What other stand-ins change is no knowledge of the dissertation: a set has to be ahead by more.
    """
    names = [choice.name for choice in joint.choice if choice.study == study]
    ran = table[table["why"] == ""]
    rows = []
    for name in names:
        remaining = [label for label in names if label != name]
        # Sets that differ in this choice alone, and so what it changes by itself.
        met = [group["met"].to_numpy() for _, group in ran.groupby(remaining)]
        gaps = [abs(int(a) - int(b)) for counts in met for a, b in combinations(counts, 2)]
        mean, largest = (float(np.mean(gaps)), max(gaps)) if gaps else (np.nan, 0)
        rows.append({"choice": name, "pairs": len(gaps), "mean": mean, "most": largest})
    return pd.DataFrame(rows)


# What measures name: `hdr`, `lhdr` and `both` tables of runs, `period`, `stress`, `stiffness`
# (of the HDR bearing at its design displacement), `layer` (first one of the LHDR at -20 degC in
# real time at `MOMENTS`), and four functions.


def grid(table: pd.DataFrame, column: str, mode: str | None = None) -> Floats:
    """Return a row for each motion, a column for each temperature from warm to cold."""
    rows = table if mode is None else table[table["mode"] == mode]
    values = rows.pivot(index="motion", columns="ambient_degC", values=column)
    return values[sorted(values.columns, reverse=True)].to_numpy(dtype=float)


def colder(table: pd.DataFrame, column: str, mode: str | None = None) -> Floats:
    """Return each temperature over the warmer one before."""
    values = grid(table, column, mode)
    return (values[:, 1:] / values[:, :-1]).ravel()


def modes(table: pd.DataFrame, column: str) -> Floats:
    """Return real time over pseudo-dynamic, warm to cold."""
    real, slow = (grid(table, column, mode)[0] for mode in ("rt", "pd"))
    return np.asarray(real / slow)


def of_type(table: pd.DataFrame, kind: int) -> pd.DataFrame:
    """Return runs under motions of Type 1 or 2."""
    return table[table["motion"].str.startswith("jra-ii-") == (kind == 2)]


def names_of_set(
    pier: Structure, mass: Any, hdr: pd.DataFrame, lhdr: pd.DataFrame, **others: Any
) -> dict[str, Any]:
    """Return what the measures of a set may name."""
    functions = {"grid": grid, "colder": colder, "modes": modes, "of_type": of_type}
    period = float(prepare_structure(pier, mass, "none").modes.periods[0])
    numbers = {"period": period, "stress": compute_deck_stress(pier, PLAN**2)}
    return functions | numbers | {"hdr": hdr, "lhdr": lhdr, "both": (hdr, lhdr)} | others


class Bridges:
    """Pier P1 with the choices of a set; a bearing is run once for those that matter to it."""

    def __init__(self) -> None:
        self._kept: dict[str, pd.DataFrame] = {}

    def compute(self, chosen: Set) -> dict[str, Any]:
        """Run both bearings under four motions at three temperatures."""
        pier = rocking_pier(float(chosen["rocking"]))
        hdr = changed_bearing(HDR_BRIDGE, hysteresis={"layer_stiffness": float(chosen["K_r"])})
        lhdr = source_bearing(LHDR_BRIDGE)
        tables = [self._table(pier, bearing, chosen) for bearing in (hdr, lhdr)]
        loop = isothermal_cycle(hdr, Runs().number("u_B") / hdr.total_rubber_thickness)
        return names_of_set(pier, chosen["mass"], *tables, stiffness=loop.stiffness_kN_mm)

    def _table(self, pier: Structure, bearing: Bearing, chosen: Set) -> pd.DataFrame:
        options = {name: chosen[name] for name in ("mass", "damping")}
        numbers = [number.strip() for number in str(chosen["motions"]).split(",")]
        motions = [f"jra-{kind}-i-{number}" for kind in ("i", "ii") for number in numbers]
        key = repr((chosen["rocking"], options, motions, bearing.hysteresis, bearing.name))
        if key not in self._kept:
            settings: dict[str, Any] = {"structure": pier, "dt": STEP, "keep": KEPT} | options
            self._kept[key] = whole_runs(bridge(bearing, motions, list(AMBIENT), **settings))
        return self._kept[key]


class Hybrids:
    """The hybrid test with the choices of a set, likewise."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[pd.DataFrame, Floats]] = {}

    def compute(self, chosen: Set) -> dict[str, Any]:
        """Run both specimens in both modes at three temperatures."""
        pier = hybrid_pier(str(chosen["bearings"]))
        lhdr = changed_bearing(source_bearing(LHDR), lead={"cores": int(chosen["cores"])})
        hdr, _ = self._table(pier, load_bearing(HDR), chosen)
        lead, layer = self._table(pier, lhdr, chosen)
        return names_of_set(pier, "consistent", hdr, lead, layer=layer)

    def _table(self, pier: Structure, bearing: Bearing, chosen: Set) -> tuple[pd.DataFrame, Floats]:
        cores = bearing.lead.cores if bearing.lead else 0
        key = repr(([chosen[k] for k in ("bearings", "damping", "motion")], bearing.name, cores))
        if key not in self._kept:
            settings: dict[str, Any] = {"structure": pier, "damping": chosen["damping"]}
            settings |= {"laboratory": {"mode": list(MODES)}, "duration": SECONDS, "keep": KEPT}
            study = hybrid(bearing, chosen["motion"], list(AMBIENT), **settings)
            self._kept[key] = whole_runs(study), outer_layer(study)
        return self._kept[key]


def whole_runs(study: EarthquakeResult) -> pd.DataFrame:
    """Return the table of a study; numbers of runs that ended early are missing."""
    table = study.table
    numbers = table.select_dtypes("float").columns.drop("ambient_degC")
    table.loc[table["outcome"] != "completed", numbers] = np.nan
    return table


def rocking_pier(factor: float) -> Structure:
    """Return pier P1 with so many times the rocking spring."""
    pier = load_structure(PIER)
    springs = tuple(
        spring.model_copy(update={"rotational_stiffness": factor * spring.rotational_stiffness})
        if spring.rotational_stiffness is not None
        else spring
        for spring in pier.springs
    )
    return pier.model_copy(update={"springs": springs})


def hybrid_pier(words: str) -> Structure:
    """Return the pier of the hybrid test on "2, share of the deck" bearings with the printed k_1.

    Examples
    --------
    >>> pier = hybrid_pier("2, share of the deck")
    >>> pier.bearings[0].count, pier.masses[0].mass
    (2, 2.539)
    """
    pier = load_structure(HYBRID_PIER)
    line, count = pier.bearings[0], int(words.partition(",")[0])
    stiffness = line.count * line.equivalent_stiffness / count
    changed = line.model_copy(update={"count": count, "equivalent_stiffness": stiffness})
    part = count / EIGHT if "share" in words else 1.0
    masses = [
        mass.model_copy(update={"mass": part * mass.mass})
        if mass.body == pier.report.deck
        else mass
        for mass in pier.masses
    ]
    return pier.model_copy(update={"bearings": [changed], "masses": masses})


def outer_layer(study: EarthquakeResult) -> Floats:
    """Return the outer layer of the coldest run in real time at `MOMENTS` [degC]."""
    table = study.table
    run = int(table.index[(table["ambient_degC"] == min(AMBIENT)) & (table["mode"] == "rt")][0])
    time = study["time"].values[run]
    recorded = np.isfinite(time)
    outer = study["rubber_temperature"].values[run, recorded, 0].astype(float)
    return np.asarray(np.interp(MOMENTS, time[recorded], outer))
