"""The layer law that meets the design curves of JRA rubbers: `python -m benchmarks.jra_compounds`.

Prints the four numbers of each that stand in data/compounds/jra-*.toml, and how far third cycles
without heating are from G_e and h_B of the curves. The shape s is held at that of shen-hdr: free,
it runs to its bound and the misfit stays as it is (rms 4.2 % both, G8).
"""

import math
from typing import Any, get_args

import numpy as np
from scipy.optimize import least_squares

from thermobearing.bearing.compound import load_compound
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.new import new_bearing
from thermobearing.bearing.scaling import extract_compound
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import isothermal_cycle
from thermobearing.design.sizing import (
    DesignRubber,
    Kind,
    damping_ratio,
    load_rubber,
    shear_modulus,
)

STRAINS = np.arange(0.5, 2.51, 0.25)
NAMES = ("G8", "G10", "G12")
START = (0.0, -1.0, math.log(0.3), math.log(0.1))
LOWEST, HIGHEST = (-3.0, -6.0, math.log(0.01), -9.0), (4.0, 4.0, math.log(2.0), 1.5)


def bearing_of_numbers(numbers: Floats) -> Bearing:
    """A bearing of the rubber; the numbers are without bounds: logarithms, alpha_0 as a logit."""
    template = load_compound("shen-hdr")
    values = {
        "shear_modulus": math.exp(numbers[0]),
        "post_yield_ratio": 1.0 / (1.0 + math.exp(-numbers[1])),
        "yield_strain": math.exp(numbers[2]),
        "hardening": math.exp(numbers[3]),
    }
    rubber = template.rubber.model_copy(update=values)
    compound = template.model_copy(update={"rubber": rubber})
    return new_bearing("trial", compound, plan="240x240mm", layers="6x5mm", shim="3.2mm")


def misfit(bearing: Bearing, rubber: DesignRubber) -> Floats:
    """G_e and h_B of the third cycles over those of the curves, less 1: a row a strain."""
    rows = []
    for strain in STRAINS:
        cycle = isothermal_cycle(bearing, float(strain))
        rows.append(
            (
                cycle.G_eq_MPa / shear_modulus(rubber, float(strain)) - 1.0,
                cycle.h_eq / damping_ratio(rubber, float(strain)) - 1.0,
            )
        )
    return np.array(rows)


def fitted(rubber: DesignRubber) -> Bearing:
    """The bearing whose rubber meets the curves best."""
    result: Any = least_squares(
        lambda numbers: misfit(bearing_of_numbers(numbers), rubber).ravel(),
        START,
        bounds=(LOWEST, HIGHEST),
        diff_step=1e-3,
    )
    return bearing_of_numbers(result.x)


def main() -> None:
    """All six."""
    for kind in get_args(Kind):
        for name in NAMES:
            rubber = load_rubber(name, kind)
            bearing = fitted(rubber)
            h, numbers = bearing.hysteresis, extract_compound(bearing).rubber
            errors = np.abs(misfit(bearing, rubber)).max(axis=0)
            print(
                f"{kind} {name}: shear_modulus {numbers.shear_modulus:.4g} "
                f"MPa, post_yield_ratio {h.post_yield_ratio:.4g}, yield_strain "
                f"{numbers.yield_strain:.4g}, hardening {h.hardening:.4g}; G_e within "
                f"{errors[0]:.1%}, h_B within {errors[1]:.1%}",
                flush=True,
            )


if __name__ == "__main__":
    main()
