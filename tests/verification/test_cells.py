"""How many heat cells a layer needs, and what `check` says about it."""

from pathlib import Path

import pytest

import thermobearing as tb
from tests.conftest import Recorder
from tests.tolerances import CELLS_ENOUGH, CELLS_ESTIMATE
from tests.unit.inputs import write_toml
from tests.verification.models import changed
from thermobearing.bearing.model import Bearing, Cells
from thermobearing.border.toml import read_toml
from thermobearing.commands.check import cells_facts
from thermobearing.cyclic.comparison import TOLERABLE, CellsError, cells_error
from thermobearing.design.factors import scaled_bearing

DATA = Path(tb.__file__).parent / "data" / "bearings"
SPECIMENS = ("shen-hdr-specimen", "shen-lhdr-specimen")


def estimate(bearing: Bearing) -> CellsError:
    found = cells_error(bearing)
    assert found is not None
    return found


@pytest.mark.parametrize("name", SPECIMENS)
def test_estimate_falls_with_the_square_of_the_cells(name: str, measured: Recorder) -> None:
    """Of second order: twice as many cells leave a quarter, and the true rise stays the same."""
    two = tb.load_bearing(name)
    four, eight = (changed(two, cells={"rubber": n, "shim": n // 2}) for n in (4, 8))
    reported = [estimate(bearing) for bearing in (two, four, eight)]
    for found in reported:
        text = f"{100.0 * found.stiffness:+.2f} %, {100.0 * found.energy:+.2f} %, "
        text += f"{found.warming:+.2f} of {found.rise:.1f} K"
        measured(f"{name}, {found.cells} cells a layer: G, energy, warming", text, "reported")
    for coarse, fine in (
        (reported[0], reported[1]),
        (reported[1], reported[2]),
    ):  # second order: a quarter
        assert fine.stiffness == pytest.approx(coarse.stiffness / 4.0, rel=CELLS_ESTIMATE)
        assert fine.energy == pytest.approx(coarse.energy / 4.0, rel=CELLS_ESTIMATE)
        assert fine.warming == pytest.approx(coarse.warming / 4.0, rel=CELLS_ESTIMATE)
        assert fine.rise == pytest.approx(coarse.rise, rel=CELLS_ENOUGH)
    assert [found.worst <= TOLERABLE for found in reported] == [False, True, True]
    assert reported[0].advised == 4


@pytest.mark.parametrize("name", SPECIMENS)
def test_default_cells_are_enough(name: str, measured: Recorder) -> None:
    """Thin layers in a slow test, the worst that bearings have; and the source keeps its two."""
    assert tb.load_bearing(name).cells.rubber == 2
    found = estimate(tb.load_bearing(name).model_copy(update={"cells": Cells()}))
    assert found.worst <= TOLERABLE
    text = (
        f"{100.0 * found.stiffness:+.2f} %, {100.0 * found.energy:+.2f} %, {found.warming:+.2f} K"
    )
    measured(f"{name}, default cells: G, energy, warming", text, "1 %")
    assert found.worst < CELLS_ENOUGH


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
