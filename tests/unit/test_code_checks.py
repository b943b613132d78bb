"""Checks of bearings after codes: demand of the motions, formulas, verdicts and the command."""

import math
import re
import tomllib

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner

import thermobearing as tb
from tests.quick import quick_cases
from tests.unit.test_earthquake_components import two_piers
from thermobearing.bearing.model import CircularPlan, RectangularPlan
from thermobearing.cli import app
from thermobearing.design.peaks import peaks_by_part
from thermobearing.design.provisions import layer_strains, limits_text, load_codes
from thermobearing.earthquake.motions import Motion
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.axial import axial_stiffness, critical_load
from thermobearing.model.checks import TOO_FEW, checked_modulus, limit_keys, secant_stiffness
from thermobearing.model.element import BearingElement
from thermobearing.model.limits import load_limits
from thermobearing.report.pieces import EXCEEDED, PASSED, TENTATIVE, Bullets
from thermobearing.report.template import ACTIONS, _actions
from thermobearing.reported import sheet_checks
from thermobearing.results.writing import as_attribute

BEARING, LOAD, ROTATION = "shen-hdr-bridge", 800.0, 0.004
STRAIN_2 = "level_2_shear_strain"
NAMES = [f"jra-ii-i-{k}" for k in (1, 2, 3)]
JRA, AASHTO = "JRA V (2017)", "AASHTO GSID (2014)"


@pytest.fixture(scope="module")
def bridge():
    level_1 = {"name": "jra-i-i-1", "group": "level 1, soft", "factor": 0.2}
    return tb.bridge(BEARING, [*NAMES, level_1], [23, -20], duration=8, dt=0.01, axial_force=LOAD)


def _rows(result, code):
    rows = result.bearing_checks
    return rows[rows["code"] == code].set_index(["run", "what"])


def _run(*words):
    return CliRunner().invoke(app, [*map(str, words)])


def _displacements(result, ambient):
    table = result.sel(ambient=ambient).dataset
    values = table["bearing_displacement_max"].values
    return dict(zip(table["motion"].values.tolist(), values.tolist(), strict=True))


def test_demand_is_the_mean_of_three_motions_of_a_level(bridge):
    rows = _rows(tb.check_bearings(bridge, rotation=ROTATION), JRA)
    rubber = tb.load_bearing(BEARING).total_rubber_thickness
    for ambient in (23, -20):
        moved, where = _displacements(bridge, ambient), f"{ambient} degC"
        strain = rows.loc[(where, "Level 2 shear strain")]
        mean = np.mean([moved[name] for name in NAMES])
        assert strain["value"] == pytest.approx(mean / rubber, rel=1e-12)
        assert (strain["limit"], strain["verdict"], strain["unverified"]) == (2.5, "OK", True)
        small = rows.loc[(where, "Level 1 shear strain")]
        assert small["value"] == pytest.approx(moved["jra-i-i-1-x0.2"] / rubber, rel=1e-12)
        assert small["limit"] == 1.5
    assert rows.loc[("23 degC", "rotation"), "value"] == ROTATION
    others = [name for _, name in rows.index if "shear strain" not in name or "local" in name]
    assert {rows.loc[("23 degC", name), "verdict"] for name in others} == {"limit not available"}


@pytest.mark.parametrize(("count", "expected"), [(6, 6.0), (7, 4.0)])
def test_a_mean_of_aashto_needs_seven_motions(count, expected):
    motions = [Motion(name=f"{k}.csv") for k in range(count)]
    data = {"peak": np.arange(1.0, count + 1.0)}
    assert peaks_by_part(data, "peak", motions, "mean of seven").tolist() == [expected]


