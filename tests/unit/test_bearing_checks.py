"""Bearings under a vertical load: overlap area, critical load, and the rows of their checks."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import thermobearing as tb
from tests.tolerances import ROUNDING
from thermobearing.bearing.model import CircularPlan, Geometry, RectangularPlan, SquarePlan
from thermobearing.cyclic.case import make_case
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.model.axial import compression_modulus, critical_load, overlap_area
from thermobearing.model.checks import (
    NO_LIMIT,
    TWISTED,
    Check,
    secant_modulus,
    twist_check,
    twisted_strain,
    vertical_checks,
)

SQUARE = SquarePlan(shape="square", side=400)
ROUND = CircularPlan(shape="circular", diameter=600)
RECTANGLE = RectangularPlan(shape="rectangular", length=500, width=300)
TEST = tb.cyclic_test(strain=[1.0], cycles=1, closing_strain=None)
LOAD = 350.0  # kN
NAMES = ["stress", "overlap_stress", "critical", "reduced"]
OF_LEAD = ["lead: melting", "lead: 0.8 of melting"]


def _geometry(plan, layers=20, rubber=8.0, shim=3.0):
    thickness = {"rubber_thickness": rubber, "shim_thickness": shim, "end_plate_thickness": 30}
    return Geometry(plan=plan, rubber_layers=layers, **thickness)


@pytest.mark.parametrize("distance", [0.0, 1.0, 150.0, 420.0, 599.0, 600.0, 800.0])
def test_overlap_of_round_plans_is_the_integral_of_their_chords(distance):
    radius = 300.0

    def _chord(x):
        return 2.0 * math.sqrt(max(radius**2 - x**2, 0.0))

    expected = 2.0 * quad(_chord, min(0.5 * distance, radius), radius, epsabs=1e-6)[0]
    for angle in (0.0, 0.7, 2.5):
        moved = distance * np.array([[math.cos(angle), math.sin(angle)]])
        assert overlap_area(ROUND, moved)[0] == pytest.approx(expected, abs=1e-3, rel=1e-7)


@pytest.mark.parametrize("moved", [(0.0, 0.0), (120.0, -80.0), (-499.0, 10.0), (0.0, 300.0)])
def test_overlap_of_rectangles_is_the_share_of_points_that_stay_above(moved):
    along, across = (np.arange(size) + 0.5 for size in (500, 300))  # a point in each mm2
    inside = [
        np.abs(points - shift - middle) < middle
        for points, shift, middle in zip((along, across), moved, (250.0, 150.0), strict=True)
    ]
    counted = int(inside[0].sum()) * int(inside[1].sum())
    assert overlap_area(RECTANGLE, np.array([moved]))[0] == counted


def test_a_lost_overlap_is_stated_at_the_largest_displacement():
    """Before: where the overlap was lost first, as if the top went no farther."""
    bearing = tb.load_bearing("shen-hdr-bridge")
    side = bearing.geometry.plan.side
    displacements = side * np.array([0.0, 0.7, 1.01, 1.2, 1.1])
    for displacement in (
        displacements,
        np.column_stack([displacements, np.zeros(len(displacements))]),
    ):
        sources = [row.source for row in vertical_checks(bearing, LOAD, displacement, 23.0)]
        assert sum(f"0 % at {1.2 * side:.0f} mm" in source for source in sources) == 2


def test_overlap_on_a_line_is_along_the_length():
    expected = [500 * 300, 400 * 300, 0]
    assert overlap_area(RECTANGLE, np.array([0.0, -100.0, 501.0])).tolist() == expected


@pytest.mark.parametrize("plan", [SQUARE, ROUND, RECTANGLE])
def test_critical_load_is_the_eigenvalue_of_haringx_column(plan):
    """B psi'' + P (1 + P/S) psi = 0 with psi = 0 at both ends, by second differences."""
    geometry, modulus = _geometry(plan), 0.9e-3
    height, rubber = 20 * 8.0 + 19 * 3.0, 20 * 8.0
    weak = math.pi * 600**4 / 64 if plan is ROUND else min(plan._sides()) ** 3 * max(plan._sides())
    weak = weak if plan is ROUND else weak / 12.0
    bending = compression_modulus(geometry, modulus) / 3.0 * weak * height / rubber
    shear = modulus * plan.area * height / rubber
    errors = []
    for cells in (40, 80):
        step = height / cells
        size = cells - 1
        second = (2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)) / step**2
        euler = bending * np.linalg.eigvalsh(second)[0]
        result = np.roots([1.0 / shear, 1.0, -euler]).max()
        errors.append(critical_load(geometry, modulus) / result - 1.0)
    assert errors[1] < 5e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.01)  # second order


def test_critical_load_of_a_round_incompressible_pad():
    """Without compressibility it is 0.218 G D^4 / (t T_r), less the slenderness of the column."""
    geometry, modulus = _geometry(ROUND), 1e-12  # far below the bulk modulus
    usual = math.pi**2 / (32.0 * math.sqrt(2.0)) * modulus * 600**4 / (8.0 * 160.0)
    assert usual == pytest.approx(0.218 * modulus * 600**4 / (8.0 * 160.0), rel=1e-3)
    height, shape = 217.0, 600.0 / 32.0
    share = 4.0 * height / (math.pi * math.sqrt(2.0) * shape * 600.0)  # sqrt(P_S / P_E)
    expected = usual * (math.sqrt(1.0 + 0.25 * share**2) - 0.5 * share)
    assert critical_load(geometry, modulus) == pytest.approx(expected, rel=1e-8)


def test_checks_of_a_test_on_a_line():
    free = tb.run("shen-lhdr-specimen", TEST, [-20, 60])
    result = tb.run("shen-lhdr-specimen", TEST, [-20, 60], axial_force=LOAD)
    assert free.bearing_checks["what"].tolist() == 2 * OF_LEAD
    assert result["force"].equals(free["force"])
    every = result.bearing_checks
    rows = every[~every["what"].isin(OF_LEAD)]
    assert rows["run"].nunique() == 2
    assert len(rows) == 2 * len(NAMES)
    bearing = tb.load_bearing("shen-lhdr-specimen")
    moved = float(np.abs(result["displacement"].values).max())
    side = bearing.geometry.plan.side
    for run, temperature in enumerate((23.0, 60.0)):  # at least that of the rubber's law
        plain, overlap, critical, reduced = rows.iloc[4 * run : 4 * run + 4].to_dict("records")
        assert plain["value"] == pytest.approx(1e3 * LOAD / bearing.area, rel=ROUNDING)
        assert overlap["value"] == pytest.approx(1e3 * LOAD / (side * (side - moved)), rel=1e-9)
        assert [plain["verdict"], overlap["verdict"]] == ["limit not available"] * 2
        modulus = secant_modulus(bearing, temperature)
        assert critical["limit"] == critical_load(bearing.geometry, modulus)
        assert reduced["limit"] == pytest.approx(critical["limit"] * (1 - moved / side), rel=1e-9)
        assert [critical["verdict"], reduced["verdict"]] == ["OK", "OK"]
    assert rows["limit"].iloc[6] < rows["limit"].iloc[2]  # warm rubber is softer
    assert "bearing_checks" in result.tables()
    assert len(result.summary()["bearing_checks"]) == len(rows) + 2 * len(OF_LEAD)
    hottest = np.nanmax(result["lead_temperature"].values, axis=1)
    melting, near = (every[every["what"] == what] for what in OF_LEAD)
    assert melting["value"].tolist() == near["value"].tolist() == hottest.tolist()
    assert set(melting["limit"]) == {327.5}
    assert set(near["limit"]) == {262.0}
    assert set(melting["verdict"]) == set(near["verdict"]) == {"OK"}


def test_resultant_decides_in_a_plane(tmp_path):
    circle = tb.cyclic_test(strain=[1.0], cycles=1, path="circle", frequency=0.5)
    result = tb.run("shen-hdr-specimen", circle, 23, axial_force=2e5)
    side = tb.load_bearing("shen-hdr-specimen").geometry.plan.side
    x, y = np.abs(result["displacement"].values[0].T)
    plain, overlap, _, reduced, _ = result.bearing_checks.to_dict("records")
    least = ((side - x) * (side - y)).min()
    assert least < side * (side - np.hypot(x, y).max())  # the diagonal is worse than the axis
    assert overlap["value"] / plain["value"] == pytest.approx(side**2 / least, rel=1e-12)
    assert reduced["verdict"] == "NG"
    assert len([text for text in result.warnings if "axial force" in text]) == 2
    result.save(tmp_path / "saved", figures=False)
    assert tb.load_result(tmp_path / "saved").bearing_checks.equals(result.bearing_checks)
    assert (tmp_path / "saved" / "checks.csv").read_text().count("\n") == 6


def test_nothing_overlaps():
    bearing = tb.load_bearing("shen-hdr-specimen")
    rows = vertical_checks(bearing, LOAD, np.array([0.0, 300.0]), 23.0)
    assert rows[1].value == math.inf
    assert (rows[3].limit, rows[3].verdict, rows[3].used) == (0.0, "NG", math.inf)


def test_tension_is_outside_the_model():
    bearing = tb.load_bearing("shen-hdr-specimen")
    for device in (bearing, None):
        (row,) = vertical_checks(device, -1.0, np.array([0.0, 100.0]), 23.0)
        assert (row.verdict, row.of_model, row.value, row.limit) == (
            *("outside the model", True),
            *(-1.0, 0.0),
        )
    assert vertical_checks(None, LOAD, np.zeros(1), 23.0) == []
    assert vertical_checks(bearing, 0.0, np.zeros(1), 23.0)[2].used == 0.0
    result = tb.run(bearing, TEST, 23, axial_force=-LOAD)
    assert result.outcome == "completed"
    assert result.bearing_checks["verdict"].tolist() == ["outside the model"]
    assert any("tension" in text for text in result.warnings)


@pytest.mark.parametrize(
    ("limit", "least", "verdict"),
    [(2.0, False, "OK"), (2.0, True, "NG"), (math.nan, False, "limit not available")],
)
def test_verdicts(limit, least, verdict):
    check = Check("what", 1.0, limit, "1", "source", least)
    assert check.verdict == verdict
    assert math.isnan(limit) or check.used == (2.0 if least else 0.5)


def test_units_and_bad_input():
    for text in ("350 kN", "0.35 MN", "350000 N"):
        assert make_case({"axial_force": text}, "case.toml").axial_force == pytest.approx(LOAD)
    for given in ("350 mm", "350", "2e6 kN", "nan kN", True, [1.0]):
        with pytest.raises(tb.InputError) as caught:
            make_case({"axial_force": given}, "case.toml")
        assert "axial_force" in str(caught.value)
        assert "case.toml" in str(caught.value)
    with pytest.raises(tb.InputError, match="axial_force"):
        tb.bridge(axial_force=math.inf)


def test_axial_force_of_a_line():
    own = [{"line": "A1", "axial_force": "500 kN"}]
    case = make_earthquake_case({"structure": "five-span-girder", "lines": own}, "case.toml")
    assert case.axial_forces() == {"A1": 500.0}
    case = make_earthquake_case(
        {"structure": "five-span-girder", "lines": own, "axial_force": "800 kN"}, "case.toml"
    )
    forces = case.axial_forces()
    assert len(forces) == len(case.structure.bearings)
    assert (forces.pop("A1"), set(forces.values())) == (500.0, {800.0})


def test_checks_of_an_earthquake_are_at_the_peak_of_the_line():
    result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23, duration=6, axial_force=800)
    rows = result.bearing_checks
    assert rows["part"].tolist() == [""] * 4
    plan = tb.load_bearing("shen-hdr-bridge").geometry.plan
    peak = float(result["bearing_displacement_max"][0])
    overlap = overlap_area(plan, np.array([peak]))[0] / plan.area
    assert rows["limit"][3] / rows["limit"][2] == pytest.approx(overlap, rel=1e-12)
    assert result.sel(ambient=23).bearing_checks.equals(rows)
    assert "bearing_checks" in result.tables()


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0])
@pytest.mark.parametrize("lag", [0.0, 0.5, 0.5 * math.pi])
def test_twist_of_round_plans_is_the_closed_form(angle, lag):
    """1 + x/R sin(lag): theta' R H/x of theta' = x F_perp / (2 G J), of a disc."""
    geometry, way = _geometry(ROUND), 250.0
    directions = np.array([[math.cos(a), math.sin(a)] for a in (angle, angle + lag)])
    local = twisted_strain(geometry, way * directions[:1], 70.0 * directions[1:])
    nominal = way / geometry.total_rubber_thickness
    expected = nominal * (1.0 + way / 300.0 * math.sin(lag))
    assert local == pytest.approx([expected], rel=ROUNDING)


def test_twist_of_a_rectangle_is_largest_at_a_corner():
    """Of all points of the plan, with the torsion of theta' from J by integration."""
    geometry, moved, force = _geometry(RECTANGLE), np.array([180.0, 90.0]), np.array([20.0, 65.0])
    x, y = (np.linspace(-0.5 * size, 0.5 * size, 401) for size in (500.0, 300.0))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    polar = np.trapezoid(np.trapezoid((grid**2).sum(axis=-1), y), x)
    height, area = geometry.total_rubber_thickness, 500.0 * 300.0
    away = np.linalg.norm(moved)
    secant = np.linalg.norm(force) * height / (area * away)
    across = float(np.cross(np.append(moved, 0.0), np.append(force, 0.0))[2]) / away
    twist = away * across / (2.0 * secant * polar)
    strain = moved / height + twist * np.stack([-grid[..., 1], grid[..., 0]], axis=-1)
    expected = np.linalg.norm(strain, axis=-1).max()
    assert twisted_strain(geometry, moved, force) == pytest.approx(expected, rel=1e-4)
    assert expected > 1.1 * away / height


