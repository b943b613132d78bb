"""study.log: what happened when, a line each. A log that cannot be written stops nothing."""

import time
from datetime import datetime
from pathlib import Path


class Log:
    """Lines with the time, appended to a file.

    Parameters
    ----------
    path : of the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def say(self, text: str) -> None:
        """Append a line."""
        stamp = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
        try:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(f"{stamp} {text}\n")
        except OSError:
            return


class Pace:
    """How quickly runs are done, and how long the rest will take.

    Parameters
    ----------
    done, total : runs at the start, and all.
    """

    def __init__(self, done: int, total: int) -> None:
        self.done, self.total = done, total
        self._first, self._began = done, time.monotonic()

    def told(self) -> str:
        """Such as "192 of 256 runs, 61.2 a second, 1 s left"."""
        passed = time.monotonic() - self._began
        told = f"{self.done} of {self.total} runs"
        if self.done == self._first or passed <= 0.0:
            return told
        rate = (self.done - self._first) / passed
        return f"{told}, {rate:.3g} a second, {duration((self.total - self.done) / rate)} left"


def duration(seconds: float) -> str:
    """A time as one would say it.

    Examples
    --------
    >>> duration(42), duration(200), duration(39_999)
    ('42 s', '3 min 20 s', '11 h 6 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
