"""Limits of the checks of laboratory tests, from data/identify/checks.toml."""

from typing import Annotated

from pydantic import Field

from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, in_unit
from thermobearing.border.units import conversion

TONF = conversion("tonf", "kN")[0]
SLIPS = (  # factors on force and displacement that would correct a mistake, and the mistake
    (TONF, 1.0, "force in tonf labelled kN"),
    (1.0 / TONF, 1.0, "force in kN labelled tonf"),
    (1e-3, 1.0, "force in N labelled kN"),
    (1e3, 1.0, "force in kN labelled N"),
    (1.0, 10.0, "displacement in cm labelled mm"),
    (1.0, 0.1, "displacement in mm labelled cm"),
)


class CheckLimits(Strict):
    """Content of data/identify/checks.toml, which states the meaning of each limit."""

    softest: Annotated[float, in_unit("MPa"), Field(gt=0)]
    stiffest: Annotated[float, in_unit("MPa"), Field(gt=0)]
    largest_strain: Annotated[float, Field(gt=0)]
    smallest_strain: Annotated[float, Field(gt=0)]
    other_rubber: Annotated[float, Field(gt=0)]
    few_samples: Annotated[int, Field(gt=0)]
    fewest_samples: Annotated[int, Field(gt=0)]
    gap_factor: Annotated[float, Field(gt=0)]
    gap_way: Annotated[float, Field(gt=0)]
    offset: Annotated[float, Field(gt=0)]
    slight_offset: Annotated[float, Field(gt=0)]
    fewest_zeros: Annotated[int, Field(gt=0)]
    leaning: Annotated[float, Field(gt=0)]
    ends_away: Annotated[float, Field(gt=0)]
    clipped_run: Annotated[int, Field(gt=0)]
    clipped_way: Annotated[float, Field(gt=0)]
    slowest: Annotated[float, in_unit("mm/s"), Field(gt=0)]
    fastest: Annotated[float, in_unit("mm/s"), Field(gt=0)]
    slow: Annotated[float, in_unit("mm/s"), Field(gt=0)]
    sparse: Annotated[float, in_unit("s"), Field(gt=0)]
    repeated: Annotated[int, Field(gt=0)]
    undamped: Annotated[float, Field(gt=0)]
    level_part: Annotated[float, Field(gt=0)]
    level_rise: Annotated[float, Field(gt=0)]
    fewest_of_part: Annotated[int, Field(gt=0)]
    fastest_rate: Annotated[float, in_unit("1/s"), Field(gt=0)]
    generated: Annotated[float, Field(gt=0)]
    jump: Annotated[float, Field(gt=0)]
    many_steps: Annotated[float, Field(gt=0)]
    lowest_kelvin: Annotated[float, in_unit("K"), Field(gt=0)]
    like_kelvin: Annotated[float, in_unit("K"), Field(gt=0)]
    coldest: Annotated[float, in_unit("degC")]
    hottest: Annotated[float, in_unit("degC")]
    notable_start: Annotated[float, in_unit("K"), Field(gt=0)]
    sensor_class: Annotated[float, in_unit("K"), Field(gt=0)]
    far_start: Annotated[float, in_unit("K"), Field(gt=0)]


def check_limits() -> CheckLimits:
    """Return the limits, read once."""
    return read_data(CheckLimits, "identify", "checks.toml")


def suspected_slip(modulus: float, strain: float) -> str:
    """Return the mistakes in units that would explain a modulus [MPa] and a strain."""
    limits = check_limits()
    mistakes = [
        f"{mistake} ({modulus * force_factor / length_factor:.3g} MPa)"
        for force_factor, length_factor, mistake in SLIPS
        if limits.softest < modulus * force_factor / length_factor < limits.stiffest
        and limits.smallest_strain < strain * length_factor < limits.largest_strain
    ]
    return f"; is {' or '.join(mistakes)}?" if mistakes else ""
