"""What --help looks like where nobody draws frames: in a pipe, in a file; which options there are.

On a terminal typer draws panels with rich. Elsewhere the same panels are plain sections.
"""

import shutil
import sys
from typing import Any

import typer.core

from thermobearing.commands.options import RUNNING, options_of

WIDTH, MOST = 100, 200  # letters of a line where COLUMNS does not say, and at most


def _plain(command: Any, ctx: Any, formatter: Any) -> None:
    """Usage, help, a section for each panel, the example."""
    formatter.width = min(shutil.get_terminal_size((WIDTH, 24)).columns, MOST)
    command.format_usage(ctx, formatter)
    command.format_help_text(ctx, formatter)
    sections: dict[str, list[tuple[str, str]]] = {}
    for parameter in command.get_params(ctx):
        record = parameter.get_help_record(ctx)
        if record is not None:
            usual = "Arguments" if parameter.param_type_name == "argument" else "Options"
            panel = getattr(parameter, "rich_help_panel", None) or usual
            sections.setdefault(panel, []).append(record)
    for name, item in getattr(command, "commands", {}).items():
        panel = getattr(item, "rich_help_panel", None) or "Commands"
        sections.setdefault(panel, []).append((name, item.get_short_help_str(limit=200)))
    for panel, rows in sections.items():
        with formatter.section(panel):
            formatter.write_dl(rows, col_max=48)
    if command.epilog:
        formatter.write_paragraph()
        formatter.write_text(command.epilog)


class Command(typer.core.TyperCommand):
    """A command with plain help in a pipe, whose messages may name its options."""

    def invoke(self, ctx: Any) -> Any:
        """Run, its options known to `as_options`."""
        before = RUNNING.set(options_of(ctx))
        try:
            return super().invoke(ctx)
        finally:
            RUNNING.reset(before)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Panels on a terminal, sections elsewhere."""
        if sys.stdout.isatty():
            super().format_help(ctx, formatter)
        else:
            _plain(self, ctx, formatter)


class Group(typer.core.TyperGroup):
    """A group of commands with plain help in a pipe, and plain faults of usage there."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Panels on a terminal, sections elsewhere."""
        if sys.stdout.isatty():
            super().format_help(ctx, formatter)
        else:
            _plain(self, ctx, formatter)

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run; a fault of usage has a frame on a terminal only."""
        drawn = self.rich_markup_mode
        if not sys.stderr.isatty():
            self.rich_markup_mode = None
        try:
            return super().main(*args, **kwargs)
        finally:
            self.rich_markup_mode = drawn
