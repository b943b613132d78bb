"""Rows of the ledger: claims, rules, verdicts and the changes that turn them.

`data/claims/*.toml` holds them, a table a row. No verdict is in a file: each run computes it.

Changes are looked at on a short list, outwards; between the last that leaves the verdict and the
first that flips it the border is halved until it is known to a sixteenth of their distance.

A row that breaks is a row with its reason: nothing that is wrong with one claim stops the others.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.core.types import Floats
from thermobearing.reproduce.runs import PRINTED, WAVES, Runs

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


def mean_group(name: str) -> str:
    """Return the group that counts a claim, by its id.

    Examples
    --------
    >>> mean_group("table-3-1-s1"), mean_group("7-2-size")
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


REPRODUCED, ECHOES, HOLDS = "reproduced", "echoes an input", "trend holds"
CONTRADICTED, CLOSE = "contradicted", "within 1 %"
UNDECIDED, NEEDS = "not decidable without the motion", "needs the test data"
FAILED = "failed"
VERDICTS = (REPRODUCED, ECHOES, HOLDS, CONTRADICTED, CLOSE, UNDECIDED, NEEDS, FAILED)
ROUNDING = 1e-6  # per cent, or of the unit
SETTLED = (REPRODUCED, ECHOES, HOLDS)
NOISE = 0.01  # relative difference below which a comparison is neither for nor against
USUALLY = 2.0 / 3.0  # more than this share is "usually", "typically", "tends"


@dataclass(frozen=True)
class Verdict:
    """What became of a claim.

    Attributes
    ----------
    kind : one of `VERDICTS`.
    words : the same with its number, "reproduced within 0.31 %", or the reason.
    """

    kind: str
    words: str

    @property
    def settled(self) -> bool:
        """Whether the source's words hold."""
        return self.kind in SETTLED


def verdict_of(rule: Rule, computed: ArrayLike) -> Verdict:
    """The verdict of a rule on computed numbers.

    Parameters
    ----------
    rule : of a claim.
    computed : a number, numbers in a row, or rows of numbers.

    Returns
    -------
    Verdict : "failed" for numbers that are none, or not as many as the rule has.

    Examples
    --------
    >>> from thermobearing.reproduce.claims import Trend
    >>> verdict_of(Within(value=12.0, per_cent=1.0), 12.06).words
    'reproduced within 0.50 %'
    >>> verdict_of(Trend(direction="rises", along="23, 0, -20 degC"), [1.2, 1.7, 2.4]).kind
    'trend holds'
    """
    if isinstance(rule, NeedsTestData):
        return Verdict(NEEDS, f"needs the test data: {rule.why}")
    numbers = np.asarray(computed, dtype=float)
    if not numbers.size or not np.isfinite(numbers).all():
        return Verdict(FAILED, "failed: what was computed is not a number")
    if isinstance(rule, Within):
        return _near(rule, numbers)
    if isinstance(rule, Limit):
        return _compared(rule, _margins(rule, numbers), numbers)
    if numbers.ndim == 0 or numbers.shape[-1] < 2:
        return Verdict(FAILED, "failed: one number has no order")
    if isinstance(rule, Order) and numbers.shape[-1] != len(rule.names):
        return Verdict(FAILED, f"failed: {numbers.shape[-1]} numbers, {len(rule.names)} names")
    falls = isinstance(rule, Order) or rule.direction == "falls"
    steps = np.diff(numbers, axis=-1) * (-1.0 if falls else 1.0)
    size = np.maximum(np.abs(numbers[..., 1:]), np.abs(numbers[..., :-1]))
    return _compared(rule, _relative(steps, size), numbers)


def of_motions(verdict: Verdict, others: Sequence[Verdict]) -> Verdict:
    """Return the verdict on one stand-in, or that the motion decides.

    Parameters
    ----------
    verdict : on the chosen stand-ins.
    others : on others of the same spectra; those that failed are not counted.

    Examples
    --------
    >>> yes, no = Verdict(HOLDS, "trend holds"), Verdict(CONTRADICTED, "contradicted: 0.9")
    >>> of_motions(no, [no, yes]).words
    'not decidable without the motion: contradicted: 0.9; trend holds with another stand-in'
    """
    for other in others:
        same = (other.settled, other.kind == CLOSE) == (verdict.settled, verdict.kind == CLOSE)
        if not same and other.kind != FAILED:
            words = f"{UNDECIDED}: {verdict.words}; {other.words} with another stand-in"
            return Verdict(UNDECIDED, words)
    return verdict


