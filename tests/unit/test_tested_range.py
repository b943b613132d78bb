"""The range that a bearing was tested in: its record in a file."""

from pathlib import Path

import pytest

import thermobearing as tb
from tests.unit.inputs import SPECIMEN, changed_table, specimen_table, write_toml
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border.errors import InputError


def test_ranges_of_the_specimens() -> None:
    found = {}
    for name in (SPECIMEN, "shen-lhdr-specimen"):
        law = tb.load_bearing(name).tested_range
        assert law is not None
        found[name] = law.ranges()
    plain, lead = found.values()
    assert plain == {
        "strain": (0.5, 2.5),
        "strain_rate": (0.333, 1.0),  # 10 and 30 mm/s over 30 mm
        "ambient": (-20.0, 23.0),
        "cycles": (0.0, 5.0),
    }
    assert lead["strain_rate"] == (0.333, 1.571)  # a sine is pi/2 faster than on average
    assert lead["lead_temperature"] == (-20.0, 96.0)
    bilinear = load_bilinear("shen-bilinear-bridge").tested_range
    assert bilinear is not None
    assert bilinear.ranges()["ambient"] == (23.0, 23.0)


def test_an_untested_bearing_has_none() -> None:
    assert tb.load_bearing("lrb-example").tested_range is None


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({}, "give one of strain, strain_rate, ambient, cycles, lead_temperature at least"),
        ({"strain": [2.5, 0.5]}, "strain: 2.5 is above 0.5; write [lowest, highest]"),
        ({"ambient": [-20, 23]}, 'has no unit; write "-20 degC"'),
        ({"strain": [0.5]}, "tested_range.strain = [0.5]: must have at least 2 entr"),
        ({"strains": [0.5, 2.5]}, 'unknown key "tested_range.strains"; did you mean "strain"'),
    ],
)
def test_bad_ranges(table: dict[str, object], said: str, tmp_path: Path) -> None:
    file = write_toml(
        tmp_path / "mine.toml", changed_table(specimen_table(), {"tested_range": table})
    )
    with pytest.raises(InputError) as caught:
        tb.load_bearing(file)
    assert said in str(caught.value)
