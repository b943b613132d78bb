"""The progress bar says how many are done, how quickly, and how long the rest takes."""

import io

import pytest
from rich.console import Console

from thermobearing.commands.common import Rate, _progress_bar


@pytest.mark.parametrize(
    ("seconds", "told"), [(0.5, "2 a second"), (0.01, "100 a second"), (120.0, "0.5 a minute")]
)
def test_rate(seconds: float, told: str) -> None:
    """Of those that were done since the first call, which may bring many from an earlier start."""
    bar = _progress_bar(Console(file=io.StringIO()))
    now = [0.0]
    bar.get_time = lambda: now[0]
    task = bar.add_task("runs", total=None)
    bar.start_task(task)
    for done in (700, 701, 702, 703):
        bar.update(task, completed=done, total=1000)
        now[0] += seconds
    assert Rate().render(bar.tasks[0]).plain == told


def test_bar_is_whole() -> None:
    console = Console(file=io.StringIO(), width=100)
    bar = _progress_bar(console)
    bar.add_task("runs", total=10, completed=3)
    console.print(bar.get_renderable())
    shown = console.file.getvalue()
    assert shown.startswith("runs")
    assert "3/10" in shown
    assert shown.rstrip().endswith("left")