def _near(rule: Within, numbers: Floats) -> Verdict:
    printed = np.asarray(rule.value, dtype=float)
    if printed.shape not in (numbers.shape, ()):
        return Verdict(FAILED, f"failed: {numbers.size} numbers, {printed.size} printed")
    gap = np.abs(numbers - printed)
    if rule.absolute is not None:
        far, allowed, unit = float(gap.max()), rule.absolute, rule.unit
    else:
        far, allowed, unit = float((100.0 * gap / np.abs(printed)).max()), rule.per_cent or 0.0, "%"
    if far <= allowed:
        near = f"within {_size(far)} {unit}".rstrip() if far > ROUNDING else "to rounding"
        return Verdict(REPRODUCED, f"reproduced {near}")
    return Verdict(CONTRADICTED, f"contradicted: {_size(far)} {unit}".rstrip() + " away")


def _relative(gaps: Floats, sizes: Floats) -> Floats:
    return np.divide(gaps, sizes, out=np.zeros_like(gaps), where=sizes > 0.0)


def _margins(rule: Limit, numbers: Floats) -> Floats:
    """How far inside the limits each number is, of the larger of it and the limit."""
    sides = [(rule.above, 1.0), (rule.below, -1.0)]
    found = [
        _relative(sign * (numbers - limit), np.maximum(np.abs(numbers), abs(limit)))
        for limit, sign in sides
        if limit is not None
    ]
    return np.asarray(np.min(found, axis=0))


def _compared(rule: Comparison, margins: Floats, numbers: Floats) -> Verdict:
    """Of relative differences that are positive where the statement holds."""
    noise = 0.0 if rule.exact else NOISE
    total, good, bad = margins.size, int((margins > noise).sum()), int((margins < -noise).sum())
    same = total - good - bad
    beside = f", {same} within 1 %" if same else ""
    told = f"{good} of {total} as said{beside}"
    if bad and not (rule.usually and good > USUALLY * (good + bad)):
        if numbers.size == 1:
            told = f"{numbers.item():.4g} {rule.unit}".rstrip()
        return Verdict(CONTRADICTED, f"{CONTRADICTED}: {told}")
    if 2 * good < total:
        return Verdict(CLOSE, f"{CLOSE}: too close to tell ({told})")
    return Verdict(HOLDS, HOLDS + (f" ({told})" if good < total else ""))


def _size(value: float) -> str:
    """Two digits, without an exponent down to rounding.

    Examples
    --------
    >>> _size(41.7), _size(0.0312), _size(4.96e-5), _size(0.0)
    ('42', '0.031', '0.00005', '0.0')
    """
    if value >= 10.0:
        return f"{value:.0f}"
    if value >= 1e-4 or value == 0.0:
        return f"{value:#.2g}"
    return f"{value:.6f}".rstrip("0") if value >= ROUNDING else f"{value:.0e}"


STEPS = (0.05, 0.2, 0.5, 1.0, 2.0, 3.0)  # relative changes that are looked at first
HALVINGS = 4  # 0.15 between two of them becomes one per cent
MORE = 0.05  # more K_r: what stands it has to say why
SYMBOL = "K_r"
KEPT = 24  # changes whose simulations are kept: claims of one chapter ask for the same ones


@dataclass(frozen=True)
class Flip:
    """The smallest change of a parameter that flips a verdict.

    Attributes
    ----------
    parameter : symbol of `data/claims/parameters.toml`.
    change : relative, 0.05 is 5 % more; None if none within reach flips it.
    """

    parameter: str
    change: float | None

    @property
    def words(self) -> str:
        """As text."""
        if self.change is None:
            return f"{self.parameter}: none"
        return f"{self.parameter} {100.0 * self.change:+.1f} %"


class Variants:
    """Simulations with changed parameters; the last few are kept."""

    def __init__(self, base: Runs | None = None) -> None:
        self.base = base or Runs()
        self._kept: OrderedDict[tuple[str, float], Runs] = OrderedDict()

    def runs(self, parameter: str, change: float) -> Runs:
        """Those with one parameter changed by a share of itself."""
        key = (parameter, round(change, 6))
        if key not in self._kept:
            changes = {parameter: 1.0 + change}
            self._kept[key] = Runs(changes, light=True, **self.base.options)
            if len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]


Judged = Callable[[Runs], Verdict]