@pytest.mark.parametrize("count", [2, 3])
def test_verdicts_of_fewer_motions_than_the_rule_needs_say_so(count):
    """AASHTO takes the largest of three motions or more; fewer are no basis of a verdict."""
    result = tb.bridge(BEARING, NAMES[:count], 23, duration=4, dt=0.01, axial_force=LOAD)
    checked = tb.check_bearings(result, "aashto", zone=3)
    rows = _rows(checked, AASHTO).loc["23 degC"]
    names = ["total shear strain", "1.2 times the vertical load at 1.5 times the displacement"]
    verdicts = set(rows.loc[names, "verdict"])
    assert verdicts == ({TOO_FEW} if count == 2 else {"OK"})
    assert rows["source"].str.contains("with 2 motions").sum() == (2 if count == 2 else 0)
    (warning,) = [text for text in checked.warnings if "the largest peaks" in text]
    assert ("too few motions" in warning) == (count == 2)
    pieces = build_pieces(checked)
    tentative = [check for check in pieces.checks if check.verdict == TENTATIVE]
    assert len(tentative) == (2 if count == 2 else 0)
    (actions,) = [block for block in _actions(pieces) if isinstance(block, Bullets)]
    assert actions.items[0].startswith("Add ground motions") == (count == 2)
    assert pieces.answer[0].startswith("2 ground motions are too few") == (count == 2)
    assert ("2 checks of codes have too few" in pieces.answer[-1]) == (count == 2)


def test_strains_of_a_layer_by_hand():
    """D_a P / (A G S) and D_r L^2 theta / (t T_r), of a square and of a round plan."""
    bearing = tb.load_bearing(BEARING)  # 480 mm, 6 layers of 17 mm
    geometry = bearing.geometry
    shape = 480.0 / (4 * 17.0)
    pressed, turned = layer_strains(bearing, LOAD, ROTATION, 1e-3)
    assert pressed == pytest.approx(1.4 * LOAD / 480.0**2 / (1e-3 * shape), rel=1e-12)
    assert turned == pytest.approx(0.5 * 480.0**2 * ROTATION / (17.0 * 102.0), rel=1e-12)
    plan = CircularPlan(shape="circular", diameter=480)
    disc = bearing.model_copy(update={"geometry": geometry.model_copy(update={"plan": plan})})
    pressed, turned = layer_strains(disc, LOAD, ROTATION, 1e-3)
    assert pressed == pytest.approx(LOAD / (math.pi * 240.0**2) / (1e-3 * shape), rel=1e-12)
    assert turned == pytest.approx(0.375 * 480.0**2 * ROTATION / (17.0 * 102.0), rel=1e-12)


def test_lead_is_left_out_of_area_and_modulus_of_all_checks():
    """Of a lead rubber bearing gamma_c = P/(A G S) with A G = K T_r and S = A/(pi D t), A net."""
    bearing = tb.load_bearing("lrb-example")
    geometry, diameter = bearing.geometry, bearing.geometry.plan.diameter
    net = 0.25 * math.pi * (diameter**2 - bearing.lead.diameter**2)
    modulus = checked_modulus(bearing, 23.0)
    element = BearingElement(bearing, 23.0)
    rubber = geometry.total_rubber_thickness
    stiffness = secant_stiffness(element, rubber)
    assert modulus * net == pytest.approx(stiffness * rubber, rel=1e-9)
    pressed, _ = layer_strains(bearing, LOAD, ROTATION, modulus)
    shape = net / (math.pi * diameter * geometry.rubber_thickness)
    assert pressed == pytest.approx(LOAD / (stiffness * rubber * shape), rel=1e-9)
    compression = 1.0 / (6.0 * modulus * shape**2) + 4.0 / (3.0 * 2.0)  # K = 2 GPa
    vertical = net / (rubber * compression)
    assert axial_stiffness(geometry, modulus, bearing.lead) == pytest.approx(vertical, rel=1e-9)


