"""What the finite elements cost that the one-dimensional model is checked with."""

import time

import thermobearing as tb
from benchmarks.rows import Row, plain
from tests.verification.test_fe_heat import AMBIENT, MODELS, finite_elements, loading, variant


def rows() -> list[Row]:
    """Time of each for five cycles of 250 % and two minutes of rest, LHDR specimen [ms]."""
    bearing = variant("LHDR")
    measured = []
    for model, options in MODELS.items():
        times = []
        for _ in range(5):
            begin = time.process_time()
            tb.run(bearing, loading(bearing), ambient=AMBIENT, **options)
            times.append(time.process_time() - begin)
        measured.append(plain(f"LHDR, 250 %, {model}", 1e3 * min(times), "ms"))
    begin = time.process_time()
    finite_elements(bearing)
    elapsed = 1e3 * (time.process_time() - begin)
    measured.append(
        plain("the same heat by axisymmetric finite elements (heat only)", elapsed, "ms")
    )
    return measured
