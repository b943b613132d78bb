"""The plain records that the compiled time integration reads and writes.

Units: kN, mm, s; mass in kN s2/mm, rotations in rad, moments in kN mm. `n` coordinates, `h`
hinges, `b` bearing lines.
"""

from typing import Final, NamedTuple

from thermobearing.core.types import Floats

# Columns of System.hinges.
INITIAL: Final = 0  # stiffness K_0 [kN mm/rad]
YIELD: Final = 1  # yield rotation [rad]
HARDENING: Final = 2  # stiffness beyond yield over K_0
UNLOADING: Final = 3  # exponent of the unloading stiffness, K_0 (theta_y/theta_max)^exponent

# Columns of a hinge state.
ROTATION: Final = 0
MOMENT: Final = 1
HIGHEST: Final = 2  # largest rotation so far, at least the yield rotation
LOWEST: Final = 3  # smallest, at most minus the yield rotation
TURNED_HIGH: Final = 4  # rotation and moment where it last turned back, above
TURNED_HIGH_MOMENT: Final = 5
TURNED_LOW: Final = 6  # below
TURNED_LOW_MOMENT: Final = 7
HINGE_STATE: Final = 8

# Columns of System.lines.
FORCE_FACTOR: Final = 0  # force in the structure over force of the modelled bearing
LENGTH_FACTOR: Final = 1  # displacement of the modelled bearing over that in the structure
SPEED: Final = 2  # of a bearing that lives on its own clock [mm/s]; 0: earthquake time

# Rows of Motion.vectors.
Q: Final = 0
V: Final = 1
A: Final = 2
RESTORING: Final = 3  # forces of springs, hinges and bearings on the coordinates
TRIAL: Final = 4
RESIDUAL: Final = 5
TRIAL_RESTORING: Final = 6
PREDICTED_V: Final = 7
PREDICTED_A: Final = 8
LOAD: Final = 9
COMMAND: Final = 10  # coordinates of the last command (predictor-corrector)
VECTORS: Final = 11

# Entries of Motion.books, energies since the start [kN mm].
CLOCK: Final = 0  # [s]
INPUT: Final = 1  # of the ground, on motion relative to it
KINETIC: Final = 2  # now
DAMPING: Final = 3
SPRINGS: Final = 4  # stored in linear springs now
HINGES: Final = 5  # work done on hinges, partly recoverable
BEARINGS: Final = 6  # work done on bearings, as the structure feels it
ITERATIONS: Final = 7
SUBSTEPS: Final = 8
MOTION_BOOKS: Final = 9

# Outcomes beside those of the coupled step (core/types.py).
NO_EQUILIBRIUM: Final = 20
DIVERGED: Final = 21


class System(NamedTuple):
    """A structure, without its bearings' insides."""

    mass: Floats  # [n, n]
    damping: Floats  # [n, n]
    stiffness: Floats  # [n, n] of the linear springs
    load: Floats  # [n] force on each coordinate per ground acceleration, with its sign
    hinge_rows: Floats  # [h, n] rotation of a hinge per coordinate
    hinges: Floats  # [h, 4]
    line_rows: Floats  # [b, n] stretch of a bearing line per coordinate
    lines: Floats  # [b, 3]


class Motion(NamedTuple):
    """Where the structure is, and scratch of the integration."""

    vectors: Floats  # [VECTORS, n]
    matrix: Floats  # [n, n] effective tangent, destroyed by the solution
    tangent: Floats  # [n, n]
    hinges: Floats  # [h, HINGE_STATE]
    trial_hinges: Floats  # [h, HINGE_STATE]
    stretches: Floats  # [b] of the bearing lines at the trial [mm]
    books: Floats  # [MOTION_BOOKS]


class Scheme(NamedTuple):
    """How time is integrated; scalars only."""

    beta: float
    gamma: float
    tolerance: float  # of the residual, over the largest inertia force
    iterations: int  # Newton steps before a step is cut in half
    halvings: int  # largest number of halvings
