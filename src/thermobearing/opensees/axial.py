"""The axial force of a served bearing, from the vertical displacement of its nodes.

Vertical stiffness, cavitation force and the stiffness that the axial force takes from the shear are
those of the last committed step, as in the lines of a structure: within a step, OpenSees meets a
law of the vertical displacement alone and a constant spring.
"""

import math
from typing import Any, Final, NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats, labels
from thermobearing.core.types import AxialResponse
from thermobearing.model.axial import axial_rows, column_of, tension_law
from thermobearing.model.element import BearingElement
from thermobearing.model.outcomes import CAVITATED, UNSTABLE, UPLIFT
from thermobearing.opensees.recording import layer_temperatures

SERVED_COLUMNS: Final = (  # of `AxialResponse`, that results of served bearings have
    "axial_force",
    "critical_load",
    "cavitation_force",
    "vertical_stiffness",
    "shortening",
    "stiffness_reduction",
    "lent",
    "axial_work",
    "axial_stored",
    "axial_mismatch",
)
SUMS: Final = ("lent", "axial_work", "axial_mismatch")  # over all steps
REDUCTIONS: Final = ("stiffness_reduction", "stiffness_reduction_y")  # along x, and across
# Outcomes, that which goes before others first.
WORST: Final = (UNSTABLE, UPLIFT, CAVITATED, "completed")


def axial_columns() -> dict[str, dict[str, str]]:
    """Return unit and meaning of the columns of results."""
    meanings = {
        name: {"units": unit, "long_name": text} for name, unit, text in labels(AxialResponse)
    }
    return {name: meanings[name] for name in SERVED_COLUMNS}


class AxialTrial(NamedTuple):
    """Response to a trial extension."""

    force: float  # [kN], positive in compression
    tangent: float  # of the tension by the extension [kN/mm]


class ServedColumn:
    """A bearing under the axial force of its nodes, from commit to commit.

    Attributes
    ----------
    row : what the axial force does to the bearing at the last commit; lent energies since the
        start.
    outcome : "unstable" once the axial force has exceeded the critical load, else "uplift" once the
        bearing has lifted by more than its dowels are long, else "cavitated" once the tension has
        exceeded the cavitation force, else "completed".
    """

    def __init__(
        self,
        bearing: Bearing,
        element: BearingElement,
        *,
        dowelled: bool = False,
        dowel_length: float | None = None,
    ) -> None:
        self._columns, self._element, self._dowelled = column_of(bearing), element, dowelled
        self._dowel_length = dowel_length or math.inf  # no uplift is a failure
        self._memory = 1.0  # largest extension so far, relative to that of cavitation
        self.outcome = "completed"
        # No axial force yet: the model is in equilibrium where its displacements are zero.
        self._points = [self._point(0.0)]
        self._rows = self._compute()
        self.row = self._rows[-1:].copy()

    @property
    def reduction(self) -> tuple[float, float]:
        """Stiffness that the axial force takes in the next step along x and y [kN/mm]."""
        row = self.row[0]
        return float(row["next_reduction"]), float(row["next_reduction_y"])

    def trial(self, extension: float) -> AxialTrial:
        """Return axial force and tangent at an extension [mm] of the next step."""
        stiffness = float(self.row["vertical_stiffness"][0])
        if self._dowelled:
            # Without a load yet, the model needs the stiffness in compression to take one.
            pressed = extension <= 0.0
            return AxialTrial(*((-stiffness * extension, stiffness) if pressed else (0.0, 0.0)))
        strength = float(self.row["cavitation_force"][0])
        pulled, tangent = tension_law(
            self._columns[0], extension, stiffness, strength, self._memory
        )
        return AxialTrial(-pulled, tangent)

    def commit(self, extension: float) -> None:
        """Accept the last trial, at an extension [mm], after the bearing has accepted its own."""
        force = self.trial(extension).force
        if not self._dowelled:
            stiffness, strength = self.row["vertical_stiffness"][0], self.row["cavitation_force"][0]
            self._memory = max(self._memory, float(extension * stiffness / strength))
        before = self.row
        self._points = [self._points[-1], self._point(force)]
        self._rows = self._compute()
        self.row = self._rows[-1:].copy()
        self.row["shortening"] = -extension
        self._set_works(before)
        for name in SUMS:
            self.row[name] += before[name]
        self.outcome = min(self.outcome, self._outcome(), key=WORST.index)

    def _set_works(self, before: Any) -> None:
        """Set the works of the last step, of forces and displacements at its ends.

        Trapezoidal, as all works of a structure: a model of mean acceleration then balances.
        """
        forces = before["axial_force"] + self.row["axial_force"]
        self.row["axial_work"] = 0.5 * forces * (self.row["shortening"] - before["shortening"])
        (start, _, _), (end, _, _) = self._points
        lent = 0.0
        for name, first, last in zip(REDUCTIONS, start, end, strict=False):
            taken = before[name][0] * first + self.row[name][0] * last
            lent += 0.5 * taken * (last - first)
        self.row["lent"] = lent

    def _outcome(self) -> str:
        """Return the outcome of the committed state alone."""
        if self.row["axial_force"][0] > self.row["critical_load"][0]:
            return UNSTABLE
        if -self.row["shortening"][0] > self._dowel_length:
            return UPLIFT
        # Damage begins where the extension exceeds that of cavitation.
        return CAVITATED if self._memory > 1.0 else "completed"

    def _point(self, force: float) -> tuple[Floats, float, Floats]:
        """Return displacement, axial force and layer temperatures of the committed state."""
        state = self._element.state
        displacement = np.ravel(state.response["displacement"]).copy()
        return displacement, force, layer_temperatures(self._element)

    def _compute(self) -> Any:
        """Return rows of the last committed steps, of which the second has kappa of the first."""
        displacement, force, rubber = (
            np.array(values) for values in zip(*self._points, strict=True)
        )
        return axial_rows(self._columns, self._element.constants, displacement, force, rubber)
