"""Figures of a study draw the curves that there are, and name those that there are not."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text
from numpy.testing import assert_allclose

from tests import tolerances
from tests.unit.made_up_study import HAZARD, ask, beyond_limit, drawn, legend_labels, made_up
from thermobearing.earthquake.measures import damping_sentence
from thermobearing.results import drawing
from thermobearing.results.screen import shown_warnings
from thermobearing.studies import figures as study_figures
from thermobearing.studies.definition.designs import AMBIENT
from thermobearing.studies.figures import remove_earlier
from thermobearing.studies.result import StudyResult
from thermobearing.studies.statistics import fragility
from thermobearing.studies.statistics.demand import ANY, counted, demand_against, quantile
from thermobearing.studies.statistics.fragility import fragility_curve
from thermobearing.studies.statistics.hazard import ALL_TEMPERATURES, RATE_OF_COUNTS


def legend(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def separated(method: str) -> StudyResult:
    """Study with drawn temperatures of which only the largest intensity has exceedances."""
    result = made_up().parts()["shen-hdr-bridge"]
    ambient = np.random.default_rng(3).normal(0.0, 10.0, result.runs)
    # The strongest motion alone exceeds the capacity: one intensity, and one IDA curve.
    strongest = result.table.index == result.table["PGA_m_s2"].idxmax()
    table = result.table.assign(
        ambient_degC=ambient, pier_ductility=np.where(strongest, 1.1, 0.5), outcome="completed"
    )
    table["PGA_m_s2"] = result.table["scale"] * 8.0
    if method == "ida":
        table["ambient_degC"] = result.table["ambient_degC"]
    return ask(StudyResult(table, result.study, result.manifest), capacity=1.0, method=method)


def test_all_temperatures_have_no_curve_where_the_counts_give_none() -> None:
    result = separated("stripes")
    curve = result.find_curves()[1]
    assert curve is not None
    assert curve.outcome == "apart"
    assert curve.name == ALL_TEMPERATURES  # no climate: the temperatures are entered
    figure = result.plot.fragility()
    assert f"{ALL_TEMPERATURES} (no curve)" in legend(figure)
    (ax,) = figure.axes
    # Marks and empty entries of the legend, but no line of a step.
    assert not [line for line in ax.lines if line.get_linestyle() == "-" and len(line.get_xdata())]
    assert not ax.collections
    assert "no bands; 6 motions" in ax.get_title(loc="left")


def test_a_step_among_the_temperatures_leaves_no_curve_of_all() -> None:
    """The mean over levels has no curve where that of a temperature is a step."""
    result = separated("ida")
    levels = StudyResult(result.table, result.study, result.manifest)
    mean = ask(levels, np.linspace(-20.0, 23.0, 50), capacity=1.0).find_curves()[1]
    assert mean is not None
    assert "apart" in {estimate.outcome for _, estimate in mean.parts}
    assert not mean.is_drawable
    whole = ask(made_up(), np.linspace(-20.0, 23.0, 50), capacity=1.0)
    usual = whole.parts()["shen-hdr-bridge"].find_curves()[1]
    assert usual is not None
    assert usual.is_drawable


def test_a_rate_with_bounds_names_its_outcome_in_sentence_table_and_figure() -> None:
    """Below one intensity no run of the cold exceeds the capacity, and from the next all do."""
    part = made_up().parts()["shen-hdr-bridge"]
    scales = np.unique(part.table["scale"])
    cold = part.table["ambient_degC"] == -20.0
    step = np.where(part.table["scale"] > scales[2], 1.5, 0.5)
    table = part.table.assign(PGA_m_s2=8.0 * part.table["scale"], outcome="completed")
    table["pier_ductility"] = np.where(cold, step, table["PGA_m_s2"] / 4.0)
    hours = np.repeat([-20.0, 23.0], [1, 3])
    result = ask(StudyResult(table, part.study, part.manifest), hours, capacity=1.0, hazard=HAZARD)
    rates = result.find_rates()[1]
    assert rates[-20.0].is_bounded
    assert rates["climate"].is_bounded
    (sentence,) = [text for text in result.notes() if "years" in text]
    assert "apart" in sentence
    assert "nan" not in sentence
    rows = result.tables()["rates"]
    assert "25.0 % (−20 °C)" in rows.note
    assert rows.note.count(RATE_OF_COUNTS) == 1
    ax = result.plot.rates().axes[1]
    assert "(apart, bounds)" in " ".join(text.get_text() for text in ax.get_xticklabels())
    ends = [line.get_ydata() for line in ax.lines if line.get_linestyle() == ":"]
    assert_allclose(ends[0], [rates[-20.0].low, rates[-20.0].high])


@pytest.mark.parametrize("method", ["stripes", "cloud"])
def test_the_note_names_the_temperatures_of_bands(method: Any) -> None:
    figure = ask(drawn(paired=False), capacity=1.0, method=method).plot.fragility()
    (ax,) = figure.axes
    (note,) = [ax.get_title(loc="left").replace("\n", " ")]
    # Three motions have no band, and the note says why.
    assert "too few motions for a band: 3" in note
    levels = ask(made_up(), capacity=1.0).parts()["shen-hdr-bridge"].plot.fragility()
    note = levels.axes[0].get_title(loc="left").replace("\n", " ")
    assert "bands of −20 °C and 23 °C; 6 motions" in note


def test_the_legend_of_the_variance_lies_above_its_bars() -> None:
    figure = made_up().plot.variance()
    figure.canvas.draw()
    (ax,) = figure.axes
    box = ax.get_legend()
    assert box is not None
    assert box.get_window_extent().y0 >= ax.get_window_extent().y1


def test_medians_with_other_treatments_of_failed_runs_stand_beside_the_count() -> None:
    """Where they differ: the failed runs of made-up studies have the largest demands."""
    part = made_up().parts()["shen-hdr-bridge"]
    table = part.table.assign(bearing_strain_max=part.table["pier_ductility"])
    result = StudyResult(table, part.study, part.manifest)
    question = {"demand": "bearing_strain_max", "capacity": 3.0}
    left_out = ask(result, **question)
    collapsed = ask(result, **question, failed="collapse").find_curves()[0]
    medians = {name: others["collapse"] for name, others in left_out.other_medians().items()}
    assert medians
    for name, median in medians.items():
        assert median == collapsed[name].median
    note = left_out.tables()["fragility"].note
    assert [note.count(f"{median:.4g} m/s²") for median in medians.values()] == [1] * len(medians)
    # A low capacity is exceeded long before runs fail.
    low = ask(result, demand="bearing_strain_max", capacity=0.5)
    assert set(low.other_medians()) < set(low.find_curves()[0])


def test_a_fragility_of_bearings_says_how_many_runs_of_each_intensity_count() -> None:
    """With failed = "left-out" the strongest motions lose most runs; titles say what is left."""
    part = beyond_limit().parts()["shen-hdr-bridge"]
    outcome = part.table["outcome"]
    table = part.table.assign(PGA_m_s2=part.table["scale"] * 8.0)
    table["bearing_strain_max"] = part.table["PGA_m_s2"] / 4.0
    result = StudyResult(table, part.study, part.manifest)
    question = {"demand": "bearing_strain_max", "capacity": 1.0}
    computed, left_out = ask(result, **question), ask(result, **question, failed="left-out")
    failed = int((outcome == "pier_beyond_limit").sum())
    options: dict[str, Any] = {"temperature": "pooled", "samples": 5}
    curve = computed.fragility(1.0, "bearing_strain_max", **options)
    assert (curve.computed, curve.left_out, curve.incomplete) == (failed, 0, {})
    curve = left_out.fragility(1.0, "bearing_strain_max", failed="left-out", **options)
    assert (curve.computed, curve.left_out) == (0, failed)
    largest = table["PGA_m_s2"].max()
    at_largest = table[table["PGA_m_s2"] == largest]
    used = int((at_largest["outcome"] == "completed").sum())
    assert curve.incomplete[largest] == (used, len(at_largest))
    within = "runs whose pier stays within its limits"
    assert within in left_out.tables()["fragility"].caption
    assert within in left_out.plot._title("fragility")
    assert within not in computed.tables()["fragility"].caption


def test_a_run_that_stopped_beyond_the_capacity_exceeds_it() -> None:
    """Molten lead and a torn bearing after the pier yielded; numbers that are wrong do not."""
    outcome = ["completed", "lead_melted", "lead_melted", "not_physical", "not_physical"]
    table = pd.DataFrame(
        {
            "outcome": outcome,
            "pier_ductility": [0.5, 14.0, 0.8, 13.0, 13.0],
            "bearing_strain_max": [1.0, 4.0, 4.0, 5.2, 2.0],
        }
    )
    runs = counted(table, "pier_ductility", "computed", 1.0)
    assert runs.kept.tolist() == [True, True, False, True, False]
    assert runs.demand.tolist() == [0.5, np.inf, np.inf]
    assert (runs.collapsed, runs.left_out) == (2, 2)
    assert counted(table, "pier_ductility", "left-out", 1.0).left_out == 4
    assert counted(table, "pier_ductility").left_out == 4  # without a capacity


def test_shares_of_the_variance_lack_the_runs_that_stopped_and_say_where_they_are() -> None:
    """A pier beyond its limits has a number; molten lead has none, at the strongest intensity."""
    result = drawn()
    table = result.table.copy()
    strongest = table["Sa_m_s2"] if "Sa_m_s2" in table else table["PGA_m_s2"]
    at_strongest = np.flatnonzero(strongest == strongest.max())[:24]
    table["outcome"] = table["outcome"].astype(object)
    table.loc[at_strongest, "outcome"] = "pier_beyond_limit"
    beyond = StudyResult(table, result.study, result.manifest)
    assert beyond.variance()["share"].tolist() == result.variance()["share"].tolist()
    assert beyond.lost_demands() == (0, len(table), "runs", "")
    assert not any(getattr(text, "code", "") == "variance_incomplete" for text in beyond.warnings)
    stopped = table.assign(outcome=table["outcome"].replace("pier_beyond_limit", "lead_melted"))
    melted = StudyResult(stopped, result.study, result.manifest)
    lost = melted.lost_demands()
    assert (lost.missing, lost.many) == (24, True)
    assert lost.concentration.startswith("Of 24 failed runs 24 have")
    assert melted.variance()["left_out"].iloc[0] == 24
    assert [text.code for text in melted.warnings if "variance" in text] == ["variance_incomplete"]
    assert lost.sentence in melted.tables()["variance"].note


def test_a_median_is_between_the_intensities_that_all_motions_settle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """All runs of six motions exceed at the largest intensity, none at the smallest."""
    exceeding = {2.0: 0, 4.0: 2, 8.0: 4, 16.0: 6}  # motions at each intensity
    rows = [
        {"motion": motion, "Sa": level, "drift": 4.0 if motion < motions else 1.0}
        for motion in range(6)
        for level, motions in exceeding.items()
        for _ in range(4)
    ]
    table = pd.DataFrame(rows)
    five = table[table["motion"] > 0]
    row, fewer = (fragility_curve(runs, "drift", 3.0, "Sa").row() for runs in (table, five))
    assert_allclose([row["median_low"], row["median_high"]], [2.0, 16.0])
    monkeypatch.setattr(fragility, "_limited", lambda estimate, *_: estimate)
    free = fragility_curve(table, "drift", 3.0, "Sa").row()
    assert free["median_low"] < 2.0
    assert free["median_high"] > 16.0
    # Five motions are too few: a probability below one half is not excluded with 95 %.
    assert fragility_curve(five, "drift", 3.0, "Sa").row() == fewer


def test_sentences_have_no_median_of_all_intensities_together() -> None:
    """Those of the fragility, or of each intensity: one of all would be that of the levels."""
    part = drawn()
    sentences = ask(part, capacity=1.0).notes()
    assert all(text[0].isupper() or text[0].isdigit() for text in sentences)
    climate = ask(part, capacity=1.0).all_curves()["climate"]
    assert f"{climate.median:.4g}" in sentences[1]
    assert len(sentences) == 2
    assert "over all 3 intensities" in part.tables()["demand"].caption
    single = ask(part.select(PGA_m_s2=[4.0]))
    assert "over all" not in single.tables()["demand"].caption
    assert len(single.notes()) == 2
    levels = made_up().select(bearing="shen-hdr-bridge")
    sentence = levels.notes()[1]
    collapsed = ask(levels, failed="collapse").notes()[1]
    assert "collapse" in collapsed
    assert "collapse" not in sentence
    assert "inf" not in collapsed
    for ambient in (-20.0, 23.0):
        for scale in (0.25, 2.0):
            median = levels.select(ambient_degC=ambient, scale=scale).table["pier_ductility"]
            assert f"{median.median():.3g}" in sentence or np.isnan(median.median())


def test_runs_that_stopped_count_as_larger_than_their_last_value() -> None:
    """Known below the smallest of these values; a range or a bound above."""
    result = made_up().select(bearing="shen-hdr-bridge")
    demand = np.tile(np.linspace(0.1, 3.6, 36), 3)
    table = result.table.assign(pier_ductility=demand[: result.runs], outcome="completed")
    stopped = table["pier_ductility"].between(2.2, 2.45) | (table["pier_ductility"] > 3.15)
    table.loc[stopped, "outcome"] = "lead_melted"
    study = ask(StudyResult(table, result.study, result.manifest), capacity=3.3)
    for ambient, rows in study.demand("pier_ductility").groupby("ambient_degC"):
        runs = table[table["ambient_degC"] == ambient]
        values = np.where(runs["outcome"] == "completed", runs["pier_ductility"], np.inf)
        least = study.demand("pier_ductility", least=True)
        least = least[least["ambient_degC"] == ambient]
        for share in ("0.05", "0.16", "0.5", "0.84", "0.95"):
            assert rows[share].iloc[0] == quantile(values, float(share))
            assert least[share].iloc[0] == quantile(runs["pier_ductility"], float(share))
        assert rows["runs"].iloc[0] == rows["all_runs"].iloc[0] == len(runs)
        assert rows["0.5"].iloc[0] == np.median(runs["pier_ductility"])  # below all that stopped
        assert np.isinf(rows["mean"].iloc[0])
    texts = study.tables()["demand"].texts()[0]
    heads = [column.title for column in study.tables()["demand"].columns]
    assert "at least" in texts[heads.index("95 %")]
    assert f"{stopped.sum()} of {result.runs} runs failed" in study.tables()["demand"].note
    assert study.demand("pier_ductility", failed="left-out")["runs"].sum() == (~stopped).sum()


def test_bands_of_medians_come_from_motions() -> None:
    """Runs of a motion are alike: the band allows for 12 motions, and fewer than 5 have none."""
    rng = np.random.default_rng(2)
    contained = 0
    for _ in range(60):
        of_motion = np.repeat(rng.normal(0.0, 0.5, 12), 30)
        table = pd.DataFrame(
            {
                "motion": np.repeat(np.arange(12), 30),
                "ambient_degC": 0.0,
                "drift": np.exp(of_motion + 0.1 * rng.normal(size=360)),
                "outcome": "completed",
            }
        )
        (row,) = demand_against(table, "drift").to_dict("records")
        contained += row["median_low"] <= 1.0 <= row["median_high"]
    assert contained / 60 > tolerances.LEAST_COVERAGE
    # As if runs were independent, the band is far too narrow.
    (alone,) = demand_against(table.drop(columns="motion"), "drift").to_dict("records")
    assert alone["median_high"] - alone["median_low"] < 0.5 * (
        row["median_high"] - row["median_low"]
    )
    (few,) = demand_against(table[table["motion"] < 4], "drift").to_dict("records")
    assert np.isnan([few["median_low"], few["median_high"]]).all()
    words = drawn().tables()["demand"]  # three motions
    assert "too few" in words.texts()[0]


def test_figures_without_titles_have_the_number_of_failed_runs() -> None:
    result = ask(beyond_limit().parts()["shen-hdr-bridge"], capacity=0.2)
    with drawing.figure_style({"titles": False}):
        drawn_figures = [result.plot.demand(), result.plot.ida(), result.plot.fragility()]
    for figure in drawn_figures:
        texts = [text.get_title().get_text() for text in figure.legends]
        texts += [ax.get_title(loc="left") for ax in figure.axes]
        assert any("failed" in text for text in texts)
    note = result.plot.ida().legends[0].get_title().get_text().replace("\n", " ")
    assert "beyond the axis" in note  # which ends at a ductility of 0.8
    inside = ask(beyond_limit().parts()["shen-hdr-bridge"], capacity=1.0).plot.ida()
    assert "beyond the axis" not in inside.legends[0].get_title().get_text()


def test_a_median_from_too_few_exceedances_has_no_curve() -> None:
    """Two of 108 runs: in the table, in the figure and for the other treatments."""
    part = made_up().select(bearing="shen-hdr-bridge", ambient_degC=23.0)
    largest = part.table["scale"].rank(method="first", ascending=False) <= 2
    table = part.table.assign(
        PGA_m_s2=part.table["scale"] * 8.0,
        pier_ductility=np.where(largest, 2.0, 0.5),
        outcome="completed",
    )
    result = ask(StudyResult(table, part.study, part.manifest), capacity=1.0, method="cloud")
    (curve,) = result.find_curves()[0].values()
    assert curve.few_words == "too few exceedances"
    assert not curve.has_median
    table_of_curves = result.tables()["fragility"]
    assert "too few exceedances" in table_of_curves.texts()[0]
    figure = result.plot.fragility()
    assert any("(too few exceedances)" in text for text in legend(figure))
    assert not figure.axes[0].collections
    assert not [
        line
        for line in figure.axes[0].lines
        if line.get_linestyle() == "-" and len(line.get_xdata())
    ]


@pytest.mark.parametrize(("shares", "mixed"), [([0, 3, 12], 1), ([0, 2, 5, 10, 12], 0)])
def test_too_few_intensities_with_both_outcomes_are_named(shares: list[int], mixed: int) -> None:
    levels = len(shares)
    table = pd.DataFrame(
        {
            "motion": np.tile(np.arange(12), levels),
            "im": np.repeat(np.arange(1.0, levels + 1.0), 12),
            "drift": (np.tile(np.arange(12), levels) < np.repeat(shares, 12)).astype(float) + 0.5,
        }
    )
    if mixed:  # one more level with both outcomes gives a dispersion
        table.loc[table.index[0], "drift"] = 1.5
    curve = fragility_curve(table, "drift", 1.0, "im", samples=9)
    assert curve.has_median
    assert bool(curve.few_mixed) == bool(mixed)
    if mixed:
        assert curve.few_mixed.startswith("2 intensities")


def test_a_demand_is_computed_once_for_tables_sentences_and_figures(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its bootstrap takes seconds with a million runs; each caller has its own copy."""
    keys: list[tuple[Any, ...]] = []

    def recorded(table: pd.DataFrame, demand: str, across: str, **options: Any) -> pd.DataFrame:
        keys.append((demand, across, *options.values()))
        return demand_against(table, demand, across, **options)

    monkeypatch.setattr("thermobearing.studies.result.demand_against", recorded)
    result = beyond_limit().parts()["shen-hdr-bridge"]
    result.tables()
    result.notes()
    result.plot.demand()
    assert len(keys) == len(set(keys)) >= 2
    before = result.demand()["0.5"].tolist()
    changed = result.demand()
    changed["0.5"] = -1.0
    assert result.demand()["0.5"].tolist() == before


