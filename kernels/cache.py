"""Machine code of all kernels for this machine, in the folder where a clone keeps it.

A clone compiles a kernel when it is first called (core/compiled/objects.py). This compiles all of
them, on all cores, before tests or many programs start.
"""

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

from kernels.entries import all_kernels, record
from thermobearing.core.compiled.objects import compile_once

# Kernels of one group have most of their parts in common, which a process writes once. The groups
# that take longest come first.
GROUPS = ("plane_lanes_", "lanes_", "plane")


def group_of(name: str) -> int:
    """Return the place of the group of a kernel: lockstep in plan, on a line, plan, the others."""
    last = name.rpartition(".")[2]
    return next((k for k, start in enumerate(GROUPS) if start in last), len(GROUPS))


def compile_all() -> None:
    """Compile the kernels that are not kept yet."""
    groups: dict[int, dict[str, Any]] = {}
    for name, kinds in record().items():
        groups.setdefault(group_of(name), {})[name] = kinds
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as pool:
        list(pool.map(_compile_group, [groups[key] for key in sorted(groups)]))


def _compile_group(kinds: dict[str, Any]) -> None:
    kernels = {kernel.name: kernel for kernel in all_kernels()}
    for name, arguments in kinds.items():
        compile_once(kernels[name], arguments)
