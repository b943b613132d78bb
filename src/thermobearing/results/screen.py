"""What the terminal views of all rooms share."""

from collections.abc import Iterable

from rich.console import Console
from rich.markup import escape


def print_facts(title: str, facts: dict[str, str]) -> None:
    """A titled list of names and values."""
    console = Console(highlight=False)
    console.print(f"[bold]{escape(title)}[/bold]")
    width = max(len(name) for name in facts)
    for name, value in facts.items():
        console.print(f"  {name:{width}}  {value}", markup=False)


def print_warnings(console: Console, warnings: Iterable[str]) -> None:
    """What a reader must know, a line each."""
    for warning in warnings:
        console.print(f"[yellow]warning:[/] {escape(warning)}", highlight=False, soft_wrap=True)
