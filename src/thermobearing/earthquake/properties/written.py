"""Tables of runs and lines as files have them: each bearing is that of the values of its row."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from thermobearing.quantities.words import part_label

if TYPE_CHECKING:
    from thermobearing.border.lazy import pd

GOVERNING_LINES: Final = {  # column of the table of runs: that of the bearing of the line
    "strain_line": "strain_bearing",
    "force_line": "force_bearing",
}


def with_own_bearing(lines: "pd.DataFrame") -> "pd.DataFrame":
    """Return a table of lines as it is written: `bearing` is that of the line of the row.

    A line with its own bearing has it in every analysis of several: the column `analysis_bearing`
    then says which analysis a row is of.
    """
    if not len(lines):
        return lines
    names = lines["bearing"]
    written = lines.drop(columns="line_bearing").assign(bearing=lines["line_bearing"])
    if names.nunique() > 1 and (names != lines["line_bearing"]).any():
        written.insert(1, "analysis_bearing", names)
    return written


def with_governing_bearings(
    table: "pd.DataFrame", line_bearings: Mapping[str, Mapping[str, str]]
) -> "pd.DataFrame":
    """Return the table of runs as it is written, with the bearings of the governing lines.

    Where lines have bearings of their own (`EarthquakeResult.line_bearings`), the bearing of the
    analysis is not that of every peak: its column is named `analysis_bearing`.
    """
    if not line_bearings:
        return table
    written = table.rename(columns={"bearing": "analysis_bearing"})
    for column, bearing_column in GOVERNING_LINES.items():
        if column in table:
            bearings = [
                line_bearings[str(bearing)].get(str(line), "")
                for bearing, line in zip(table["bearing"], table[column], strict=True)
            ]
            written.insert(written.columns.tolist().index(column) + 1, bearing_column, bearings)
    return written


def place_in_words(
    line_bearings: Mapping[str, Mapping[str, str]], run: str, bearing: str, part: str, name: str
) -> str:
    """Return the name of a run and its line or pier; a line is named with its own bearing.

    `bearing` is that of the analysis, with which the name of the run begins.
    """
    lines, label = line_bearings.get(bearing, {}), part_label(part.rpartition("_")[2], name)
    if not lines:
        return f"{run}, {label}"
    run = run.removeprefix(f"{bearing}, ")
    if name in lines and part.endswith("line"):
        return f"{label} with {lines[name]}, {run}"
    return f"{run}, {label}"  # a pier carries lines of several bearings
