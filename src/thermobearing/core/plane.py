"""Coupled steps in a plane: the kernels of a line (step.py, march.py) with pairs for vectors.

States and scratch come from `new_state` and `new_workspace` with two components. Explicit Euler,
closed small loops and monotone hardening are for a line only (`line_only_options`).
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.march import march
from thermobearing.core.step import step
from thermobearing.core.types import EULER, Constants, Kept, Path, State, Workspace
from thermobearing.core.vector import as_plane

F = TypeVar("F", bound=Callable[..., Any])


@compiled
def step_plane(
    constants: Constants,
    work: Workspace,
    state: State,
    x: float,
    y: float,
    dt: float,
    ambient: float,
    new: State,
) -> tuple[float, float, float, float, float, float, int]:
    """`step` to the displacement (x, y) [mm].

    Returns the two components of the force [kN], the tangent [kN/mm] by rows, and the outcome.
    """
    at: Any = (x, y)
    result: Any = step(constants, as_plane(work), as_plane(state), at, dt, ambient, as_plane(new))
    force, ((xx, xy), (yx, yy)), outcome = result
    return force[0], force[1], xx, xy, yx, yy, outcome


@compiled
def march_plane(
    constants: Constants, work: Workspace, state: State, spare: State, path: Path, rows: Kept
) -> tuple[int, int, int, int, float]:
    """`march` along displacements [steps, 2]; rows are kept with two components."""
    return march(
        constants,
        as_plane(work),
        as_plane(state),
        as_plane(spare),
        as_plane(path),
        as_plane(rows),
    )


def count_components(state: State) -> int:
    """Return 1 for the state of a bearing on a line, 2 in a plane."""
    return int(state.response["displacement"].ndim)


def plain(kernel: F, state: State) -> F:
    """Return a kernel for this state; in a plane plain Python, for what takes next to no time."""
    return kernel if count_components(state) == 1 else cast(F, getattr(kernel, "py_func", kernel))


def line_only_options(constants: Constants) -> list[str]:
    """Return the chosen options that are not available in a plane."""
    rubber = constants.rubber
    chosen = {
        "integrator = euler": rubber.integrator == EULER,
        "small_loops = closed": rubber.closed_loops,
        "hardening = monotone": rubber.monotone,
        "a hysteresis_law whose registration has no function plane": (
            rubber.law != 0 and rubber.law_in_plane == 0
        ),
    }
    return [name for name, is_chosen in chosen.items() if is_chosen]
