"""Wrong arguments of public functions: an InputError, an OutputError or a result, never else.

`python -m tests.fuzz.misuse` tries all values; here a few values stand for them.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest

import thermobearing as tb
import thermobearing.laws
from tests.fuzz import misuse

# The valid calls of these take an analysis each.
SLOW = {"EarthquakeResult", "forecast", "identify_bearing", "make_report", "make_motion", "study",
        "match_spectrum", "run_design", "bounds_study", "cross_validate", "StudyResult", "overlay",
        "temperature_factors", "validate_bearing", "TestRecord", "check_bearings", "live_page",
        "generate_weather", "sweep", "synthetic_record", "opensees.serve", "bearing_weather",
        "opensees.write_material", "equal_bearing", "sequence", "hybrid", "bridge",
        "save_motion", "end_state"}  # fmt: skip
NAMES = sorted({*misuse.public_items()} - misuse.MADE - {"list_bearings", "list_motions"})
VALUES = {label: misuse.VALUES[label] for label in misuse.QUICK}


@pytest.fixture(autouse=True)
def _place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(thermobearing.laws, "_REGISTERED", {})
    with misuse.lasting_folders(tmp_path):
        yield


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.thorough] if n in SLOW else []) for n in NAMES],
)
def test_wrong_arguments_are_named(name: str) -> None:
    counted = {t.name: misuse.count_faults(t, VALUES) for t in misuse.targets({name})}
    assert sum(counts.calls for counts in counted.values()) >= len(counted)
    assert not [f"{key}: {counts.faults}" for key, counts in counted.items() if counts.faults]


def test_messages_name_argument_and_entry() -> None:
    for call, pieces in (
        (lambda: tb.live_page(5), ["live_page()", "path = 5"]),  # type: ignore[arg-type]
        (lambda: tb.BearingElements([3]), ["elements[0] = 3"]),  # type: ignore[list-item]
        (lambda: tb.examine_structure("pier-p1", mass="consistant"), ["consistent"]),  # type: ignore[arg-type]
        (lambda: tb.load_test(file="x"), ['unknown key "file"', "path"]),  # type: ignore[call-arg]
        (lambda: tb.load_spectrum("jra-ii-i", 10**5000), ["factor", "16610 bits"]),
    ):
        with pytest.raises(tb.InputError) as caught:
            call()
        assert all(piece in str(caught.value) for piece in pieces), caught.value
