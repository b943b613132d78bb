"""The kept list of mutants does not rot: each change applies in one place and has its tests."""

import ast
from bisect import bisect
from collections import Counter
from functools import cache
from itertools import accumulate, pairwise

import pytest

from tests.mutants import random_ones
from tests.mutants.kept import PACKAGE, ROOT, entries, kept_mutants, nearest_tests, original
from tests.mutants.random_ones import files_of_the_package, random_mutants

FEWEST = 150  # of the kept list
KEPT = kept_mutants()


def test_every_kept_mutant_applies_and_is_another_program() -> None:
    mutants, faults = KEPT
    assert not faults, "\n".join(faults)
    for mutant in mutants:
        before, after = original(mutant.file), mutant.text
        at = bisect(range(len(before)), False, key=lambda n: before[: n + 1] != after[: n + 1])
        begin, end = next(place for place in statements(before) if at < place[1])
        changed = after[begin : end + len(after) - len(before)]
        assert understood(changed) != understood(before[begin:end]), mutant.means


@cache
def statements(text: str) -> list[tuple[int, int]]:
    """Return where each statement of a file begins and ends; decorators belong to the next one."""
    starts = [0, *accumulate(map(len, text.splitlines(keepends=True)))]
    ends = [starts[node.end_lineno or 0] for node in ast.parse(text).body]
    return list(pairwise([0, *ends]))


@cache
def understood(statement: str) -> str:
    return ast.dump(ast.parse(statement))


def test_the_list_is_long_and_reaches_every_room() -> None:
    rooms = {path.name for path in (ROOT / PACKAGE).iterdir() if (path / "__init__.py").exists()}
    counts = Counter(mutant.room for mutant in KEPT[0])
    assert counts.total() >= FEWEST
    assert rooms | {"cli", "reproduction"} == set(counts)
    texts = [(entry["file"], entry["old"], entry["new"]) for entry in entries()]
    assert len(set(texts)) == len(texts)


def test_every_file_has_nearest_tests_that_exist() -> None:
    nearest = nearest_tests()
    assert not set(files_of_the_package()) - set(nearest)
    named = [test for mutant in KEPT[0] for test in mutant.tests]
    for test in {*named, *(test for tests in nearest.values() for test in tests)}:
        file, _, function = test.partition("::")
        text = (ROOT / file).read_text(encoding="utf-8")
        assert f"def {function.split('[')[0]}(" in text or not function, test


def test_chance_repeats_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    files = files_of_the_package()[::300]  # all of them take seconds to read
    monkeypatch.setattr(random_ones, "files_of_the_package", lambda: files)
    monkeypatch.setattr(random_ones, "_all_places", random_ones._all_places.__wrapped__)
    first = random_mutants(20, seed=5)
    assert [m.text for m in random_mutants(20, seed=5)] == [m.text for m in first]
    assert [m.means for m in random_mutants(20, seed=6)] != [m.means for m in first]
