"""Statements of Shen (2023), the rules that judge them, and the changes that turn a verdict.

`data/chapter-3.toml` and the files next to it have a table for each; docs/files.md says what a row
has. No verdict is in a file: every run computes it. A row that breaks becomes a row with its
reason, and the others go on.

Changes are tried on a short list, outwards; between the last that leaves the verdict and the first
that flips it the border is halved until it is known to a sixteenth of their distance.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from reproduction.measures import evaluate, words
from reproduction.records import Needs, missing, record_words
from reproduction.runs import PRINTED, WAVES, Runs, load_data
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats

CHAPTERS = {  # files, and their headings
    "chapter-3": "Chapter 3, tests",
    "chapter-4": "Chapter 4, high damping rubber",
    "chapter-5": "Chapter 5, lead cores",
    "chapter-6": "Chapter 6, bridge",
    "conclusions": "Chapter 7 and conclusions",
    "misprints": "Misprints",
}
PARTS = tuple(CHAPTERS)
# What is counted apart: results, their repetition in chapter 7, and errors of the print.
GROUPS = {"statements": PARTS[:4], "chapter 7 repeats": PARTS[4:5], "misprints": PARTS[5:]}
REPRODUCED, ECHOES, HOLDS = "reproduced", "echoes an input", "trend holds"
CONTRADICTED, CLOSE = "contradicted", "within 1 %"
UNDECIDED, NEEDS = "not decidable without the motion", "needs the test data"
FAILED = "failed"
VERDICTS = (REPRODUCED, ECHOES, HOLDS, CONTRADICTED, CLOSE, UNDECIDED, NEEDS, FAILED)
SETTLED = (REPRODUCED, ECHOES, HOLDS)
ROUNDING = 1e-6  # per cent, or of the unit
NOISE = 0.01  # relative difference below which a comparison is neither for nor against
USUALLY = 2.0 / 3.0  # more than this share is "usually", "typically", "tends"
STEPS = (0.05, 0.2, 0.5, 1.0, 2.0, 3.0)  # relative changes that are tried first
HALVINGS = 4  # 0.15 between two of them becomes one per cent
SYMBOL, MORE = "K_r", 0.05  # a verdict that more stiffness leaves has to say why
KEPT = 24  # changes whose simulations are kept: claims of one chapter ask for the same ones
DIGITS_END = 1e-12  # digits of smaller numbers depend on the processor
MOST = 12  # numbers that are listed one by one
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
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        both_or_neither = ("per_cent" in given) == ("absolute" in given)
        return ["give either per_cent or absolute"] if both_or_neither else []


class Comparison(Strict):
    """Comparisons; those within the noise floor count neither for nor against.

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
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        return [] if {"above", "below"} & set(given) else ["give above, below or both"]


class NeedsTestData(Strict):
    """A statement that only the measurements of Shen (2023) can judge."""

    kind: Literal["needs-test-data"] = "needs-test-data"
    why: Words


Rule = Annotated[Within | Trend | Order | Limit | NeedsTestData, Field(discriminator="kind")]


class Measured(Needs):
    """How records of the tests judge a statement: the records, an expression and its rule.

    `assumes` is what the rule takes for the words of Shen (2023), where these have no number.
    """

    computed: Words
    rule: Annotated[Within | Trend | Order | Limit, Field(discriminator="kind")]
    assumes: str = ""


class Claim(Strict):
    """One checkable statement or number of Shen (2023).

    `computed` is an expression (see `measures`), none where test data are needed; `measured` is how
    these judge it where they are given. `echoes` says that it is an input or an identity, which no
    result can change. `flips` are symbols of `parameters.toml` that may flip the verdict, `reach`
    how far they are changed [%], `depends` why 5 % more K_r does not flip it. `figure` is the name
    of the figure that shows it, "fig_3_07".
    A statement that is contradicted states the `fact` in a sentence, which statements of the same
    fact share, or why it is no fact (`aside`): a misprint, a statement that another place of the
    dissertation contradicts, or another reading of a choice that it states twice.
    """

    id: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=80)]
    place: Words
    statement: Words
    fact: Words | None = None
    aside: Literal["misprint", "self-contradiction", "second reading"] | None = None
    computed: Words | None = None
    rule: Rule
    measured: Measured | None = None
    echoes: bool = False
    flips: tuple[str, ...] = ()
    depends: str = ""
    reach: Annotated[float, Field(ge=5, le=300)] = 50.0
    figure: str | None = None

    @classmethod
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        rule = given.get("rule")
        kind = rule.get("kind") if isinstance(rule, dict) else getattr(rule, "kind", None)
        needs = kind == "needs-test-data"
        faults = ["give computed, or a rule of kind needs-test-data"]
        faults = faults if needs == ("computed" in given) else []
        if "measured" in given and not needs:
            faults.append("measured belongs to a rule of kind needs-test-data")
        return faults