def test_the_legend_of_demand_names_only_what_is_drawn() -> None:
    """Where runs fail at every temperature, no mean is finite; at all but one, it is a mark."""
    table = made_up().demand()
    runs = counted(made_up().table, made_up().demand_name, capacity=ANY)
    draw = partial(study_figures._draw_demand, result=made_up(), across=AMBIENT, runs=runs)
    assert "mean" in legend_labels(draw(table))
    table["mean"] = [1.0, *[np.inf] * (len(table) - 1)]  # in the first of two panels
    figure = draw(table)
    lines = {str(line.get_label()).split(",")[0]: line for line in figure.axes[0].lines}
    assert lines["mean"].get_marker() == "_"
    table[["mean", "0.95"]] = np.inf
    labels = legend_labels(draw(table))
    assert "mean" not in labels
    assert "5 to 95 %" not in labels
    assert "16 to 84 % of runs" in labels


def drawn_texts(figure: Any) -> str:
    return " ".join(" ".join(text.get_text() for text in figure.findobj(Text)).split())


def test_incomplete_studies_say_so_in_figures() -> None:
    """The figures of some runs, of one bearing too, state how many of the study there are."""
    complete = ask(made_up(), capacity=1.0, hazard=HAZARD)
    some = StudyResult(
        complete.table[:-16],
        complete.study,
        {"runs": complete.runs},
        "out/p1",
        complete.question,
    )
    count = f"{complete.runs - 16} of {complete.runs} runs"
    part = some.select(bearing="shen-hdr-bridge")
    assert part.outcome == "incomplete"
    assert part.warnings[0].startswith(count)
    for result, is_complete in ((some, False), (complete, True)):
        for name, draw in result.plot.draw_all().items():
            assert (count in drawn_texts(draw())) != is_complete, name


