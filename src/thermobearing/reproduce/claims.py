"""The claims of the source as data: place, statement, what is computed, the rule of the verdict.

`data/claims/*.toml` holds them, a table a row. No verdict is in a file: each run computes it.
"""

from functools import cache
from typing import Annotated, Any, Literal

from pydantic import Field

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml

FOLDER = "claims"
PARTS = ("chapter-3", "chapter-4", "chapter-5", "chapter-6", "conclusions", "misprints")
# What is counted apart: results, their repetition in chapter 7, and errors of the print.
GROUPS = {"statements": PARTS[:4], "chapter 7 repeats": PARTS[4:5], "misprints": PARTS[5:]}
Words = Annotated[str, Field(min_length=1, max_length=600)]
Number = Annotated[float, Field(ge=-1e12, le=1e12)]


class Within(Strict):
    """Near a printed number, or near each of several: relative, or absolute in its unit."""

    kind: Literal["within"] = "within"
    value: Number | tuple[Number, ...]
    unit: str = ""
    per_cent: Annotated[float, Field(gt=0, le=100)] | None = None
    absolute: Annotated[float, Field(gt=0, le=1e6)] | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """One of the two tolerances."""
        both = ("per_cent" in given) == ("absolute" in given)
        return ["give either per_cent or absolute"] if both else []


class Comparison(Strict):
    """Comparisons; those within the noise floor of `judge` count neither for nor against.

    `usually` is for statements with "usually", "typically" or "tends": more than two thirds of
    the comparisons are enough. `exact` is for printed numbers, which have no noise.
    """

    usually: bool = False
    exact: bool = False
    unit: str = ""


class Trend(Comparison):
    """Numbers in a row (of each row, if there are several) that all rise, or all fall."""

    kind: Literal["trend"] = "trend"
    direction: Literal["rises", "falls"]
    along: Words  # what changes from one to the next: "23, 0, -20 degC"


class Order(Comparison):
    """Numbers with names, the largest first."""

    kind: Literal["order"] = "order"
    names: Annotated[tuple[Words, ...], Field(min_length=2)]


class Limit(Comparison):
    """All numbers above, below, or between limits."""

    kind: Literal["limit"] = "limit"
    above: Number | None = None
    below: Number | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """At least one."""
        return [] if {"above", "below"} & set(given) else ["give above, below or both"]


class NeedsTestData(Strict):
    """A statement that only the source's own measurements can judge."""

    kind: Literal["needs-test-data"] = "needs-test-data"
    why: Words


Rule = Annotated[Within | Trend | Order | Limit | NeedsTestData, Field(discriminator="kind")]


class Claim(Strict):
    """One checkable statement or number of the source.

    Attributes
    ----------
    id : a name of its own, "table-3-1-s1".
    place : "Table 3.1", "3.4.5", "Fig. 4.9", "Eq. 4.28".
    statement : what the source says, in our own words.
    computed : module and function of this room, "chapter_3.first_shape_factor"; none where the
        test data would be needed.
    rule : how the numbers become a verdict.
    echoes : whether the numbers are an input or an identity, which no result can change.
    flips : symbols of `data/claims/parameters.toml` that may flip the verdict.
    depends : why 5 % more K_r does not flip it, if it does not.
    reach : how far the parameters are changed in the search for a flip [%].
    figure : name of the figure that shows it, as "fig_3_07".
    """

    id: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=80)]
    place: Words
    statement: Words
    computed: Annotated[str, Field(pattern=r"^[a-z_0-9]+\.[a-z_0-9]+$")] | None = None
    rule: Rule
    echoes: bool = False
    flips: tuple[str, ...] = ()
    depends: str = ""
    reach: Annotated[float, Field(ge=5, le=300)] = 50.0
    figure: str | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """Something is computed, or the test data are needed."""
        rule = given.get("rule")
        kind = rule.get("kind") if isinstance(rule, dict) else getattr(rule, "kind", None)
        needs = kind == "needs-test-data"
        if needs == ("computed" in given):
            return ["give computed, or a rule of kind needs-test-data"]
        return []

    @property
    def needs_data(self) -> bool:
        """Whether only measurements could judge it."""
        return isinstance(self.rule, NeedsTestData)


def group_of(name: str) -> str:
    """Return the group that counts a claim, by its id.

    Examples
    --------
    >>> group_of("table-3-1-s1"), group_of("7-2-size")
    ('statements', 'chapter 7 repeats')
    """
    return _groups().get(name, "statements")


@cache
def _groups() -> dict[str, str]:
    return {
        claim.id: group
        for group, parts in GROUPS.items()
        for part in parts
        for claim in load_claims(part)
    }


class _ClaimsFile(Strict):
    """A file of claims."""

    claim: tuple[Claim, ...] = ()


def load_claims(part: str | None = None) -> list[Claim]:
    """The claims of a part of the source, or all.

    Parameters
    ----------
    part : "chapter-3" to "chapter-6", "conclusions" or "misprints"; all by default.

    Returns
    -------
    list of Claim, in the order of the source.

    Raises
    ------
    InputError : no such part; or a claim that says too much, too little or the same as another.

    Examples
    --------
    >>> load_claims("chapter-3")[0].place
    'Table 3.1'
    """
    if part is not None and part not in PARTS:
        raise InputError(f'no part is called "{part}"{nearest(part, PARTS)}', "claims")
    found: list[Claim] = []
    for name in PARTS if part is None else (part,):
        path = data_path(FOLDER, f"{name}.toml")
        if path.exists():
            found += validated(_ClaimsFile, read_toml(path), str(path)).claim
    names = [claim.id for claim in found]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError([f'id "{name}" is there twice' for name in twice], "claims")
    return found
