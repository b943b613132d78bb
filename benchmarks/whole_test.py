"""The whole of Table 3.4 at one temperature, rests included."""

import thermobearing as tb
from benchmarks.rows import Row, at_most
from benchmarks.specimen import NAME, run_at, seconds, specimen_constants, table_34

LIMIT = 50.0  # [ms]
SHORT_LIMIT = 1.5  # of one cycle [ms]
COLD = -20.0  # [degC], the slowest of the three


def rows() -> list[Row]:
    """The run alone, and what a user calls, which ends with a labelled dataset."""
    constants, segments = specimen_constants(), table_34()
    steps = run_at(constants, segments, COLD).steps
    alone = seconds(lambda: run_at(constants, segments, COLD), 20)
    bearing, test = tb.load_bearing(NAME), tb.cyclic_test()
    labelled = seconds(lambda: tb.run(bearing, test, ambient=COLD).dataset, 10)
    measured = seconds(lambda: tb.run(bearing, test, ambient=COLD).cycles, 10)
    cases = {
        f"Table 3.4 with rests at -20 degC, {steps:,} steps": alone,
        "the same by tb.run(), sampled, checked and labelled": labelled,
        "the same with the table of cycles": measured,
    }
    timed = [(label, times, LIMIT) for label, times in cases.items()]
    short = tb.cyclic_test(strain=[0.5], cycles=1)
    taken = seconds(lambda: tb.run(bearing, short, ambient=COLD), 50)
    timed.append(("one cycle by tb.run(), without labels", taken, SHORT_LIMIT))
    return [
        at_most(label, 1e3 * times[0], limit, "ms", f"median {1e3 * times[len(times) // 2]:.1f} ms")
        for label, times, limit in timed
    ]
