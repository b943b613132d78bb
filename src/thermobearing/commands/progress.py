"""The progress bar of commands.

Not in `common.py`, since rich takes a third as long to import as all else that a help text needs.
"""

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

LOOKS_BACK = 600.0  # window of the rate that is shown [s]


class Rate(ProgressColumn):
    """The rate per second, or per minute where that is less than one."""

    def render(self, task: Task) -> Text:
        """Return the rate; empty until two tasks are completed."""
        speed = task.speed
        if not speed:
            return Text("")
        message = f"{speed:.3g} per second" if speed >= 1.0 else f"{60.0 * speed:.3g} per minute"
        return Text(message, style="progress.data.speed")


def progress_bar(console: Console) -> Progress:
    """Return a progress bar that disappears at the end."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        Rate(),
        TimeRemainingColumn(),
        TextColumn("left"),
        console=console,
        transient=True,
        speed_estimate_period=LOOKS_BACK,
    )