class _Claims(Strict):
    claim: tuple[Claim, ...]


@cache
def load_claims(part: str | None = None) -> tuple[Claim, ...]:
    """Return the claims of a part ("chapter-3", "conclusions", "misprints") or all, in order."""
    if part is not None and part not in PARTS:
        raise InputError(f'no part is called "{part}"{nearest(part, PARTS)}', "claims")
    files = PARTS if part is None else (part,)
    claims = [claim for name in files for claim in load_data(_Claims, f"{name}.toml").claim]
    names = [claim.id for claim in claims]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise InputError([f'id "{name}" is there twice' for name in twice], "claims")
    return tuple(claims)


def record_needs() -> dict[str, Needs]:
    """Return which records judge claims that need test data, by the id of the claim."""
    return {claim.id: claim.measured for claim in load_claims() if claim.measured}


@cache
def _groups() -> dict[str, str]:
    pairs = [(group, part) for group, parts in GROUPS.items() for part in parts]
    return {claim.id: group for group, part in pairs for claim in load_claims(part)}


def group_by_id(name: str) -> str:
    """Return the group that counts a claim."""
    return _groups().get(name, "statements")


# Verdicts


class Verdict(NamedTuple):
    """One of `VERDICTS`, and the same with its number ("reproduced within 0.31 %") or reason."""

    kind: str
    words: str

    @property
    def settled(self) -> bool:
        """Whether the words of Shen (2023) hold."""
        return self.kind in SETTLED


def judge(rule: Rule, computed: ArrayLike) -> Verdict:
    """Return the verdict of a rule on a number, numbers in a row, or rows of numbers."""
    if isinstance(rule, NeedsTestData):
        return Verdict(NEEDS, f"needs the test data: {rule.why}")
    numbers = np.asarray(computed, dtype=float)
    if not numbers.size or not np.isfinite(numbers).all():
        return Verdict(FAILED, "failed: what was computed is not a number")
    if isinstance(rule, Within):
        return _judge_within(rule, numbers)
    if isinstance(rule, Limit):
        return _judge_comparison(rule, _margins(rule, numbers), numbers)
    if numbers.ndim == 0 or numbers.shape[-1] < 2:
        return Verdict(FAILED, "failed: one number has no order")
    if isinstance(rule, Order) and numbers.shape[-1] != len(rule.names):
        return Verdict(FAILED, f"failed: {numbers.shape[-1]} numbers, {len(rule.names)} names")
    falls = isinstance(rule, Order) or rule.direction == "falls"
    steps = np.diff(numbers, axis=-1) * (-1.0 if falls else 1.0)
    size = np.maximum(np.abs(numbers[..., 1:]), np.abs(numbers[..., :-1]))
    return _judge_comparison(rule, _relative(steps, size), numbers)


def judge_motions(verdict: Verdict, others: Sequence[Verdict]) -> Verdict:
    """Return the verdict on one stand-in, or that the motion decides, by verdicts on others."""
    for alternative in others:
        same = (alternative.settled, alternative.kind == CLOSE) == (
            verdict.settled,
            verdict.kind == CLOSE,
        )
        # A run that fails with another wave says nothing about the statement.
        if not same and alternative.kind != FAILED:
            text = f"{UNDECIDED}: {verdict.words}; {alternative.words} with another stand-in"
            return Verdict(UNDECIDED, text)
    return verdict


def _judge_within(rule: Within, numbers: Floats) -> Verdict:
    printed = np.asarray(rule.value, dtype=float)
    if printed.shape not in (numbers.shape, ()):
        return Verdict(FAILED, f"failed: {numbers.size} numbers, {printed.size} printed")
    gap = np.abs(numbers - printed)
    if rule.absolute is not None:
        largest_gap, allowed, unit = float(gap.max()), rule.absolute, rule.unit
    else:
        largest_gap = float((100.0 * gap / np.abs(printed)).max())
        allowed, unit = rule.per_cent or 0.0, "%"
    if largest_gap <= allowed:
        if largest_gap <= ROUNDING:
            return Verdict(REPRODUCED, "reproduced to rounding")
        return Verdict(REPRODUCED, f"reproduced within {_size(largest_gap)} {unit}".rstrip())
    return Verdict(CONTRADICTED, f"contradicted: {_size(largest_gap)} {unit}".rstrip() + " away")


def _relative(gaps: Floats, sizes: Floats) -> Floats:
    return np.divide(gaps, sizes, out=np.zeros_like(gaps), where=sizes > 0.0)


