"""What the terminal views of all rooms share."""

from rich.console import Console
from rich.markup import escape


def print_facts(title: str, facts: dict[str, str]) -> None:
    """A titled list of names and values."""
    console = Console(highlight=False)
    console.print(f"[bold]{escape(title)}[/bold]")
    width = max(len(name) for name in facts)
    for name, value in facts.items():
        console.print(f"  {name:{width}}  {value}", markup=False)
