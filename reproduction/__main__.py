"""Make the tables and figures of Shen (2023) again, and judge every claim of it.

From the data files and the code alone; what needs the measurements of Shen (2023) says so.
"""

import argparse
import sys
from pathlib import Path

from rich.progress import Progress

from reproduction.work import CHAPTERS, reproduce
from thermobearing.border.errors import InputError, OutputError
from thermobearing.results.directory import check_target
from thermobearing.results.screen import say


def main(words: list[str] | None = None) -> int:
    """Run the program; return its exit status: 0, 2 for bad input, 3 where a part broke."""
    parser = argparse.ArgumentParser("python -m reproduction", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("reproduced"), metavar="DIR")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier directory")
    parser.add_argument("--chapter", type=int, choices=CHAPTERS, help="one alone; 7: conclusions")
    parser.add_argument("--jobs", type=int, help="processes; as many as cores by default")
    parser.add_argument("--no-flips", action="store_true", help="verdicts, not what flips them")
    parser.add_argument("--no-figures", action="store_true", help="draw no figures")
    parser.add_argument("--report", action="store_true", help="write report.html and report.pdf")
    given = parser.parse_args(words)
    try:
        check_target(given.output, overwrite=given.overwrite)
        with Progress(transient=True) as bar:
            task = bar.add_task("claims, figures, tables")
            found = reproduce(
                chapter=given.chapter,
                figures=not given.no_figures,
                flips=not given.no_flips,
                jobs=given.jobs,
                progress=lambda done, total: bar.update(task, completed=done, total=total),
            )
        folder = found.save(given.output, overwrite=given.overwrite)
        found.show()
        if given.report:
            found.write_report(folder)
    except (InputError, OutputError) as error:
        print(f"reproduction: {error}", file=sys.stderr)
        return 2
    say(f"written: {folder}")
    return 3 if found.broken else 0


if __name__ == "__main__":
    sys.exit(main())
