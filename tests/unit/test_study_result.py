"""What a study found: numbers, curves, figures, answers to questions, documents."""

import json
import re
import shlex
import shutil
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import thermobearing as tb
import thermobearing.studies.figures as figures
from tests.quick import quick_cases
from tests.unit.made_up_study import (
    HAZARD,
    MOTIONS,
    SITE,
    SPREAD,
    ask,
    beyond_limit,
    drawn,
    legend_labels,
    made_up,
)
from thermobearing.bearing.model import TemperatureLaw
from thermobearing.border.errors import InputError
from thermobearing.commands.study import studies as app
from thermobearing.earthquake.run import run_task
from thermobearing.loading import load_result
from thermobearing.quantities.warned import BEYOND_TESTS, NO_RANGE
from thermobearing.report.pieces import Heading
from thermobearing.report.template import document
from thermobearing.results import drawing
from thermobearing.studies import figures as study_figures
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.question import (
    Question,
    change_question,
    load_question,
    save_question,
)
from thermobearing.studies.report import _input_tables, build_pieces
from thermobearing.studies.result import StudyResult, study_result
from thermobearing.studies.run.engine import repeat_run
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.statistics.demand import ANY, counted, in_classes, worst_runs
from thermobearing.studies.statistics.hazard import Hazard
from thermobearing.studies.tables import result_tables


def test_summary_and_worst_runs() -> None:
    result = made_up()
    assert (result.runs, result.outcome) == (216, "some_failed")
    assert result.factors == ["bearing", "motion", "scale", "ambient_degC"]
    summary = result.summary()
    assert summary["outcomes"]["not_converged"] == result.failed
    assert (summary["demand"], summary["intensity"]) == ("pier_ductility", "PGA_m_s2")
    worst = result.worst(3)
    # The scale alone says nothing where it was found for an intensity.
    assert_allclose(worst["PGA_m_s2"], result.table.loc[worst["run"], "PGA_m_s2"])
    through = result.table[result.table["outcome"] == "completed"]
    failed = result.table[result.table["outcome"] != "completed"]
    best = through.nlargest(3, "pier_ductility")["run"].tolist()
    assert worst["run"].tolist() == [*best, failed["run"].min()]
    words = shlex.split(worst["command"][0])
    assert words[3:] == ["out/p1", str(best[0]), "-o", f"out/p1-run-{best[0]}"]
    assert worst_runs(failed, 3) == []
    with pytest.raises(InputError):
        worst_runs(through.drop(columns="pier_ductility"), 3)


