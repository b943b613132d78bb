"""The kept list: changes with a meaning, each an error that an engineer could make."""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGE = Path("src") / "thermobearing"


@dataclass(frozen=True)
class Mutant:
    """One changed file, and the tests that should notice.

    Attributes
    ----------
    file : below src/thermobearing, or of `reproduction/` next to it.
    means : what is wrong now, in words.
    text : the whole file with the change.
    tests : arguments of pytest.
    plain : run the kernels as plain Python, which is quicker than compiling them for one look.
    by_chance : a random change, on which the thorough tests are left out.
    """

    file: str
    means: str
    text: str
    tests: tuple[str, ...]
    plain: bool = False
    by_chance: bool = False

    @property
    def room(self) -> str:
        """Folder of the file; the file itself at the root of the package."""
        return folder_name(self.file)


def folder_name(file: str) -> str:
    """Folder of a file below the package; "cli" for those next to the folders."""
    folder, slash, _ = file.partition("/")
    return folder if slash else "cli"


def place(root: Path, file: str) -> Path:
    """Return where a file of the package, or of `reproduction/`, lies in a copy of the tree."""
    return root / (file if file.startswith("reproduction/") else PACKAGE / file)


def original(file: str) -> str:
    """Text of a file as it is."""
    return place(ROOT, file).read_text(encoding="utf-8")


def _below_tests(names: Iterable[str]) -> list[str]:
    return [f"tests/{name}" for name in names]


def nearest_tests() -> dict[str, list[str]]:
    """Tests by file of the package, for changes that name none."""
    table = tomllib.loads((HERE / "nearest.toml").read_text(encoding="utf-8"))
    return {file: _below_tests(names) for file, names in table.items()}


def entries() -> list[dict[str, Any]]:
    """The kept list as it is written."""
    result: list[dict[str, Any]] = []
    for path in sorted((HERE / "kept").glob("*.toml")):
        result += tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]
    return result


def changed(file: str, old: str, new: str) -> str:
    """The file with the change; ValueError unless it can be made in exactly one place."""
    try:
        text = original(file)
    except FileNotFoundError:
        raise ValueError(f"{file}: no such file") from None
    count = text.count(old)
    if count != 1:
        raise ValueError(f"{file}: {old!r} is there {count} times")
    return text.replace(old, new)


def kept_mutants() -> tuple[list[Mutant], list[str]]:
    """The kept list ready to run, and sentences on those that no longer apply."""
    nearest = nearest_tests()
    result, faults = [], []
    for entry in entries():
        file = str(entry["file"])
        try:
            text = changed(file, str(entry["old"]), str(entry["new"]))
        except ValueError as error:
            faults.append(f"cannot be applied: {error} ({entry['means']})")
            continue
        tests = _below_tests(entry["tests"]) if "tests" in entry else nearest[file]
        plain = bool(entry.get("plain"))
        result.append(Mutant(file, str(entry["means"]), text, tuple(tests), plain))
    return result, faults
