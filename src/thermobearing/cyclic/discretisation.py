"""How far the heat cells of the layers are from enough: Richardson's estimate on one test."""

import math
from dataclasses import dataclass

from thermobearing.bearing.model import Bearing
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run

STRAIN, PERIOD, COUNT, AMBIENT = 1.75, 4.0, 5, -20.0  # of the reference test; s, degC
REFERENCE = f"{COUNT} sine cycles of {100 * STRAIN:g} %, {PERIOD:g} s, {AMBIENT:g} degC"
FINER = 2  # times as many cells in layers and shims
RICHARDSON = FINER**2 / (FINER**2 - 1)  # of the difference, for a scheme of second order
TOLERABLE = 0.01  # of stiffness and energy: specimens of one make differ by 10 %
MOST_CELLS = 1000  # in a layer
LEAST_DAMPING = 1e-3  # h_eq below which there is no energy to speak of: linear rubber


@dataclass(frozen=True)
class CellsError:
    """What too few cells do to the last cycle of the reference test; signs as they are.

    Attributes
    ----------
    stiffness, energy : of G_eq and of the energy of the cycle, relative.
    warming : of the rise of the hottest layer [K].
    rise : that rise, with many cells [K].
    cells : in a rubber layer.
    """

    stiffness: float
    energy: float
    warming: float
    rise: float
    cells: int

    @property
    def worst(self) -> float:
        """The larger of stiffness and energy, without sign."""
        return max(abs(self.stiffness), abs(self.energy))

    @property
    def enough(self) -> bool:
        """Whether both are tolerable."""
        return self.worst <= TOLERABLE

    @property
    def advised(self) -> int:
        """Cells in a rubber layer that would be enough, even."""
        wanted = self.cells * math.sqrt(self.worst / TOLERABLE)
        return min(MOST_CELLS, max(self.cells, 2 * math.ceil(0.5 * wanted)))


def cells_error(bearing: Bearing) -> CellsError | None:
    """Estimated error of a bearing's cells in layers and shims, from twice as many.

    Parameters
    ----------
    bearing : any layered bearing.

    Returns
    -------
    CellsError, or None where the reference test does not run to its end.

    Raises
    ------
    InputError : twice as many cells are more than a run can have.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> found = cells_error(load_bearing("shen-hdr-specimen"))
    >>> found.enough, found.advised
    (False, 4)
    """
    cells = bearing.cells
    twice = {"rubber": FINER * cells.rubber, "shim": FINER * cells.shim}
    finer = bearing.model_copy(update={"cells": cells.model_copy(update=twice)})
    test = CyclicTest(
        dt=0.005,
        steps=[
            {"step": "cycles", "strain": STRAIN, "wave": "sine", "period": PERIOD, "count": COUNT}
        ],
    )
    given, fine = (run(each, test, AMBIENT) for each in (bearing, finer))
    if given.outcome != "completed" or fine.outcome != "completed":
        return None
    ours, better = _last_cycle(given), _last_cycle(fine)
    rise = better[2] - AMBIENT
    return CellsError(
        stiffness=RICHARDSON * (ours[0] - better[0]) / better[0],
        energy=RICHARDSON * (ours[1] - better[1]) / max(better[1], LEAST_DAMPING * better[0]),
        warming=RICHARDSON * (ours[2] - better[2]),
        rise=rise + (RICHARDSON - 1.0) * (better[2] - ours[2]),
        cells=cells.rubber,
    )


def _last_cycle(result: Result) -> tuple[float, float, float]:
    """G_eq and G_eq h_eq [MPa] of the last cycle, the hottest layer at its end [degC].

    The energy is 2 pi G_eq h_eq strain^2 a volume.
    """
    last = result.cycles.iloc[-1]
    modulus, damping = float(last["G_eq_MPa"]), float(last["h_eq"])
    return modulus, modulus * damping, float(result["rubber_temperature"].values[0, -1].max())
