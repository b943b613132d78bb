"""The progress bar of long commands: how many are done, how quickly, how long the rest takes."""

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

LOOKS_BACK = 600.0  # what was done before that says little of the rest [s]


class Rate(ProgressColumn):
    """How many are done in a second; in a minute where that is less than one."""

    def render(self, task: Task) -> Text:
        """Nothing until two are done."""
        speed = task.speed
        if not speed:
            return Text("")
        told = f"{speed:.3g} a second" if speed >= 1.0 else f"{60.0 * speed:.3g} a minute"
        return Text(told, style="progress.data.speed")


def progress_bar(console: Console) -> Progress:
    """A bar that vanishes when all is done."""
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
