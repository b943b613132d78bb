"""One structure, one ground motion, bearings with their heat: from matrices to histories."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from thermobearing.core.types import (
    BOOKS,
    Constants,
    Floats,
    State,
    new_state,
    new_workspace,
)
from thermobearing.model.outcomes import NAMES
from thermobearing.structure.matrices import (
    Matrices,
    Modes,
    build_matrices,
    find_modes,
    hinge_stiffness,
    line_stiffness,
    rayleigh,
)
from thermobearing.structure.model import MassModel, Structure
from thermobearing.structure.newmark import newmark_march, start_motion
from thermobearing.structure.predictor import predictor_march
from thermobearing.structure.takeda import NEVER_TURNED
from thermobearing.structure.types import (
    DIVERGED,
    HIGHEST,
    HINGE_STATE,
    LOWEST,
    MOTION_BOOKS,
    NO_EQUILIBRIUM,
    TURNED_HIGH,
    TURNED_LOW,
    VECTORS,
    Motion,
    Scheme,
    System,
)

Method = Literal["average-acceleration", "linear-acceleration", "predictor-corrector"]
BETA = {
    "average-acceleration": 1.0 / 4.0,
    "linear-acceleration": 1.0 / 6.0,
    "predictor-corrector": 1.0 / 6.0,
}
GAMMA = 0.5
TOLERANCE = 1e-10  # of the largest inertia force
ITERATIONS = 15
HALVINGS = 8

OUTCOMES = {**NAMES, NO_EQUILIBRIUM: "no_equilibrium", DIVERGED: "diverged"}
SENTENCES = {
    "no_equilibrium": (
        "Newton's method found no equilibrium, even in the smallest part of a step. Try a smaller "
        "dt, or method average-acceleration."
    ),
    "diverged": (
        "A coordinate left every sensible range. Try a smaller dt: explicit correction and "
        "linear acceleration are stable for small steps only."
    ),
}


@dataclass(frozen=True)
class Line:
    """What a bearing line is made of in one run.

    Attributes
    ----------
    constants : of the modelled bearing.
    temperature : of its cells at the start [degC].
    lead : temperature of its lead at the start [degC]; None for that of the cells beside it.
    speed : of its actuator [mm/s], if it lives on its own clock; 0 for earthquake time.
    """

    constants: Constants
    temperature: Floats
    lead: float | None = None
    speed: float = 0.0


@dataclass
class StructureHistory:
    """Kept rows of one run; the columns by name are in `columns`."""

    rows: Floats
    columns: dict[str, slice]
    states: Sequence[State]
    outcome: str = "completed"
    steps: int = 0
    iterations: int = 0
    substeps: int = 0

    def get(self, name: str) -> Floats:
        """[kept, width] columns of one kind."""
        return self.rows[:, self.columns[name]]


@dataclass(frozen=True)
class Prepared:
    """A structure that is ready to be shaken by any number of motions."""

    structure: Structure
    matrices: Matrices
    modes: Modes  # with the equivalent stiffness of the bearings
    damping: Floats  # [n, n]
    ratios: Floats  # damping ratio of each mode
    predictor: Floats = field(repr=False)  # [n, n] stiffness of the predictor


def prepare_structure(structure: Structure, mass_model: MassModel = "consistent") -> Prepared:
    """Matrices, modes and damping of a structure."""
    matrices = build_matrices(structure, mass_model)
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    stiffness = stiffness + line_stiffness(structure, matrices)
    modes = find_modes(matrices.mass, stiffness, structure.name)
    damping, ratios = rayleigh(structure, matrices, modes)
    return Prepared(structure, matrices, modes, damping, ratios, stiffness)


def build_system(prepared: Prepared, lines: Sequence[Line]) -> System:
    """The structure as the compiled integration wants it."""
    structure, matrices = prepared.structure, prepared.matrices
    hinges = [
        [h.stiffness, h.yield_rotation, h.hardening_ratio, h.unloading_exponent]
        for h in structure.hinges
    ]
    factors = [
        [given.count / given.scale**2, given.scale, line.speed]
        for given, line in zip(structure.bearings, lines, strict=True)
    ]
    return System(
        mass=np.ascontiguousarray(matrices.mass),
        damping=np.ascontiguousarray(prepared.damping),
        stiffness=np.ascontiguousarray(matrices.springs),
        load=matrices.load,
        hinge_rows=np.ascontiguousarray(matrices.hinge_rows),
        hinges=np.reshape(np.array(hinges, dtype=np.float64), (len(hinges), 4)),
        line_rows=np.ascontiguousarray(matrices.line_rows),
        lines=np.array(factors),
    )


def new_motion(system: System) -> Motion:
    """At rest, hinges never bent."""
    n, hinges = len(system.load), np.zeros((len(system.hinges), HINGE_STATE))
    hinges[:, HIGHEST], hinges[:, LOWEST] = system.hinges[:, 1], -system.hinges[:, 1]
    hinges[:, TURNED_HIGH], hinges[:, TURNED_LOW] = NEVER_TURNED, -NEVER_TURNED
    return Motion(
        vectors=np.zeros((VECTORS, n)),
        matrix=np.zeros((n, n)),
        tangent=np.zeros((n, n)),
        hinges=hinges,
        trial_hinges=hinges.copy(),
        stretches=np.zeros(len(system.lines)),
        books=np.zeros(MOTION_BOOKS),
    )


def row_columns(system: System, lines: Sequence[Line]) -> dict[str, slice]:
    """Where `write_motion_row` puts what: books, q, v, a, hinge0, bearing0, layers0, ..."""
    n = len(system.load)
    widths = {"books": MOTION_BOOKS, "q": n, "v": n, "a": n}
    widths |= {f"hinge{h}": 2 for h in range(len(system.hinges))}
    for b, line in enumerate(lines):
        widths |= {f"bearing{b}": BOOKS, f"layers{b}": len(line.constants.multiplicity)}
    ends = np.cumsum([0, *widths.values()])
    return {
        name: slice(int(start), int(end))
        for name, start, end in zip(widths, ends[:-1], ends[1:], strict=True)
    }


def run_structure(
    prepared: Prepared,
    lines: Sequence[Line],
    ground: Floats,
    dt: float,
    ambient: Floats,
    *,
    method: Method = "average-acceleration",
    keep_every: int = 1,
    noise: Floats | None = None,
    delay: float = 0.0,
) -> StructureHistory:
    """Shake a structure; always returns what was computed, with a typed outcome.

    Parameters
    ----------
    prepared : from `prepare_structure`.
    lines : one per bearing line of the structure.
    ground : [steps + 1] ground acceleration at the ends of steps [mm/s2], linear between.
    dt : of the steps [s].
    ambient : [steps] mean ambient temperature of each step [degC].
    method : Newmark with constant mean or linear acceleration, or the source's
        predictor-corrector (Eq. 3.8-3.16).
    keep_every : keep every n-th step; the start and the last step besides.
    noise : [steps] error of the measured force of the modelled bearing [kN]; only with the
        predictor-corrector.
    delay : of the actuator [s], >= 0; likewise.
    """
    system = build_system(prepared, lines)
    motion = new_motion(system)
    constants = tuple(line.constants for line in lines)
    works = tuple(new_workspace(item) for item in constants)
    states, spares = (
        tuple(new_state(line.constants, line.temperature, line.lead) for line in lines)
        for _ in range(2)
    )
    steps = len(ground) - 1
    keep = np.zeros(steps, dtype=np.bool_)
    keep[keep_every - 1 :: keep_every] = True
    keep[-1] = True
    columns = row_columns(system, lines)
    rows = np.zeros((1 + int(keep.sum()), max(part.stop for part in columns.values())))
    for b, line in enumerate(lines):
        start = new_state(line.constants, line.temperature, line.lead)
        rows[0, columns[f"bearing{b}"]] = start.books
        middles = line.temperature[line.constants.layer_cells[:, 2:]]
        rows[0, columns[f"layers{b}"]] = middles.mean(axis=1)
    start_motion(system, motion, ground[0])
    rows[0, columns["a"]] = motion.vectors[2]
    history = StructureHistory(rows, columns, states)
    scheme = Scheme(BETA[method], GAMMA, TOLERANCE, ITERATIONS, HALVINGS)
    if method == "predictor-corrector":
        errors = np.zeros(steps) if noise is None else noise
        commands = np.zeros((steps + 1, len(lines)))
        stiffness = np.ascontiguousarray(prepared.predictor)
        done, kept, outcome = predictor_march(
            system, constants, works, states, spares, motion, scheme, stiffness, ground, dt,
            ambient, errors, commands, delay / dt, keep, rows[1:],
        )  # fmt: skip
    else:
        done, kept, outcome = newmark_march(
            system, constants, works, states, spares, motion, scheme, ground, dt, ambient, keep,
            rows[1:],
        )  # fmt: skip
    history.steps, history.rows = int(done), rows[: 1 + kept]
    history.outcome = OUTCOMES[int(outcome)]
    history.iterations, history.substeps = int(motion.books[-2]), int(motion.books[-1])
    return history
