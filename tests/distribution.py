"""Use the wheel and the source distribution in empty environments: `make dist-check`.

`python tests/distribution.py dist PYTHON...` makes an environment for each Python, installs the
wheel with pip, and runs the commands of README.md in an empty directory that knows nothing of the
repository. It prints the time of each. The first Python also runs tests from the source
distribution, and the tools that check the metadata, the citation and the conda recipe.

`python tests/distribution.py --verify dist PYTHON...` installs the wheel and runs only
`thermobearing verify`: as it is, and with a stored number that is wrong. Python alone is enough.
"""

import hashlib
import json
import os
import re
import resource
import subprocess
import sys
import tarfile
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

ROOT = Path(__file__).parents[1]
LARGEST = 5.0  # the wheel [MB]
STUDY = """
kind = "study"
name = "winter"
[case]
structure = "pier-p1"
duration = "5 s"
[design]
kind = "factorial"
[factors]
bearing = ["shen-hdr-bridge", "shen-lhdr-bridge"]
motion = "jra-ii-i-1"
ambient = ["-20 degC", "23 degC"]
"""
NEEDS = (  # what each command says it needs, where only the wheel is installed
    ("thermobearing report bridge", "report"),
    ("thermobearing report bridge --no-pdf", "report"),
    ("thermobearing report bridge --xlsx", "report"),
    ("thermobearing study study.toml -o study", "study"),
    ("thermobearing identify tests.xlsx --bearing shen-hdr-specimen", "xlsx"),
    (
        "thermobearing identify warm/history.csv --bearing shen-hdr-specimen --posterior -o post",
        "bayes",
    ),
)
WITHOUT_LIBRARIES = {"THERMOBEARING_KERNELS": "jit"}  # as on a machine that no library fits
NEEDS_TO_COMPILE = (("thermobearing cyclic -o compiled", "jit"),)
NEEDS_AFTER = (  # where the other extras but `cluster` are installed
    ("thermobearing study study.toml -o dask --executor dask", "cluster"),
)
WITH_EXTRAS = (
    "thermobearing report bridge --xlsx",
    "thermobearing study study.toml -o study",
    "thermobearing study table study -o study.csv",
)
ORIGIN = """
import importlib.util, sys
import thermobearing
from thermobearing.core.compiled.native import open_library
assert thermobearing.__file__.startswith(sys.prefix), thermobearing.__file__
assert importlib.util.find_spec("numba") is None
assert open_library()[0] is not None, open_library()[1]
"""
PLACE = """
import thermobearing
from pathlib import Path
print(Path(thermobearing.__file__).parent / "data" / "verify" / "references.json")
"""
SLOWEST = 60.0  # all comparisons of `thermobearing verify` [s]
WRONG = 5.0  # added to the stored temperature of a lead core [K]
TOOLS = ("twine", "cffconvert", "py-rattler-build")
RENDER = "from rattler_build import Stage0Recipe as R; print(R.from_file('recipe.yaml').render())"
SDIST_TESTS = ("tests/unit/test_dependencies.py", "tests/unit/test_public.py", "tests/docs")


