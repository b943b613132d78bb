"""The residuals of a fit: force, and temperatures if wanted, weighted, at all samples."""

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing
from thermobearing.identify.cycles import cycles_of
from thermobearing.identify.forward import ForwardModel, Prediction
from thermobearing.identify.parameters import ParameterSet
from thermobearing.identify.record import TestRecord

Floats = NDArray[np.float64]

LOST = 2.0  # residual where the model does not get through: twice the largest force
KELVIN = 5.0  # a temperature that is off by this counts as ...
KELVIN_AS = 0.05  # ... a force that is off by this part of the largest
ROBUST_SCALE = 0.02  # of the largest force: beyond it a robust loss bends
STEP = 1e-3  # of the unit cube, for finite differences: the law is not smooth below ~1e-5


class Problem:
    """Least squares between records and model over the unit cube of the free parameters.

    Parameters
    ----------
    records : tests of one bearing.
    pset : what is free.
    temperatures : count thermocouples too.
    loss : of the fit, for the weights that its outliers keep in the uncertainty.
    clipped : by record, samples that do not count (a saturated force).
    coarse : the model with coarse steps by record, where it was made already.

    Examples
    --------
    >>> import thermobearing as tb
    >>> from thermobearing.identify.parameters import parameter_set
    >>> bearing = tb.load_bearing("shen-hdr-specimen")
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None)
    >>> record = tb.identify.synthetic_record(bearing, 23.0, test, noise=0.0)
    >>> pset = parameter_set(bearing, ["K_r"], [23.0])
    >>> problem = Problem([record], pset)
    >>> problem.cost(pset.start) < problem.cost(pset.start + 0.1)
    True
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
        self.weights = [sample_weights(record) for record in self.records]
        for weight, bad in zip(self.weights, clipped or [], strict=False):
            weight[bad] = 0.0

    def with_parameters(self, pset: ParameterSet) -> "Problem":
        """The same tests and models with other free parameters.

        Parameters
        ----------
        pset : of a bearing of the same geometry and materials.

        Returns
        -------
        Problem : which has counted the same evaluations.
        """
        other = copy(self)
        other.pset, other._last, other.history = pset, None, list(self.history)
        return other

    def predict(self, cube: Floats, *, fine: bool = True) -> list[Prediction | None]:
        """The model at the samples of all records.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.
        fine : a step of the model at every sample.

        Returns
        -------
        list : None for a record that the model does not get through.
        """
        bearing = self.pset.bearing(cube)
        self.evaluations += 1
        return [model.run(bearing) for model in (self.fine if fine else self.coarse)]

    def parts(self, cube: Floats, *, fine: bool = False) -> list[Floats]:
        """Weighted residuals of each record, relative to its largest force.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.
        fine : a step of the model at every sample.

        Returns
        -------
        list of ndarray
        """
        key = (cube.tobytes(), fine)
        if self._last is None or self._last[0] != key:
            self._last = (key, self._parts(cube, fine=fine))
        return self._last[1]

    def _parts(self, cube: Floats, *, fine: bool) -> list[Floats]:
        found = []
        predictions = self.predict(cube, fine=fine)
        for record, weight, predicted in zip(self.records, self.weights, predictions, strict=True):
            if predicted is None:
                extra = len(record.temperatures) if self.temperatures else 0
                found.append(np.full(len(record.time) * (1 + extra), LOST))
            else:
                found.append(self._weighted(record, weight, predicted))
        return found

    def _weighted(self, record: TestRecord, weight: Floats, predicted: Prediction) -> Floats:
        off = (predicted.force - record.force) / record.peak_force
        rows = [weight * (off - np.average(off, weights=weight**2 + 1e-300))]
        if self.temperatures:
            for title, measured in record.temperatures.items():
                off = predicted.temperatures[title] - measured
                rows.append(np.sqrt(record.weight) * KELVIN_AS / KELVIN * off)
        return np.concatenate(rows)

    def parts_of(
        self, bearing: Bearing, moved: Sequence[TestRecord], *, fine: bool = True
    ) -> list[Floats] | None:
        """Return the weighted residuals of another bearing in tests that were done otherwise.

        Parameters
        ----------
        bearing : of the same layers; its materials may differ too.
        moved : the records with other forces, displacements or ambient temperatures.
        fine : a step of the model at every sample.

        Returns
        -------
        list of ndarray, one for each record, or None where the model fails.
        """
        found = []
        for other, weight in zip(moved, self.weights, strict=True):
            predicted = ForwardModel(other, bearing, fine=fine).run(bearing)
            if predicted is None:
                return None
            found.append(self._weighted(other, weight, predicted))
        return found

    def residuals(self, cube: Floats, *, fine: bool = False) -> Floats:
        """All residuals in one vector.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.
        fine : a step of the model at every sample.

        Returns
        -------
        ndarray
        """
        vector = np.concatenate(self.parts(cube, fine=fine))
        cost = float(np.mean(vector**2))
        if not self.history or cost < self.history[-1][1]:
            self.history.append((self.evaluations, cost))
        return vector

    def cost(self, cube: Floats) -> float:
        """Mean of the squared residuals, coarse steps.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.

        Returns
        -------
        float : >= 0
        """
        return float(np.mean(self.residuals(np.asarray(cube)) ** 2))

    def jacobian(self, cube: Floats, *, fine: bool = False, central: bool = False) -> Floats:
        """Finite differences in the unit cube, turned inwards at its faces.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.
        fine : a step of the model at every sample.
        central : differences to both sides where there is room.

        Returns
        -------
        ndarray : residuals by parameters.
        """
        cube = np.asarray(cube, dtype=float)
        here = None if central else np.concatenate(self.parts(cube, fine=fine))
        columns = []
        for i in range(len(cube)):
            up, down = cube.copy(), cube.copy()
            up[i] = min(cube[i] + STEP, 1.0)
            down[i] = max(cube[i] - STEP, 0.0)
            if here is not None and up[i] - cube[i] > 0.5 * STEP:
                low, base = here, cube[i]
                high = np.concatenate(self.parts(up, fine=fine))
                columns.append((high - low) / (up[i] - base))
                continue
            high = np.concatenate(self.parts(up, fine=fine))
            low = np.concatenate(self.parts(down, fine=fine))
            columns.append((high - low) / (up[i] - down[i]))
        return np.column_stack(columns)


def robust_weights(residuals: Floats, loss: str) -> Floats:
    """Weight that each residual keeps under a robust loss of scipy: d rho / d z.

    Parameters
    ----------
    residuals : relative to the largest force.
    loss : "linear", "soft_l1", "huber" or "cauchy".

    Returns
    -------
    ndarray : in (0, 1].

    Examples
    --------
    >>> robust_weights(np.array([0.0, 0.02]), "cauchy").tolist()
    [1.0, 0.5]
    """
    z = (residuals / ROBUST_SCALE) ** 2
    if loss == "soft_l1":
        return np.asarray(1.0 / np.sqrt(1.0 + z))
    if loss == "huber":
        return np.asarray(1.0 / np.sqrt(np.maximum(z, 1.0)))
    return np.asarray(1.0 / (1.0 + z)) if loss == "cauchy" else np.ones_like(z)


def sample_weights(record: TestRecord) -> Floats:
    """Square roots of weights of the samples of a record.

    Parameters
    ----------
    record : with its weight, that of first cycles, and its balance of cycles.

    Returns
    -------
    ndarray : one for each sample, >= 0.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> record = record_from_arrays(t, np.sin(np.pi * t), np.sin(np.pi * t), 23.0)
    >>> float(sample_weights(replace(record, weight=4.0)).max())
    2.0
    """
    weights = np.full(len(record.time), np.sqrt(record.weight))
    if record.cycle_balance > 0.0:
        for cycle in cycles_of(record):
            part = slice(cycle.first, cycle.last)
            peak = float(np.abs(record.force[part]).max())
            weights[part] *= (record.peak_force / peak) ** record.cycle_balance
    if record.first_cycle_weight != 1.0:
        for cycle in cycles_of(record):
            if cycle.number == 1 and not cycle.closing:
                weights[cycle.first : cycle.last] *= np.sqrt(record.first_cycle_weight)
    return weights
