"""Parameters from tests: recovery, time, coverage, model error, methods at the same budget."""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import thermobearing as tb
from benchmarks.rows import Row, at_least, at_most, plain
from reproduction.krill_herd import krill_herd, krill_herd_search
from thermobearing.identify.fit.parameters import default_free, with_values
from thermobearing.identify.fit.synthetic import generic_start, synthetic_record
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.uncertainty.covariance import _assumed_groups
from thermobearing.identify.uncertainty.groups import chosen_groups, shift

Floats = NDArray[np.float64]

AMBIENTS = (-20.0, 0.0, 23.0)  # [degC]
SEEDS, PROBLEMS, FILES = 10, 80, 20
BUDGET = 1000  # evaluations of each method in the table
MEMORY = 0.8  # of the correlated noise
LIMITS = {"HDR": 15.0, "LHDR": 40.0}  # [s], three tests on two cores
LOGGED = {"HDR": 40, "LHDR": 12, "LRB": 20}  # problems with a logger that runs through rests
NAMES = {"HDR": "shen-hdr-specimen", "LHDR": "shen-lhdr-specimen", "LRB": "lrb-example"}


def tests_of(bearing: tb.Bearing, seed: int, **options: float) -> list[TestRecord]:
    """Table 3.4 at three temperatures with 2 % of noise."""
    return [
        synthetic_record(bearing, ambient, seed=10 * seed + i, **options)  # type: ignore[arg-type]
        for i, ambient in enumerate(AMBIENTS)
    ]


def true_value(bearing: tb.Bearing, key: str) -> float:
    """A number of a bearing by dotted key."""
    table, name = key.split(".")
    return float(getattr(getattr(bearing, table), name))


def recovery(kind: str) -> list[Row]:
    """Ten seeds from a generic start."""
    truth = tb.load_bearing(NAMES[kind])
    tests_of(truth, 0)
    errors, scores, r2, seconds, beyond, well = [], [], [], [], 0, set()
    for seed in range(SEEDS):
        records = tests_of(truth, seed)
        begin = time.perf_counter()
        identification = identify_bearing(records, generic_start(truth), seed=seed)
        seconds.append(time.perf_counter() - begin)
        r2 += [fit.R2 for fit in identification.fits]
        for key, item in identification.uncertainty.estimates.items():
            error = abs(item.value - true_value(truth, key))
            if item.well_determined:
                well.add(item.parameter.kind.symbol)
                errors.append(error / abs(true_value(truth, key)))
                scores.append(error / item.stderr)
                beyond += error > 3.0 * item.stderr
    label = f"{kind}, 3 x 25 cycles, {SEEDS} seeds"
    note = f"of {len(scores)} values, {beyond} beyond 3 standard errors; " + " ".join(sorted(well))
    median = f"median {np.median(seconds):.1f} s"
    return [
        at_most(f"{label}: largest error, well determined", 100.0 * max(errors), 3.0, "%"),
        at_most(f"{label}: largest error in standard errors", max(scores), 3.0, note=note),
        at_least(f"{label}: smallest R2", min(r2), 0.99),
        at_most(f"{label}: longest time", max(seconds), LIMITS[kind], "s", median),
    ]


def intervals_cover_truth(identification: Identification, truth: tb.Bearing) -> list[bool]:
    """Whether each 95 % interval of a fit holds the truth."""
    items = identification.uncertainty.estimates.items()
    return [item.lower <= true_value(truth, key) <= item.upper for key, item in items]


def coverage(memory: float) -> Row:
    """Share of 95 % intervals that hold the truth, over eighty problems."""
    truth = tb.load_bearing(NAMES["HDR"])
    inside = []
    for seed in range(PROBLEMS):
        identification = identify_bearing(
            tests_of(truth, 100 + seed, memory=memory), truth, starts=1
        )
        inside += intervals_cover_truth(identification, truth)
    share = 100.0 * float(np.mean(inside))
    kind = f"noise of correlation {memory:g}" if memory else "white noise"
    label = f"95 % intervals that hold the truth, {PROBLEMS} HDR problems, {kind}"
    return Row(label, share, "%", "85 to 99 %", 85.0 <= share <= 99.0)


def logged(kind: str) -> Row:
    """Coverage with a logger of 20 Hz that runs through rests, and jitter of 0.02 mm."""
    truth = tb.load_bearing(NAMES[kind])
    test = tb.cyclic_test(
        strain=[0.5, 1.5, 2.5], cycles=3, rest=600.0, wave="sine" if truth.lead else "triangular"
    )
    inside, r2 = [], []
    for seed in range(LOGGED[kind]):
        records = [
            synthetic_record(
                truth,
                ambient,
                test,
                sampling=20.0,
                jitter=0.02,
                through_rests=True,
                seed=500 + 10 * seed + i,
            )
            for i, ambient in enumerate((-20.0, 23.0))
        ]
        identification = identify_bearing(records, truth, starts=1, start_from="bearing")
        r2 += [fit.R2 for fit in identification.fits]
        inside += intervals_cover_truth(identification, truth)
    share = 100.0 * float(np.mean(inside))
    label = f"the same, {LOGGED[kind]} {kind} problems, jitter and rests of 10 min at 20 Hz"
    note = f"smallest R2 {min(r2):.4f}"
    return Row(label, share, "%", "85 to 99 %", 85.0 <= share <= 99.0, note)


def file_off(kind: str) -> Row:
    """Share of intervals that hold the truth, when what is not free is off as its source says."""
    bearing = tb.load_bearing(NAMES[kind])
    inside = []
    for seed in range(FILES):
        truth = with_another_file(bearing, seed)
        identification = identify_bearing(tests_of(truth, 300 + seed), bearing, starts=1)
        inside += intervals_cover_truth(identification, truth)
    share = 100.0 * float(np.mean(inside))
    label = f"the same, {FILES} {kind} problems, white noise, fixed values off by their uncertainty"
    return Row(label, share, "%", "85 to 99 %", 85.0 <= share <= 99.0)


