"""How many heat cells a layer needs, and what `check` says about it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests.conftest import Recorder
from tests.tolerances import CELLS_ENOUGH, CELLS_ESTIMATE
from tests.unit.inputs import write_toml
from tests.verification.models import changed
from thermobearing.bearing.cells import Cells
from thermobearing.bearing.model import Bearing
from thermobearing.border.toml import read_toml
from thermobearing.commands.check import cells_facts
from thermobearing.cyclic.comparison import TOLERABLE, CellsError, cells_error
from thermobearing.design.factors import scaled_bearing
from thermobearing.model.stack import build_stack

DATA = Path(tb.__file__).parent / "data" / "bearings"
SPECIMENS = ("shen-hdr-specimen", "shen-lhdr-specimen")


def estimate(bearing: Bearing) -> CellsError:
    result = cells_error(bearing)
    assert result is not None
    return result


@pytest.mark.parametrize("name", SPECIMENS)
def test_estimate_falls_with_the_square_of_the_cells(name: str, measured: Recorder) -> None:
    """Of second order: twice as many cells leave a quarter, and the true rise stays the same."""
    two = tb.load_bearing(name)
    four, eight = (changed(two, cells={"rubber": n, "shim": n // 2}) for n in (4, 8))
    reported = [estimate(bearing) for bearing in (two, four, eight)]
    for result in reported:
        text = f"{100.0 * result.stiffness:+.2f} %, {100.0 * result.energy:+.2f} %, "
        text += f"{result.warming:+.2f} of {result.rise:.1f} K"
        measured(f"{name}, {result.cells} cells a layer: G, energy, warming", text, "reported")
    for coarse, fine in (
        (reported[0], reported[1]),
        (reported[1], reported[2]),
    ):  # second order: a quarter
        assert fine.stiffness == pytest.approx(coarse.stiffness / 4.0, rel=CELLS_ESTIMATE)
        assert fine.energy == pytest.approx(coarse.energy / 4.0, rel=CELLS_ESTIMATE)
        assert fine.warming == pytest.approx(coarse.warming / 4.0, rel=CELLS_ESTIMATE)
        assert fine.rise == pytest.approx(coarse.rise, rel=CELLS_ENOUGH)
    assert [result.worst <= TOLERABLE for result in reported] == [False, True, True]
    assert reported[0].advised == 4


@pytest.mark.parametrize("name", SPECIMENS)
def test_default_cells_are_enough(name: str, measured: Recorder) -> None:
    """Thin layers in a slow test, the worst that bearings have; and the source keeps its two."""
    assert tb.load_bearing(name).cells.rubber == 2
    result = estimate(tb.load_bearing(name).model_copy(update={"cells": Cells()}))
    assert result.worst <= TOLERABLE
    stiffness, energy = 100.0 * result.stiffness, 100.0 * result.energy
    text = f"{stiffness:+.2f} %, {energy:+.2f} %, {result.warming:+.2f} K"
    measured(f"{name}, default cells: G, energy, warming", text, "1 %")
    assert result.worst < CELLS_ENOUGH


def test_a_file_without_cells_and_a_scaled_bearing_get_the_defaults(tmp_path: Path) -> None:
    table = read_toml(DATA / "shen-hdr-specimen.toml")
    assert table.pop("cells")["rubber"]["value"] == 2
    path = write_toml(tmp_path / "mine.toml", table)
    assert tb.load_bearing(path).cells == Cells() == Cells(end_plate=10, rubber=6, shim=2)
    assert scaled_bearing("shen-hdr-specimen", 2.0).cells == Cells()
    assert scaled_bearing("shen-hdr-bridge", 0.5).cells.end_plate == 20  # finer parts stay
    facts = cells_facts(path)
    assert facts["error of cells"].startswith("G +")
    assert "advice" not in facts


def test_check_says_when_the_error_is_not_known(tmp_path: Path) -> None:
    """Rubber that insulates, a heat capacity far too small: the reference test runs away."""
    table = read_toml(DATA / "shen-hdr-specimen.toml")
    table["materials"]["rubber"] |= {"density": "50 kg/m^3", "specific_heat": "50 J/(kg K)"}
    table["hysteresis"] |= {"hysteretic_temperature_coefficient": 0.0}
    facts = cells_facts(write_toml(tmp_path / "light.toml", table))
    assert facts["error of cells"].startswith("unknown: 5 sine cycles of 175 %")


def test_linear_rubber_and_a_thousand_cells_are_reported_too(tmp_path: Path) -> None:
    table = read_toml(DATA / "shen-hdr-specimen.toml")
    table["hysteresis"] |= {"post_yield_ratio": 1.0}
    facts = cells_facts(write_toml(tmp_path / "linear.toml", table))
    assert "energy +" in facts["error of cells"] or "energy -" in facts["error of cells"]
    table["cells"] = {"rubber": 1000, "shim": 1000}
    table["geometry"]["rubber_layers"] = 200
    facts = cells_facts(write_toml(tmp_path / "many.toml", table))
    assert facts == {"error of cells": "unknown: twice as many cells exceed the limit"}


MISMATCH = "layer_force_mismatch_max"  # of rounding
# Cells with which the plates of library bearings have a third of their cells or fewer.
GRADED = {
    "shen-lhdr-bridge": {"end_plate": 5, "sealing_plate": 5, "plate_grading": 1.3},
    "shen-hdr-bridge": {"end_plate": 5, "plate_grading": 1.3},
    "lrb-example": {"end_plate": 5, "plate_grading": 1.3},
}


def graded(name: str) -> Bearing:
    return changed(tb.load_bearing(name), cells=GRADED[name])


def kelvin(one: Any, other: Any) -> dict[str, float]:
    """Largest difference of each temperature of two datasets [K]."""
    names = [
        name
        for name in ("rubber_temperature", "lead_temperature")
        if name in one and one[name].notnull().any()
    ]
    return {name: float(np.abs(one[name] - other[name]).max()) for name in names}


@pytest.mark.parametrize("half", [True, False])
def test_graded_plates_grow_from_the_rubber_and_keep_their_thickness(half: bool) -> None:
    bearing = graded("shen-lhdr-bridge")
    stack = build_stack(bearing, half=half)
    end, sealing = stack.thickness[:5], stack.thickness[5:10]
    for plate, thickness in ((end, 70.0), (sealing, 50.0)):
        assert plate.sum() == pytest.approx(thickness, rel=1e-14)
        assert plate[:-1] / plate[1:] == pytest.approx(1.3, rel=1e-14)
    assert np.flatnonzero(stack.interface[:11]).tolist() == [4, 9]
    assert np.flatnonzero(stack.touches_lead_end)[0] == 4
    equal = build_stack(changed(bearing, cells={"plate_grading": None}), half=half)
    assert (equal.part, equal.thickness[0], equal.thickness[5]) == (stack.part, 14.0, 10.0)
    if not half:
        assert stack.thickness.tolist() == stack.thickness[::-1].tolist()
        assert not stack.interface[-1]
    else:
        assert stack.thickness[10:].tolist() == equal.thickness[10:].tolist()


def test_graded_plates_have_no_extremely_unequal_cells() -> None:
    assert Cells(end_plate=18, plate_grading=1.3).grading == 1.3
    for table in ({"end_plate": 19, "plate_grading": 1.3}, {"plate_grading": 2.1}):
        with pytest.raises(tb.InputError, match=r"plate_grading = "):
            Cells(**table)


def test_published_coefficients_need_equal_cells() -> None:
    published = tb.ModelOptions(scheme="published")
    test = tb.cyclic_test(strain=[0.5], cycles=1)
    with pytest.raises(tb.InputError, match=r"cells\.plate_grading = 1\.3"):
        tb.run(graded("shen-hdr-bridge"), test, model=published)
    case = tb.ModelOptions(scheme="published", upper_face=tb.EndFace(eta=2.5))
    with pytest.raises(tb.InputError, match=r"cells\.plate_grading = 1\.3"):
        tb.bridge(graded("shen-hdr-bridge"), "jra-ii-i-1", -20.0, duration=1, model=case)


def test_enough_cells_leave_graded_plates_as_they_are() -> None:
    cells = Cells(end_plate=5, sealing_plate=4, rubber=2, shim=1, plate_grading=1.3)
    enough = cells.enough()
    assert (enough.end_plate, enough.sealing_plate, enough.rubber, enough.shim) == (5, 4, 6, 2)
    assert enough.grading == 1.3


@pytest.mark.parametrize("name", ["shen-lhdr-bridge", "shen-hdr-bridge"])
def test_graded_plates_in_an_earthquake(name: str, measured: Recorder) -> None:
    """Peaks of pier P1 and all temperatures are those of the cells of the library.

    Heat reaches 22 mm of a plate of 50 or 70 mm, so that its face, whose `eta` is that of the
    outermost cell, has no part in it.
    """
    bearings = [tb.load_bearing(name), graded(name)]
    equal, unequal = (tb.bridge(bearing, "jra-ii-i-1", -20.0).dataset for bearing in bearings)
    peaks = [key for key in equal.data_vars if str(key).endswith("_max") and key != MISMATCH]
    assert {"bearing_force_max", "pier_moment_max", "deck_acceleration_max"} < set(peaks)
    relative = max(float(np.abs(unequal[key] / equal[key] - 1.0).max()) for key in peaks)
    difference = max(kelvin(equal, unequal).values())
    measured(f"{name}, graded plates against equal cells, peaks in an earthquake", relative, "1e-6")
    measured(f"{name}, the same, temperatures [K]", difference, "0.01")
    assert 0.0 < relative <= 1e-6
    assert difference <= 0.01


@pytest.mark.parametrize("name", GRADED)
def test_graded_plates_in_tests_with_a_rest(name: str, measured: Recorder) -> None:
    """Five cycles, 1.5 h and five cycles: as near to 160 cells a plate as the library's cells.

    The largest error of the lead is that of its first seconds at rest.
    """
    test = tb.cyclic_test(strain=[1.0, 1.75], cycles=5, rest="1.5 h", wave="sine")
    faces = tb.ModelOptions(upper_face=tb.EndFace(film=20.0), lower_face=tb.EndFace(film=20.0))
    library = tb.load_bearing(name)
    fine = changed(library, cells={"end_plate": 160, "sealing_plate": 160})
    reference, equal, unequal = (
        tb.run(bearing, test, -20.0, model=faces).dataset
        for bearing in (fine, library, graded(name))
    )
    force = float(np.abs(unequal["force"] - reference["force"]).max() / reference["force"].max())
    errors, before = kelvin(unequal, reference), kelvin(equal, reference)
    measured(f"{name}, graded plates against 160 cells, force of a test", force, "3e-5")
    for key, error in errors.items():
        text = f"{error:.2g}, and of the library's cells {before[key]:.2g}"
        measured(f"{name}, the same, {key.replace('_', ' ')} [K]", text, "1.1 times, or 0.002")
        assert error <= max(1.1 * before[key], 0.002), key
    assert force <= 3e-5