def find_flip(claim: Claim, judged: Judged, variants: Variants, parameter: str) -> Flip:
    """The smallest change of one parameter, to either side, that flips a verdict that holds.

    Parameters
    ----------
    claim : its `reach` is how far is looked.
    judged : verdict of the claim on simulations.
    variants : simulations with changes.
    parameter : a symbol of `data/claims/parameters.toml`.

    Returns
    -------
    Flip

    Examples
    --------
    >>> from thermobearing.reproduce.claims import Within
    >>> from thermobearing.reproduce.claims import verdict_of
    >>> claim = Claim(id="a", place="-", statement="-", computed="a.b", rule=Within(value=1.0,
    ...     per_cent=10.0))
    >>> def judged(runs):
    ...     return verdict_of(claim.rule, runs.change.get("K_r", 1.0))
    >>> find_flip(claim, judged, Variants(), "K_r").words
    'K_r +10.6 %'
    """

    def flipped(change: float) -> bool:
        try:
            verdict = judged(variants.runs(parameter, change))
        except InputError:  # no bearing has such a number: as far as one can go
            return False
        return not verdict.settled and verdict.kind != FAILED

    found = [
        change for sign in (1.0, -1.0) if (change := _first(flipped, sign, claim.reach / 100.0))
    ]
    return Flip(parameter, min(found, key=abs) if found else None)


def _first(flipped: Callable[[float], bool], sign: float, reach: float) -> float | None:
    """The smallest change to one side that flips, or None."""
    stands = 0.0
    for size in (step for step in STEPS if step <= reach):
        if flipped(sign * size):
            return _border(flipped, sign, stands, size)
        stands = size
    return None


def _border(flipped: Callable[[float], bool], sign: float, stands: float, falls: float) -> float:
    for _ in range(HALVINGS):
        middle = 0.5 * (stands + falls)
        stands, falls = (stands, middle) if flipped(sign * middle) else (middle, falls)
    return sign * falls


def last_that_stands(change: float) -> float:
    """The largest change that was seen to leave the verdict, below the one that flips it.

    Examples
    --------
    >>> round(last_that_stands(0.05), 6), round(last_that_stands(-0.059375), 6)
    (0.046875, -0.05)
    """
    size = abs(change)
    above = next(step for step in STEPS if step >= size)
    below = max((step for step in STEPS if step < above), default=0.0)
    sign = 1.0 if change > 0.0 else -1.0
    return sign * (size - (above - below) / 2.0**HALVINGS)


def _stands_more_stiffness(judged: Judged, variants: Variants) -> bool:
    """Whether a verdict that holds stands 5 % more K_r."""
    return judged(variants.runs(SYMBOL, MORE)).settled


def _all_flips(claim: Claim, judged: Judged, variants: Variants) -> Sequence[Flip]:
    """Of every parameter that the claim names."""
    return [find_flip(claim, judged, variants, parameter) for parameter in claim.flips]


MOST = 12  # numbers that are told one by one


def _number_words(value: float) -> str:
    """Four digits at most, a true minus sign.

    Examples
    --------
    >>> _number_words(1703.4), _number_words(0.12341)
    ('1703', '0.1234')
    """
    text = f"{value:.0f}" if 1000.0 <= abs(value) < 1e6 else f"{value:.4g}"
    return text.replace("-", "\N{MINUS SIGN}")


def reason(error: Exception) -> str:
    """What broke, in a line.

    Examples
    --------
    >>> reason(ValueError("no root"))
    'failed: ValueError: no root'
    """
    told = str(error).splitlines()[0] if str(error) else "no reason given"
    return f"failed: {type(error).__name__}: {told}"


def computed_words(claim: Claim, computed: Any) -> str:
    """What was computed, with its unit; the ends of the range where there are many numbers."""
    if computed is None:
        return ""
    values = np.atleast_1d(np.asarray(computed, dtype=float))
    unit = getattr(claim.rule, "unit", "")
    if values.size > MOST:
        low, high = _number_words(float(values.min())), _number_words(float(values.max()))
        text = f"{values.size} numbers, {low} to {high}"
    else:
        rows = [", ".join(map(_number_words, row)) for row in np.atleast_2d(values)]
        text = "; ".join(rows)
    return f"{text} {unit}".strip()