def with_another_file(bearing: tb.Bearing, seed: int) -> tb.Bearing:
    """A bearing whose numbers that a fit takes from the file are off, by chance."""
    rng = np.random.default_rng(seed)
    for group in _assumed_groups(bearing, default_free(bearing, AMBIENTS), chosen_groups(None)):
        # Within the bounds that a bearing accepts; E2 has no negative values.
        sigmas = float(np.clip(rng.normal(), -2.4, 2.4))
        bearing = shift(bearing, group, abs(sigmas) if group.name == "E2" else sigmas)
    return bearing


def yield_stress() -> list[Row]:
    """LHDR whose lead is not that of the file, with the yield stress free and fixed."""
    bearing = tb.load_bearing(NAMES["LHDR"])
    fixed = [k for k in default_free(bearing, AMBIENTS) if k != "lead.yield_stress"]
    rows = []
    for name, free in (("free", None), ("fixed", fixed)):
        errors, scores = [], []
        for value in (10.0, 11.0, 13.0, 14.0):
            truth = with_values(bearing, {"lead.yield_stress": value})
            records = tests_of(truth, round(value))
            for item in identify_bearing(
                records, bearing, free=free, starts=1
            ).uncertainty.estimates.values():
                true = true_value(truth, item.parameter.kind.key)
                if true:
                    errors.append(abs(item.value / true - 1.0))
                    scores.append(abs(item.value - true) / item.stderr_of_tests)
        note = f"at most {max(scores):.1f} standard errors of the tests"
        label = f"LHDR, lead of 10 to 14 MPa, 12 in the file, {name}: largest error"
        rows.append(plain(label, 100.0 * max(errors), "%", note=note))
    return rows


def model_error() -> list[Row]:
    """First cycles stiffer than the law on purpose."""
    truth = tb.load_bearing(NAMES["HDR"])
    rows = []
    for factor in (1.0, 1.1, 1.3, 1.5):
        identification = identify_bearing(
            tests_of(truth, 0, first_cycle=factor), generic_start(truth)
        )
        lowest = min(fit.R2 for fit in identification.fits)
        share = identification.uncertainty.effective_samples / identification.uncertainty.samples
        note = f"{len(identification.warnings)} warnings; a sample is worth {share:.2f} of one"
        rows.append(plain(f"R2 with first cycles x {factor:g}", lowest, note=note))
    return rows


def known_functions() -> list[Row]:
    """Krill Herd on two functions of seven dimensions."""

    def sphere(u: Floats) -> float:
        return float(((10.0 * u - 5.0) ** 2).sum())

    def rosenbrock(u: Floats) -> float:
        x = 10.0 * u - 5.0
        return float((100.0 * (x[1:] - x[:-1] ** 2) ** 2 + (1.0 - x[:-1]) ** 2).sum())

    rows = []
    cases: list[tuple[str, Callable[[Floats], float], float]] = [
        ("sphere", sphere, 1e-4),
        ("Rosenbrock", rosenbrock, 7.0),
    ]
    for name, function, limit in cases:
        begin = time.perf_counter()
        values = [krill_herd(function, 7, evaluations=5000, seed=s).value for s in range(5)]
        note = f"worst {max(values):.2g}; {(time.perf_counter() - begin) / 5:.2f} s a run"
        label = f"Krill Herd, 7-D {name}, 5000 evaluations, median"
        rows.append(at_most(label, float(np.median(values)), limit, note=note))
    return rows


def _cost(identification: Identification) -> float:
    return float(
        np.mean(np.concatenate(identification.problem.parts(identification.cube, fine=True)) ** 2)
    )


def methods() -> list[Row]:
    """The same three HDR tests, every method with the same budget, three seeds."""
    truth = tb.load_bearing(NAMES["HDR"])
    records = tests_of(truth, 7)
    cases = {
        "krill-herd alone": {"search": krill_herd_search(BUDGET), "polish": False},
        "krill-herd, then least squares": {"search": krill_herd_search(BUDGET - 150)},
        "least squares, one start": {"starts": 1},
        "least squares, 8 starts": {"starts": 8},
    }
    lowest, rows, results = np.inf, [], {}
    for name, options in cases.items():
        runs = [
            identify_bearing(
                records,
                generic_start(truth),
                seed=seed,
                **options,  # type: ignore[arg-type]
            )
            for seed in range(3)
        ]
        results[name] = runs
        lowest = min(lowest, *(_cost(run) for run in runs))
    for name, runs in results.items():
        costs = sorted(_cost(run) / lowest for run in runs)
        error = max(
            abs(run.values[key] / true_value(truth, key) - 1.0)
            for run in runs
            for key in run.uncertainty.estimates
        )
        seconds = np.median([run.seconds for run in runs])
        note = (
            f"worst {costs[-1]:.4g}; largest parameter error {error:.1%}; "
            f"{max(run.evaluations for run in runs)} evaluations, {seconds:.1f} s"
        )
        rows.append(plain(f"cost over the best, {name}, median of 3", costs[1], note=note))
    return rows


def rows() -> list[Row]:
    """All of them; some minutes."""
    return [
        *recovery("HDR"),
        *recovery("LHDR"),
        coverage(0.0),
        coverage(MEMORY),
        *(logged(kind) for kind in LOGGED),
        file_off("HDR"),
        file_off("LHDR"),
        *yield_stress(),
        *model_error(),
        *known_functions(),
        *methods(),
    ]
