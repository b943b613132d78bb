"""A fit near its optimum, where residuals are linear: what moves what, and how surely.

Residuals of neighbouring samples are alike (filters, and above all model error), so the
textbook covariance sigma^2 (J^T J)^-1 is far too small. Gradients are summed over half
cycles, which are taken to be independent (cluster-robust "sandwich"; Huber 1967, White
1980): (J^T J)^-1 (sum g_b g_b^T) (J^T J)^-1 with B/(B - p) for few blocks. The textbook
value is kept as a floor.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify.forward import turning_points
from thermobearing.identify.problem import Problem, robust_weights
from thermobearing.identify.record import TestRecord

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AT_BOUND = 2e-3  # of the range: nearer to a bound than this is at it
BLOCK_TURN = 0.05  # of the largest displacement: half cycles larger than this are blocks


def half_cycles(record: TestRecord) -> Ints:
    """Number of the half cycle that each sample belongs to, cut half-way between turns.

    Not at the turns: there the gradients of stiffness, d_y and s change sign at once, and noise
    that is alike on both sides cancels, which sums cut there would not see.

    Parameters
    ----------
    record : a test.

    Returns
    -------
    ndarray of int : from 0.
    """
    turns = turning_points(record.displacement, BLOCK_TURN * record.peak_displacement)
    middles = (turns[:-1] + turns[1:]) // 2
    return np.searchsorted(middles, np.arange(len(record.time)), side="right").astype(np.int64)


@dataclass(frozen=True)
class Linear:
    """Residuals and their derivatives at the optimum, under the weights of the loss.

    Attributes
    ----------
    inside : of the free parameters, those that are not at a bound.
    parts : weighted residuals of each record.
    weights : square root of the weight that the loss leaves to each residual.
    jacobian : [residual, parameter inside] by the place in the unit cube.
    blocks : number of the block of each residual, over all records.
    """

    inside: NDArray[np.bool_]
    parts: list[Floats]
    weights: Floats
    jacobian: Floats
    blocks: Ints

    @cached_property
    def residuals(self) -> Floats:
        """Of all records."""
        return np.concatenate(self.parts)

    @property
    def variance(self) -> float:
        """Of the residuals, with the freedom of the fit taken off."""
        n, p = self.jacobian.shape
        r = self.residuals
        return float(r @ r / max(n - p, 1))

    @cached_property
    def _scaled(self) -> tuple[Floats, Floats, Floats]:
        """Lengths of the columns of J, J in columns of length one, and (J^T J)^-1 of these."""
        scale = np.maximum(np.linalg.norm(self.jacobian, axis=0), 1e-12)
        J = self.jacobian / scale
        return scale, J, np.linalg.pinv(J.T @ J, rcond=1e-12)

    def solved(self, columns: Floats) -> Floats:
        """(J^T J)^-1 J^T times columns."""
        scale, J, bread = self._scaled
        return np.asarray((bread @ (J.T @ columns)) / scale.reshape(-1, *[1] * (columns.ndim - 1)))

    def meat(self, columns: Floats, residuals: Floats | None = None) -> Floats:
        """Sum over the blocks of the outer products of their gradients; residuals of the fit."""
        products = columns * (self.residuals if residuals is None else residuals)[:, None]
        g = np.zeros((int(self.blocks.max()) + 1, columns.shape[1]))
        np.add.at(g, self.blocks, products)
        count = len(g)
        return np.asarray(g.T @ g * count / max(count - self.jacobian.shape[1], 1))

    def covariance(self) -> Floats:
        """Of the parameters inside, by the tests alone, in the unit cube."""
        scale, J, bread = self._scaled
        classical = bread * self.variance
        sandwich = bread @ self.meat(J) @ bread
        least = np.maximum(np.diag(sandwich), 1e-300)
        grow = np.sqrt(np.maximum(1.0, np.diag(classical) / least))
        return np.asarray(sandwich * np.outer(grow, grow) / np.outer(scale, scale))


def linearised(problem: Problem, cube: Floats, *, fine: bool = True) -> Linear:
    """A fit near a point of the unit cube.

    Parameters
    ----------
    problem : residuals of the tests.
    cube : the optimum, in [0, 1] for each free parameter.
    fine : a step of the model at every sample.

    Returns
    -------
    Linear
    """
    plain = problem.parts(cube, fine=fine)
    roots = [np.sqrt(robust_weights(part, problem.loss)) for part in plain]
    jacobian = problem.jacobian(cube, fine=fine, central=fine)
    inside = (cube > AT_BOUND) & (cube < 1.0 - AT_BOUND)
    weights = np.concatenate(roots)
    labels, first = [], 0
    for record, part in zip(problem.records, plain, strict=True):
        blocks = np.unique(half_cycles(record), return_inverse=True)[1]
        labels.append(first + np.resize(blocks, len(part)))
        first += int(blocks.max()) + 1
    return Linear(
        inside=inside,
        parts=[root * part for root, part in zip(roots, plain, strict=True)],
        weights=weights,
        jacobian=weights[:, None] * jacobian[:, inside],
        blocks=np.concatenate(labels).astype(np.int64),
    )