def _margins(rule: Limit, numbers: Floats) -> Floats:
    """Return how far inside the limits each number is, of the larger of it and the limit."""
    sides = [(limit, sign) for limit, sign in ((rule.above, 1.0), (rule.below, -1.0))]
    margins = [
        _relative(sign * (numbers - limit), np.maximum(np.abs(numbers), abs(limit)))
        for limit, sign in sides
        if limit is not None
    ]
    return np.asarray(np.min(margins, axis=0))


def _judge_comparison(rule: Comparison, margins: Floats, numbers: Floats) -> Verdict:
    """Judge relative differences that are positive where the statement holds."""
    # Differences within the noise count neither for nor against the statement.
    noise = 0.0 if rule.exact else NOISE
    total, good, bad = margins.size, int((margins > noise).sum()), int((margins < -noise).sum())
    same = total - good - bad
    counts = f"{good} of {total} as said" + (f", {same} within 1 %" if same else "")
    if bad and not (rule.usually and good > USUALLY * (good + bad)):
        if numbers.size == 1:
            counts = f"{numbers.item():.4g} {rule.unit}".rstrip()
        return Verdict(CONTRADICTED, f"{CONTRADICTED}: {counts}")
    if 2 * good < total:
        return Verdict(CLOSE, f"{CLOSE}: too close to decide ({counts})")
    return Verdict(HOLDS, HOLDS + (f" ({counts})" if good < total else ""))


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


# Flips


class Flip(NamedTuple):
    """The smallest relative change of a parameter that flips a verdict; None: none in reach."""

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
        """Return those with one parameter changed by a share of itself."""
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
    """Return the smallest change of a parameter, to either side, that flips a verdict."""

    def flipped(change: float) -> bool:
        try:
            verdict = judged(variants.runs(parameter, change))
        except InputError:  # no bearing has such a number: as far as one can go
            return False
        return not verdict.settled and verdict.kind != FAILED

    changes = [_first(flipped, sign, claim.reach / 100.0) for sign in (1.0, -1.0)]
    return Flip(parameter, min(filter(None, changes), key=abs, default=None))


def _first(flipped: Callable[[float], bool], sign: float, reach: float) -> float | None:
    stands = 0.0
    for falls in (step for step in STEPS if step <= reach):
        if flipped(sign * falls):
            for _ in range(HALVINGS):
                middle = 0.5 * (stands + falls)
                stands, falls = (stands, middle) if flipped(sign * middle) else (middle, falls)
            return sign * falls
        stands = falls
    return None


def last_that_stands(change: float) -> float:
    """Return the largest change that was seen to leave the verdict, below one that flips it.

    Examples
    --------
    >>> round(last_that_stands(0.05), 6), round(last_that_stands(-0.059375), 6)
    (0.046875, -0.05)
    """
    size = abs(change)
    above = next(step for step in STEPS if step >= size)
    below = max((step for step in STEPS if step < above), default=0.0)
    return float(np.copysign(size - (above - below) / 2.0**HALVINGS, change))


# Rows


@dataclass(frozen=True)
class Row:
    """A claim with what came out.

    `flips` are the smallest changes that flip a verdict that holds, `stiffer` whether it stands 5 %
    more K_r (None for others); `printed` is the verdict on the model as printed, None for misprints
    and where test data are needed.
    """

    claim: Claim
    verdict: Verdict
    computed: Any = None
    flips: tuple[Flip, ...] = ()
    stiffer: bool | None = None
    printed: Verdict | None = None

    @property
    def smallest(self) -> Flip | None:
        """Return the flip that needs least."""
        flips = [flip for flip in self.flips if flip.change is not None]
        return min(flips, key=lambda flip: abs(flip.change or 0.0), default=None)

    @property
    def flip_words(self) -> str:
        """Return what flips a verdict that holds, or that nothing within reach does."""
        if self.smallest:
            return self.smallest.words
        if self.stiffer is None:
            return ""
        tried = " and ".join(self.claim.flips)
        return f"none: {tried} changed by up to {self.claim.reach:g} %" if tried else "none"


def failure(error: Exception) -> str:
    """Return what broke, in a line."""
    text = str(error).splitlines()[0] if str(error) else "no reason given"
    return f"failed: {type(error).__name__}: {text}"


def compute(claim: Claim, runs: Runs) -> Floats:
    """Return the numbers of a claim."""
    names = words(runs) | (record_words(claim.measured) if claim.measured else {})
    return np.asarray(evaluate(claim.computed or "", names), dtype=float)


def make_row(claim: Claim, runs: Runs, variants: Variants | None = None) -> Row:
    """Return a claim judged, with its flips if there are `variants` to look among."""
    try:
        if isinstance(claim.rule, NeedsTestData):
            return _judge_by_records(claim, runs)
        return _judge_claim(claim, runs, variants)
    except Exception as error:  # whatever breaks is the reason of its row
        return Row(claim, Verdict(FAILED, failure(error)))


