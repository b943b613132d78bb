"""Share of 95 % bands that hold the truth, of parameters and of predictions in the cold.

Each fit is of three tests whose ambient temperatures are off, up or down by the same size; of
another bearing of the compound, with offsets of force and displacement. Bands of K_eq, Q_d and
energy at -20 degC, and of their factors to 23 degC, come from the draws that `identify --predict`
makes.
"""

from dataclasses import replace

import numpy as np

import thermobearing as tb
from benchmarks.identification import AMBIENTS, NAMES, intervals_cover_truth, true_value
from benchmarks.rows import Row
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.parameters import SHAPE, default_free, with_values
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.cycles import largest_measures
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.uncertainty.posterior import forecast

FITS = 60  # of each bearing and error
ERRORS = (0.0, 0.3, 1.0)  # of the ambient temperatures [K]
COLD, WARM = -20.0, 23.0  # [degC]
QUANTITIES = ("K_eq", "Q_d", "energy")
LEAST, MOST = 90.0, 98.0  # [%]


def calibrated(kind: str, kelvin: float, seed: int) -> tuple[Identification, tb.Bearing]:
    """A fit of three tests at ambient temperatures that are off, and the true bearing."""
    bearing = tb.load_bearing(NAMES[kind])
    wave = "sine" if bearing.lead else "triangular"
    test = tb.cyclic_test(strain=[0.5, 1.0, 1.5], cycles=5, rest=600.0, wave=wave)
    rng = np.random.default_rng(1000 + seed)
    values = {
        key: true_value(bearing, key) * rng.uniform(0.97 if key == SHAPE else 0.92, 1.03)
        for key in default_free(bearing, AMBIENTS)
    }
    truth, records = with_values(bearing, values), []
    for i, ambient in enumerate(AMBIENTS):
        offset = kelvin * float(rng.choice([-1.0, 1.0]))
        noise = float(rng.uniform(0.005, 0.01))
        record = synthetic_record(
            truth, ambient + offset, test, noise=noise, jitter=0.02, seed=10 * seed + i
        )
        # Offsets of the transducers, which a calibration has to tolerate.
        zero = rng.uniform(-0.01, 0.01) * record.peak_force
        x = record.displacement + rng.uniform(-0.3, 0.3)
        records.append(replace(record, ambient=ambient, force=record.force + zero, displacement=x))
    return identify_bearing(records, bearing, starts=1), truth


def bands_cover_truth(
    identification: Identification, truth: tb.Bearing, seed: int
) -> dict[str, bool]:
    """Whether the band of each prediction holds its truth."""
    test, values, draws = identification.records[0], {}, {}
    bands = forecast(identification, [COLD, WARM], seed=seed, narrow=False).bands
    for band in bands:
        run = ForwardModel(test, truth, fine=True, ambient=band.ambient).run(truth)
        assert run is not None
        values[band.ambient] = largest_measures(test, run.force)
        draws[band.ambient] = {item.quantity: item.draws for item in band.predicted}
    inside = {}
    for item in bands[0].predicted:
        if item.quantity not in QUANTITIES:
            continue
        true = values[COLD][item.quantity]
        inside[f"{item.quantity}(-20)"] = item.lower <= true <= item.upper
        factors = draws[COLD][item.quantity] / draws[WARM][item.quantity]
        low, high = np.quantile(factors, [0.025, 0.975])
        factor = true / values[WARM][item.quantity]
        inside[f"{item.quantity}(-20)/{item.quantity}(23)"] = bool(low <= factor <= high)
    return inside


def coverage_rows(kind: str, kelvin: float, fits: int) -> list[Row]:
    """Coverage of one bearing and one error of the ambient temperatures."""
    counts: dict[str, list[bool]] = {}
    for seed in range(fits):
        identification, truth = calibrated(kind, kelvin, seed)
        counts.setdefault("parameters", []).extend(intervals_cover_truth(identification, truth))
        for name, inside in bands_cover_truth(identification, truth, seed).items():
            counts.setdefault(name, []).append(inside)
    label = f"{kind}, ambient temperatures off by {kelvin:g} K, {fits} fits"
    target = f"{LEAST:g} to {MOST:g} %"
    rows = []
    for name, inside in counts.items():
        share = 100.0 * float(np.mean(inside))
        note = f"{sum(inside)} of {len(inside)}"
        met = None if fits < FITS else LEAST <= share <= MOST
        rows.append(Row(f"{label}: {name}", share, "%", target, met, note))
    return rows


def rows(fits: int = FITS) -> list[Row]:
    """All bearings and errors; some 80 minutes of CPU time with 60 fits each."""
    return [row for kind in NAMES for kelvin in ERRORS for row in coverage_rows(kind, kelvin, fits)]
