"""The ledger in its short form: every verdict as listed, and flips of some rows as listed.

All flips: THERMOBEARING_LEDGER=all; a new list: tests/reproduce/baseline.py.
"""

import os
from functools import cache
from typing import Any

import pytest

from tests.reproduce.baseline import load_baseline
from thermobearing.reproduce.claims import (
    FAILED,
    SETTLED,
    Claim,
    Variants,
    claim_function,
    last_that_stands,
    load_claims,
    make_row,
    verdict_of,
)
from thermobearing.reproduce.runs import Runs

CLAIMS = {claim.id: claim for claim in load_claims()}
LISTED = load_baseline()
EACH = 1 if os.environ.get("THERMOBEARING_LEDGER") == "all" else 9  # of the rows that flip


@cache
def runs() -> Runs:
    return Runs()


@cache
def variants() -> Variants:
    return Variants(runs())


def smallest(row: dict[str, Any]) -> tuple[str, float] | None:
    """The flip that needs least."""
    known = [(name, change) for name, change in row["flips"].items() if change is not None]
    return min(known, key=lambda item: abs(item[1]), default=None)


FLIPPING = [name for name, row in LISTED.items() if smallest(row)]


def test_the_list_has_every_claim() -> None:
    assert list(LISTED) == list(CLAIMS)


def test_every_verdict_is_as_listed() -> None:
    """One test: its claims share simulations, which each worker of a test each would make anew."""
    verdicts = {name: make_row(claim, runs()).verdict for name, claim in CLAIMS.items()}
    others = {
        name: f"{verdict.words}; listed: {LISTED[name]['words']}"
        for name, verdict in verdicts.items()
        if verdict.kind != LISTED[name]["verdict"] or verdict.kind == FAILED
    }
    assert not others


def settled(claim: Claim, parameter: str, change: float) -> bool:
    computed = claim_function(claim)(variants().runs(parameter, change))
    return verdict_of(claim.rule, computed).settled


@pytest.mark.parametrize("name", FLIPPING[::EACH])
def test_the_flip_is_as_listed(name: str) -> None:
    flip = smallest(LISTED[name])
    assert flip is not None
    parameter, change = flip
    assert not settled(CLAIMS[name], parameter, change)
    stands = last_that_stands(change)
    assert stands == 0.0 or settled(CLAIMS[name], parameter, stands)


def test_what_stands_more_stiffness_says_why() -> None:
    for name, row in LISTED.items():
        if row["verdict"] in SETTLED:
            assert row["stands_5_per_cent_more_K_r"] in (True, False)
            assert CLAIMS[name].depends or not row["stands_5_per_cent_more_K_r"], name
