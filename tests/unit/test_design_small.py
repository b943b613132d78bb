"""Small errors of designs that went unseen once."""

from typing import Any

import pytest

import thermobearing as tb
from thermobearing.design.bounds import first_motions
from thermobearing.design.case import make_design_case
from thermobearing.design.rubber import checked_strain, load_rubber
from thermobearing.design.run import run_design, run_factors


def test_factors_are_relative_to_the_reference_of_the_rubber() -> None:
    """15 degC in the natural rubber bearing, 23 in those of the source."""
    table = run_factors(["lrb-example"], temperatures=[15.0], strains=[1.0], cycles="1-3").table
    assert (table[table["ambient_degC"] == 15.0]["factor"] == 1.0).all()


def test_bounds_are_tried_on_ground_i() -> None:
    assert first_motions() == [f"jra-{kind}-i-{n}" for kind in ("i", "ii") for n in (1, 2, 3)]


def test_a_design_has_one_bearing_line() -> None:
    table = tb.structure.load_structure("pier-p1").model_dump(exclude_none=True)
    table["bearings"] = [table["bearings"][0], {**table["bearings"][0], "name": "second"}]
    two = tb.structure.Structure.model_validate(table)
    with pytest.raises(tb.InputError, match=r'exactly one bearing line, .*"second"; give one pier'):
        make_design_case({}, "test", structure=two)


def test_limits_and_tests_hold_at_every_temperature() -> None:
    """A limit of one's own; the cold runs of layered bearings are compared with their tests.

    Before, limits were 250 % and 3, and a design at -40 degC said nothing of the -20 tested.
    """
    given: dict[str, Any] = {"motions": ["jra-ii-i-1"], "tolerance": 0.1, "ambient": [-40.0]}
    given |= {"sizing": {"strain_limit": 0.2, "ductility_limit": 9.0}}
    templates = [tb.load_bearing("shen-hdr-bridge")]
    design = run_design(make_design_case({}, "test", **given), templates=templates)
    limits = {check.what: (check.limit, check.source) for check in design.checks}
    assert limits["shear strain"] == (0.2, "sizing.strain_limit")
    assert limits["pier ductility"] == (9.0, "sizing.ductility_limit")
    (row,) = design.temperatures.to_dict("records")
    assert (row["verdict"], row["fails"]) == ("NG", "strain")
    assert any("ambient -40 degC, below the -20 degC tested" in text for text in design.warnings)


@pytest.mark.parametrize("strain", [0.19, 2.51])
def test_curves_end_at_their_strains(strain: float) -> None:
    with pytest.raises(tb.InputError, match=r"0\.2 to 2\.5"):
        checked_strain(strain)


def test_each_kind_of_rubber_has_its_own_curves() -> None:
    curves: list[Any] = [load_rubber("G8", kind) for kind in ("HDR", "HDR-S")]  # type: ignore[arg-type]
    assert [item.kind for item in curves] == ["HDR", "HDR-S"]
    assert [item.shear_modulus[0] for item in curves] == [2.3686, 3.477]
