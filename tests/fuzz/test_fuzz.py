"""Hostile input at every border: a clean error, a completed run or a typed outcome, never else.

Two thousand examples by default, always the same; the first tenth of them where the thorough
tests are left out (`make test`). `make fuzz` tries a hundred thousand others;
THERMOBEARING_FUZZ is their number and THERMOBEARING_FUZZ_SEED their seed. What fails is reported
with an example, and kept whole in the folder THERMOBEARING_FUZZ_KEEP if that is set.
"""

import os
import time
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings

import thermobearing.cyclic.protocol
import thermobearing.identify.fit.search
import thermobearing.model.effort
import thermobearing.motions.matching
from tests.fuzz import conftest
from tests.fuzz.borders import Border, library_borders
from tests.fuzz.commands import command_borders
from tests.fuzz.judge import Example, Tally

USUAL = 2300  # some of which come out alike, and are tried once
QUICK = 10  # divides their number where thorough tests are left out
COUNT = int(os.environ.get(conftest.COUNT, USUAL))
BORDERS = [*library_borders(), *command_borders()]
# The limits of the package, lowered: what they let through is then tried in milliseconds.
LIMITS: list[tuple[Any, str, float]] = [
    (thermobearing.model.effort, "MAX_STEPS", 20_000),
    (thermobearing.model.effort, "MAX_CELL_STEPS", 2e6),
    (thermobearing.model.effort, "MAX_KEPT", 1e6),
    (thermobearing.cyclic.protocol, "MAX_STEPS", 20_000),
    (thermobearing.motions.matching, "MOST_ROUNDS", 2),
    (thermobearing.identify.fit.search, "MOST_STEPS", 2),
    (thermobearing.identify.fit.search, "POLISH_STEPS", 2),
]


@pytest.fixture(autouse=True)
def _limits(monkeypatch: pytest.MonkeyPatch) -> None:
    for module, name, value in LIMITS:
        assert hasattr(module, name)
        monkeypatch.setattr(module, name, value)


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("border", BORDERS, ids=lambda border: border.name.replace(" ", "-"))
def test_every_example_ends(border: Border, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    tally = Tally(border.name)
    count = max(2, round(COUNT * border.weight / sum(item.weight for item in BORDERS)))
    if COUNT == USUAL and "not thorough" in request.config.option.markexpr:
        count = max(2, count // QUICK)

    def each(example: Example) -> None:
        tally.try_example(example, tmp_path / "here")

    chosen = settings(
        max_examples=count,
        derandomize=COUNT == USUAL,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    test = chosen(given(border.examples)(each))
    if COUNT != USUAL:
        test = seed(int(os.environ[conftest.SEED]))(test)
    begin = time.process_time()
    test()
    spent = round(1000 * (time.process_time() - begin))
    row = (border.name, {**tally.ends, "faults": len(tally.faults), "ms": spent})
    request.node.user_properties.append((conftest.KEY, row))
    assert not tally.faults, tally.reported()


def test_there_are_two_thousand() -> None:
    assert USUAL >= 2000
    assert sum(border.weight for border in BORDERS) >= 2000