def test_a_few_runs_are_shown_and_saved(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = made_up()
    few = StudyResult(whole.table.iloc[:6], whole.study, whole.manifest)
    assert few.outcome == "incomplete"
    assert few.warnings[0].startswith("6 of 216 runs")
    few.show()
    assert "6 runs" in capsys.readouterr().out
    few.save(tmp_path / "out", figures=False)
    saved = load_result(tmp_path / "out")
    assert len(saved.tables["table"]) == 6  # type: ignore[union-attr]


def test_very_many_motions_and_numbers_are_reported_in_short() -> None:
    whole = made_up()
    runs = np.arange(whole.runs)
    table = whole.table.assign(motion=[f"m{k % 40}" for k in runs], scale=1.0 + runs % 20)
    reported = _input_tables(StudyResult(table, whole.study, {}))["factors"]
    rows = {row[0]: row[2] for row in reported.rows}
    assert rows["motion"].endswith("m10, m11 and 28 more")
    assert rows["scale"] == "1 to 20, 20 values"


def test_the_inputs_state_what_all_runs_share() -> None:
    whole = made_up()
    cold = np.where(np.arange(whole.runs) % 2, -21.5, 17464.0)
    table = whole.table.assign(ambient_degC=cold, motion="only")
    result = StudyResult(table, whole.study, {})
    tables = _input_tables(result)
    shared = dict(tables["constant"].rows)
    assert shared["structure"] == whole.study.factors.structure.levels[0].name
    assert not shared.keys() & {row[0] for row in tables["factors"].rows}
    (values,) = [row[2] for row in tables["factors"].rows if row[0] == "ambient temperature"]
    assert set(values.split(", ")) == {"\N{MINUS SIGN}21.5", "17464"}


def test_runs_outside_the_calibration_range_are_counted_for_each_bearing() -> None:
    """By limit, the largest number first, with the side where a column of the table tells it."""
    whole = made_up()
    number = np.arange(whole.runs)
    limits = np.where(number % 4 == 0, "strain strain_rate", "strain_rate")
    limits = np.where(number % 8 == 1, "", limits)
    strain = np.where(number % 8 == 0, 2.6, 0.1)
    table = whole.table.assign(beyond_tested=limits, bearing_strain_max=strain)
    hdr = (table["bearing"] == "shen-hdr-bridge").to_numpy()
    outside = int((hdr & (limits != "")).sum())
    above, below = (int((hdr & (number % 8 == place)).sum()) for place in (0, 4))
    result = StudyResult(table, whole.study, {"runs": whole.runs})
    (warning,) = [text for text in result.beyond_ranges() if text.place == "shen-hdr-bridge"]
    assert warning.code == BEYOND_TESTS
    assert warning in result.warnings
    numbers = [int(text) for text in re.findall(r"(?:: | in |of )(\d+)(?= |,|$)", warning)]
    assert numbers == [outside, hdr.sum(), outside, *sorted([above, below], reverse=True)]
    assert warning.index("strain rate outside") < warning.index("strain above 250 %")
    assert "strain below 50 %" in warning
    # Few are no warning; a report still does not say that all lie inside.
    rare = table.assign(beyond_tested=np.where(number == 0, "strain", ""))
    few = StudyResult(rare, whole.study, {"runs": whole.runs})
    assert not few.beyond_ranges()
    pieces = build_pieces(few)
    assert [len(part) for part in (pieces.validity, pieces.notes)] == [0, 1]
    assert not pieces.validity_unknown
    # A table of an earlier version was not compared, and a law without tests has no range.
    earlier = StudyResult(table.drop(columns="beyond_tested"), whole.study, {})
    assert [text.code for text in earlier.beyond_ranges()] == [NO_RANGE] * 2


def test_a_report_counts_the_runs_outside_under_validity() -> None:
    whole = made_up()
    table = whole.table.assign(beyond_tested="ambient")
    result = StudyResult(table, whole.study, {"runs": whole.runs})
    pieces = build_pieces(result)
    assert len(pieces.validity) == 2  # a sentence for each bearing, as in `warnings`
    assert not set(pieces.validity) & set(pieces.warnings)
    headings = [block.text for block in document(pieces, {}).blocks if isinstance(block, Heading)]
    assert "Validity" in headings


def test_a_law_of_the_user_is_stated_and_asked_for_by_the_commands() -> None:
    whole = made_up()
    (bearing, *others) = whole.study.factors.bearing.levels
    assert not any("--law" in command for command in whole.worst()["command"])
    law = TemperatureLaw.model_construct(law="arrhenius@12345678", parameters={"elastic": 310.0})
    named = bearing.model_copy(update={"temperature_law": law})
    levels = whole.study.factors.bearing.model_copy(update={"levels": [named, *others]})
    factors = whole.study.factors.model_copy(update={"bearing": levels})
    study = whole.study.model_copy(update={"factors": factors})
    result = StudyResult(whole.table, study, whole.manifest, "out/p1")
    assert all("--law" in command for command in result.worst()["command"])
    shared = dict(_input_tables(result)["constant"].rows)
    assert shared[f"law of {bearing.name}"] == "arrhenius@12345678 elastic = 310.0"


def test_curves_of_one_bearing_only() -> None:
    result = made_up()
    with pytest.raises(InputError, match="would mix bearings"):
        result.fragilities(1.0)
    parts = result.parts()
    assert list(parts) == ["shen-hdr-bridge", "shen-lhdr-bridge"]
    curves = parts["shen-hdr-bridge"].fragilities(1.0, samples=40)
    medians = [curve.median for curve in curves.values()]
    assert list(curves) == [-20.0, 0.0, 23.0]
    assert medians == sorted(medians)
    both = result.select(ambient_degC=-20.0).fragilities(1.0, by="bearing", samples=40)
    assert both["shen-hdr-bridge"].median < both["shen-lhdr-bridge"].median
    with pytest.raises(InputError, match="no run has"):
        result.select(bearing="none")
    with pytest.raises(InputError, match="no column"):
        result.select(bearng="none")


def test_rates_over_the_climate_and_over_the_warm() -> None:
    part = made_up().parts()["shen-hdr-bridge"]
    hours = np.random.default_rng(2).normal(8.0, 9.0, 2000)
    part = ask(part, hours, capacity=1.0, hazard=HAZARD, failed="collapse")
    curves, rates = part.find_rates()
    assert all(curve.left_out == 0 for curve in curves.values())
    table = part.rates_table(curves, rates).set_index("name")
    assert list(rates) == [-20.0, 0.0, 23.0, "climate"]
    assert table.loc[23.0, "over_reference"] == 1.0
    assert table.loc[-20.0, "over_reference"] > table.loc["climate", "over_reference"] > 1.0
    assert table.loc[-20.0, "over_low"] > 1.0  # same motions: far narrower than bands of rates
    years = table.loc["climate", "rate"] * table.loc["climate", "return_period_years"]
    assert years == pytest.approx(1.0)
    with pytest.raises(InputError):
        part.rates(curves, Hazard([1.0, 2.0], [2.0, 1.0], "PGV"))


def test_classes_of_temperatures_are_from_cold_to_warm() -> None:
    falling = pd.DataFrame({"ambient_degC": np.arange(20.0, -20.0, -1.0)})
    table, by = in_classes(falling, "ambient_degC")
    names = table[by].unique().tolist()
    assert [names[0], names[-1]] == ["−19 to −10 °C", "11 to 20 °C"]
    assert table["ambient_degC"].is_monotonic_increasing


def test_drawn_temperatures_are_put_into_classes_and_are_a_climate_themselves() -> None:
    whole = made_up().parts()["shen-hdr-bridge"]
    rng = np.random.default_rng(3)
    table = whole.table.assign(ambient_degC=rng.normal(0.0, 10.0, whole.runs))
    result = StudyResult(table, whole.study, whole.manifest)
    result = ask(result, capacity=1.0, failed="collapse")
    curves, climate = result.find_curves()
    assert climate is not None
    assert len(curves) == 4
    assert all(name.endswith("°C") for name in curves)
    assert sum(curve.runs for curve in curves.values()) == climate.runs == result.runs
    with pytest.raises(InputError):
        result.over_climate(curves, [0.0])


def test_variance_by_correlation_ratio() -> None:
    result = made_up().variance().set_index("factor")
    assert result["share"]["scale"] > result["share"]["ambient_degC"]
    assert result["share"].sum() == pytest.approx(1.0)
    assert result["left_out"].iloc[0] == made_up().failed


def test_every_figure_reports_failed_runs() -> None:
    result = ask(made_up(), np.linspace(-20.0, 23.0, 50), capacity=1.0, hazard=HAZARD)
    figures = result.plot.draw_all()
    names = ["demand", "variance"]
    for bearing in ("shen-hdr-bridge", "shen-lhdr-bridge"):
        names += [f"ida-{bearing}", f"fragility-{bearing}", f"rates-{bearing}"]
    assert list(figures) == names
    for name in ("demand", "variance", *names[2:5]):
        texts = figures[name]().findobj(match=lambda artist: hasattr(artist, "get_text"))
        assert any("left out" in text.get_text() for text in texts), name
    without = [name for name in names if name[:4] not in ("frag", "rate")]
    assert list(made_up().plot.draw_all()) == without
    with pytest.raises(InputError):
        ask(made_up(), hazard=HAZARD).plot.draw_all()


def test_treatments_of_runs_of_a_pier_beyond_its_limits() -> None:
    result = beyond_limit()
    strained = result.table.assign(bearing_strain_max=result.table["PGA_m_s2"] / 4.0)
    result = StudyResult(strained, result.study, result.manifest, "out/p1")
    part = ask(result, demand="bearing_strain_max", capacity=1.0).parts()["shen-hdr-bridge"]
    assert part.failed > 0
    for failed, counts in (
        ("computed", (0, 0, part.failed)),
        ("left-out", (part.failed, 0, 0)),
        ("collapse", (0, part.failed, 0)),
    ):
        options: dict[str, Any] = {"temperature": "pooled", "failed": failed, "samples": 5}
        curve = part.fragility(1.0, "bearing_strain_max", **options)
        assert (curve.left_out, curve.collapsed, curve.computed) == counts
        assert curve.sentence.startswith(f"{part.failed} of {part.runs} runs failed")
        assert curve.runs == part.runs - curve.left_out
    assert f"{part.failed} of {part.runs} runs failed and are counted with" in part.warnings[0]
    of_pier = part.fragility(1.0, "pier_ductility", temperature="pooled", samples=5)
    assert (of_pier.left_out, of_pier.collapsed) == (0, part.failed)


def test_runs_of_a_pier_beyond_its_limits_are_ranked() -> None:
    whole = beyond_limit()
    ductility = whole.table["pier_ductility"].fillna(3.3 + 0.01 * whole.table["run"])
    strain = whole.table["PGA_m_s2"] / 4.0
    table = whole.table.assign(pier_ductility=ductility, bearing_strain_max=strain)
    result = StudyResult(table, whole.study, whole.manifest, "out/p1")
    failed = table[table["outcome"] == "pier_beyond_limit"]["run"]
    worst = result.worst(3)["run"].tolist()
    assert worst == [*failed.tolist()[::-1][:3], failed.min()]
    assert result.worst(result.runs)["run"].is_unique
    by_strain = result.worst(3, "bearing_strain_max")
    assert by_strain["run"].tolist()[:3] == table.nlargest(3, "bearing_strain_max")["run"].tolist()


def test_a_cloud_that_contradicts_its_runs_is_a_warning() -> None:
    result = ask(drawn(paired=False), capacity=1.0, method="cloud")
    kinked = result.table.assign(
        pier_ductility=result.table["pier_ductility"] ** np.where(result.table["scale"] > 0, 4.0, 1)
    )
    kinked["pier_ductility"] = np.where(
        kinked["PGA_m_s2"] > 11.0, 1.2, 0.01 * result.table["pier_ductility"]
    )
    wrong = StudyResult(kinked, result.study, result.manifest, question=result.question)
    codes = [getattr(text, "code", "") for text in wrong.warnings]
    assert codes == ["curve_contradicted"]
    by_stripes = StudyResult(
        kinked, result.study, {}, question=Question(capacity=1.0, method="stripes")
    )
    assert by_stripes.warnings == []


def test_the_table_of_fragility_has_a_row_over_the_climate() -> None:
    """All temperatures together, as the annual rates have it."""
    of_all = ask(drawn(paired=False), capacity=1.0)
    table = result_tables(of_all)["fragility"]
    assert [row[0] for row in table.rows][-1] == "climate"
    medians = [column.title for column in table.columns].index("Median PGA [m/s²]")
    expected = of_all.fragility(1.0, name="climate").median
    assert table.rows[-1][medians] == pytest.approx(expected)
    # Over levels it is a mean of curves, whose parameters have no band.
    of_levels = ask(made_up(), np.linspace(-20.0, 23.0, 50), capacity=1.0)
    table = result_tables(of_levels)["fragility-shen-hdr-bridge"]
    climate = of_levels.parts()["shen-hdr-bridge"].find_curves()[1]
    assert climate is not None
    assert table.rows[-1][medians] == pytest.approx(climate.median)
    assert np.isnan([climate.row()[key] for key in ("median_low", "dispersion_high")]).all()
    assert [
        row[0]
        for row in result_tables(ask(made_up(), capacity=1.0))["fragility-shen-hdr-bridge"].rows
    ] == ["−20 °C", "0 °C", "23 °C"]


def test_the_inputs_state_how_factors_are_defined() -> None:
    tables = _input_tables(drawn(paired=True))
    definitions = {row[0]: row[-1] for row in tables["factors"].rows}
    assert definitions["scale"] == "PGA: levels 4 m/s^2, 8 m/s^2, 12 m/s^2"
    assert definitions["bearing.K_r"] == "factor: lognormal, median 1.0, cov 0.2"
    assert definitions["ambient temperature"] == ("a random hour of the climate cold-town, 1 year")
    (paired,) = [row[1] for row in tables["design"].rows if row[0] == "paired"]
    assert paired.startswith("true")
    assert "paired" not in dict(_input_tables(made_up())["design"].rows)


def test_the_figure_of_the_variance_says_that_a_share_below_zero_is_an_error() -> None:
    shares = made_up().variance()
    draw = partial(study_figures._draw_variance, counts=made_up().lost_demands().sentence)
    plain, doubtful = (
        draw(shares.assign(share=shares["share"] - shift), "pier_ductility")
        for shift in (0.0, shares["share"].min() + 0.1)
    )
    assert "paired" not in plain.get_supxlabel()
    assert f"{shares['left_out'].iloc[0]} failed" in plain.get_supxlabel()
    assert plain.axes[0].get_xlabel() == "share of the variance [%]"
    assert "paired" in doubtful.get_supxlabel()
    assert min(bar.get_width() for bar in doubtful.axes[0].patches) == 0.0
    assert "as zero" in doubtful.get_supxlabel().replace("\n", " ")


def test_collapses_leave_shares_of_the_variance_and_are_stated_once() -> None:
    """They have no number: shares of all factors were NaN, and the figure an empty frame."""
    result = beyond_limit()
    actual = result.variance()
    assert_allclose(actual["share"], made_up().variance()["share"])
    assert (actual["left_out"] == result.failed).all()
    assert drawing.holds_data(result.plot.variance())
    (sentence,) = result.warnings
    assert sentence.count(f"{result.failed} of {result.runs} runs failed") == 1
    assert sentence != made_up().warnings[0]


def test_the_median_of_the_demand_is_inside_its_panel() -> None:
    """Also where so many runs collapse that the upper fractiles are infinite."""
    result = ask(made_up(), capacity=1e-6)
    demand = result.demand()
    collapsed = demand.assign(**{"0.84": np.inf, "0.95": np.inf, "mean": np.inf})
    runs = counted(result.table, result.demand_name, capacity=ANY)
    for ax in figures._draw_demand(collapsed, result, "ambient_degC", runs).axes:
        assert ax.get_ylim()[1] > demand["0.5"].max()


def test_bands_and_marks_of_figures_with_collapses_have_their_words() -> None:
    result = ask(beyond_limit(), capacity=1.0)
    (legend,) = result.plot.demand().legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert any("5 %" in label and "failed" in label for label in labels)
    assert not any("failed" in text.get_text() for text in made_up().plot.demand().legends[0].texts)
    part = result.parts()["shen-hdr-bridge"]
    for capacity, marked in ((1.0, True), (0.01, False)):  # the panel ends at 4 times the capacity
        figure = ask(part, capacity=capacity).plot.ida()
        marks = [line for ax in figure.axes for line in ax.lines if line.get_marker() == "x"]
        words = [text.get_text() for text in figure.legends[0].get_texts()]
        assert bool(marks) == ("last before collapse" in words) == marked
        right = figure.axes[0].get_xlim()[1]
        assert all((np.asarray(line.get_xdata()) <= right).all() for line in marks)


def test_classes_of_temperatures_have_colours_from_cold_to_warm() -> None:
    names = ["-25 to -13 °C", "-13 to 0 °C", "0 to 10 °C", "10 to 25 °C"]
    colours = study_figures._level_colours(names)
    assert colours == study_figures._level_colours([-20.0, -5.0, 5.0, 20.0])
    assert study_figures._level_colours([20.0, -20.0]) == [colours[3], colours[0]]


def test_a_note_on_a_fragility_lies_above_its_panel() -> None:
    (ax,) = ask(made_up(), capacity=1.0).parts()["shen-hdr-bridge"].plot.fragility().axes
    assert "left out" in ax.get_title(loc="left")
    assert not [text for text in ax.texts if text.get_text()]


def test_too_few_motions_or_levels_are_said_instead_of_numbers() -> None:
    part = ask(made_up(), capacity=1.0, hazard=HAZARD).parts()["shen-hdr-bridge"]
    four = part.select(motion=MOTIONS[:4])
    tables, usual = result_tables(four), result_tables(part)
    for name, ends in (("fragility", ("low", "high")), ("rates", ("low", "high"))):
        heads = [column.title for column in tables[name].columns]
        for row, text in zip(tables[name].texts(), usual[name].texts(), strict=True):
            for head, cell, number in zip(heads, row, text, strict=False):
                banded = any(word in head.split() for word in ends)
                assert (cell == "too few") == banded, head
                assert number != "too few"
    (ax,) = four.plot.fragility().axes
    assert not ax.collections
    curves, rates = four.find_rates()
    assert all(rate.few_motions for rate in rates.values())
    assert all(curve.few_motions for curve in curves.values())
    # A median beyond the largest intensity is no result, whatever the number of motions.
    high = ask(part.select(scale=[0.25, 0.5]), capacity=0.8)
    curves, _ = high.find_curves()
    assert [bool(curve.beyond_levels) for curve in curves.values()] == [False, True, False]
    assert "too few" in [cell for row in result_tables(high)["fragility"].texts() for cell in row]
    labels = legend_labels(high.plot.fragility())[:3]
    assert ["too few" in label for label in labels] == [False, True, False]
    # Of three temperatures, the coldest and the warmest have a band.
    assert len(part.plot.fragility().axes[0].collections) == 2


def test_methods_take_their_demand_from_their_arguments() -> None:
    """The options of the last figures do not change what Python computes."""
    part = made_up().parts()["shen-hdr-bridge"]
    table = part.table.assign(bearing_strain_max=2.0 * part.table["pier_ductility"])
    plain = StudyResult(table, part.study, part.manifest)
    asked = ask(plain, demand="bearing_strain_max", capacity=2.5, failed="collapse")
    assert asked.default_demand == plain.demand_name == "pier_ductility"
    assert asked.demand_name == "bearing_strain_max"
    curve = asked.fragility(1.0, temperature="pooled", samples=5)
    assert (curve.demand, curve.collapsed) == ("pier_ductility", 0)
    pd.testing.assert_frame_equal(asked.demand(), plain.demand())
    assert asked.worst(1).columns[-2] == "pier_ductility"
    # Tables and figures are those of the question.
    curves, _ = asked.find_curves()
    assert {curve.demand for curve in curves.values()} == {"bearing_strain_max"}
    assert "bearing strain" in asked.plot.demand().get_suptitle()


def test_a_curve_is_printed_on_one_line() -> None:
    part = ask(made_up(), capacity=1.0).parts()["shen-hdr-bridge"].select(ambient_degC=-20.0)
    curve = part.fragility(1.0, name="cold")
    text = repr(curve)
    assert "\n" not in text
    assert len(text) < 200
    assert f"{curve.median:.4g}" in text
    assert f"of {curve.runs} runs" in text


def test_temperatures_are_apart_in_figures_of_fragility() -> None:
    """Each has its panel of IDA curves, and open marks of its own size at its intensities."""
    part = ask(made_up(), capacity=1.0).parts()["shen-hdr-bridge"]
    panels = [ax for ax in part.plot.ida().axes if ax.get_visible()]
    titles = [f"{at} °C, 6 curves" for at in ("−20", "0", "23")]
    assert [ax.get_title(loc="left") for ax in panels] == titles
    cold = part.select(ambient_degC=-20.0).ida().fractiles()
    (median,) = [line for line in panels[0].lines if line.get_label() == "50 % fractile"]
    shown = cold[cold["curves"] == 6]["0.5"].to_numpy()
    assert_allclose(np.asarray(median.get_xdata())[1:], shown[np.isfinite(shown)])
    (ax,) = part.plot.fragility().axes
    marks = [line for line in ax.lines if line.get_marker() == "o" and len(line.get_xdata())]
    assert {line.get_markerfacecolor() for line in marks} == {"none"}
    assert len({line.get_markersize() for line in marks}) == 3
    for line, curve in zip(marks, part.find_curves()[0].values(), strict=True):
        assert_allclose(line.get_xdata(), curve.counts[curve.intensity])


def test_a_median_is_stated_in_g_too() -> None:
    table = result_tables(ask(made_up(), capacity=1.0))["fragility-shen-hdr-bridge"]
    titles = [column.title for column in table.columns]
    both = [titles.index(f"Median PGA [{unit}]") for unit in ("m/s²", "g")]
    for row in table.rows:
        assert row[both[0]] == pytest.approx(9.80665 * row[both[1]])


@pytest.mark.parametrize("method", quick_cases(["stripes", "cloud"], 1))
def test_draws_of_each_run_have_fragility_and_rates_and_no_ida(method: Any) -> None:
    result = ask(drawn(paired=False), capacity=1.0, method=method, hazard=HAZARD)
    assert list(result.plot.draw_all()) == ["demand", "variance", "fragility", "rates"]
    assert {"fragility", "rates"} <= set(result_tables(result))
    assert not any("paired = true" in text for text in result.warnings)
    with pytest.raises(InputError):
        ask(result, capacity=1.0, method="ida").find_curves()
    assert drawn(paired=True).has_ida
    assert not drawn(paired=True).warnings


def test_paired_draws_have_one_share_of_the_variance() -> None:
    """One number of the draw tells all of its factors: they had equal shares, and the rest less
    than nothing.
    """
    result = drawn(paired=True).variance().set_index("factor")["share"]
    both = "ambient_degC, bearing.K_r, bearing.m_T"
    assert list(result.index) == ["motion", "PGA_m_s2", both, "interaction and rest"]
    assert result["interaction and rest"] >= 0.0
    assert result.sum() == pytest.approx(1.0)
    alone = drawn(paired=False).variance()["factor"].tolist()
    assert alone[2:] == ["ambient_degC", "bearing.K_r", "bearing.m_T", "interaction and rest"]


def test_indices_over_a_climate_name_the_temperature() -> None:
    one: dict[str, Any] = {"bearing": "shen-hdr-bridge", "motion": MOTIONS[0]}
    one |= {"ambient": {"climate": "cold-town", "years": 1}, "bearing.K_r": SPREAD}
    design = {"kind": "sobol", "samples": 16, "arrangement": "saltelli"}
    table = {"kind": "study", "name": "sobol", "factors": one, "design": design}
    study = make_study(table, "test")
    runs = Plan(study).runs
    runs = runs.assign(outcome="completed", pier_ductility=runs["bearing.K_r"])
    result = StudyResult(runs, study, {"runs": len(runs)})
    assert result.variance()["factor"].tolist() == ["ambient_degC", "bearing.K_r"]
    codes = [getattr(text, "code", "") for text in result.warnings]
    assert "correlation_ratios" not in codes
    # Two motions have each sample twice: shares are of another kind, and the result says so.
    crossed = make_study(table | {"factors": one | {"motion": MOTIONS[:2]}}, "test")
    runs = Plan(crossed).runs.assign(outcome="completed")
    runs = runs.assign(pier_ductility=runs["bearing.K_r"])
    several = StudyResult(runs, crossed, {"runs": len(runs)})
    assert "correlation_ratios" in [getattr(text, "code", "") for text in several.warnings]
    assert "interaction and rest" in several.variance()["factor"].tolist()


def test_tables_say_their_units() -> None:
    part = ask(made_up().parts()["shen-hdr-bridge"], capacity=1.0, hazard=HAZARD)
    tables = result_tables(part)
    heads = {name: [column.title for column in table.columns] for name, table in tables.items()}
    assert {"Median PGA [m/s²]", "Median PGA, 95 % low [m/s²]"} <= set(heads["fragility"])
    assert {"Rate [1/year]", "Rate high [1/year]", "Return period [year]"} <= set(heads["rates"])
    output = [part.split(": ")[1] for part in tables["fragility"].note.split("; ")]
    assert len(output) == len(set(output))
    strain = made_up().table.assign(bearing_displacement_max_mm=made_up().table["pier_ductility"])
    question = Question(demand="bearing_displacement_max_mm")
    demand = result_tables(StudyResult(strain, made_up().study, {}, question=question))["demand"]
    assert "Mean [mm]" in [column.title for column in demand.columns]


def test_a_question_without_an_answer() -> None:
    part = made_up().parts()["shen-hdr-bridge"]
    with pytest.raises(InputError):
        part.find_rates()
    with pytest.raises(InputError):
        ask(part, demand="PGA_m_s2").find_curves()


def test_tables_keep_their_numbers_whatever_the_order_of_rows() -> None:
    part = made_up().parts()["shen-hdr-bridge"]
    mixed = part.table.sample(frac=1.0, random_state=1)
    again = StudyResult(mixed, part.study, part.manifest)
    pd.testing.assert_frame_equal(part.demand(), again.demand())
    one, two = part.fragilities(1.0, samples=5), again.fragilities(1.0, samples=5)
    assert [c.median for c in one.values()] == pytest.approx([c.median for c in two.values()])


CAPACITY = 0.00035  # strain, in a study of half a second


@pytest.fixture
def directory(small_done: Path, tmp_path: Path) -> Path:
    (tmp_path / "site.csv").write_text(SITE)
    return Path(shutil.copytree(small_done, tmp_path / "p1"))


def run(words: list[Any]) -> tuple[int, str]:
    result = CliRunner().invoke(app, [str(word) for word in words])
    return result.exit_code, result.output


def test_a_question_is_kept_and_read_back(directory: Path) -> None:
    options = {"capacity": CAPACITY, "hazard": "site.csv", "weather": "cold-town", "failed": None}
    question = change_question(load_question(directory), options, directory.parent)
    save_question(directory, question)
    again = study_result(directory).question
    assert again.model_dump() == question.model_dump()
    assert again.capacity == CAPACITY
    assert again.hazard is not None
    assert again.hazard.rate == (0.5, 0.05, 0.0025, 0.0005, 0.00005)
    assert len(again.temperatures.temperature) > 8000
    save_question(directory, change_question(again, {"capacity": 2.0}))
    assert load_question(directory).hazard == question.hazard


def test_a_document_answers(directory: Path) -> None:
    options = {"capacity": CAPACITY, "demand": "bearing_strain_max", "hazard": "site.csv"}
    save_question(directory, change_question(Question(), options, directory.parent))
    result = tb.load_result(directory)
    assert isinstance(result, StudyResult)
    assert result.question.capacity == CAPACITY
    pieces = build_pieces(result)
    assert "largest bearing strain above 0.00035, from 8 runs" in pieces.question
    assert pieces.answer[0].startswith("All 8 runs")
    assert {"demand", "variance", "worst", "fragility-shen-hdr-bridge"} <= set(pieces.tables)
    assert list(pieces.figures)[:3] == ["demand", "variance", "ida-shen-hdr-bridge"]
    assert pieces.identity["Command"] == "thermobearing study study.toml -o p1"
    files = tb.make_report(directory, title={"project": "Bridge 12"}, pdf=False)
    page = files[0].read_text()
    assert "Bridge 12" in page
    assert "Shares of the variance" in page


@pytest.mark.thorough
def test_figures_by_the_command(directory: Path) -> None:
    words = ["figures", directory, "--demand", "bearing_strain_max", "--capacity", CAPACITY]
    status, output = run([*words, "--hazard", directory.parent / "site.csv", "--json"])
    assert status == 0, output
    reported = json.loads(output.splitlines()[-1])
    names = [Path(name).stem for name in reported["files"]]
    assert {"demand", "variance", "ida-shen-hdr-bridge", "rates-shen-hdr-bridge"} <= set(names)
    # Figures of another demand than the default one do not replace those.
    folders = {Path(name).parent for name in reported["files"]}
    assert folders == {directory / "figures" / "bearing_strain_max"}
    assert "Annual rates, shen-hdr-bridge" in output
    assert load_question(directory).capacity == CAPACITY
    status, output = run(["figures", directory, "--capacity", "-1"])
    assert status == 2


def test_figures_of_a_paper_by_the_command(directory: Path) -> None:
    style = ["--figure-format", "svg", "--figure-width", "single-column", "--no-titles", "-q"]
    assert run(["figures", directory, *style]) == (0, "")
    text = (directory / "figures" / "demand.svg").read_text()
    assert 'width="255.1' in text  # 90 mm in points
    assert "against" not in text  # the title
    status, output = run(["figures", directory, "--figure-width", "3"])
    assert status == 2
    assert "figure-width" in output


@pytest.mark.thorough
def test_worst_and_repeat_by_the_command(directory: Path, tmp_path: Path) -> None:
    words = ["worst", directory, "--count", 2, "--demand", "bearing_strain_max", "--json"]
    status, output = run(words)
    assert status == 0, output
    worst = json.loads(output.splitlines()[-1])["runs"]
    assert len(worst) == 2
    assert worst[0]["command"] in output
    number = worst[0]["run"]
    status, output = run(["repeat", directory, number, "-o", tmp_path / "again", "--no-figures"])
    assert status == 0, output
    again = tb.load_result(tmp_path / "again")
    strain = study_result(directory).table.set_index("run")["bearing_strain_max"][number]
    assert again.table["bearing_strain_max"].tolist() == [strain]
    status, output = run(["repeat", directory, 8])
    assert status == 2
    assert "no run 8" in output


def test_figures_read_the_columns_that_they_need(directory: Path) -> None:
    demand = "bearing_strain_max"
    save_question(directory, Question(demand=demand, capacity=CAPACITY))
    whole, read = study_result(directory), study_result(directory, demands=[demand])
    assert {"id", "bearing_heat_kN_mm"} <= set(whole.table) - set(read.table)
    assert demand in read.table
    assert [str(warning) for warning in read.warnings] == [str(text) for text in whole.warnings]
    tables, expected = read.tables(), whole.tables()
    assert list(tables) == list(expected)
    for name, table in tables.items():
        assert (table.rows, table.note) == (expected[name].rows, expected[name].note)
    assert list(read.plot.draw_all()) == list(whole.plot.draw_all())
    # With a name that does not exist, an error names similar ones among all columns.
    assert list(study_result(directory, demands=["bearing_heat"]).table) == list(whole.table)


def test_a_study_without_a_run_has_no_result(directory: Path) -> None:
    for file in (directory / "shards").glob("*.parquet"):
        file.unlink()
    with pytest.raises(InputError, match="no run"):
        study_result(directory)


TABLE = {
    "kind": "study",
    "name": "p1",
    "case": {"duration": "6 s"},
    "factors": {
        "bearing": ["shen-bilinear-bridge", "shen-hdr-bridge"],
        "motion": "jra-ii-i-1",
        "scale": [0.5, 1.5],
        "ambient": "-20 degC",
    },
}


def test_a_run_again_has_the_same_bits_and_is_what_bridge_does() -> None:
    study = make_study(TABLE, "test")
    row = Plan(study).runs.to_dict("records")[3]
    history = run_task(Preparer(Plan(study)).make_task(row))
    again = repeat_run(study, 3)
    moved = again.dataset["bearing_displacement"].values[0]
    assert np.array_equal(moved, history.bearing(0)["displacement"][::2].astype(moved.dtype))
    motion = {"name": "jra-ii-i-1", "factor": 1.5}
    bridge = tb.bridge("shen-hdr-bridge", motion, -20, duration=6)
    assert np.array_equal(moved, bridge.dataset["bearing_displacement"].values[0])
    assert "factor = 1.5" in again.dataset.attrs["case"]
    assert again.table["bearing"].tolist() == ["shen-hdr-bridge"]
