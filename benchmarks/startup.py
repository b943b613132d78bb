"""How long until a user sees anything: importing the package, asking for help."""

from statistics import median

from benchmarks.commands import CLI, CommandError, run_python
from benchmarks.rows import Row, at_most, failed, plain

LIMIT = 0.6  # [s]
REPEATS = 5


def timed(what: str, code: str, *arguments: str, limit: float | None = LIMIT) -> Row:
    """Median wall time of a fresh process, the first (cold files) not counted."""
    try:
        run_python(code, arguments)
        times = sorted(run_python(code, arguments) for _ in range(REPEATS))
    except CommandError as error:
        return failed(what, str(error), f"<= {limit:g} s" if limit else "")
    middle = median(time.wall for time in times)
    note = f"fastest {times[0].wall:.2f} s, processor {times[0].processor:.2f} s"
    if limit is None:
        return plain(what, middle, "s", note)
    return at_most(what, middle, limit, "s", note)


def rows() -> list[Row]:
    """Each row is the whole process, Python's own start included."""
    return [
        timed("python without anything, for comparison", "pass", limit=None),
        timed("import thermobearing", "import thermobearing"),
        timed("the same and everything run() needs", "import thermobearing; thermobearing.run"),
        timed("thermobearing --help", CLI, "--help"),
        timed("thermobearing cyclic --help", CLI, "cyclic", "--help"),
    ]
