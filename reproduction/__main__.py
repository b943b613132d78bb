"""Make the tables and figures of Shen (2023) again, and judge every claim of it.

From the data files and the code alone; what needs the measurements of Shen (2023) says so.
"""

import argparse
import sys
from pathlib import Path

from rich.progress import Progress

from reproduction.claims import record_needs
from reproduction.exposure_time import compare_exposure_time, show_exposure_time
from reproduction.records import list_wanted
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
    parser.add_argument(
        "--exposure-time",
        type=Path,
        metavar="TABLE.toml",
        help="instead: compare K_d and Q_d after hours in the cold with a table of measured values",
    )
    parser.add_argument(
        "--records",
        type=Path,
        metavar="FOLDER",
        help="judge the rows that need the test data by records of the tests; see --list",
    )
    parser.add_argument(
        "--list", action="store_true", help="list the files that --records looks for, and end"
    )
    arguments = parser.parse_args(words)
    try:
        if arguments.exposure_time is not None:
            show_exposure_time(compare_exposure_time(arguments.exposure_time))
            return 0
        if arguments.list:
            for files, means, columns, rows in list_wanted(record_needs()):
                say(f"{files}\n  {means}: {columns}\n  for {rows}")
            return 0
        check_target(arguments.output, overwrite=arguments.overwrite)
        with Progress(transient=True) as bar:
            task = bar.add_task("claims, figures, tables")
            result = reproduce(
                chapter=arguments.chapter,
                figures=not arguments.no_figures,
                flips=not arguments.no_flips,
                records=arguments.records,
                jobs=arguments.jobs,
                progress=lambda done, total: bar.update(task, completed=done, total=total),
            )
        folder = result.save(arguments.output, overwrite=arguments.overwrite)
        result.show()
        if arguments.report:
            result.write_report(folder)
    except (InputError, OutputError) as error:
        print(f"reproduction: {error}", file=sys.stderr)
        return 2
    say(f"written: {folder}")
    return 3 if result.broken else 0


if __name__ == "__main__":
    sys.exit(main())