def test_viscous_damping_above_a_quarter_is_a_warning() -> None:
    """The words are those of `bridge`, with the runs above a quarter and the largest share."""
    result = made_up()
    shares = np.full(result.runs, 0.2)
    codes = [getattr(text, "code", "") for text in result.warnings]
    assert "viscous_damping" not in codes
    shares[:7], shares[7], shares[8] = 0.3, 0.84, np.nan
    table = result.table.assign(damping_of_input=shares)
    damped = StudyResult(table, result.study, result.manifest, "out/p1")
    (text,) = [text for text in damped.warnings if getattr(text, "code", "") == "viscous_damping"]
    kind = result.study.factors.structure.levels[0].damping.kind
    assert text == damping_sentence(shares[~np.isnan(shares)], kind)
    assert f"8 of {result.runs - 1} runs" in text
    assert "at most 84" in text
    assert text in shown_warnings(damped.warnings)


def test_titles_name_the_bearing() -> None:
    result = ask(made_up(), capacity=1.0, hazard=HAZARD)
    for name, draw in result.plot.draw_all().items():
        kind, _, bearing = name.partition("-")
        if bearing:
            assert bearing in draw().get_suptitle(), kind


def test_earlier_figures_are_removed(tmp_path: Path) -> None:
    """Those of another set of bearings or question; all other files stay."""
    result = ask(made_up(), capacity=1.0)
    earlier = ["fragility.png", "rates-shen-hdr-bridge.png", "ida.svg"]
    of_user = ["fragility-notes.png", "fragility.csv", "sketch.png"]
    kept = ["demand.png", "fragility-shen-hdr-bridge.pdf", "fragility-shen-hdr-bridge.png"]
    for name in [*earlier, *of_user, *kept]:
        (tmp_path / name).touch()
    written = [tmp_path / name for name in kept[:2]]
    assert {path.name for path in remove_earlier(result, tmp_path, written)} == set(earlier)
    assert {path.name for path in tmp_path.iterdir()} == {*of_user, *kept}
