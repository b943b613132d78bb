"""The same bearing at another size: what heating does, and why specimens do not tell (7.2)."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import resized
from thermobearing.border.errors import InputError
from thermobearing.border.numbers import is_number
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run

SPECIMEN = 1.0 / 6.0
STRAIN, PERIOD, COUNT, REST = 1.75, 2.0, 5, 3600.0  # of the study; s


def scaled_bearing(bearing: Bearing | str | Path, factor: float) -> Bearing:
    """A bearing with all lengths times a factor, of the same compound.

    Under the same strain history in the same time, forces go with the factor squared and
    displacements with the factor (bearing/scaling.py); stresses, strains and coefficients stay. The
    new bearing has at least as many heat cells as a file without the table `cells`.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    factor : in [0.001, 1000]; 1/6 makes the source's specimen of its prototype.

    Returns
    -------
    Bearing

    Raises
    ------
    InputError : the factor is not between 0.001 and 1000.

    Examples
    --------
    >>> small = scaled_bearing("shen-hdr-bridge", 0.5)
    >>> small.total_rubber_thickness, small.area
    (51.0, 57600.0)
    """
    if not is_number(factor) or not 1e-3 <= factor <= 1e3:
        raise InputError(f"factor = {factor!r}: must be a number from 0.001 to 1000")
    bearing = as_bearing(bearing)
    g = bearing.geometry
    lengths = ("length", "width", "side", "diameter")
    plan = g.plan.model_copy(
        update={name: factor * getattr(g.plan, name) for name in lengths if hasattr(g.plan, name)}
    )
    thick = ("rubber_thickness", "shim_thickness", "sealing_plate_thickness", "end_plate_thickness")
    geometry = g.model_copy(
        update={"plan": plan} | {name: factor * getattr(g, name) for name in thick}
    )
    core = factor * bearing.lead.diameter if bearing.lead is not None else None
    return resized(bearing, geometry, core).model_copy(
        update={
            "name": f"{bearing.name}-x{factor:.4g}",
            "description": f"{bearing.name} with all lengths times {factor:.4g}",
            "cells": bearing.cells.enough(),
        }
    )


def scale_study(
    bearing: Bearing | str | Path,
    factors: Sequence[float] = (SPECIMEN, 1.0),
    ambient: float = -20.0,
    **options: Any,
) -> tuple[pd.DataFrame, dict[float, Result]]:
    """The same strain history at several sizes: five 2 s cycles of 175 %, then an hour of rest.

    Parameters
    ----------
    bearing : at full size: a Bearing, a library name, or a TOML file.
    factors : lengths over those of the full size, each in [0.001, 1000].
    ambient : temperature [degC], in [-100, 100].
    options : of `run`.

    Returns
    -------
    DataFrame : per factor: rise of outer and inner layer and of the lead at the end of loading and
        after one and ten minutes of rest [K], stress of cycle 5 over cycle 1.
    dict : the results by factor.

    Examples
    --------
    >>> table, _ = scale_study("shen-hdr-bridge")
    >>> small, full = table["inner_after_10_min_K"]
    >>> bool(small < 0.3 * full)
    True
    """
    bearing = as_bearing(bearing)
    cycles = {"step": "cycles", "strain": STRAIN, "wave": "sine", "period": PERIOD, "count": COUNT}
    test = CyclicTest(dt=0.005, steps=[cycles, {"step": "rest", "duration": REST}])
    results = {
        float(factor): run(scaled_bearing(bearing, factor), test, ambient, **options)
        for factor in factors
    }
    rows = []
    end = PERIOD * COUNT
    for factor, result in results.items():
        time = result.time(0)
        rows.append({"factor": factor, "total_rubber_mm": factor * bearing.total_rubber_thickness})
        for name, later in (("at_end", 0.0), ("after_1_min", 60.0), ("after_10_min", 600.0)):
            row = int(time.searchsorted(end + later - 1e-6))
            layers = result["rubber_temperature"].values[0, row] - ambient
            rows[-1] |= {f"outer_{name}_K": float(layers[0]), f"inner_{name}_K": float(layers[-1])}
            if result.has_lead:
                lead = float(result["lead_temperature"].values[0, row]) - ambient
                rows[-1][f"lead_{name}_K"] = lead
        stress = result.cycles["stress_max_MPa"].to_numpy()
        rows[-1]["stress_cycle_5_over_1"] = float(stress[-1] / stress[0])
    return pd.DataFrame(rows), results
