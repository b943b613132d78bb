"""Run the golden cases as on other processors: `python -m tests.targets [--numba] [NAME ...]`.

Results must not depend on the processor, on BLAS or on the kernels. Each target is a type of
processor that this one can stand in for: OPENBLAS_CORETYPE selects the BLAS kernels, and
NPY_DISABLE_CPU_FEATURES the functions of numpy, of an older processor, THERMOBEARING_KERNELS the
built kernels of a level of x86-64, and NUMBA_CPU_NAME the processor that numba compiles for. One
row is printed for each; the exit status is 1 if a golden case fails, or a target does not take
effect.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from thermobearing.core.compiled.native import CHOICE, FOLDER, LEVELS, read_library

ROOT = Path(__file__).parents[1]
COUNTS = re.compile(r"(\d+) (passed|failed|errors?)\b")
# What a process with the variables of a target runs on: asked of it, since libraries ignore names
# that they do not have, such as those of features in another version of numpy.
PROBE = """
import json, warnings
import numpy as np
from threadpoolctl import threadpool_info
from thermobearing.core.compiled.native import open_library
blas = sorted({item["architecture"] for item in threadpool_info() if item["user_api"] == "blas"})
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    library = open_library()[0]
simd = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
print(json.dumps([blas, simd, library.file.stem.rpartition("-")[2] if library else "jit"]))
"""
# Names that OpenBLAS reports for the types that it is asked for.
BLAS = {"Prescott": {"Katmai", "Prescott"}, "Haswell": {"Haswell"}, "SkylakeX": {"SkylakeX"}}


class Target(NamedTuple):
    """A type of processor, as variables of the environment."""

    name: str
    variables: Mapping[str, str]
    blas: frozenset[str] = frozenset()  # one of them must be in use; any if empty
    plain_numpy: bool = False  # numpy must use none of its functions for newer processors
    kernels: str = ""  # that must be in use; any if empty


class Row(NamedTuple):
    """What the golden cases gave on a target."""

    target: str
    passed: int
    failed: int
    seconds: float
    fault: str = ""


def processor_features() -> set[str]:
    """Return the flags of this processor, none where the system does not say."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    except OSError:
        return set()
    lines = (line.partition(":")[2] for line in text.splitlines() if line.startswith("flags"))
    return set(next(lines, "").split())


def built_levels() -> list[str]:
    """Return the levels of x86-64 whose kernels are built and run here."""
    features, result = processor_features(), []
    for level in ("v1", "v3", "v4"):
        needed = LEVELS["v3"] | LEVELS["v4"] if level == "v4" else LEVELS[level]
        try:
            read_library(FOLDER, f"linux-x86_64-{level}")
        except (OSError, ValueError, KeyError):
            continue
        if needed <= features:
            result.append(level)
    return result


def list_targets(*, numba: bool) -> list[Target]:
    """Return the targets of this machine; those of numba compile for minutes."""
    features = processor_features()
    supported = {"Prescott": "pni", "Haswell": "avx2", "SkylakeX": "avx512vl"}
    targets = [Target("native", {})]
    for name, feature in supported.items():
        if feature in features:
            variables = {"OPENBLAS_CORETYPE": name}
            targets.append(Target(f"openblas-{name}", variables, frozenset(BLAS[name])))
    simd = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
    if simd:
        variables = {"NPY_DISABLE_CPU_FEATURES": " ".join(simd)}
        targets.append(Target("numpy-baseline", variables, plain_numpy=True))
    targets += [Target(f"kernels-{at}", {CHOICE: at}, kernels=at) for at in built_levels()]
    if numba:
        jit = {CHOICE: "jit"}
        targets.append(Target("numba-native", jit, kernels="jit"))
        older = {"NUMBA_CPU_NAME": "x86-64-v2", "NUMBA_CPU_FEATURES": ""}
        targets.append(Target("numba-x86-64-v2", jit | older, kernels="jit"))
    return targets


def _run(command: list[str], environment: Mapping[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )


def wrong_effect(target: Target, environment: Mapping[str, str]) -> str:
    """Return why the variables of a target do not take effect; empty if they do."""
    command = [sys.executable, "-c", PROBE]
    probe = _run(command, environment)
    if probe.returncode:
        return probe.stderr.strip().rpartition("\n")[2]
    blas, simd, kernels = json.loads(probe.stdout)
    if target.blas and not set(blas) <= target.blas:
        return f"BLAS uses {', '.join(blas)}"
    if target.plain_numpy and simd:
        return f"numpy uses {', '.join(simd)}"
    if target.kernels and kernels != target.kernels:
        return f"the kernels are {kernels}"
    return ""


def run_target(target: Target, paths: list[str], workers: str) -> Row:
    """Run tests on a target, and print what they write if one fails."""
    begin = time.monotonic()
    environment = {**os.environ, **target.variables}
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(ROOT / "src"), *filter(None, [os.environ.get("PYTHONPATH")])]
    )
    if fault := wrong_effect(target, environment):
        return Row(target.name, 0, 0, time.monotonic() - begin, fault)
    command = [sys.executable, "-m", "pytest", "-q", "--numprocesses", workers, *paths]
    tests = _run(command, environment)
    last = tests.stdout.strip().rpartition("\n")[2]
    counts = {kind.rstrip("s"): int(count) for count, kind in COUNTS.findall(last)}
    failed = counts.get("failed", 0) + counts.get("error", 0)
    if tests.returncode:
        print(f"{target.name}:\n{tests.stdout}{tests.stderr}", file=sys.stderr)
    fault = "" if failed or not tests.returncode else f"pytest ended with {tests.returncode}"
    return Row(target.name, counts.get("passed", 0), failed, time.monotonic() - begin, fault)


def main() -> None:
    """Run the targets and print a row for each."""
    parser = argparse.ArgumentParser("python -m tests.targets", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="of targets; all by default")
    parser.add_argument("--numba", action="store_true", help="also compile by numba, for minutes")
    parser.add_argument("--list", action="store_true", help="print the names of the targets")
    parser.add_argument("--workers", default="auto", help="processes that pytest uses")
    parser.add_argument("--tests", nargs="+", default=["tests/regression"], metavar="PATH")
    options = parser.parse_args()
    numba = options.numba or any(name.startswith("numba") for name in options.names)
    targets = {target.name: target for target in list_targets(numba=numba)}
    unknown = [name for name in options.names if name not in targets]
    if unknown:
        parser.error(f"no target {unknown[0]} on this machine; there are {', '.join(targets)}")
    if options.list:
        print("\n".join(targets))
        return
    print(f"{'target':20} {'passed':>6} {'failed':>6} {'seconds':>8}")
    bad = False
    for name in options.names or targets:
        row = run_target(targets[name], options.tests, options.workers)
        print(
            f"{row.target:20} {row.passed:6} {row.failed:6} {row.seconds:8.1f} {row.fault}".rstrip()
        )
        sys.stdout.flush()
        bad = bad or bool(row.failed or row.fault or not row.passed)
    sys.exit(bad)


if __name__ == "__main__":
    main()
