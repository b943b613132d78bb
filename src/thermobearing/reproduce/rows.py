"""One row of the ledger: a claim, what was computed, its verdict and what flips it.

A row that breaks is a row with its reason: nothing that is wrong with one claim stops the others.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.reproduce.claims import Claim, group_of
from thermobearing.reproduce.flips import Flip, Variants, all_flips, stands_more_stiffness
from thermobearing.reproduce.judge import (
    ECHOES,
    FAILED,
    REPRODUCED,
    Verdict,
    of_motions,
    verdict_of,
)
from thermobearing.reproduce.runs import PRINTED, WAVES, Runs
from thermobearing.reproduce.told import reason

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


def function_of(claim: Claim) -> Callable[[Runs], Any]:
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
    function = function_of(claim)

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
    stiffer = stands_more_stiffness(judged, variants)
    if stiffer and not claim.depends:
        verdict = Verdict(FAILED, "failed: stands 5 % more K_r and does not say why")
    flips = tuple(all_flips(claim, judged, variants))
    return replace(row, verdict=verdict, flips=flips, stiffer=stiffer)


def _as_printed(claim: Claim, judged: Callable[[Runs], Verdict], runs: Runs) -> Verdict | None:
    if group_of(claim.id) == "misprints":
        return None
    try:
        return judged(runs.beside(**PRINTED))
    except Exception as error:  # an analysis that has no printed scheme
        return Verdict(FAILED, reason(error))
