"""Earlier releases compared with the present: the same calculations by turns on one machine.

Releases are taken from the history of git into build/releases and, like the present, compiled by
numba for this machine, which takes some minutes the first time. Version 0.2.0 stays as an anchor,
so that a slow growth over several releases is seen.
"""

import io
import json
import os
import subprocess
import sys
import tarfile
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.rows import Row, at_most, failed

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "build" / "releases"
PROGRAM = Path(__file__).with_name("release_times.py")
CONTENTS = ("pyproject.toml", "src", "benchmarks", "tests")
ROUNDS = 5
ANCHOR = "0.2.0"
SLOWER, ANCHOR_SHARE = 1.05, 0.8  # of the time of the last release, and of a step of the anchor


class NoReleaseError(Exception):
    """There is no history from which an earlier release could be built."""


@dataclass(frozen=True)
class Release:
    """A version and the commit that changed the version to it."""

    version: str
    commit: str


def git(*arguments: str) -> bytes:
    """Return what a command of git prints about this checkout."""
    try:
        process = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise NoReleaseError("there is no git history of earlier releases") from error
    return process.stdout


def releases() -> list[Release]:
    """Return the releases before the present commit, the last one first."""
    present = git("rev-parse", "HEAD").decode().strip()
    commits = git("log", "-G^version = ", "--format=%H", "--", "pyproject.toml").decode().split()
    tables = {
        commit: tomllib.loads(git("show", f"{commit}:pyproject.toml").decode())
        for commit in commits
        if commit != present
    }
    return [Release(table["project"]["version"], commit) for commit, table in tables.items()]


def compared() -> list[Release]:
    """Return the last release and the anchor."""
    before = releases()
    if not before:
        raise NoReleaseError("there is no release before the present commit")
    anchors = [release for release in before[1:] if release.version == ANCHOR]
    return [before[0], *anchors]


def unpacked(release: Release) -> Path:
    """Return the folder with the sources of a release, which are taken from the history once."""
    folder = FOLDER / f"{release.version}-{release.commit[:8]}"
    if not folder.exists():
        archive = git("archive", release.commit, *CONTENTS)
        # The archive is of this repository; Python 3.11.2 has no filters, later ones ask for one.
        safety: dict[str, Any] = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}
        with tarfile.open(fileobj=io.BytesIO(archive)) as members:
            members.extractall(folder, **safety)
    return folder


def times(checkout: Path, cache: Path) -> dict[str, float]:
    """Return the times of the calculations with the sources of a checkout."""
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(map(str, (checkout / "src", checkout))),
        "NUMBA_CACHE_DIR": str(cache),
        "THERMOBEARING_KERNELS": "jit",
    }
    # -P: modules of the folder of this program are not those of the same name elsewhere.
    command = [sys.executable, "-P", str(PROGRAM)]
    process = subprocess.run(
        command, cwd=checkout, env=environment, check=True, stdout=subprocess.PIPE, text=True
    )
    measured: dict[str, float] = json.loads(process.stdout.splitlines()[-1])
    return measured


def fastest(rounds: list[dict[str, float]]) -> dict[str, float]:
    """Return the shortest time of each calculation: other processes only make a run slower."""
    return {name: min(times_of_round[name] for times_of_round in rounds) for name in rounds[0]}


def ratio_rows(release: Release, before: dict[str, float], now: dict[str, float]) -> list[Row]:
    """Return the times now over those of a release, of the calculations that both have."""
    anchor = release.version == ANCHOR
    names = [name for name in now if name in before]
    if anchor:  # its motions were others, so that a pier has other iterations
        names = [name for name in names if name.startswith("step")]
    return [
        at_most(
            f"{name.rpartition(' [')[0]}, over release {release.version}",
            now[name] / before[name],
            ANCHOR_SHARE if anchor else SLOWER,
            note=f"{now[name]:.3g} and {before[name]:.3g} {name.rpartition(' [')[2][:-1]}",
        )
        for name in names
    ]


def rows() -> list[Row]:
    """Measure the present and earlier releases by turns."""
    try:
        earlier = compared()
    except NoReleaseError as error:
        return [failed("earlier releases", str(error))]
    checkouts = {release: unpacked(release) for release in earlier}
    now: list[dict[str, float]] = []
    before: dict[Release, list[dict[str, float]]] = {release: [] for release in earlier}
    for _ in range(ROUNDS):
        now.append(times(ROOT, FOLDER / "cache"))
        for release, folder in checkouts.items():
            before[release].append(times(folder, FOLDER / "cache"))
    return [
        row
        for release in earlier
        for row in ratio_rows(release, fastest(before[release]), fastest(now))
    ]