@pytest.mark.parametrize(("zone", "times", "name"), [(4, 1.5, "1.5 times"), (1, 2.0, "twice")])
def test_rows_of_aashto(bridge, zone, times, name):
    rows = _rows(tb.check_bearings(bridge, ["aashto"], rotation=ROTATION, zone=zone), AASHTO)
    rows = rows.loc["23 degC"]
    bearing = tb.load_bearing(BEARING)
    modulus = checked_modulus(bearing, 23.0)
    critical = critical_load(bearing.geometry, modulus, bearing.lead)
    largest = max(_displacements(bridge, 23).values())  # fewer than seven motions
    pressed, turned = layer_strains(bearing, LOAD, ROTATION, modulus)
    total = rows.loc["total shear strain"]
    assert total["value"] == pytest.approx(pressed + largest / 102.0 + 0.5 * turned, rel=1e-12)
    assert (total["limit"], total["verdict"]) == (5.5, TOO_FEW)  # one motion of a group
    still = rows.loc["vertical load without displacement"]
    assert still["verdict"] == "OK"  # whatever the motions
    assert (still["value"], still["limit"]) == (LOAD, pytest.approx(critical / 3.0, rel=1e-12))
    (away,) = [row for what, row in rows.iterrows() if name in what]
    assert away["value"] == pytest.approx(1.2 * LOAD, rel=1e-12)
    share = max(0.0, 1.0 - times * largest / 480.0)
    assert away["limit"] == pytest.approx(critical * share, rel=1e-12)
    assert len([what for what in rows.index if what.startswith("1.2")]) == 1


def test_exceeded_limits_are_warnings(bridge):
    data = bridge.dataset.copy()
    data["bearing_displacement_max"] = 10.0 * data["bearing_displacement_max"]
    result = tb.check_bearings(tb.EarthquakeResult(data), ["jra", "aashto"])
    strain = _rows(result, JRA).loc[("23 degC", "Level 2 shear strain")]
    away = _rows(result, AASHTO).loc["23 degC"].iloc[3]
    assert (strain["verdict"], away["verdict"], away["limit"]) == ("NG", "NG", 0.0)
    assert "; top and bottom no longer overlap" in away["source"]
    output = [text for text in result.warnings if "the limit is" in text]
    assert any(text.startswith(JRA) for text in output)
    again = tb.check_bearings(result, ["jra", "aashto"])
    assert again.bearing_checks.equals(result.bearing_checks)
    assert again.warnings == result.warnings


def _longer():
    """Return a bearing of the same area that is longer than wide."""
    bearing = tb.load_bearing(BEARING)
    plan = RectangularPlan(shape="rectangular", length=600, width=384)
    geometry = bearing.geometry.model_copy(update={"plan": plan})
    return bearing.model_copy(update={"geometry": geometry})


def test_overlap_in_plan_is_that_of_both_displacements():
    pair = {"name": NAMES[0], "across": NAMES[1], "angle": "20 deg"}
    options = {"structure": two_piers(), "duration": 6, "dt": 0.01, "axial_force": LOAD}
    both = tb.bridge(_longer(), [pair], 23, **options, keep=tb.Keep(every=1))
    x, y = np.abs(both["bearing_displacement"].values[0][:, :2].T)
    least = ((600.0 - x) * (384.0 - y)).min() / 230400.0
    line = str(both.dataset.attrs["line"])
    rows = both.bearing_checks.set_index(["part", "what"])["limit"].loc[line]
    assert rows.iloc[3] / rows.iloc[2] == pytest.approx(least, rel=1e-5)  # single precision
    peaks = both.sel(direction="resultant").lines.set_index("line")["displacement_max_mm"]
    strain = _rows(tb.check_bearings(both), JRA)
    strain = strain[strain["part"] == line].loc[("23 degC", "Level 2 shear strain"), "value"]
    assert strain == pytest.approx(peaks[line] / 102.0, rel=1e-6)
    each = tb.bridge(_longer(), [pair], 23, **options, components=1)
    known = tb.check_bearings(each, ["aashto"])
    table = each.lines.set_index(["direction", "line"])["displacement_max_mm"]
    for direction, size in (("x", 600.0), ("y", 384.0)):
        run = next(name for name in each.run_names if name.endswith(f", {direction}"))
        mine = known.bearing_checks[known.bearing_checks["part"] == line]
        own = mine[mine["run"] == run]["limit"]
        moved = table[direction, line]
        assert own.iloc[3] / own.iloc[2] == pytest.approx(1.0 - moved / size, rel=1e-9)
        limit = mine[(mine["code"] == AASHTO) & mine["run"].str.endswith(direction)]["limit"]
        share = 1.0 - 1.5 * moved / size
        assert limit.iloc[3] / (3.0 * limit.iloc[2]) == pytest.approx(share, rel=1e-9)


