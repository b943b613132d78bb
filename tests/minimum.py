"""Print the lowest versions that pyproject.toml declares, as constraints for pip."""

import re
import tomllib
from pathlib import Path

LOWEST = re.compile(r"^([A-Za-z0-9_.-]+)\s*>=\s*([0-9.]+)")

# What those versions pull in themselves, as it was then: later ones warn at their import.
OF_THEIR_TIME = ["click<8.3", "pyparsing<3.3"]


def lowest_versions() -> list[str]:
    """Such as "numpy==2.0.*", of every dependency of the program and of the tests."""
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
    result = [LOWEST.match(text) for text in _declared(project)]
    return [f"{match[1]}=={match[2]}.*" for match in result if match] + OF_THEIR_TIME


def _declared(project: dict[str, dict[str, list[str]]]) -> list[str]:
    return [*project["dependencies"], *_of_extra(project["optional-dependencies"], "test")]


def _of_extra(extras: dict[str, list[str]], name: str) -> list[str]:
    """Return the packages of an extra, with those of the extras that it names."""
    packages: list[str] = []
    for text in extras[name]:
        named = re.fullmatch(r"thermobearing\[(.+)\]", text)
        packages += [
            package
            for other in (named[1].split(",") if named else ())
            for package in _of_extra(extras, other)
        ] or [text]
    return packages


if __name__ == "__main__":
    print("\n".join(dict.fromkeys(lowest_versions())))
