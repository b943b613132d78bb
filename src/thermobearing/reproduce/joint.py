"""Which unprinted choices would make the source's statements true together, and how many at once.

Sets of choices (`data/claims/joint.toml`) are computed, each statement is judged, and the sets are
put in order. A set that meets many statements is compatible with them: that is no proof that it was
the source's. The motions are stand-ins with the spectra of the accelerograms and other phases.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import combinations, product
from typing import Annotated, Any, Literal, get_args

import numpy as np
import pandas as pd
from pydantic import Field

from thermobearing.bearing.library import changed_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import Keep
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.study import bridge, hybrid
from thermobearing.reproduce import joint_measures
from thermobearing.reproduce.joint_measures import COLD, MOMENTS, Computed
from thermobearing.reproduce.runs import AMBIENT, Runs
from thermobearing.structure.model import Structure, load_structure

Study = Literal["bridge", "hybrid"]
Set = Mapping[str, Any]
STEP, KEPT = 0.01, 20  # of the runs of the search [s]; of their histories
EIGHT = 8  # bearings of the hypothetical bridge, 3.4.1
SECONDS = 20.0  # of the hybrid test


class Choice(Strict):
    """What the source leaves open; the first value is our default."""

    study: Study
    name: str
    values: Annotated[tuple[float | int | str, ...], Field(min_length=1)]
    means: str


class Statement(Strict):
    """What the source says; it holds where all numbers of the measure stay between the limits."""

    study: Study
    name: str
    place: str
    says: str
    measure: str
    above: float | None = None
    below: float | None = None

    def holds(self, numbers: Floats) -> bool:
        """False where a number is missing."""
        low = -np.inf if self.above is None else self.above
        high = np.inf if self.below is None else self.below
        return bool(np.all((numbers > low) & (numbers < high)))


class Joint(Strict):
    """The file of both."""

    choice: tuple[Choice, ...]
    statement: tuple[Statement, ...]

    def sets(self, study: Study) -> list[dict[str, Any]]:
        """All combinations, the default one first."""
        chosen = [choice for choice in self.choice if choice.study == study]
        names = [choice.name for choice in chosen]
        return [dict(zip(names, v, strict=True)) for v in product(*(c.values for c in chosen))]

    def statements(self, study: Study) -> list[Statement]:
        """Of one study."""
        return [statement for statement in self.statement if statement.study == study]


@cache
def load_joint() -> Joint:
    """What is searched.

    Examples
    --------
    >>> load_joint().sets("bridge")[0]["damping"]
    'modal'
    """
    path = data_path("claims", "joint.toml")
    return validated(Joint, read_toml(path), str(path))


def all_tables(_runs: Runs) -> dict[str, pd.DataFrame]:
    """Sets of both studies, best first, what each choice does, and statements that no set meets."""
    found = {}
    for study in get_args(Study):
        table = search(load_joint(), study)
        found[f"joint_{study}"] = table
        found[f"joint_{study}_choices"] = weights(load_joint(), study, table)
        found[f"joint_{study}_conflicts"] = conflicts(load_joint(), study, table)
    return found


def search(joint: Joint, study: Study) -> pd.DataFrame:
    """Every set judged: the one that meets most first, of equal ones that nearest to the default.

    Parameters
    ----------
    joint : choices and statements.
    study : "bridge" (chapter 6) or "hybrid" (chapter 3).

    Returns
    -------
    DataFrame : a column a choice, `met` and `of`, `changed` (choices away from the default), and
        of each statement whether it is met and its smallest and largest number; `why` a set
        could not be run.
    """
    maker: Bridges | Hybrids = Bridges() if study == "bridge" else Hybrids()
    sets, statements = joint.sets(study), joint.statements(study)
    rows = []
    for chosen in sets:
        met, told, why = judged(maker, chosen, statements)
        changed = sum(chosen[name] != sets[0][name] for name in chosen)
        counts = {"met": sum(met.values()), "of": len(met), "changed": changed}
        rows.append({**chosen, **counts, **met, **told, "why": why})
    table = pd.DataFrame(rows)
    order = ["met", "changed"]
    return table.sort_values(order, ascending=[False, True], kind="stable", ignore_index=True)


def judged(
    maker: "Bridges | Hybrids", chosen: Set, statements: Sequence[Statement]
) -> tuple[dict[str, bool], dict[str, str], str]:
    """Which statements a set meets, their numbers, and why it could not be run, if so."""
    try:
        computed = maker.computed(chosen)
    except InputError as error:
        names = [statement.name for statement in statements]
        told = {f"{name}: numbers": "" for name in names}
        return dict.fromkeys(names, False), told, " ".join(str(error).split())
    met, told = {}, {}
    for statement in statements:
        numbers = np.asarray(getattr(joint_measures, statement.measure)(computed), float)
        met[statement.name] = statement.holds(numbers)
        told[f"{statement.name}: numbers"] = span(numbers)
    return met, told, ""


def span(numbers: Floats) -> str:
    """Smallest to largest.

    Examples
    --------
    >>> span(np.array([0.5, 1.25])), span(np.array([2.0]))
    ('0.5 to 1.25', '2')
    """
    low, high = float(numbers.min()), float(numbers.max())
    return f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"


def conflicts(joint: Joint, study: Study, table: pd.DataFrame) -> pd.DataFrame:
    """How many sets meet each statement; and pairs that each are met, but never in one set."""
    names = [statement.name for statement in joint.statements(study)]
    rows: list[dict[str, Any]] = [
        {"statement": name, "and": "", "met_by": int(table[name].sum()), "of": len(table)}
        for name in names
    ]
    for first, second in combinations(names, 2):
        together = int((table[first] & table[second]).sum())
        if not together and table[first].any() and table[second].any():
            rows.append({"statement": first, "and": second, "met_by": 0, "of": len(table)})
    return pd.DataFrame(rows)


def weights(joint: Joint, study: Study, table: pd.DataFrame) -> pd.DataFrame:
    """How much one choice alone changes the count of statements met, between sets equal otherwise.

    What other stand-ins change is no knowledge of the source: a set has to be ahead by more.

    Returns
    -------
    DataFrame : `choice`, `pairs` of sets, `mean` and `most` of the differences between them.
    """
    names = [choice.name for choice in joint.choice if choice.study == study]
    ran = table[table["why"] == ""]
    rows = []
    for name in names:
        others = [other for other in names if other != name]
        met = [group["met"].to_numpy() for _, group in ran.groupby(others)]
        gaps = [abs(int(a) - int(b)) for found in met for a, b in combinations(found, 2)]
        mean, most = (float(np.mean(gaps)), max(gaps)) if gaps else (np.nan, 0)
        rows.append({"choice": name, "pairs": len(gaps), "mean": mean, "most": most})
    return pd.DataFrame(rows)


class Bridges:
    """Pier P1 with the choices of a set; a bearing is run once for those that matter to it."""

    def __init__(self) -> None:
        self._kept: dict[str, pd.DataFrame] = {}

    def computed(self, chosen: Set) -> Computed:
        """Both bearings under four motions at three temperatures."""
        pier = rocking_pier(float(chosen["rocking"]))
        stiffness = {"layer_stiffness": float(chosen["K_r"])}
        hdr = changed_bearing("shen-hdr-bridge", hysteresis=stiffness)
        lhdr = load_bearing("shen-lhdr-bridge")
        first, second = (self._table(pier, bearing, chosen) for bearing in (hdr, lhdr))
        return Computed(pier, chosen["mass"], first, second, hdr)

    def _table(self, pier: Structure, bearing: Bearing, chosen: Set) -> pd.DataFrame:
        options = {name: chosen[name] for name in ("mass", "damping")}
        numbers = [number.strip() for number in str(chosen["motions"]).split(",")]
        motions = [f"jra-{kind}-i-{number}" for kind in ("i", "ii") for number in numbers]
        key = repr((chosen["rocking"], options, motions, bearing.hysteresis, bearing.name))
        if key not in self._kept:
            study = bridge(
                bearing,
                motions,
                list(AMBIENT),
                structure=pier,
                dt=STEP,
                keep=Keep(every=KEPT),
                **options,
            )
            self._kept[key] = whole(study)
        return self._kept[key]


class Hybrids:
    """The hybrid test with the choices of a set, likewise."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[pd.DataFrame, tuple[float, ...]]] = {}

    def computed(self, chosen: Set) -> Computed:
        """Both specimens in both modes at three temperatures."""
        pier = hybrid_pier(str(chosen["bearings"]))
        hdr = load_bearing("shen-hdr-specimen")
        lhdr = changed_bearing("shen-lhdr-specimen", lead={"cores": int(chosen["cores"])})
        warm, _ = self._table(pier, hdr, chosen)
        cold, layer = self._table(pier, lhdr, chosen)
        return Computed(pier, "consistent", warm, cold, hdr, layer)

    def _table(
        self, pier: Structure, bearing: Bearing, chosen: Set
    ) -> tuple[pd.DataFrame, tuple[float, ...]]:
        cores = bearing.lead.cores if bearing.lead else 0
        open_ = [chosen[name] for name in ("bearings", "damping", "motion")]
        key = repr((open_, bearing.name, cores))
        if key not in self._kept:
            study = hybrid(
                bearing,
                chosen["motion"],
                list(AMBIENT),
                structure=pier,
                damping=chosen["damping"],
                laboratory={"mode": ["rt", "pd"]},
                duration=SECONDS,
                keep=Keep(every=KEPT),
            )
            self._kept[key] = whole(study), outer_layer(study)
        return self._kept[key]