@pytest.mark.parametrize("axial_force", quick_cases([None, -50.0], 0))
def test_without_compression_there_is_no_demand(bridge, axial_force):
    text = bridge.dataset.attrs["case"].replace('axial_force = "800.0 kN"\n', "")
    assert text != bridge.dataset.attrs["case"]
    text = text if axial_force is None else f'axial_force = "{axial_force} kN"\n{text}'
    data = bridge.dataset.assign_attrs(case=text, bearing_checks=as_attribute([]))
    rows = _rows(tb.check_bearings(tb.EarthquakeResult(data), "aashto"), AASHTO).loc["23 degC"]
    first = rows["verdict"].iloc[:-1]
    assert set(first) == {"demand not available"}
    missing = "demand not available" if axial_force is None else "outside the model"
    assert rows["verdict"].iloc[-1] == missing
    needs = rows["source"].str.startswith("needs the vertical load: give --axial-force; ")
    assert needs.tolist() == [axial_force is None] * 5
    document = build_pieces(tb.check_bearings(tb.EarthquakeResult(data), "aashto"))
    actions = [block for block in _actions(document) if isinstance(block, Bullets)]
    assert any(ACTIONS["not assessed needs"] in one.items for one in actions) == bool(needs.all())


def test_strains_of_all_tables_are_in_percent(bridge):
    result = tb.check_bearings(bridge)
    largest = _rows(result, JRA).xs("Level 2 shear strain", level="what")["value"].max()
    names = [column.head for column in result.tables()["checks_jra"].columns]
    rows = {
        row[0]: dict(zip(names, row, strict=True)) for row in result.tables()["checks_jra"].rows
    }
    shown = rows["Level 2 shear strain"]
    assert shown["Value"] == pytest.approx(100.0 * largest, rel=1e-12)
    assert (shown["Limit"], shown["Unit"]) == ("≤ 250", "%")
    (check,) = [one for one in build_pieces(result).checks if "Level 2 shear" in one.what]
    assert (check.value, check.limit, check.unit) == (shown["Value"], 250.0, "%")


def test_bilinear_bearings_have_a_strain_only():
    result = tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", 23, duration=4, axial_force=LOAD)
    rows = _rows(tb.check_bearings(result), JRA).loc["23 degC"]
    assert rows.loc["Level 2 shear strain", "verdict"] == TOO_FEW
    needs = {"Level 1 shear strain": "a Level 1 motion"}
    needs["Level 2 local shear strain"] = "the plan of the bearing"
    for name, needed in needs.items():
        assert rows.loc[name, "verdict"] == "demand not available"
        assert rows.loc[name, "source"].startswith(f"needs {needed}; ")


def test_checks_are_in_files_tables_and_documents(bridge, tmp_path):
    result = tb.check_bearings(bridge, ["jra", "aashto"])
    place = result.save(tmp_path / "out", figures=False)
    again = tb.load_result(place)
    assert again.bearing_checks.equals(result.bearing_checks)
    assert {"bearing_checks", "checks_jra", "checks_aashto"} <= set(again.tables())
    assert len(result.summary()["bearing_checks"]) == len(result.bearing_checks)
    tb.make_report(place, pdf=False, live=False)
    page = (place / "report.html").read_text(encoding="utf-8")
    assert all(text in page for text in (JRA, AASHTO, "not entered"))


ENTERED = {"edition": "2nd edition", "clause": "clause 9.9", "entered_by": "K. Sato"}


