"""Several bearing lines and piers: separate rows, bearings, air and counts."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.studies import small_study
from thermobearing.border.schema import validated
from thermobearing.border.toml import to_toml
from thermobearing.design.bounds import DEMANDS, bounds_study, least_safe
from thermobearing.earthquake.answer import main_results
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.measures import COLUMNS, cold_ratios, with_partial_loops
from thermobearing.earthquake.properties.written import with_governing_bearings, with_own_bearing
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.run import build_tasks, find_outcome
from thermobearing.earthquake.tables import _parts_table, governing_runs, make_tables
from thermobearing.quantities.words import change
from thermobearing.structure import model
from thermobearing.structure.matrices import _coordinates
from thermobearing.structure.result import implausible_structure
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.shard import run_shard
from thermobearing.studies.statistics.demand import counted

MOTION: dict[str, Any] = {"motion": "jra-ii-i-1", "duration": 6.0}


def two_piers() -> dict[str, Any]:
    """A deck on two hinged piers that stand on the ground, A without a hinge: stiff."""
    pier = {"on": "ground", "rotates": True}
    spring = {"base": "ground", "rotational_stiffness": "4e7 kN m/rad"}
    line = {"body": "deck", "height": "10 m", "count": 3, "equivalent_stiffness": "2.6 kN/mm"}
    return {
        "name": "two piers",
        "bodies": [{"name": "deck", "moves": True}, {"name": "A"} | pier, {"name": "B"} | pier],
        "masses": [
            {"body": "deck", "height": "10 m", "mass": "400 t"},
            {"body": "A", "height": "7 m", "mass": "150 t"},
            {"body": "B", "height": "7 m", "mass": "150 t"},
        ],
        "springs": [{"name": "foot of A", "body": "A"} | spring],
        "hinges": [
            {
                "name": "foot of B",
                "body": "B",
                "yield_moment": "9000 kN m",
                "yield_rotation": "0.003 rad",
            }
        ],
        "bearings": [
            {"name": "on A", "base": "A"} | line,
            {"name": "on B", "base": "B"} | line | {"count": 1},
        ],
        "report": {"deck": "deck", "pier": "B", "pier_top": "10 m"},
    }


def make_bridge(structure: dict[str, Any]) -> model.Structure:
    return validated(model.Structure, structure, "test")


@pytest.fixture(scope="module")
def study() -> tb.EarthquakeResult:
    lines = [{"line": "on A", "ambient": "-20 degC"}]
    structure = make_bridge(two_piers())
    return tb.bridge("shen-hdr-bridge", ambient=[23.0], structure=structure, lines=lines, **MOTION)


@pytest.fixture(scope="module")
def two_kinds() -> tb.EarthquakeResult:
    """HDR on A, whose force and energy depend much on temperature, and LRB on B, two motions."""
    return tb.bridge(
        "lrb-example",
        ["jra-ii-i-1", "jra-ii-i-2"],
        [23.0, -20.0],
        structure=make_bridge(two_piers()),
        lines=[{"line": "on A", "bearing": "shen-hdr-bridge"}],
        duration=6.0,
    )


def test_the_cold_compares_each_line_with_itself(two_kinds: tb.EarthquakeResult) -> None:
    """The largest force is of the LRB when warm and of the HDR when cold: no ratio of a bearing."""
    keys = ["line_bearing", "motion", "ambient_degC"]
    lines = two_kinds.lines.set_index(keys)
    ratios = cold_ratios(two_kinds).set_index(keys)
    assert len(ratios) == 4
    columns = {"force_max_kN": "bearing_force_max_kN", "energy_kN_mm": "bearing_energy_kN_mm"}
    for (bearing, motion, _), row in ratios.iterrows():
        cold, warm = (lines.loc[(bearing, motion, ambient)] for ambient in (-20.0, 23.0))
        for column, peak in columns.items():
            assert_allclose(row[peak], cold[column] / warm[column])
    forces = two_kinds.lines.groupby(["ambient_degC", "line_bearing"])["force_max_kN"].mean()
    means = forces.loc[-20.0] / forces.loc[23.0]  # not the mean of the ratios of the motions
    assert means["shen-hdr-bridge"] > 1.5 * means["lrb-example"]
    sentence = " ".join(main_results(two_kinds))
    for bearing, ratio in means.items():
        size = change(ratio, "larger", "smaller")
        assert f"with {bearing} the mean bearing force is {size}" in sentence
    rows = {row[0]: row[2] for row in make_tables(two_kinds)["cold"].rows}
    assert {name: cell.split()[0] for name, cell in rows.items()} == {
        name: f"{ratio:.2f}" for name, ratio in means.items()
    }
    assert two_kinds.table["energy_of_warmest"].isna().all()  # of an HDR and an LRB


def test_a_written_row_of_a_line_names_its_own_bearing(two_kinds: tb.EarthquakeResult) -> None:
    written = with_own_bearing(two_kinds.lines)
    assert "line_bearing" not in written
    assert "analysis_bearing" not in written
    bearings = dict(zip(written["line"], written["bearing"], strict=True))
    assert bearings == {"on A": "shen-hdr-bridge", "on B": "lrb-example"}
    twice = pd.concat([two_kinds.lines, two_kinds.lines.assign(bearing="shen-lhdr-bridge")])
    rows = with_own_bearing(twice)
    assert not rows.duplicated(["bearing", "analysis_bearing", "motion", "ambient_degC"]).any()


def test_a_written_run_names_the_bearings_of_its_peaks(two_kinds: tb.EarthquakeResult) -> None:
    table = two_kinds.table
    written = with_governing_bearings(table, two_kinds.line_bearings)
    assert "bearing" not in written
    assert written["analysis_bearing"].tolist() == table["bearing"].tolist()
    bearings = {"on A": "shen-hdr-bridge", "on B": "lrb-example"}
    for name in ("strain", "force"):
        governing = [bearings[line] for line in table[f"{name}_line"]]
        assert written[f"{name}_bearing"].tolist() == governing
    assert set(written["force_bearing"]) != {"lrb-example"}
    assert with_governing_bearings(table, {}) is table


def test_one_sided_loops_are_partial() -> None:
    sides = {"loop_D_plus_mm": [8.6, 35.8, 60.0], "loop_D_minus_mm": [-44.8, -25.7, -29.0]}
    assert with_partial_loops(pd.DataFrame(sides))["loop"].tolist() == ["partial", "", "partial"]


def test_the_energy_of_one_kind_is_the_mean_over_its_lines() -> None:
    structure = make_bridge(two_piers())
    result = tb.bridge("shen-hdr-bridge", ambient=[23.0, -20.0], structure=structure, **MOTION)
    energy = result.lines.set_index(["ambient_degC", "line"])["energy_kN_mm"]
    ratio = energy.loc[-20.0].mean() / energy.loc[23.0].mean()
    assert_allclose(cold_ratios(result)["bearing_energy_kN_mm"], ratio)


def test_the_table_holds_the_governing_values(study: tb.EarthquakeResult) -> None:
    """The largest of all lines and piers with its place; before: line and pier of the report."""
    lines, piers = study.lines.set_index("line"), study.piers.set_index("pier")
    row = study.table.iloc[0]
    assert row["bearing_strain_max"] == lines["strain_max"].max()
    assert row["strain_line"] == lines["strain_max"].idxmax()
    # Line A, in colder air, has the larger force; the report is about B.
    assert row["bearing_force_max_kN"] == lines.loc["on A", "force_max_kN"]
    assert row["force_line"] == "on A"
    assert row["bearing_energy_kN_mm"] == lines["energy_kN_mm"].max()
    assert row["pier_ductility"] == piers.loc["B", "ductility"]
    assert row["pier_displacement_max_mm"] == piers.loc["B", "displacement_max_mm"]
    assert row["displacement_pier"] == row["ductility_pier"] == "B"
    assert float(study["bearing_force_max"][0]) == row["bearing_force_max_kN"]
    assert study.hottest(0)["rubber"] == lines["rubber_max_degC"].max()
    assert np.isnan(piers.loc["A", "ductility"])
    # Each pier moves by itself: A is stiff.
    assert piers.loc["A", "displacement_max_mm"] < 0.3 * piers.loc["B", "displacement_max_mm"]
    turned = piers.loc["B", "rotation_max_rad"]
    assert piers.loc["B", "displacement_max_mm"] == pytest.approx(1e4 * turned)


def test_the_document_is_about_all_lines(study: tb.EarthquakeResult) -> None:
    """Answer, first table and peaks; before: 155 kN of the line of the report."""
    pieces = build_pieces(study)
    force = study.lines["force_max_kN"].max()
    assert f"{force:.3g} kN (" in pieces.answer[2]
    assert "23 °C, line on A)" in pieces.answer[2]
    governing = {row[0]: row[1:] for row in pieces.tables["governing"].rows}
    assert governing["Force of one bearing [kN]"] == [force, "on A", "jra-ii-i-1", 23.0]
    peaks = pieces.tables["peaks"]
    heads = [column.head for column in peaks.columns]
    assert peaks.rows[0][heads.index("Force of one")] == force
    warm = study.lines["rubber_rise_K"].max()
    assert f"{warm:.1f} K" in pieces.answer[3]
    # Histories are those of one line, and say so, with its own peak.
    strains = 100.0 * study.lines.set_index("line")["strain_max"]
    assert strains.idxmax() == "on A"
    assert "line on A," in pieces.figures["loops"].caption
    assert f"{strains['on A']:.0f} %" in pieces.figures["loops"].alt
    assert "line on B," in pieces.figures["temperature"].caption  # of the report


def test_many_rows_become_the_largest_of_all_runs(study: tb.EarthquakeResult) -> None:
    table = _parts_table(study, "line", row_limit=1)
    place = [column.name for column in table.columns].index("rubber_max_degC")
    assert [(row[0], row[place]) for row in table.rows] == [
        (row["line"], row["rubber_max_degC"]) for row in study.lines.to_dict("records")
    ]
    twice = study.dataset.copy(deep=True).assign_coords(line=["on A", "on A too"])
    for name in twice:
        if str(name).startswith("line_"):
            twice[name][..., 1] = twice[name][..., 0]
    assert [row[0] for row in _parts_table(type(study)(twice), "line").rows] == ["on A, on A too"]


def test_a_study_of_runs_counts_the_governing_line(tmp_path: Path) -> None:
    """One by one and in lockstep, as `bridge`; before: line and pier of the report."""
    file = tmp_path / "two.toml"
    file.write_text(to_toml(make_bridge(two_piers())))
    case = {"duration": "4 s", "structure": str(file)}
    study = small_study(case, bearing=["shen-hdr-bridge"], ambient=["-20 degC"], scale=[1.0])
    side = study.design.model_copy(update={"lockstep": True})
    rows = Plan(study).runs
    alone = run_shard(Plan(study), rows)
    together = run_shard(Plan(study.model_copy(update={"design": side})), rows)
    whole = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", -20, structure=file, duration=4)
    drift = whole.piers["displacement_max_mm"].max() / 1e4
    for table in (alone, together):
        for name in COLUMNS:
            assert_allclose(table[name], whole.table[name], rtol=tol.LANE_PEAK, err_msg=name)
        assert_allclose(table["pier_drift_max"], drift, rtol=tol.LANE_PEAK)
        assert_allclose(table["rubber_max_degC"], whole.hottest(0)["rubber"], rtol=1e-6)
    assert whole.table["bearing_strain_max"][0] == whole.lines["strain_max"].max()


def test_a_pier_beyond_its_limits_ends_as_that(tmp_path: Path) -> None:
    """In one run, one by one and in lockstep; it exceeds every capacity of a pier."""
    table = two_piers() | {"limits": {"drift": "0.0004 rad"}}
    file = tmp_path / "two.toml"
    file.write_text(to_toml(make_bridge(table)))
    result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", -20, structure=file, duration=4)
    drift = result.piers["displacement_max_mm"].max() / 1e4
    assert drift > 0.0004
    assert result.outcome == "pier_beyond_limit"
    assert "P-delta" in result.sentence
    case = {"duration": "4 s", "structure": str(file)}
    study = small_study(case, bearing=["shen-hdr-bridge"], ambient=["-20 degC"], scale=[0.01, 1.0])
    side = study.design.model_copy(update={"lockstep": True})
    rows = Plan(study).runs
    alone, together = (
        run_shard(Plan(study.model_copy(update={"design": one})), rows)
        for one in (study.design, side)
    )
    for actual in (alone, together):
        assert actual["outcome"].tolist() == ["completed", "pier_beyond_limit"]
        pier = counted(actual, "pier_ductility")
        assert (pier.left_out, pier.collapsed) == (0, 1)
        assert pier.demand[1] == np.inf
        # The bearing is computed to the end of the motion, if a bearing of failed piers is wanted.
        strain = counted(actual, "bearing_strain_max")
        assert (strain.left_out, strain.computed) == (0, 1)
        assert_array_equal(strain.demand, actual["bearing_strain_max"])
        strain = counted(actual, "bearing_strain_max", "left-out")
        assert (strain.left_out, strain.computed) == (1, 0)
        assert_array_equal(strain.demand, actual["bearing_strain_max"][:1])


@pytest.mark.parametrize(
    ("limits", "outcome"),
    [({}, "completed"), ({"ductility": 1.01}, "pier_beyond_limit"), ({"drift": "1 mrad"}, "")],
)
def test_limits_of_piers_are_keys_of_the_structure(limits: dict[str, Any], outcome: str) -> None:
    task = build_tasks(make_case(two_piers() | {"limits": limits}))[0]
    yields = 0.003 * 1.02
    result = find_outcome(task, [1.0, 1.0], [yields], [9.0, 0.0])
    assert result == (outcome or "completed")
    assert find_outcome(task, [1.0, 1.0], [yields], [9.0, 1001.0]) == "pier_beyond_limit"
    assert find_outcome(task, [1e5, 1.0], [yields], [9.0, 0.0]) == "not_physical"


@pytest.mark.thorough
def test_the_default_study_exceeds_the_limit_of_a_pier() -> None:
    """Ductility 10.7, before "completed" without a word."""
    result = tb.bridge("shen-hdr-bridge", "jra-ii-ii-1", [23, -20])
    assert result.table["outcome"].tolist() == ["completed", "pier_beyond_limit"]
    assert result.table["pier_ductility"][1] == pytest.approx(10.7, abs=0.05)


def test_a_line_in_colder_air(study: tb.EarthquakeResult) -> None:
    lines = study.lines.set_index("line")
    assert list(lines["line_ambient_degC"]) == [-20.0, 23.0]
    assert lines.loc["on A", "rubber_max_degC"] < 23.0 < lines.loc["on B", "rubber_max_degC"]
    each = lines["total_force_max_kN"] / lines["force_max_kN"]
    assert list(each) == [3.0, 1.0]
    air = [one.ambient for one in build_tasks(make_case(two_piers()))[0].lines]
    assert air == [-20.0, 23.0]
    text = "line on A stays at -20 degC in all runs"
    assert not any(text in one for one in study.warnings)  # one temperature is not compared
    more = {
        "structure": make_bridge(two_piers()),
        "lines": [{"line": "on A", "ambient": "-20 degC"}],
    }
    two = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23.0, 0.0], duration=1, **more)
    assert sum(text in one for one in two.warnings) == 1


def make_case(structure: dict[str, Any], **more: Any) -> Any:
    given = {"lines": [{"line": "on A", "ambient": "-20 degC"}], "ambient": [23.0]} | more
    return make_earthquake_case({}, "test", structure=make_bridge(structure), **given)


def test_the_figure_has_a_dot_for_every_part(study: tb.EarthquakeResult, tmp_path: Path) -> None:
    figure = study.plot.parts()
    panels = {ax.get_ylabel(): ax for ax in figure.axes}
    assert set(panels) == {
        "bearing strain [%]",
        "force of the line [kN]",
        "pier displacement [mm]",
        "pier ductility",
    }
    dots = [float(line.get_ydata()[0]) for line in panels["bearing strain [%]"].lines]  # type: ignore[index,arg-type]
    assert_allclose(dots, 100.0 * study.lines["strain_max"])
    ticks = [text.get_text() for text in panels["pier ductility"].get_xticklabels()]
    assert ticks == ["A", "B"]  # as the structure has them; the report is on B


def test_counts_go_into_the_structure() -> None:
    """And the same bearing on a separate line is of the same kind, to the bit."""
    line = {"line": "on B", "count": 4, "equivalent_stiffness": "3 kN/mm"}
    case = make_case(two_piers(), lines=[line | {"bearing": "shen-hdr-bridge"}])
    assert [(b.count, b.equivalent_stiffness) for b in case.structure.bearings] == [
        (3, 2.6),
        (4, 3.0),
    ]
    assert case.lines[0].count is None
    task = build_tasks(make_case(two_piers(), bearings=["shen-hdr-bridge"], lines=case.lines))[0]
    assert task.lines[0].device is task.lines[1].device
    alone = make_case(two_piers(), lines=[line])
    assert alone.lines == ()


def test_lines_of_another_bearing_are_reported_about_with_their_own_numbers() -> None:
    """Bilinear ones, half as strong on A: plain Python would not compile for two kinds."""
    weak = tb.load_bilinear("shen-bilinear-bridge").model_copy(
        update={"name": "weak", "total_rubber_thickness": 56.0}
    )
    case = make_case(two_piers(), bearings=["shen-bilinear-bridge"])
    case = case.model_copy(update={"lines": (case.lines[0].model_copy(update={"bearing": weak}),)})
    task = build_tasks(case)[0]
    assert [one.device.bearing.name for one in task.lines] == ["weak", "shen-bilinear-bridge"]
    assert case.reported_line_number == 1


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([{"line": "on C"}], 'no bearing line is called "on C"; did you mean'),
        ([{"line": "on A"}, {"line": "on A"}], "more than once"),
        ([{"line": "on A", "bearing": "shen-hdr-brige"}], "shen-hdr-bridge"),
        ([{"line": "on A", "weather": "none.csv"}], "none.csv"),
        ([{"line": "on A", "ambient": "0 degC", "weather": "x.csv"}], "not both"),
        ([{"line": f"on {k}", "bearing": "lrb-example"} for k in "AB"], "is not used"),
    ],
)
def test_lines_that_cannot_be(lines: Any, message: str) -> None:
    with pytest.raises(tb.InputError, match=message):
        make_case(two_piers(), lines=lines)


def test_two_lines_of_one_name() -> None:
    table = two_piers()
    table["bearings"][1]["name"] = "on A"
    with pytest.raises(tb.InputError, match='two bearing lines are called "on A"'):
        make_bridge(table)
    table = two_piers()
    table["report"]["line"] = "on C"
    with pytest.raises(tb.InputError, match=r"report\.line"):
        make_bridge(table)


def test_the_line_of_the_report_may_be_said() -> None:
    table = two_piers()
    assert model.reported_line(make_bridge(table)) == 1
    table["report"]["line"] = "on A"
    assert model.reported_line(make_bridge(table)) == 0
    piers = model.list_piers(make_bridge(table))
    assert [(pier.name, pier.base, pier.top, pier.hinges[0]) for pier in piers] == [
        ("B", "ground", 10000.0, 0),
        ("A", "ground", 10000.0, None),
    ]


def test_a_fixed_base_is_that_of_stiff_springs() -> None:
    """The footing held, against the footing on springs a million times as stiff."""
    held = tb.bridge("shen-bilinear-bridge", ambient=23, fixed_base=True, **MOTION)
    stiff = tb.load_structure("pier-p1")
    springs = [
        spring.model_copy(
            update={
                key: 1e6 * value
                for key in ("stiffness", "rotational_stiffness")
                if (value := getattr(spring, key)) is not None
            }
            | {"damping_ratio": 0.0}
        )
        for spring in stiff.springs
    ]
    stiff = stiff.model_copy(update={"springs": tuple(springs)})
    other = tb.bridge("shen-bilinear-bridge", ambient=23, structure=stiff, **MOTION)
    assert held.summary()["structure"] == "pier-p1 (fixed base)"
    assert held.dataset.attrs["coordinates"] == ["deck x", "pier rotation"]
    for name in ("bearing_strain_max", "pier_ductility", "deck_acceleration_max_m_s2"):
        assert_allclose(held.table[name], other.table[name], rtol=tol.STIFF_SPRINGS)


def test_what_has_no_foundation_has_none_to_hold() -> None:
    with pytest.raises(tb.InputError, match="true or false"):
        make_earthquake_case({"fixed_base": "yes"}, "test")
    assert _coordinates(model.fixed_base(tb.load_structure("pier-p1")))[0] == "deck x"


def test_air_of_lines_is_added_to_that_of_the_run() -> None:
    given: dict[str, Any] = {"structure": make_bridge(two_piers()), **MOTION, "duration": 2.0}
    lines = [{"line": name, "ambient": "-5 degC"} for name in ("on A", "on B")]
    plain = tb.bridge("shen-hdr-bridge", ambient=-5, **given)
    output = tb.bridge("shen-hdr-bridge", ambient=-5, lines=lines, **given)
    assert_array_equal(output["line_force"], plain["line_force"])
    other = tb.bridge("shen-hdr-bridge", ambient=23, lines=lines, **given)
    assert_allclose(other["line_force"], plain["line_force"], rtol=1e-6)


def test_a_run_with_several_cold_lines_leaves_the_law_once() -> None:
    """Two lines of one bearing in one run; before, lines were counted and called runs."""
    output = tb.bridge(
        "shen-hdr-bridge", ambient=[-30.0], structure=make_bridge(two_piers()), **MOTION
    )
    (law,) = [text for text in output.warnings if "temperature law" in text]
    assert "; in jra-ii-i-1 at -30 degC)" in law  # of one run, not of several


def test_bounds_judge_every_line_and_pier() -> None:
    structure = make_bridge(two_piers())
    study = bounds_study("shen-hdr-bridge", ambient=[23.0, -20.0], structure=structure, **MOTION)
    assert set(study["part"]) == {"on A", "on B", "A", "B", ""}
    strain = study[study["demand"] == "bearing_strain_max"].set_index("part")
    assert list(strain.index) == ["on A", "on B"]
    assert strain.loc["on A", "coupled_max"] != strain.loc["on B", "coupled_max"]
    shown = least_safe(study)
    assert len(shown) == len(DEMANDS)
    lowest = study.groupby("demand")["envelope_over_coupled"].min()
    assert_array_equal(shown["envelope_over_coupled"], lowest.loc[list(DEMANDS)].to_numpy())
    whole = tb.bridge("shen-hdr-bridge", ambient=[23.0, -20.0], structure=structure, **MOTION)
    largest = whole.lines.groupby("line")["strain_max"].max()
    assert_array_equal(strain["coupled_max"], largest.loc[list(strain.index)])


def test_the_largest_of_all_lines_and_piers_is_said(
    study: tb.EarthquakeResult, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = governing_runs(study).set_index("what")
    farthest = study.lines.loc[study.lines["strain_max"].idxmax()]
    assert rows.loc["bearing strain", "largest"] == farthest["strain_max"]
    assert rows.loc["bearing strain", "part"] == farthest["line"]
    assert rows.loc["pier ductility", "part"] == "B"  # A has no hinge
    deck = float(np.abs(study.dataset["deck_displacement"]).max())
    assert rows.loc["deck displacement [mm]", "largest"] == pytest.approx(deck, rel=1e-3)
    assert (
        study.table["deck_displacement_max_mm"][0] == rows.loc["deck displacement [mm]", "largest"]
    )
    assert study.summary()["largest"] == governing_runs(study).to_dict("records")
    study.show()
    shown = capsys.readouterr().out
    assert "largest of all lines and piers" in shown
    title = study.plot.pier().get_suptitle()
    assert title.replace("\n", " ").endswith("(pier B), shen-hdr-bridge, jra-ii-i-1")


def test_the_structure_of_the_docs_is_what_they_say(tmp_path: Path) -> None:
    """k = M/(theta h^2), u_y = theta h; the equivalent stiffness does not touch the response."""
    text = (Path(__file__).parents[2] / "docs" / "files" / "bridge.md").read_text()
    block = next(b for b in text.split("```") if 'name = "pier and abutment"' in b)
    file = tmp_path / "mine.toml"
    file.write_text(block.removeprefix("toml\n"))
    assert implausible_structure(model.load_structure(file)) == []
    (hinge,) = model.load_structure(file).hinges
    assert hinge.yield_rotation * 8000.0 == pytest.approx(20.0)
    assert hinge.stiffness / 8000.0**2 == pytest.approx(200.0)
    other = tmp_path / "other.toml"
    other.write_text(file.read_text().replace('"2.6 kN/mm"', '"1.3 kN/mm"'))
    one, two = (
        tb.bridge("shen-hdr-bridge", ambient=[23.0], structure=path, **MOTION)
        for path in (file, other)
    )
    assert_array_equal(one["bearing_force"], two["bearing_force"])


def test_a_study_says_what_is_not_usual_in_its_bearing_and_structure() -> None:
    bearing = tb.load_bearing("shen-hdr-bridge")
    soft = bearing.hysteresis.model_copy(update={"layer_stiffness": 0.0784})
    odd = bearing.model_copy(update={"name": "odd", "hysteresis": soft})
    light = two_piers()
    light["masses"][0]["mass"] = "400 kg"
    output = tb.bridge(odd, ambient=[23.0], structure=make_bridge(light), **MOTION).warnings
    assert any(text.startswith("odd: shear modulus K_r t_r / A") for text in output), output
    assert any(text.startswith("mass of the deck = 0.4 t") for text in output), output


def test_histories_of_every_pier_and_line(study: tb.EarthquakeResult) -> None:
    data, run = study.dataset, 0
    kept = np.isfinite(data["time"].values[run])
    for name in study.piers["pier"].unique():
        figure = study.plot.pier(pier=name)
        assert name in figure.get_suptitle()
        drawn = figure.axes[0].lines[0].get_ydata()
        own = data["pier_part_displacement"].sel(pier_part=name).values[run][kept]
        assert np.isin(drawn, own).all()
        assert np.abs(drawn).max() == pytest.approx(np.abs(own).max())
    for name in study.lines["line"].unique():
        figure = study.plot.strain(line=name)
        drawn = np.abs(figure.axes[0].lines[0].get_ydata()).max()
        own = data.sel(line=name).isel(run=run)
        per_mm = float(own["line_strain_max"] / own["line_displacement_max"])
        way = np.abs(own["line_displacement"].values[kept]).max()
        assert drawn == pytest.approx(100.0 * per_mm * way, rel=tol.SIX_DIGITS)
    with pytest.raises(tb.InputError, match='pier = "Q": no pier has that name'):
        study.plot.pier(pier="Q")
