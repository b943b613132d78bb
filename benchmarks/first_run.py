"""The first cyclic test after installing, which compiles, and the ones after it."""

import tempfile
from pathlib import Path

from benchmarks.commands import CLI, CommandError, Elapsed, run_python
from benchmarks.rows import Row, at_most, failed

COLD_LIMIT, WARM_LIMIT = 25.0, 3.0  # [s]
COLD = "first `thermobearing cyclic --no-figures` (compiles), three temperatures"
WARM = "next `thermobearing cyclic --no-figures`, three temperatures"


def rows() -> list[Row]:
    """Cold with an empty folder for compiled code; warm is the fastest of three."""
    with tempfile.TemporaryDirectory() as name:
        compiled = str(Path(name) / "compiled")

        def cyclic(number: int) -> Elapsed:
            target = str(Path(name) / f"result{number}")
            arguments = ("cyclic", "--no-figures", "-q", "-o", target)
            return run_python(CLI, arguments, NUMBA_CACHE_DIR=compiled)

        try:
            cold = cyclic(0)
            warm = sorted(cyclic(number) for number in (1, 2, 3))
        except CommandError as error:
            targets = ((COLD, COLD_LIMIT), (WARM, WARM_LIMIT))
            return [failed(what, str(error), f"<= {limit:g} s") for what, limit in targets]
    note = f"median {warm[1].wall:.2f} s, processor {warm[0].processor:.2f} s"
    return [
        at_most(COLD, cold.wall, COLD_LIMIT, "s", f"processor {cold.processor:.1f} s"),
        at_most(WARM, warm[0].wall, WARM_LIMIT, "s", note),
    ]