def test_entered_limits_lose_their_star_and_say_who_entered_them(bridge):
    limits = {
        "jra": {
            STRAIN_2: {"value": "20 %", **ENTERED},
            "level_2_overlap_stress": {"value": "12 MPa", **ENTERED},
            "uplift_stress": {"value": "2 MPa", **ENTERED},
            "rotation": {"value": "0.003 rad", **ENTERED},
        },
        "aashto": {"reserve_without_displacement": {"value": 4.0, **ENTERED}},
        "bearing": {"stress": {"value": "3 MPa", **ENTERED}},
    }
    result = tb.check_bearings(bridge, ["jra", "aashto"], rotation=ROTATION, limits=limits)
    rows = _rows(result, JRA).loc["23 degC"]
    strain = rows.loc["Level 2 shear strain"]
    assert (strain["limit"], strain["verdict"], strain["unverified"]) == (0.2, "NG", False)
    assert all(text in strain["source"] for text in ENTERED.values())
    assert rows.loc["Level 2 buckling: stress on the overlap", "limit"] == 12.0
    uplift = rows.loc["uplift: axial force"]
    assert (uplift["limit"], uplift["least"]) == (-2.0 * 480.0**2 / 1e3, True)
    assert (uplift["verdict"], uplift["of_model"]) == ("OK", False)
    assert (rows.loc["rotation", "limit"], rows.loc["rotation", "verdict"]) == (0.003, "NG")
    still = _rows(result, AASHTO).loc["23 degC"].loc["vertical load without displacement"]
    plain = _rows(tb.check_bearings(bridge, "aashto"), AASHTO).loc["23 degC"]
    reserve = plain.loc["vertical load without displacement", "limit"]
    assert 4.0 * still["limit"] == pytest.approx(3.0 * reserve, rel=1e-12)
    (stress,) = {
        (row["limit"], row["verdict"], row["unverified"], row["used"] > 1.0)
        for row in result.bearing_checks.to_dict("records")
        if row["what"] == "compressive stress on the gross plan"
    }
    assert stress == (3.0, "NG", False, True)
    starred = result.bearing_checks.query("unverified and limit == limit")
    assert set(starred.query("code == @JRA")["what"]) == {"Level 1 shear strain"}
    # The edition of a limit that was entered is that of the office.
    names = {check.limited for check in sheet_checks(result.bearing_checks.to_dict("records"))}
    assert f"{AASHTO.partition(' (')[0]}: vertical load without displacement" in names
    assert f"{JRA}: Level 1 shear strain" in names
    again = tb.check_bearings(result, ["jra", "aashto"], rotation=ROTATION)
    assert again.bearing_checks.equals(result.bearing_checks)  # the case holds the limits


def test_uplift_without_a_limit_is_the_smallest_stress_of_the_bearings() -> None:
    """In MPa, the unit of the limit that an office enters; of two lines the one with less load."""
    structure = two_piers()
    first, second = (line.name for line in structure.bearings)
    lines = [{"line": first, "axial_force": "200 kN"}]
    given = {"duration": 1, "structure": structure, "lines": lines, "axial_force": LOAD}
    given["components"] = 1
    result = tb.check_bearings(tb.bridge(BEARING, NAMES[0], 23, **given), "aashto")
    area = tb.load_bearing(BEARING).geometry.plan.area
    rows = result.bearing_checks.query("what == 'uplift: axial force'")
    values = dict(zip(rows["part"], rows["value"], strict=True))
    assert values == pytest.approx({first: 1e3 * 200.0 / area, second: 1e3 * LOAD / area})
    assert set(rows["unit"]) == {"MPa"}
    note = result.tables()["checks_aashto"].note
    assert f"uplift: axial force (smallest {1e3 * 200.0 / area:.3g} MPa)" in note


