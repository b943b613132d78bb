"""How a run ended: a name for the files, a sentence for people saying what to try."""

from typing import Final

from thermobearing.core.types import (
    COMPLETED,
    EULER_UNSTABLE,
    NOT_CONVERGED,
    NOT_FINITE,
    SOFTENED,
    TEMPERATURE_RUNAWAY,
)

INTERRUPTED: Final = "interrupted"
NOT_PHYSICAL: Final = "not_physical"
PIER_BEYOND_LIMIT: Final = "pier_beyond_limit"

NAMES: Final = {
    COMPLETED: "completed",
    SOFTENED: "completed",
    NOT_CONVERGED: "layer_forces_not_converged",
    NOT_FINITE: "not_finite",
    EULER_UNSTABLE: "euler_unstable",
    TEMPERATURE_RUNAWAY: "temperature_runaway",
}

SENTENCES: Final = {
    "completed": "The analysis ran to its end.",
    "layer_forces_not_converged": (
        "No equal layer forces were found in a step. Try a smaller dt, or integrator exact."
    ),
    "not_finite": (
        "A force or temperature became infinite or undefined. Try a smaller dt and check the "
        "units of the bearing file."
    ),
    "euler_unstable": (
        "The explicit Euler integration of Z ran away. Try a smaller dt, or integrator exact."
    ),
    "temperature_runaway": (
        "A rubber layer left -273 to 400 degC (it decomposes) or the lead reached 327 degC (it "
        "melts): fewer cycles, a smaller amplitude or a slower motion. Check stiffness, plan and "
        "heat capacity for their units; with very stiff rubber, heat_source dissipation has this "
        "feedback while held."
    ),
    NOT_PHYSICAL: (
        "A bearing was strained beyond 500 % (it tears), a plate left -273 to 1500 degC, or the "
        "energy books do not close: no real bearing does that. Check stiffness, thicknesses, "
        "conductivities and temperature coefficients for their units, and try a smaller dt."
    ),
    INTERRUPTED: "The run was interrupted; what had been computed until then was kept.",
}

EQUAL_FORCES: Final = "equal_layer_forces"
SOFTENED_LAYERS: Final = "softened_layers"
SHARING_SENTENCES: Final = {
    EQUAL_FORCES: "All rubber layers carried the same force in every step.",
    SOFTENED_LAYERS: (
        "A layer's tangent stiffness was not safely positive in some steps (large strain in the "
        "cold, just after reversal): there the hardening factor was taken partly at the mean "
        "strain, and layer_force_mismatch_max_kN says how far the layer law was from the force."
    ),
}
