"""Synthetic tests: to plan a test programme, and to verify calibrations."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.schema import check_seed
from thermobearing.core.records import Floats
from thermobearing.cyclic.protocol import CyclicTest, Wave, cyclic_test
from thermobearing.identify.fit.parameters import available, with_values
from thermobearing.identify.records.cycles import full_cycles
from thermobearing.identify.records.record import TestRecord, record_from_arrays


@checked
def synthetic_record(
    bearing: Bearing | str | Path,
    ambient: float,
    test: CyclicTest | None = None,
    *,
    noise: float = 0.02,
    memory: float = 0.0,
    sampling: float = 50.0,
    first_cycle: float = 1.0,
    jitter: float = 0.0,
    through_rests: bool = False,
    seed: int = 0,
) -> TestRecord:
    """Create a test record from the model, with noise, as a laboratory would measure it.

    Parameters
    ----------
    bearing : the bearing that is "tested": a Bearing, a library name, or a TOML file.
    ambient : [degC].
    test : the loading; Table 3.4 by default (sine waves for bearings with lead).
    noise : standard deviation of the force, relative to its peak, 0 to 10.
    memory : correlation of the noise from sample to sample, in [0, 1); 0 is white.
    sampling : [Hz], 1e-6 to 1e6; ends of legs are recorded too.
    first_cycle : factor on the force of the first cycle of each amplitude, 0.1 to 10: an
        intentional model error, similar to scragging.
    jitter : standard deviation of the noise of the displacement [mm], 0 to 10.
    through_rests : record samples during rests too.
    seed : of the noise.

    Raises
    ------
    InputError : a number out of range, or the simulation ended early.

    Examples
    --------
    >>> short = cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> synthetic_record("shen-hdr-specimen", 23.0, short).name
    'synthetic at 23 degC'
    """
    from thermobearing.cyclic.run import run

    if not 0.0 <= memory < 1.0:
        raise InputError(f"memory = {memory}: must be at least 0 and less than 1")
    for name, value, low, high, unit in (
        ("noise", noise, 0.0, 10.0, ""),
        ("sampling", sampling, 1e-6, 1e6, " Hz"),
        ("first_cycle", first_cycle, 0.1, 10.0, ""),
        ("jitter", jitter, 0.0, 10.0, " mm"),
    ):
        if not low <= value <= high:
            raise InputError(f"{name} = {value}: must be {low:g} to {high:g}{unit}")
    bearing = as_bearing(bearing)
    wave: Wave = "triangular" if bearing.lead is None else "sine"
    result = run(bearing, test or cyclic_test(wave=wave), ambient=ambient, keep=[])
    if result.outcome != "completed":
        raise InputError(f"the simulated test ended early: {result.outcome}")
    time = result.time(0)
    x, force = (np.asarray(result[name].values[0]) for name in ("displacement", "force"))
    if through_rests:
        clock = np.arange(time[0], time[-1], 1.0 / sampling)
        time, x, force = clock, np.interp(clock, time, x), np.interp(clock, time, force)
    recorded = _logged(time, x, sampling)
    name = f"synthetic at {ambient:g} degC"
    record = record_from_arrays(time[recorded], x[recorded], force[recorded], ambient, name=name)
    force = record.force.copy()
    for cycle in full_cycles(record):
        if cycle.number == 1 and not cycle.closing:
            force[cycle.first : cycle.last + 1] *= first_cycle
    check_seed(seed)
    rng = np.random.default_rng(seed)
    white = rng.normal(size=len(force))
    # An autoregressive process of first order; the factor keeps the variance at one.
    for i in range(1, len(white) if memory else 0):
        white[i] = memory * white[i - 1] + np.sqrt(1.0 - memory**2) * white[i]
    noisy = force + noise * record.peak_force * white
    moved = record.displacement
    if jitter:
        moved = moved + jitter * rng.normal(size=len(force))
    return record_from_arrays(record.time, moved, noisy, ambient, name=name)


def _logged(time: Floats, x: Floats, sampling: float) -> NDArray[np.bool_]:
    """Return the steps that a logger records: every n-th while moving, reversals, and rests."""
    gaps = np.diff(time, prepend=time[0])
    usual_gap = float(np.median(gaps[1:]))
    stride = max(1, round(1.0 / (sampling * usual_gap)))
    recorded = np.arange(len(time)) % stride == 0
    pause = gaps > 1.5 * usual_gap
    recorded |= pause
    recorded[:-1] |= pause[1:]
    # Reversals between two logged samples would make the loops smaller than those of the model.
    recorded[1:-1] |= (x[1:-1] - x[:-2]) * (x[2:] - x[1:-1]) < 0.0
    recorded[-1] = True
    return np.asarray(recorded)


def generic_start(bearing: Bearing | str | Path) -> Bearing:
    """Return a bearing with parameters that belong to no bearing, to start a calibration from."""
    bearing = as_bearing(bearing)
    values = {k.key: k.generic for k in available(bearing) if k.generic is not None}
    return with_values(bearing, values)
