"""What the verification tests share: bearings, runs, and the independent layer law. No tests."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing, Material, SquarePlan
from thermobearing.core.heat import conduct, factor, has_side_loss
from thermobearing.core.march import march
from thermobearing.core.records import Floats, Rows, labels, rows
from thermobearing.core.types import (
    BearingResponse,
    Constants,
    Kept,
    Path,
    new_state,
    new_workspace,
)
from thermobearing.model.constants import build_constants
from thermobearing.model.stack import EndFace, build_stack


def specimen() -> Bearing:
    """The HDR specimen of the source, six rubber layers of 5 mm."""
    return load_bearing("shen-hdr-specimen")


def changed(bearing: Bearing, **parts: dict[str, Any]) -> Bearing:
    """The bearing with some fields of its parts replaced: changed(b, cells={"shim": 2})."""
    copies = {
        name: getattr(bearing, name).model_copy(update=update) for name, update in parts.items()
    }
    return bearing.model_copy(update=copies)


def assembled(
    bearing: Bearing,
    *,
    half: bool = True,
    upper: EndFace | None = None,
    lower: EndFace | None = None,
    **options: Any,
) -> Constants:
    """Constants of a half stack, or of a full one whose faces are alike unless `lower` is given."""
    upper = upper or EndFace(eta=2.0)
    lower = None if half else (lower or upper)
    stack = build_stack(bearing, half=half)
    return build_constants(bearing, stack, upper=upper, lower=lower, **options)


def slab(
    *,
    rubber: Material,
    steel: Material,
    side_film: float,
    cells: int,
    rubber_thickness: float = 20.0,
    end_plate_thickness: float = 20.0,
) -> Bearing:
    """One rubber layer between two end plates: in half stacks, a slab of `cells` + `cells`."""
    return changed(
        specimen(),
        geometry={
            "plan": SquarePlan(shape="square", side=100.0),
            "rubber_layers": 1,
            "rubber_thickness": rubber_thickness,
            "end_plate_thickness": end_plate_thickness,
        },
        materials={"rubber": rubber, "steel": steel, "side_film": side_film},
        cells={"rubber": 2 * cells, "end_plate": cells, "shim": 1},
    )


def rate_matrix(constants: Constants) -> Floats:
    """M of dT/dt = -M (T - ambient), from the rates that the heat step uses [1/s]."""
    cells = constants.cells
    own = cells.to_previous + cells.to_next + cells.end_loss + cells.side_loss
    return np.diag(own) - np.diag(cells.to_previous[1:], -1) - np.diag(cells.to_next[:-1], 1)


@dataclass(frozen=True)
class HeatStep:
    change: Floats  # [K]
    stored: float  # [kN mm], whole bearing, as the losses
    ends: float
    sides: float


def heat_step(
    constants: Constants, temperature: Floats, dt: float, ambient: float, source: Floats
) -> HeatStep:
    """One conduction step of the core with a source [K] added to each cell over the step."""
    rates, work = constants.cells, new_workspace(constants).cells
    factor(rates, constants.side_implicit, dt, work)
    work.change[:] = source
    after = np.empty(len(temperature))
    implicit, sides = constants.side_implicit, has_side_loss(rates) != 0.0
    response = conduct(rates, implicit, sides, temperature, dt, ambient, work, after)
    assert np.array_equal(after, temperature + work.change)
    return HeatStep(work.change, *response)


@dataclass(frozen=True)
class Run:
    outcome: int
    softened: int
    response: Rows[BearingResponse]
    layer_start: Floats  # layer temperatures at the START of each step, which the law uses
    d: Floats  # layer displacements at the end of each step, as all that follow
    z: Floats
    cells: Floats  # cell temperatures
    constants: Constants


def marched(
    constants: Constants, x: Floats, dt: float, start: float | Floats, ambient: float
) -> Run:
    """March through the displacements x from cell temperatures `start`, keeping every step."""
    n, layers = len(constants.cells.capacity), len(constants.multiplicity)
    first = np.broadcast_to(np.asarray(start, dtype=float), (n,))
    layer, d, z = (np.zeros((len(x), layers)) for _ in range(3))
    cells = np.zeros((len(x), n))  # in double precision: single is a choice of cyclic/history.py
    room = Kept(rows(BearingResponse, len(x)), layer, d, z, cells)
    path = Path(
        x=np.asarray(x, dtype=float),
        dt=np.full(len(x), dt),
        ambient=np.full(len(x), ambient, dtype=float),
        keep=np.ones(len(x), dtype=bool),
        settled=0.0,
    )
    state, spare = new_state(constants, first), new_state(constants, first)
    work = new_workspace(constants)
    done, kept, outcome, softened, _ = march(constants, work, state, spare, path, room)
    assert done == kept
    middle = constants.layer_cells
    at_first = 0.5 * (first[middle["upper_middle"]] + first[middle["lower_middle"]])
    return Run(
        outcome=outcome,
        softened=softened,
        response=room.response[:kept],
        layer_start=np.vstack([at_first, layer[: max(kept - 1, 0)]]),
        d=d[:kept],
        z=z[:kept],
        cells=cells[:kept],
        constants=constants,
    )


def layer_forces(bearing: Bearing, run: Run) -> Floats:
    """Eq. 4.34 as printed, for every step and layer [kN]."""
    h, t_r = bearing.hysteresis, bearing.geometry.rubber_thickness
    warmer = (run.layer_start - 23.0) / 100.0
    a, k = h.post_yield_ratio, h.layer_stiffness
    elastic = a * np.exp(h.elastic_temperature_coefficient * warmer) * k * run.d
    hysteretic = (1.0 - a) * np.exp(h.hysteretic_temperature_coefficient * warmer) * k * run.z
    return np.asarray(elastic + (1.0 + h.hardening * (run.d / t_r) ** 2) * hysteretic)


def sine(bearing: Bearing, strain: float, period: float, cycles: float, dt: float) -> Floats:
    """Bearing displacement [mm] at the end of each step of a sine of the given shear strain."""
    t = dt * np.arange(1, round(cycles * period / dt) + 1)
    return np.asarray(strain * bearing.total_rubber_thickness * np.sin(2.0 * np.pi * t / period))


def smooth_history(rng: np.random.Generator, peak: float, steps: int) -> Floats:
    """A random sum of six sines that starts near zero and peaks at `peak` [mm]."""
    t = np.arange(1, steps + 1) / steps
    waves = np.arange(1, 7) * rng.uniform(0.5, 1.5, 6)
    x = np.sin(2.0 * np.pi * np.outer(t, waves)) @ rng.normal(size=6)
    return np.asarray(peak * x / np.max(np.abs(x)))


def stored_heat(run: Run, start: float | Floats) -> float:
    """Heat in the cells now above that at the start, from the temperatures [kN mm]."""
    return float(run.constants.cells.capacity @ (run.cells[-1] - start))


def numbers(response: Rows[BearingResponse]) -> Floats:
    return np.column_stack([response[label.name] for label in labels(BearingResponse)])