def _judge_by_records(claim: Claim, runs: Runs) -> Row:
    """Return a claim that needs test data, judged if the records are there; no flips."""
    verdict = judge(claim.rule, ())
    if runs.records is None or claim.measured is None:
        return Row(claim, verdict)
    if lacking := missing(claim.measured, runs.records):
        return Row(claim, Verdict(NEEDS, f"{verdict.words}; {lacking}"))
    changes = {"computed": claim.measured.computed, "rule": claim.measured.rule}
    return _judge_claim(claim.model_copy(update=changes), runs, None)


def _judge_claim(claim: Claim, runs: Runs, variants: Variants | None) -> Row:
    def judged(changed: Runs) -> Verdict:
        return judge(claim.rule, compute(claim, changed))

    runs.shaken = False
    computed = compute(claim, runs)
    verdict = judge(claim.rule, computed)
    if runs.shaken and verdict.kind != FAILED:
        # Other waves of the same spectrum: a verdict that they change is one on the motion.
        alternatives = [judged(runs.varied(moved_on=k)) for k in range(1, WAVES)]
        verdict = judge_motions(verdict, alternatives)
    if claim.echoes and verdict.kind == REPRODUCED:
        verdict = Verdict(ECHOES, f"{ECHOES}: {verdict.words}")
    row = Row(claim, verdict, computed.tolist(), printed=_as_printed(claim, judged, runs))
    if variants is None or not verdict.settled:
        return row
    # A verdict that a stiffer rubber leaves as it is must say what it depends on instead.
    stiffer = judged(variants.runs(SYMBOL, MORE)).settled
    if stiffer and not claim.depends:
        verdict = Verdict(FAILED, "failed: stands 5 % more K_r and does not say why")
    flips = tuple(find_flip(claim, judged, variants, parameter) for parameter in claim.flips)
    return replace(row, verdict=verdict, flips=flips, stiffer=stiffer)


def _as_printed(claim: Claim, judged: Judged, runs: Runs) -> Verdict | None:
    if group_by_id(claim.id) == "misprints":
        return None
    try:
        return judged(runs.varied(**PRINTED))
    except Exception as error:  # an analysis that has no printed scheme
        return Verdict(FAILED, failure(error))


# Words


def _number_words(value: float) -> str:
    """Four digits at most, a true minus sign; what is rounding only has no digits.

    Examples
    --------
    >>> _number_words(1703.4), _number_words(0.12341), _number_words(3e-15)
    ('1703', '0.1234', '< 1e−12')
    """
    if 0.0 < abs(value) < DIGITS_END:
        return f"< {DIGITS_END:.0e}".replace("-", "\N{MINUS SIGN}")
    text = f"{value:.0f}" if 1000.0 <= abs(value) < 1e6 else f"{value:.4g}"
    return text.replace("-", "\N{MINUS SIGN}")


def computed_words(claim: Claim, computed: Any) -> str:
    """Return what was computed with its unit; the ends of the range of many numbers."""
    if computed is None:
        return ""
    values = np.atleast_1d(np.asarray(computed, dtype=float))
    if values.size > MOST:
        low, high = _number_words(float(values.min())), _number_words(float(values.max()))
        text = f"{values.size} numbers, {low} to {high}"
    else:
        rows = np.atleast_2d(values).reshape(-1, values.shape[-1])
        text = "; ".join(", ".join(map(_number_words, row)) for row in rows)
    return f"{text} {getattr(claim.rule, 'unit', '')}".strip()


def rule_words(rule: Rule) -> str:
    """Return what decides, in words.

    Examples
    --------
    >>> rule_words(Limit(above=1.0, unit="kN"))
    'above 1 kN'
    """
    if isinstance(rule, NeedsTestData):
        return "measurements of Shen (2023)"
    if isinstance(rule, Within):
        printed = ", ".join(map(_number_words, np.atleast_1d(np.asarray(rule.value, dtype=float))))
        tolerance = (
            f"{rule.per_cent:g} %" if rule.per_cent else f"{rule.absolute:g} {rule.unit}".strip()
        )
        return f"{printed} {rule.unit}".strip() + f" within {tolerance}"
    if isinstance(rule, Limit):
        sides = (("above", rule.above), ("below", rule.below))
        text = " and ".join(f"{n} {_number_words(v)}" for n, v in sides if v is not None)
        text = f"{text} {rule.unit}".strip()
    elif isinstance(rule, Order):
        text = " > ".join(rule.names)
    else:
        text = f"{rule.direction}: {rule.along}"
    return f"usually {text}" if rule.usually else text