def test_an_entered_ductility_replaces_first_yield_in_the_report(bridge):
    dataset = bridge.dataset.assign(pier_ductility=2.4 + 0.0 * bridge.dataset["pier_ductility"])
    result = []
    for value in (2.0, 3.0):
        limits = {"pier": {"ductility": {"value": value, **ENTERED}}}
        checked = tb.check_bearings(EarthquakeResult(dataset), [], limits=limits)
        result += [check for check in build_pieces(checked).checks if "ductility" in check.what]
    assert [(check.limit, check.verdict) for check in result] == [(2.0, EXCEEDED), (3.0, PASSED)]
    assert all(text in result[0].source for text in ENTERED.values())


def test_without_stars_no_warning_on_the_published_text(bridge):
    known = {name: {"value": "200 %", **ENTERED} for name in ("level_1_shear_strain", STRAIN_2)}
    result = tb.check_bearings(bridge, limits={"jra": known})
    assert not any("published text" in text for text in result.warnings)
    unread = tb.check_bearings(bridge, limits={"jra": {STRAIN_2: known[STRAIN_2]}})
    assert any("published text" in text for text in unread.warnings)


def test_a_new_file_has_every_check_as_a_comment_and_is_entered_line_by_line(tmp_path):
    """Each line of a limit without "# " and filled in is a limit of that check, and no other."""
    text = limits_text(["jra", "aashto"])
    assert not tomllib.loads(text)
    tables = re.findall(r"^# (\[[a-z]+\..+\])$", text, re.MULTILINE)
    keys = {
        f"[{code.name}.{check.key}]"
        for code in load_codes(["jra", "aashto"])
        for check in code.checks
    }
    keys |= {f"[bearing.{key}]" for key in limit_keys().values()} | {"[pier.ductility]"}
    assert keys == set(tables)
    lines = re.findall(r"^# (\[\w+\.\w+\]|\w+ = .*)$", text, re.MULTILINE)
    filled = "\n".join(lines).replace('""', '"read"')
    numbers = {'"... %"': '"300 %"', '"... MPa"': '"9 MPa"', '"... rad"': '"0.01 rad"'}
    for before, after in numbers.items():
        filled = filled.replace(before, after)
    file = tmp_path / "limits.toml"
    file.write_text(filled, encoding="utf-8")
    limits = load_limits(file)
    for table in tables:
        assert limits.of(*table[1:-1].split(".")) is not None
    assert limits.of("jra", "level_1_shear_strain").number == 1.5
    assert limits.of("aashto", "reserve_without_displacement").number == 3.0
    assert limits.of("pier", "ductility").number == 1.0


@pytest.mark.parametrize(
    ("entry", "reported"),
    [
        ({"value": "2 kN"}, "kN"),
        ({"value": 2.5}, "has no unit"),
        ({"value": "2.5 %"}, "10"),
        ({"edition": ""}, "edition"),
        ({"clause": None}, "clause"),
        ({"entered_by": None}, "entered_by"),
        ({"page": "3"}, "page"),
    ],
)
def test_faulty_limits_are_refused_with_key_and_reason(entry, reported, tmp_path):
    table = {k: v for k, v in ({"value": "250 %", **ENTERED} | entry).items() if v is not None}
    file = tmp_path / "limits.toml"
    file.write_text(tomli_w.dumps({"jra": {STRAIN_2: table}}), encoding="utf-8")
    with pytest.raises(tb.InputError, match=STRAIN_2) as error:
        load_limits(file)
    assert reported in str(error.value)
    assert str(file) in str(error.value)


def test_commands_write_check_and_use_limits(tmp_path):
    file = tmp_path / "limits.toml"
    assert _run("limits", "new", "--code", "jra", "-o", file).exit_code == 0
    assert _run("limits", "new", "-o", file).exit_code == 2  # it exists
    analysis = ("--bearing", BEARING, "--motion", NAMES[0], "--ambient", "23", "--duration", "4")
    target = tmp_path / "out"
    assert _run("bridge", *analysis, "--limits", file, "-o", target).exit_code == 2
    assert not target.exists()
    limit = {"value": "222 %", **ENTERED}
    file.write_text(tomli_w.dumps({"jra": {STRAIN_2: limit}}), encoding="utf-8")
    assert _run("check", file).exit_code == 0
    written = ("--limits", file, "--no-figures", "-o", target)
    assert _run("bridge", *analysis, *written).exit_code == 0
    result = tb.load_result(target)
    assert set(result.bearing_checks["code"]) == {JRA}
    assert 2.22 in result.bearing_checks["limit"].tolist()
    case = target / "case.resolved.toml"
    assert tb.check_bearings(result).bearing_checks.equals(result.bearing_checks)
    again = ("bridge", case, "--no-figures", "-o", tmp_path / "again")
    assert _run(*again).exit_code == 0  # the case states the limits
    assert tb.load_result(tmp_path / "again").bearing_checks.equals(result.bearing_checks)


