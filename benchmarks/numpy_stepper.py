"""The same equations in plain NumPy and SciPy, step by step in Python."""

import thermobearing as tb
from benchmarks.rows import Row, at_least, plain
from benchmarks.specimen import ETA, NAME, seconds, step_microseconds, table_34
from thermobearing.verify.numpy_stepper import NumpyStepper

STEPS = 400
WARM = 23.0  # [degC]; the reference has no rule for softening layers
LIMIT = 100.0


def rows() -> list[Row]:
    """Time per step, and how many times faster the package is in the same run."""
    bearing, segment = tb.load_bearing(NAME), table_34()[0]
    x, dt = segment.x[:STEPS].tolist(), segment.dt[:STEPS].tolist()

    def march() -> None:
        stepper = NumpyStepper(bearing, WARM, ETA)
        for position, duration in zip(x, dt, strict=True):
            stepper.step(position, duration, WARM)

    before, _ = step_microseconds(WARM)
    slow = 1e6 * seconds(march, 10)[0] / STEPS
    fast = min(before, step_microseconds(WARM)[0])
    note = f"ours {fast:.3f} us in the same run"
    return [
        plain("plain NumPy stepper of the same equations", slow, "us"),
        at_least("ratio plain NumPy / coupled step", slow / fast, LIMIT, note=note),
    ]
