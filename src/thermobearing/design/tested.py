"""What designs, bounds and factors ask of the ranges that their bearings were tested in."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import pandas as pd

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.validity import ranges_of
from thermobearing.results.ranges import Row, asked_of_tests, one_per_cause, outside_tests, rows_of

if TYPE_CHECKING:
    from thermobearing.design.result import Design


def asked_by_design(design: "Design") -> list[Row]:
    """Rows of `compared`: the last round against its curves, equal bearings against their tests.

    Those stand for the design displacement, and for every run at every temperature.
    """
    rows = rows_of(design.study.tested_range)
    for item in design.equal:
        bearing, far = item.bearing, item.displacement
        reached = {"strain": far / bearing.total_rubber_thickness}
        rows += asked_of_tests(f"{bearing.name}, {far:.0f} mm", reached, ranges_of(bearing))
    return rows + list(design.temperatures.attrs.get("tested_range", []))


def warnings_of_design(design: "Design") -> list[str]:
    """Sentences: what left the curves of the compound, or the tests of equal bearings."""
    rows = asked_by_design(design)
    said: list[tuple[str, str]] = []
    bearings: list[Bearing | BilinearBearing] = [*design.bearings]
    bearings += [item.bearing for item in design.equal]
    for bearing in {one.name: one for one in bearings}.values():  # some groups share a size
        mine = [row for row in rows if str(row["run"]).startswith(f"{bearing.name}, ")]
        outside = outside_tests(bearing.name, mine, ranges_of(bearing), skip=("strain_rate",))
        said += [(bearing.name, text.removeprefix(f"{bearing.name}: ")) for text in outside]
    return one_per_cause(said)


def asked_by_bounds(tables: Mapping[str, pd.DataFrame]) -> list[Row]:
    """Rows of `compared` of the coupled model, of all bearings."""
    return [row for table in tables.values() for row in table.attrs.get("tested_range", [])]


def warnings_of_bounds(tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Sentences: what the coupled model was not tested at, and runs that ended early."""
    said: list[tuple[str, str]] = []
    for name, table in tables.items():
        rows, ranges = table.attrs.get("tested_range", []), table.attrs.get("ranges")
        outside = outside_tests(name, rows, ranges, skip=("strain_rate",))
        said += [(name, text.removeprefix(f"{name}: ")) for text in outside]
    return one_per_cause(said)
