"""The kept list of mutants does not rot: each change applies in one place and has its tests."""

import ast
from collections import Counter
from functools import cache

from tests.mutants.kept import PACKAGE, ROOT, entries, kept_mutants, nearest_tests, original
from tests.mutants.random_ones import files_of_the_package, random_mutants

FEWEST = 150  # of the kept list
KEPT = kept_mutants()


def test_every_kept_mutant_applies_and_is_another_program() -> None:
    mutants, faults = KEPT
    assert not faults, "\n".join(faults)
    for mutant in mutants:
        assert programs(mutant.text) != programs(original(mutant.file)), mutant.means


@cache
def programs(text: str) -> list[str]:
    """The statements of a file as they are understood: without comments and layout."""
    lines = text.splitlines(keepends=True)
    places = [(node.lineno, node.end_lineno) for node in ast.parse(text).body]
    # Lines before a definition, as those of a decorator, belong to it.
    begins = [0, *(end for _, end in places)]
    return [
        understood("".join(lines[begin:end]))
        for begin, (_, end) in zip(begins, places, strict=False)
    ]


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


def test_chance_repeats_itself() -> None:
    first = random_mutants(20, seed=5)
    assert [m.text for m in random_mutants(20, seed=5)] == [m.text for m in first]
    assert [m.means for m in random_mutants(20, seed=6)] != [m.means for m in first]