def test_a_file_without_limits_of_a_code_is_enough(tmp_path):
    file = tmp_path / "limits.toml"
    entry = {"pier": {"ductility": {"value": 2.0, **ENTERED}}}
    file.write_text(tomli_w.dumps(entry), encoding="utf-8")
    assert _run("check", file).exit_code == 0
    analysis = ("--bearing", BEARING, "--motion", NAMES[0], "--ambient", 23, "--duration", 1)
    done = _run("bridge", *analysis, "--limits", file, "--no-figures", "-o", tmp_path / "out")
    assert done.exit_code == 0
    limits = tomllib.loads((tmp_path / "out" / "case.resolved.toml").read_text("utf-8"))["limits"]
    assert limits["pier"]["ductility"]["value"] == 2.0


def test_hybrid_tests_have_no_limits_of_codes():
    with pytest.raises(tb.InputError, match="limits"):
        tb.hybrid(limits={"jra": {STRAIN_2: {"value": "222 %", **ENTERED}}})


@pytest.mark.parametrize(
    ("codes", "options", "key"),
    [
        (["eurocode"], {}, "codes"),
        (["jra", 3], {}, "codes"),
        (None, {}, "codes"),
        ([], {}, "codes"),
        ([["jra"]], {}, "codes"),
        (["jra"], {"rotation": 0.3}, "rotation"),
        (["jra"], {"rotation": math.nan}, "rotation"),
        (["jra"], {"rotation": "0.01 mm"}, "rotation"),
        (["aashto"], {"zone": 5}, "zone"),
        (["aashto"], {"zone": True}, "zone"),
        (["jra"], {"limits": {}}, "limits"),
        (["jra"], {"limits": 3}, "limits"),
    ],
)
def test_bad_input(bridge, codes, options, key):
    with pytest.raises(tb.InputError, match=key):
        tb.check_bearings(bridge, codes, **options)
    with pytest.raises(tb.InputError, match="a part of its motions"):
        tb.check_bearings(bridge.sel(motion=NAMES[0]))
    with pytest.raises(tb.InputError, match="no result of a bridge"):
        tb.check_bearings(3)


def test_codes_are_known_once():
    assert [code.title for code in load_codes(["jra", "aashto", "jra"])] == [JRA, AASHTO]
    assert [code.title for code in load_codes("jra")] == [JRA]


def test_the_command_refuses_before_the_analysis(tmp_path):
    done = CliRunner().invoke(app, ["bridge", "--codes", "en", "-o", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert not (tmp_path / "out").exists()


def test_an_early_end_leaves_out_the_codes_and_names_its_cause():
    strong = {"name": "jra-ii-i-1", "factor": 15}
    given = {"duration": 8, "dt": 0.01, "axial_force": LOAD}
    result = tb.check_bearings(tb.bridge(BEARING, strong, 23, **given), ["jra", "aashto"])
    assert result.outcome == "not_physical"
    assert set(result.bearing_checks["code"]) == {""}
    unchecked = [text for text in result.warnings if "not checked, because" in text]
    assert [text.split(":")[0] for text in unchecked] == [JRA, AASHTO]
    assert all("not_physical" in text for text in unchecked)
    largest = result.table["bearing_strain_max"].max()
    assert largest > 5.0
    assert f"strained to {100 * largest:.0f} % ({result.run_names[0]})" in result.sentence
