"""Fragility curves that their own runs contradict, and runs that stopped at a limit, in a study."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

from tests.unit.made_up_study import HAZARD, ask, drawn, legend_labels, made_up
from thermobearing.border.errors import InputError
from thermobearing.commands.study import studies as app
from thermobearing.studies.question import save_question
from thermobearing.studies.report import write_pelicun
from thermobearing.studies.result import StudyResult
from thermobearing.studies.statistics.demand import counted, worst_runs
from thermobearing.studies.statistics.fragility import OUTCOMES
from thermobearing.studies.statistics.hazard import Rate
from thermobearing.studies.tables import _period, count_failures, result_tables, worst_table

COLD = -20.0
ROOT = Path(__file__).parents[2]


def with_step() -> StudyResult:
    """Half of the runs exceed the capacity at all but the smallest intensity, in the cold."""
    part = made_up().parts()["shen-hdr-bridge"]
    levels = {scale: k for k, scale in enumerate(np.unique(part.table["scale"]))}
    # 30 motions at each intensity, so that a count of a half is unlikely where a curve has none.
    table = pd.concat(
        [part.table.assign(motion=part.table["motion"].astype(str) + f"-{k}") for k in range(5)],
        ignore_index=True,
    )
    level = table["scale"].map(levels)
    number = table["motion"].astype("category").cat.codes
    cold = np.where(number % 2 == 0, level > 0, level == 5)
    beyond = np.where(table["ambient_degC"] == COLD, cold, level > number % 4)
    table = table.assign(
        run=range(len(table)),
        PGA_m_s2=8.0 * table["scale"],
        pier_ductility=np.where(beyond, 1.5, 0.5),
        outcome="completed",
    )
    return StudyResult(table, part.study, {"runs": len(table)}, "out/step")


def stopped() -> StudyResult:
    """Lead melts in the three strongest runs, two of which pass 500 % strain before."""
    part = made_up().parts()["shen-hdr-bridge"].select(ambient_degC=COLD)
    strain = part.table["PGA_m_s2"] / 2.0
    order = strain.rank(method="first", ascending=False)
    table = part.table.assign(
        bearing_strain_max=np.where(order <= 2, 6.0 - 0.1 * order, np.where(order == 3, 4.0, 0.3)),
        outcome=np.where(order <= 3, "lead_melted", "completed"),
        pier_ductility=part.table["PGA_m_s2"] / 8.0,
    )
    return StudyResult(table, part.study, part.manifest, "out/stopped")


@pytest.mark.parametrize("method", ["stripes", "ida"])
def test_a_contradicted_curve_says_so_wherever_it_is_stated(method: Any, tmp_path: Path) -> None:
    temperatures = np.linspace(-20.0, 23.0, 50)
    result = ask(with_step(), temperatures, capacity=1.0, method=method, hazard=HAZARD)
    curves = result.all_curves()
    outcomes = {name: curve.outcome for name, curve in curves.items()}
    assert outcomes == {
        COLD: "contradicted",
        0.0: "completed",
        23.0: "completed",
        "climate": "contradicted",
    }
    tables = result_tables(result)
    frame = {row[0]: row for row in tables["fragility"].rows}
    assert "contradicted" in frame["−20 °C"]
    assert "contradicted" not in frame["0 °C"]
    counts = tables["counts"].rows
    # Those of every curve, of which one contradicts its counts.
    assert list(dict.fromkeys(row[0] for row in counts)) == ["−20 °C", "0 °C", "23 °C"]
    assert [row[2:4] for row in counts[:6]] == [[30, 0], *[[30, 15]] * 4, [30, 30]]
    assert tables["counts"].note.count("°C") == 1
    assert ["contradicted" in row for row in tables["rates"].rows] == [True, False, False, True]
    texts = " ".join(result.notes())
    assert texts.count("contradicted") >= 3
    codes = [getattr(text, "code", "") for text in result.warnings]
    assert "curve_contradicted" in codes
    figure = result.plot.fragility()
    labels = legend_labels(figure)
    assert labels[0] == "−20 °C (contradicted)"
    assert "contradicted" not in labels[1]
    assert "contradicted" in figure.axes[0].get_title(loc="left")
    ticks = [text.get_text() for text in result.plot.rates().axes[1].get_xticklabels()]
    assert ["contradicted" in text for text in ticks] == [True, False, False, True]
    warnings = write_pelicun(result, tmp_path / "pelicun").without_curve
    damage = pd.read_csv(tmp_path / "pelicun" / "damage.csv")
    assert damage["Incomplete"].tolist() == [1, 0, 0]
    assert len(warnings) == 1
    assert warnings[0].startswith(str(damage["ID"][0]))


def test_runs_that_stopped_are_counted_in_each_mode_and_ranked() -> None:
    result = stopped()
    (row,) = count_failures(result.table).to_dict("records")
    assert (row["outcome"], row["runs"]) == ("lead_melted", 3)
    assert row["also"] == "2 beyond 500 % strain"
    assert row["also"] in result.notes()[0]
    # The column of newer runs, also of a pier beyond its limits; the outcome is not repeated.
    limits = np.where(result.table["outcome"] == "lead_melted", "strain lead_temperature pier", "")
    (row,) = count_failures(result.table.assign(limits_passed=limits)).to_dict("records")
    assert row["also"] == "3 beyond 500 % strain and 3 with a pier beyond its limits"
    assert count_failures(result.table[result.table["outcome"] == "completed"])["also"].empty
    worst = result.worst(4, "bearing_strain_max")
    assert worst["outcome"].tolist() == ["lead_melted"] * 3 + ["completed"]
    assert_allclose(worst["bearing_strain_max"], [5.9, 5.8, 4.0, 0.3])
    shown = worst_table(result, worst.drop(columns="command"))
    assert [row[-1] for row in shown.rows] == ["at least 5.9", "at least 5.8", "at least 4", 0.3]
    assert shown.note
    completed = result.select(outcome="completed").worst(1, "bearing_strain_max")
    assert not worst_table(result, completed).note
    diverged = result.table["outcome"].where(result.table["run"] != worst["run"][0], "diverged")
    ranked = worst_runs(result.table.assign(outcome=diverged), 2, "bearing_strain_max")
    assert ranked == worst["run"].tolist()[1:3]
    assert worst_runs(result.table.assign(outcome="diverged"), 3) == []


def test_the_figure_of_ida_counts_runs_as_its_capacity_does() -> None:
    """A run that stopped beyond the capacity is a collapse in curves, fractiles and the median."""
    result = ask(stopped(), capacity=2.5, demand="bearing_strain_max", method="ida")
    drawn_curves = result.ida("bearing_strain_max", capacity=2.5).curves
    infinite = sum(int(np.isinf(curve.demand).sum()) for curve in drawn_curves)
    counted_runs = counted(result.table, "bearing_strain_max", "computed", 2.5)
    assert infinite == counted_runs.larger == 3
    (curve,) = result.find_curves()[0].values()
    assert curve.larger == 3
    note = result.plot.ida().legends[0].get_title().get_text().replace("\n", " ")
    assert curve.sentence in note
    assert "last before collapse or stop" in legend_labels(result.plot.ida())
    # Without a capacity all runs that stopped are larger than their last values.
    assert sum(int(np.isinf(c.demand).any()) for c in result.ida("bearing_strain_max").curves) > 0
    above = result.ida("bearing_strain_max", capacity=5.85).curves
    assert sum(int(np.isinf(curve.demand).sum()) for curve in above) == 1


def test_a_curve_is_of_one_temperature_unless_all_are_asked_for() -> None:
    part = made_up().parts()["shen-hdr-bridge"]
    with pytest.raises(InputError, match=r'temperature = -20 or 0 or 23 .*"pooled"'):
        part.fragility(1.0)
    with pytest.raises(InputError, match="no run has temperature = 5"):
        part.fragility(1.0, temperature=5.0)
    with pytest.raises(InputError, match="3 temperatures"):
        made_up().fragilities(1.0, by="bearing")
    cold = part.fragility(1.0, temperature=COLD, samples=5)
    assert cold.row()["median"] == part.fragilities(1.0, samples=5)[COLD].row()["median"]
    assert part.fragility(1.0, temperature="pooled", samples=5).runs > 2 * cold.runs
    assert drawn(paired=False).fragility(1.0, samples=5).runs == drawn(paired=False).runs
    by = made_up().fragilities(1.0, by="bearing", temperature=COLD, samples=5)
    assert by["shen-hdr-bridge"].median == cold.median


def test_ida_curves_are_of_one_temperature_unless_all_are_asked_for() -> None:
    part = made_up().parts()["shen-hdr-bridge"]
    with pytest.raises(InputError, match=r'temperature = -20 or 0 or 23 .*"pooled"'):
        part.ida()
    assert len(part.ida(temperature=COLD).curves) == 6
    assert len(part.ida(temperature="pooled").curves) == 18


def test_the_figure_of_ida_has_the_median_of_each_temperature_at_the_capacity() -> None:
    result = ask(made_up().parts()["shen-hdr-bridge"], capacity=1.0, method="ida")
    panels = [ax for ax in result.plot.ida().axes if ax.get_visible()]
    for ax, curve in zip(panels, result.find_curves()[0].values(), strict=True):
        (mark,) = [line for line in ax.lines if line.get_marker() == "D"]
        assert_allclose([*mark.get_xdata(), *mark.get_ydata()], [1.0, curve.median])


def test_rates_name_the_governing_temperature_first_and_the_warmest() -> None:
    levels = ask(made_up().parts()["shen-hdr-bridge"], capacity=1.0, hazard=HAZARD)
    rates = levels.find_rates()[1]
    assert rates[COLD].rate == max(rate.rate for rate in rates.values())
    sentences = [text for text in levels.notes() if "years" in text]
    assert [text.partition(" °C")[0] for text in sentences] == ["−20", "23"]
    # Over a climate its rate is the answer, which no temperature governs alone.
    climate = ask(levels, np.linspace(COLD, 23.0, 50), capacity=1.0, hazard=HAZARD)
    assert sum("years" in text for text in climate.notes()) == 1


@pytest.mark.parametrize(
    ("years", "stated"),
    [(5812.0, "5810"), (14.26, "14.3"), (123456.0, "123000"), (2.345e7, "2.34e+07")],
)
def test_return_periods_have_three_digits(years: float, stated: str) -> None:
    rate = Rate(1.0 / years, 0.5 / years, 2.0 / years, np.ones(3), groups=12)
    assert f"in {stated} years" in _period(rate)


def test_a_demand_without_bands_says_why() -> None:
    part = made_up().parts()["shen-hdr-bridge"]
    strongest = part.table["scale"] > 0.4
    table = part.table.assign(outcome=np.where(strongest, "pier_beyond_limit", "completed"))
    result = StudyResult(table.assign(pier_ductility=0.5), part.study, part.manifest)
    note = result.plot.demand().legends[0].get_title().get_text().replace("\n", " ")
    assert "no band 5 to 95 % and 16 to 84 % of runs" in note
    full = StudyResult(
        table.assign(pier_ductility=0.5, outcome="completed"), part.study, part.manifest
    )
    assert "no band" not in full.plot.demand().legends[0].get_title().get_text()


def test_medians_of_few_motions_say_how_many_a_band_needs() -> None:
    few = made_up().parts()["shen-hdr-bridge"].select(motion=["jra-ii-i-1", "jra-ii-i-2"])
    table = result_tables(few)["demand"]
    assert table.rows[0][-2:] == ["too few", "too few"]
    assert "fewer than 5 motions" in table.note
    assert "motions" not in result_tables(made_up())["demand"].note


def test_the_documents_have_every_outcome_of_a_curve() -> None:
    text = (ROOT / "docs" / "files" / "study.md").read_text(encoding="utf-8")
    table = text.partition("**Outcomes of a fragility curve**")[2].partition("In place of")[0]
    rows = "".join(line.split("|")[1] for line in table.splitlines() if line.startswith("| `"))
    assert [f"`{name}`" for name in OUTCOMES if f"`{name}`" not in rows] == []


def test_figures_of_another_method_replace_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders = []
    study = ask(made_up(), capacity=1.0)
    monkeypatch.setattr("thermobearing.studies.result.study_result", lambda *_, **__: study)

    def note_folder(self: Any, folder: Path, **options: Any) -> list[Path]:
        folders.append(folder.relative_to(tmp_path).as_posix())
        return []

    monkeypatch.setattr(type(study.plot), "save_all", note_folder)
    save_question(tmp_path, study.question)
    for method in ("stripes", "cloud"):
        CliRunner().invoke(app, ["figures", str(tmp_path), "--method", method, "--quiet"])
    assert folders == ["figures", "figures/cloud"]