def test_no_twist_on_a_line_or_at_rest():
    geometry = _geometry(SQUARE)
    moved = np.array([[0.0, 0.0], [120.0, -60.0]])
    local = twisted_strain(geometry, moved, 0.4 * moved)
    nominal = np.hypot(*moved.T) / geometry.total_rubber_thickness
    assert local == pytest.approx(nominal, rel=ROUNDING)
    check = twist_check(geometry, moved, 0.4 * moved)
    assert (check.verdict, check.unit) == (NO_LIMIT, "1")


def test_twist_in_the_checks_of_tests_and_bridges_in_a_plane():
    turns = {"step": "path", "path": "circle", "strain": 1.0, "period": 4.0, "count": 1}
    test = tb.run("shen-hdr-specimen", tb.CyclicTest(dt=0.02, steps=[turns]), 23.0)
    row = test.bearing_checks.set_index("what").loc[TWISTED]
    assert row["value"] == test["local_strain"].values.max() > 1.05
    assert test.cycles["local_strain"][0] == row["value"]
    pair = {"name": "jra-ii-i-1", "across": "jra-ii-i-2"}
    bridge = tb.bridge(
        "shen-hdr-bridge", pair, 23, structure="five-span-bridge", duration=2.0, dt=0.02
    )
    lines = bridge.bearing_checks.query("what == @TWISTED")
    assert list(lines["part"]) == list(bridge.lines["line"])
    assert (lines["value"].to_numpy() >= bridge.lines["strain_max"].to_numpy()).all()
    assert "local_strain" not in tb.run("shen-hdr-specimen", TEST, 23.0).dataset