def rule_words(rule: Rule) -> str:
    """What decides, in words.

    Examples
    --------
    >>> rule_words(Limit(above=1.0, unit="kN"))
    'above 1 kN'
    """
    if isinstance(rule, NeedsTestData):
        return "the source's measurements"
    if isinstance(rule, Within):
        printed = np.atleast_1d(np.asarray(rule.value, dtype=float))
        near = f"{rule.per_cent:g} %" if rule.per_cent else f"{rule.absolute:g} {rule.unit}".strip()
        return f"{', '.join(map(_number_words, printed))} {rule.unit}".strip() + f" within {near}"
    if isinstance(rule, Limit):
        sides = (("above", rule.above), ("below", rule.below))
        told = " and ".join(f"{n} {_number_words(v)}" for n, v in sides if v is not None)
        told = f"{told} {rule.unit}".strip()
    elif isinstance(rule, Order):
        told = " > ".join(rule.names)
    else:
        told = f"{rule.direction}: {rule.along}"
    return f"usually {told}" if rule.usually else told


ROOM = "thermobearing.reproduce"


@dataclass(frozen=True)
class Row:
    """A claim with what came out.

    Attributes
    ----------
    claim : what the source says.
    verdict : computed.
    computed : the numbers; none if there are none.
    flips : smallest changes that flip a verdict that holds.
    stiffer : whether a verdict that holds stands 5 % more K_r; None for others.
    printed : verdict on the model as printed; None for misprints and where test data are needed.
    """

    claim: Claim
    verdict: Verdict
    computed: Any = None
    flips: tuple[Flip, ...] = ()
    stiffer: bool | None = None
    printed: Verdict | None = None

    @property
    def smallest(self) -> Flip | None:
        """The flip that needs least."""
        known = [flip for flip in self.flips if flip.change is not None]
        return min(known, key=lambda flip: abs(flip.change or 0.0), default=None)

    @property
    def flip_words(self) -> str:
        """What flips a verdict that holds, or that nothing within reach does; "" for others."""
        if self.smallest:
            return self.smallest.words
        if self.stiffer is None:
            return ""
        tried = " and ".join(self.claim.flips)
        return f"none: {tried} changed by up to {self.claim.reach:g} %" if tried else "none"


def claim_function(claim: Claim) -> Callable[[Runs], Any]:
    """The function that computes a claim.

    Raises
    ------
    InputError : there is none of that name.
    """
    module, _, name = str(claim.computed).partition(".")
    try:
        found: Callable[[Runs], Any] = getattr(import_module(f"{ROOM}.{module}"), name)
    except (ImportError, AttributeError):
        raise InputError(f'{claim.id}: no function "{claim.computed}"', "claims") from None
    return found


def make_row(claim: Claim, runs: Runs, variants: Variants | None = None) -> Row:
    """A claim judged; its flips are looked for if there are `variants` to look among.

    Parameters
    ----------
    claim : of `load_claims`.
    runs : simulations with the parameters as they are.
    variants : simulations with changed ones; without them no flip is looked for.

    Returns
    -------
    Row : "failed" with the reason if something breaks.

    Examples
    --------
    >>> from thermobearing.reproduce.claims import load_claims
    >>> make_row(load_claims("chapter-3")[0], Runs()).verdict.kind
    'echoes an input'
    """
    if claim.needs_data:
        return Row(claim, verdict_of(claim.rule, ()))
    try:
        return _made(claim, runs, variants)
    except Exception as error:  # whatever breaks is told in its row
        return Row(claim, Verdict(FAILED, reason(error)))


def _made(claim: Claim, runs: Runs, variants: Variants | None) -> Row:
    function = claim_function(claim)

    def judged(changed: Runs) -> Verdict:
        return verdict_of(claim.rule, function(changed))

    runs.shaken = False
    computed = np.asarray(function(runs), dtype=float)
    verdict = verdict_of(claim.rule, computed)
    if runs.shaken and verdict.kind != FAILED:
        verdict = of_motions(verdict, [judged(runs.beside(moved_on=k)) for k in range(1, WAVES)])
    if claim.echoes and verdict.kind == REPRODUCED:
        verdict = Verdict(ECHOES, f"{ECHOES}: {verdict.words}")
    row = Row(claim, verdict, computed.tolist(), printed=_as_printed(claim, judged, runs))
    if variants is None or not verdict.settled:
        return row
    stiffer = _stands_more_stiffness(judged, variants)
    if stiffer and not claim.depends:
        verdict = Verdict(FAILED, "failed: stands 5 % more K_r and does not say why")
    flips = tuple(_all_flips(claim, judged, variants))
    return replace(row, verdict=verdict, flips=flips, stiffer=stiffer)


def _as_printed(claim: Claim, judged: Callable[[Runs], Verdict], runs: Runs) -> Verdict | None:
    if mean_group(claim.id) == "misprints":
        return None
    try:
        return judged(runs.beside(**PRINTED))
    except Exception as error:  # an analysis that has no printed scheme
        return Verdict(FAILED, reason(error))