def whole(study: EarthquakeResult) -> pd.DataFrame:
    """The table of a study; numbers of runs that ended early are missing."""
    table = study.table
    numbers = table.select_dtypes("float").columns.drop("ambient_degC")
    table.loc[table["outcome"] != "completed", numbers] = np.nan
    return table


def rocking_pier(factor: float) -> Structure:
    """Pier P1 with so many times the rocking spring."""
    pier = load_structure("pier-p1")
    springs = [
        spring.model_copy(update={"rotational_stiffness": factor * spring.rotational_stiffness})
        if spring.rotational_stiffness is not None
        else spring
        for spring in pier.springs
    ]
    return pier.model_copy(update={"springs": tuple(springs)})


def hybrid_pier(words: str) -> Structure:
    """The pier of the hybrid test on so many bearings; together they keep the printed k_1.

    Examples
    --------
    >>> pier = hybrid_pier("2, share of the deck")
    >>> pier.bearings[0].count, pier.masses[0].mass
    (2, 2.539)
    """
    pier = load_structure("hybrid-pier")
    line, count = pier.bearings[0], int(words.partition(",")[0])
    each = line.count * line.equivalent_stiffness / count
    changed = line.model_copy(update={"count": count, "equivalent_stiffness": each})
    part = count / EIGHT if "share" in words else 1.0
    masses = [
        mass.model_copy(update={"mass": part * mass.mass})
        if mass.body == pier.report.deck
        else mass
        for mass in pier.masses
    ]
    return pier.model_copy(update={"bearings": [changed], "masses": masses})


def outer_layer(study: EarthquakeResult) -> tuple[float, ...]:
    """Of the coldest run in real time at `MOMENTS` [degC]."""
    table = study.table
    run = int(table.index[(table["ambient_degC"] == COLD) & (table["mode"] == "rt")][0])
    time = study["time"].values[run]
    known = np.isfinite(time)
    outer = study["rubber_temperature"].values[run, known, 0].astype(float)
    return tuple(float(value) for value in np.interp(MOMENTS, time[known], outer))
