"""The least-squares problem of a calibration and its linearisation.

Residuals of neighbouring samples are correlated (filters, and above all model error), so the
textbook covariance sigma^2 (J^T J)^-1 is far too small. Gradients are summed over half
cycles, which are taken to be independent (cluster-robust "sandwich"; Huber 1967, White
1980): (J^T J)^-1 (sum g_b g_b^T) (J^T J)^-1 with B/(B - p) for few blocks. The textbook
value is kept as a floor.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats, Ints
from thermobearing.identify.fit.forward import ForwardModel, Prediction
from thermobearing.identify.fit.parameters import ParameterSet
from thermobearing.identify.records.cycles import full_cycles, turning_points
from thermobearing.identify.records.record import TestRecord

LOST = 2.0  # residual if the model does not complete the test: twice the largest force
KELVIN = 5.0  # an error of a temperature of this size counts as ...
KELVIN_AS = 0.05  # ... an error of the force of this part of the largest
ROBUST_SCALE = 0.02  # of the largest force: beyond it a robust loss bends
STEP = 1e-3  # of the unit cube, for finite differences: the law is not smooth below ~1e-5
UNIFORM = 12.0  # inverse of the variance of a uniform distribution between 0 and 1
AT_BOUND = 2e-3  # of the range: nearer to a bound than this is at it
BLOCK_TURN = 0.05  # of the largest displacement: half cycles larger than this are blocks


class Problem:
    """Least squares between records and model over the unit cube of the free parameters.

    `clipped` contains for each record the samples without weight, `coarse` the models with coarse
    steps if they exist already. `loss` sets the weights of outliers in the uncertainty.
    """

    def __init__(
        self,
        records: Sequence[TestRecord],
        pset: ParameterSet,
        *,
        temperatures: bool = False,
        loss: str = "linear",
        clipped: Sequence[NDArray[np.bool_]] | None = None,
        coarse: Sequence[ForwardModel] | None = None,
    ) -> None:
        self.records = list(records)
        self.pset = pset
        self.coarse = list(coarse or [ForwardModel(record, pset.base) for record in self.records])
        self.fine = [ForwardModel(record, pset.base, fine=True) for record in self.records]
        self.temperatures = temperatures
        self.loss = loss
        self.evaluations = 0
        self._last: tuple[tuple[bytes, bool], list[Floats]] | None = None
        self.history: list[tuple[int, float]] = []
        self.weights = [_sample_weights(record) for record in self.records]
        for weight, bad in zip(self.weights, clipped or [], strict=False):
            weight[bad] = 0.0

    def with_parameters(self, pset: ParameterSet) -> "Problem":
        """Return the problem of the same tests and models with other free parameters."""
        problem = copy(self)
        problem.pset, problem._last, problem.history = pset, None, list(self.history)
        return problem

    def predict(self, cube: Floats, *, fine: bool = True) -> list[Prediction | None]:
        """Run the model through all records; None where it ends early."""
        bearing = self.pset.bearing(cube)
        self.evaluations += 1
        return [model.run(bearing) for model in (self.fine if fine else self.coarse)]

    def parts(self, cube: Floats, *, fine: bool = False) -> list[Floats]:
        """Return the weighted residuals of each record, relative to its largest force."""
        key = (cube.tobytes(), fine)
        # Search and gradient ask for the same point one after the other.
        if self._last is None or self._last[0] != key:
            residuals = []
            runs = self.predict(cube, fine=fine)
            for record, weight, run in zip(self.records, self.weights, runs, strict=True):
                if run is None:
                    extra = len(record.temperatures) if self.temperatures else 0
                    residuals.append(np.full(len(record.time) * (1 + extra), LOST))
                else:
                    residuals.append(self._weighted(record, weight, run))
            self._last = (key, residuals)
        return self._last[1]

    def _weighted(self, record: TestRecord, weight: Floats, predicted: Prediction) -> Floats:
        error = (predicted.force - record.force) / record.peak_force
        # A zero of the force that is off is no misfit of the bearing: the mean does not count.
        # The summand keeps a record whose weights are all zero from dividing by zero.
        rows = [weight * (error - np.average(error, weights=weight**2 + 1e-300))]
        if self.temperatures:
            for title, measured in record.temperatures.items():
                # A missing reading is no misfit.
                error = np.nan_to_num(predicted.temperatures[title] - measured)
                rows.append(np.sqrt(record.weight) * KELVIN_AS / KELVIN * error)
        return np.concatenate(rows)

    def data(self) -> list[Floats]:
        """Return what the responses of each record are compared with, weighted as the residuals.

        The residuals are linear in the prediction: these are minus those of a prediction of zero.
        """
        values = []
        for record, weight in zip(self.records, self.weights, strict=True):
            temperatures = {title: np.zeros_like(v) for title, v in record.temperatures.items()}
            zero = Prediction(np.zeros_like(record.force), temperatures)
            values.append(-self._weighted(record, weight, zero))
        return values

    def split_parts(
        self,
        bearing: Bearing,
        moved: Sequence[TestRecord],
        *,
        fine: bool = True,
        delay: float = 0.0,
    ) -> list[Floats] | None:
        """Return the weighted residuals of another bearing in tests with other signals.

        `moved` are the records with other forces, displacements or ambient temperatures; `delay` is
        that of the force of the model [s]. None if the model ends early.
        """
        residuals = []
        for record, weight in zip(moved, self.weights, strict=True):
            predicted = ForwardModel(record, bearing, fine=fine).run(bearing)
            if predicted is None:
                return None
            if delay:
                force = np.interp(record.time - delay, record.time, predicted.force)
                predicted = replace(predicted, force=force)
            residuals.append(self._weighted(record, weight, predicted))
        return residuals

    def residuals(self, cube: Floats, *, fine: bool = False) -> Floats:
        """Return all residuals in one vector, and record progress."""
        vector = np.concatenate(self.parts(cube, fine=fine))
        cost = float(np.mean(vector**2))
        if not self.history or cost < self.history[-1][1]:
            self.history.append((self.evaluations, cost))
        return vector

    def cost(self, cube: Floats) -> float:
        """Return the mean of the squared residuals, with coarse steps."""
        return float(np.mean(self.residuals(np.asarray(cube)) ** 2))

    def jacobian(self, cube: Floats, *, fine: bool = False, central: bool = False) -> Floats:
        """Return finite differences [residual, parameter], one-sided at the faces of the cube."""
        cube = np.asarray(cube, dtype=float)
        centre = None if central else np.concatenate(self.parts(cube, fine=fine))
        columns = []
        for i in range(len(cube)):
            up, down = cube.copy(), cube.copy()
            # At a face of the cube the step stays inside: the law may end at a bound.
            up[i] = min(cube[i] + STEP, 1.0)
            down[i] = max(cube[i] - STEP, 0.0)
            high, low, base = np.concatenate(self.parts(up, fine=fine)), centre, cube[i]
            # Backward where a forward step has no room, and as the second half of a central one.
            if low is None or up[i] - base <= 0.5 * STEP:
                low, base = np.concatenate(self.parts(down, fine=fine)), down[i]
            columns.append((high - low) / (up[i] - base))
        return np.column_stack(columns)


def _robust_weights(residuals: Floats, loss: str) -> Floats:
    """Return the weight that each residual keeps under a robust loss of scipy: d rho / d z."""
    z = (residuals / ROBUST_SCALE) ** 2
    if loss == "soft_l1":
        return np.asarray(1.0 / np.sqrt(1.0 + z))
    if loss == "huber":
        return np.asarray(1.0 / np.sqrt(np.maximum(z, 1.0)))
    return np.asarray(1.0 / (1.0 + z)) if loss == "cauchy" else np.ones_like(z)


def _sample_weights(record: TestRecord) -> Floats:
    """Return the square roots of the weights of the samples of a record."""
    weights = np.full(len(record.time), np.sqrt(record.weight))
    for cycle in full_cycles(record):
        part = slice(cycle.first, cycle.last)
        # Forces relative to the peak of their own cycle: otherwise small cycles, whose residuals
        # are small, would have no effect next to large ones.
        if record.cycle_balance > 0.0:
            peak = float(np.abs(record.force[part]).max())
            weights[part] *= (record.peak_force / peak) ** record.cycle_balance
        if cycle.number == 1 and not cycle.closing:
            weights[part] *= np.sqrt(record.first_cycle_weight)
    return weights


def half_cycles(record: TestRecord) -> Ints:
    """Return the number of the half cycle of each sample, cut half-way between reversals.

    Not at the reversals: there the gradients of stiffness, d_y and s change sign at once, and noise
    that is correlated across them cancels, which sums cut there would miss.
    """
    turns = turning_points(record.displacement, BLOCK_TURN * record.peak_displacement)
    middles = (turns[:-1] + turns[1:]) // 2
    return np.searchsorted(middles, np.arange(len(record.time)), side="right").astype(np.int64)


@dataclass(frozen=True)
class Linear:
    """Residuals and their derivatives at the optimum, with the weights of the loss."""

    parts: list[Floats]  # weighted residuals of each record
    weights: Floats  # square root of the weight that the loss leaves to each residual
    jacobian: Floats  # [residual, parameter] by the place in the unit cube
    blocks: Ints  # number of the block of each residual, over all records
    # Inverse of the prior variance of each parameter: that of a uniform distribution between the
    # bounds where it ended at one or the tests do not see it, else zero.
    prior: Floats | None = None

    @cached_property
    def residuals(self) -> Floats:
        """Residuals of all records."""
        return np.concatenate(self.parts)

    @property
    def variance(self) -> float:
        """Variance of the residuals, with the degrees of freedom of the fit."""
        n, p = self.jacobian.shape
        r = self.residuals
        return float(r @ r / max(n - p, 1))

    @property
    def _ridge(self) -> Floats:
        """Information of the prior, in the unit of J^T J."""
        if self.prior is None:
            return np.zeros(self.jacobian.shape[1])
        return self.prior * self.variance

    @cached_property
    def _scaled(self) -> tuple[Floats, Floats, Floats]:
        """Lengths of the columns of J, J in columns of length one, and (J^T J)^-1 of these.

        A prior counts as one more row of J for each parameter.
        """
        ridge = self._ridge
        length = np.sqrt(np.linalg.norm(self.jacobian, axis=0) ** 2 + ridge)
        scale = np.maximum(length, 1e-12)
        J = self.jacobian / scale
        return scale, J, np.linalg.pinv(J.T @ J + np.diag(ridge / scale**2), rcond=1e-12)

    def solved(self, columns: Floats) -> Floats:
        """Return (J^T J)^-1 J^T times columns."""
        scale, J, bread = self._scaled
        return np.asarray((bread @ (J.T @ columns)) / scale.reshape(-1, *[1] * (columns.ndim - 1)))

    def meat(self, columns: Floats, residuals: Floats | None = None) -> Floats:
        """Return the sum over the blocks of the outer products of their gradients."""
        products = columns * (self.residuals if residuals is None else residuals)[:, None]
        g = np.zeros((int(self.blocks.max()) + 1, columns.shape[1]))
        np.add.at(g, self.blocks, products)
        count = len(g)
        return np.asarray(g.T @ g * count / max(count - self.jacobian.shape[1], 1))

    def covariance(self) -> Floats:
        """Return the covariance of the parameters by the tests alone, in the unit cube."""
        scale, J, bread = self._scaled
        classical = bread * self.variance
        sandwich = bread @ (self.meat(J) + np.diag(self._ridge / scale**2) * self.variance) @ bread
        # With few blocks the sandwich may be too small by chance: no error is less than the
        # textbook's. Factors on rows and columns keep the correlations.
        variances = np.maximum(np.diag(sandwich), 1e-300)
        factors = np.sqrt(np.maximum(1.0, np.diag(classical) / variances))
        return np.asarray(sandwich * np.outer(factors, factors) / np.outer(scale, scale))


def linearise(problem: Problem, cube: Floats, *, fine: bool = True) -> Linear:
    """Linearise a problem at a point of the unit cube."""
    plain = problem.parts(cube, fine=fine)
    roots = [np.sqrt(_robust_weights(part, problem.loss)) for part in plain]
    jacobian = problem.jacobian(cube, fine=fine, central=fine)
    weights = np.concatenate(roots)
    # Of a parameter at its bound, or one without effect, the tests say nothing: it has the
    # variance of a uniform distribution, or J^T J would be singular.
    unseen = (cube <= AT_BOUND) | (cube >= 1.0 - AT_BOUND) | ~jacobian.any(axis=0)
    labels, first = [], 0
    for record, part in zip(problem.records, plain, strict=True):
        # Thermocouples repeat the blocks of the force: residuals of one half cycle belong together.
        blocks = np.unique(half_cycles(record), return_inverse=True)[1]
        labels.append(first + np.resize(blocks, len(part)))
        first += int(blocks.max()) + 1
    return Linear(
        parts=[root * part for root, part in zip(roots, plain, strict=True)],
        weights=weights,
        jacobian=weights[:, None] * jacobian,
        blocks=np.concatenate(labels).astype(np.int64),
        prior=np.where(unseen, UNIFORM, 0.0),
    )
