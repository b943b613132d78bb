"""What was found in files, on the terminal."""

from thermobearing.border.errors import printable
from thermobearing.identify.screen import MARKS
from thermobearing.intake.result import Intake, Intakes
from thermobearing.results.screen import print_table

USED = ("time", "displacement", "force", "ambient", "strain")


def print_intakes(found: Intakes) -> None:
    """Columns and findings of each file.

    Parameters
    ----------
    found : from `take_in`.
    """
    for item in found.files:
        print(printable(_headline(item)))
        _print_columns(item)
        for finding in item.report.findings:
            print(printable(f"  {MARKS[finding.level]:8} {finding.check}: {finding.sentence}"))


def _headline(item: Intake) -> str:
    form = f'sheet "{item.sheet}"' if item.sheet else f"separated by {item.separator}"
    comma = "decimal comma, " if item.decimal == "," else ""
    blocks = "1 block" if item.blocks == 1 else f"{item.blocks} blocks"
    length = float(item.record.time[-1] - item.record.time[0])
    return (
        f"{item.file.name}: {form}, {comma}{item.rows} rows in {blocks}, {length:.4g} s, "
        f"ambient {item.record.ambient:.3g} degC"
    )


def _print_columns(item: Intake) -> None:
    rows = []
    for column in item.columns:
        unit = f"{column.assumed} (assumed)" if column.assumed else column.unit
        taken = column.holds if column.holds in USED else "not used"
        why = column.why
        if column.holds == "temperature":
            taken = column.place or taken
            why = column.why if column.place else "a thermocouple? say where it sits"
        elif column.holds in ("numbers", "words", "nothing"):
            why = column.why
        rows.append([printable(text) for text in (column.title, unit, taken, why)])
    print_table(("column", "unit", "taken as", "because of"), rows, keys=4)