def readme_commands() -> Iterator[list[str]]:
    """Give the commands and the Python example of README.md."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for example in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        yield ["python", "-c", example]
    for command in re.findall(r"(?:^|`)(thermobearing [a-z]+ [^`\n]+)", text, re.MULTILINE):
        yield command.split()


class Environment:
    """An empty environment of a Python in a separate directory, and runs in `work`."""

    def __init__(self, python: str, folder: Path) -> None:
        self.bin, self.work = folder / "bin", folder / "work"
        self.work.mkdir(parents=True)
        ours = ("PYTHON", "THERMOBEARING", "NUMBA", "VIRTUAL_ENV", "CI")
        self.variables = {k: v for k, v in os.environ.items() if not k.startswith(ours)}
        subprocess.run([python, "-m", "venv", folder], check=True, env=self.variables)

    def run(
        self,
        *command: str,
        status: int = 0,
        where: Path | None = None,
        variables: Mapping[str, str] = MappingProxyType({}),
    ) -> str:
        """Run a program of the environment, print its time and return its output."""
        start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            [self.bin / command[0], *command[1:]],
            cwd=where or self.work,
            env={**self.variables, **variables},
            capture_output=True,
            text=True,
            check=False,
        )
        wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        line = " ".join(command).replace("\n", " ")
        print(f"{wall:7.1f} s {cpu:7.1f} CPU s   {line[:88]}", flush=True)
        output = done.stdout + done.stderr
        if done.returncode != status or "Traceback" in output:
            sys.exit(f"status {done.returncode}: {line}\n{output}")
        return output

    def install(self, *what: str) -> None:
        """Install packages and check that their versions agree."""
        self.run("python", "-m", "pip", "install", "--quiet", *what)
        self.run("python", "-m", "pip", "check")


def check_wheel(wheel: Path, environment: Environment) -> None:
    """Run what README.md shows, then what needs extras: first without and then with them."""
    environment.install(str(wheel))
    environment.run("python", "-c", ORIGIN)
    check_verify(environment)
    for command in readme_commands():
        environment.run(*command)
    (environment.work / "study.toml").write_text(STUDY, encoding="utf-8")
    (environment.work / "tests.xlsx").write_bytes(b"PK\x03\x04")
    check_needs(environment, NEEDS)
    check_needs(environment, NEEDS_TO_COMPILE, WITHOUT_LIBRARIES)
    environment.install(f"{wheel}[report,study,xlsx]")
    check_needs(environment, NEEDS_AFTER)
    for line in WITH_EXTRAS:
        environment.run(*line.split())


def check_verify(environment: Environment) -> None:
    """Run `thermobearing verify`: all green and soon; one red row with a wrong reference."""
    summary = verify_summary(environment, status=0)
    verdicts = {row["check"]: row["verdict"] for row in summary["rows"]}
    assert set(verdicts.values()) == {"green"}, verdicts
    assert summary["seconds"] < SLOWEST, summary["seconds"]
    print(f"{len(verdicts)} comparisons in {summary['seconds']:.1f} s, all green", flush=True)

    file = Path(environment.run("python", "-c", PLACE).strip())
    stored = file.read_text(encoding="utf-8")
    references = json.loads(stored)
    references["finite_elements"]["shen-lhdr-specimen"]["lead"] += WRONG
    file.write_text(json.dumps(references), encoding="utf-8")
    try:
        summary = verify_summary(environment, status=1)
    finally:
        file.write_text(stored, encoding="utf-8")
    red = [row["what"] for row in summary["rows"] if row["verdict"] == "red"]
    assert len(red) == len(summary["explanations"]) == 1, summary["explanations"]
    print(f"red with a lead core {WRONG:g} K warmer: {red[0]}", flush=True)


def verify_summary(environment: Environment, status: int) -> dict[str, Any]:
    """Run `thermobearing verify`, which ends with this status, and return its summary."""
    output = environment.run("thermobearing", "verify", "--json", status=status)
    line = next(line for line in output.splitlines() if line.startswith("{"))
    return dict(json.loads(line))


def check_needs(
    environment: Environment,
    needs: Iterable[tuple[str, str]],
    variables: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """Run commands without what they need: each names its extra."""
    for line, extra in needs:
        output = environment.run(*line.split(), status=2, variables=variables)
        assert f"thermobearing[{extra}]" in output, line


def check_sums(folder: Path) -> None:
    """Compare the files of a release with their SHA-256, where these have been written."""
    sums = folder / "SHA256SUMS"
    for line in sums.read_text(encoding="utf-8").splitlines() if sums.exists() else []:
        digest, name = line.split("  ")
        if hashlib.sha256((folder / name).read_bytes()).hexdigest() != digest:
            sys.exit(f"{name} is not that of {sums.name}")


def main(folder: Path, pythons: list[str]) -> None:
    """Check the files that `make dist` left in a folder."""
    check_sums(folder)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    for file in (wheel, sdist):
        print(f"{file.stat().st_size / 1e6:6.2f} MB   {file.name}")
    assert wheel.stat().st_size <= LARGEST * 1e6, f"the wheel is above {LARGEST} MB"
    with tempfile.TemporaryDirectory() as name:
        for k, python in enumerate(pythons):
            print(f"\n{python}")
            check_wheel(wheel, Environment(python, Path(name) / f"wheel-{k}"))
        tools = Environment(pythons[0], Path(name) / "tools")
        tools.install(*TOOLS)
        tools.run("twine", "check", "--strict", str(wheel), str(sdist))
        tools.run("cffconvert", "--validate", "-i", str(ROOT / "CITATION.cff"))
        tools.run("python", "-c", RENDER, where=ROOT)
        unpacked = Environment(pythons[0], Path(name) / "sdist")
        with tarfile.open(sdist) as packed:
            packed.extractall(unpacked.work, filter="data")
        (source,) = unpacked.work.iterdir()
        unpacked.install(f"{source}[test]")
        unpacked.install("--no-deps", "--force-reinstall", str(wheel))  # some tests need libraries
        unpacked.run(
            "python", "-m", "pytest", "-q", "-m", "not thorough", *SDIST_TESTS, where=source
        )


def verify(folder: Path, pythons: list[str]) -> None:
    """Check only `thermobearing verify` of the wheel in a folder."""
    (wheel,) = folder.glob("*.whl")
    with tempfile.TemporaryDirectory() as name:
        for k, python in enumerate(pythons):
            environment = Environment(python, Path(name) / f"wheel-{k}")
            environment.install(str(wheel))
            check_verify(environment)


if __name__ == "__main__":
    arguments = sys.argv[1:]
    check = verify if arguments[0] == "--verify" else main
    folder, *pythons = arguments[1:] if check is verify else arguments
    check(Path(folder).resolve(), pythons or [sys.executable])
