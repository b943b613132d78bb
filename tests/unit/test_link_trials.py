"""Links in place of bearings: peaks of the same bridge, and those of the coupled analysis."""

import io
import tomllib
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.unit.test_lines_and_piers import two_piers
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.border.schema import validated
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.properties.lines import line_properties
from thermobearing.earthquake.properties.links import trials_note
from thermobearing.earthquake.properties.notes import SCRAGGED, bounded_note, with_bounds
from thermobearing.earthquake.properties.peaks import (
    PEAKS,
    TOLERANCE,
    design_peaks,
    largest_differences,
    settle_bridge,
    settle_case,
    step_note,
    step_warning,
)
from thermobearing.earthquake.properties.trials import shortfall_note, try_links, upper_note
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.report.pieces import Pieces
from thermobearing.structure.model import Structure

HDR, LRB = "shen-hdr-bridge", "lrb-example"
MOTIONS = [{"name": name, "factor": 0.4} for name in ("jra-ii-i-1", "jra-ii-ii-1")]
CASE: dict[str, Any] = {"ambient": [23.0, -20.0], "duration": 15}


@pytest.fixture(scope="module")
def bridge() -> EarthquakeResult:
    """HDR on one pier, LRB on the other."""
    structure = validated(Structure, two_piers(), "test")
    lines = [{"line": "on A", "bearing": HDR}]
    return tb.bridge(LRB, MOTIONS, structure=structure, lines=lines, **CASE)


@pytest.fixture(scope="module")
def pieces(bridge: EarthquakeResult) -> Pieces:
    return build_pieces(bridge)


def read_csv_file(pieces: Pieces, name: str) -> pd.DataFrame:
    return pd.read_csv(io.BytesIO(pieces.files[name]), keep_default_na=False)


def run_links(rows: pd.DataFrame, strengths: str, **options: Any) -> EarthquakeResult:
    """Run the two piers on the bilinear loops of rows of properties.csv."""
    links = {}
    for line, row in rows.iterrows():
        strength = row[strengths] if row[strengths] != "" else row["Q_d_kN"]
        links[line] = BilinearBearing(
            name=str(line).replace(" ", "-"),
            total_rubber_thickness=100.0,
            strength=float(strength),
            initial_stiffness=float(row["K_1_kN_mm"]),
            post_yield_stiffness=float(row["K_d_kN_mm"]),
        )
    structure = validated(Structure, two_piers(), "test")
    lines = [{"line": "on A", "bearing": links["on A"]}]
    return tb.bridge(
        links["on B"], MOTIONS, 23.0, structure=structure, lines=lines, duration=15, **options
    )


def test_a_trial_is_the_bridge_on_bilinear_bearings(
    bridge: EarthquakeResult, pieces: Pieces
) -> None:
    """The rows of properties.csv as bilinear bearings of a case of one's own, heated lead too."""
    trials, properties = read_csv_file(pieces, "links.csv"), read_csv_file(pieces, "properties.csv")
    assert trials["lead"].tolist().count("heated") == 2
    lower = properties[properties["bound"] == "lower"].set_index("line")
    structure = validated(Structure, two_piers(), "test")
    for lead, strengths in (("", "Q_d_kN"), ("heated", "Q_d_heated_kN")):
        rows = trials[(trials["bound"] == "lower") & (trials["lead"] == lead)].set_index("line")
        alone = run_links(lower, strengths, dt=float(rows["links_step_s"].iloc[0]))
        lines = [{"line": "on A", "bearing": HDR}]
        settled = tb.bridge(
            LRB,
            MOTIONS,
            23.0,
            structure=structure,
            lines=lines,
            duration=15,
            dt=float(rows["coupled_step_s"].iloc[0]),
        )
        for line in ("on A", "on B"):
            with_links, coupled = (
                result.lines[result.lines["line"] == line] for result in (alone, settled)
            )
            for column, name in (
                ("displacement_max_mm", "displacement"),
                ("force_max_kN", "force"),
            ):
                unit = column.rpartition("_")[2]
                values = rows.loc[line, [f"{name}_links_{unit}", f"{name}_coupled_{unit}"]]
                peaks = with_links[column].max(), coupled[column].max()
                assert_allclose(values.to_numpy(dtype=float), peaks, rtol=1e-6)
                assert_allclose(float(rows.loc[line, f"{name}_ratio"]), peaks[0] / peaks[1])
        moment = alone.table["pier_moment_max_kN_m"].max()
        assert_allclose(float(rows.loc["on B", "pier_moment_links_kN_m"]), moment, rtol=1e-6)
        # Pier A has no hinge, and so no moment.
        assert rows.loc["on A", "pier_moment_links_kN_m"] == ""


def test_trials_are_at_a_step_at_which_peaks_have_settled(pieces: Pieces) -> None:
    """A run at a quarter of the step agrees within 1.5 %; one at the default step does not."""
    trials, properties = read_csv_file(pieces, "links.csv"), read_csv_file(pieces, "properties.csv")
    rows, links = (
        table[(table["rubber"] == SCRAGGED) & (table["ambient_degC"] == -20.0)].set_index("line")
        for table in (trials, properties)
    )
    step = float(rows["links_step_s"].iloc[0])
    assert step < 0.005
    assert float(rows["links_change"].iloc[0]) <= TOLERANCE
    finer = run_links(links, "Q_d_kN", dt=step / 4)
    peaks = design_peaks(finer).droplevel(["bearing", "ambient_degC"])
    for column, (name, unit) in PEAKS.items():
        values = pd.to_numeric(rows[f"{name}_links_{unit}"])
        assert_allclose(values[peaks.index], peaks[column], rtol=0.015)
    coarse = design_peaks(run_links(links, "Q_d_kN"))
    differences = largest_differences(coarse.droplevel(["bearing", "ambient_degC"]), peaks)
    assert max(value for value in differences.values() if value == value) > 0.015


def test_an_analysis_with_too_many_steps_says_that_it_was_not_repeated(
    bridge: EarthquakeResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermobearing.earthquake.properties.trials.MOST_STEPS_OF_LINKS", 1.0)
    lines = with_bounds(line_properties(bridge))
    first = settle_case(bridge_case(bridge), bridge, most_steps=1.0)
    assert (first.step, first.runs, np.isnan(first.change)) == (0.005, 0, True)
    trials = try_links({str(lines["state"].iloc[0]): first}, lines)
    assert trials.rows["links_step_s"].unique().tolist() == [0.005]
    assert trials.rows["links_halvings"].unique().tolist() == [0]
    note = trials_note(trials)
    assert note.count("not repeated") == 1 + len(trials.rows.groupby(["ambient_degC", "lead"]))
    assert "nan" not in note


def test_an_analysis_that_was_halved_once_is_not_said_to_move(bridge: EarthquakeResult) -> None:
    """It is an exception, as one that moves is, each with its own size."""
    lines = with_bounds(line_properties(bridge))
    state = str(lines["state"].iloc[0])
    settled = settle_bridge(bridge)
    once = settled._replace(halvings=1, change=0.002)
    assert not once.has_settled
    assert "halved once, which moved no peak by more than 0.2 %" in step_note(once)
    notes = {
        change: trials_note(try_links({state: settled._replace(halvings=2, change=change)}, lines))
        for change in (0.002, 0.027)
    }
    assert "coupled analysis with" not in notes[0.002]
    assert "still moves a peak by 2.7 %" in notes[0.027]


def test_an_analysis_states_the_error_of_its_step(bridge: EarthquakeResult) -> None:
    """The moment of the pier too; a step that is too large is a warning with the one to take."""
    settled = settle_bridge(bridge)
    assert (settled.has_settled, settled.step, settled.runs) == (True, 0.00125, 8)
    expected = largest_differences(design_peaks(bridge), design_peaks(settled.result))
    assert settled.differences == expected
    note = step_note(settled)
    assert all(word in note for word in ("pier moment", "displacement", "1.25 ms", "8 more runs"))
    assert step_warning(settled) == ""
    coarse = settled._replace(differences=expected | {"pier_moment_max_kN_m": 0.031}, change=0.02)
    assert not coarse.has_settled
    assert "3.1 %" in step_warning(coarse)
    assert "--dt 0.000625" in step_warning(coarse)
    assert "--dt 0.00125 --state virgin" in step_warning(coarse._replace(change=0.01), "virgin")
    assert "not computed" in step_note(settled._replace(runs=0))
    assert step_warning(settled._replace(runs=0)) == ""
    other = settled._replace(differences=expected | {"force_max_kN": np.inf})
    assert "another outcome" in step_note(other)


def test_a_plain_report_has_links_of_both_states(bridge: EarthquakeResult, pieces: Pieces) -> None:
    """Scragged at both temperatures, and virgin in the cold from the analysis of virgin rubber."""
    properties = read_csv_file(pieces, "properties.csv")
    on_a = properties[properties["line"] == "on A"]
    states = list(zip(on_a["rubber"], on_a["ambient_degC"], on_a["bound"], strict=True))
    assert states == [(SCRAGGED, 23.0, "lower"), (SCRAGGED, -20.0, ""), ("virgin", -20.0, "upper")]
    structure = validated(Structure, two_piers(), "test")
    lines = [{"line": "on A", "bearing": HDR}]
    virgin = tb.bridge(
        LRB, MOTIONS, -20.0, structure=structure, lines=lines, duration=15, state="virgin"
    )
    expected = line_properties(virgin).set_index("line")
    for name in ("K_eff_kN_mm", "Q_d_kN", "K_1_kN_mm", "design_displacement_mm"):
        assert_allclose(float(on_a[name].iloc[-1]), expected.loc["on A", name])
    text = pieces.files["links.txt"].decode()
    for head in (
        "lower values (scragged rubber, warmest)",
        "lower values (scragged rubber, warmest, lead heated)",
        "upper values (virgin rubber, first loading, coldest)",
    ):
        assert f"\n  {head}\n" in text
    assert "--state virgin" not in text


def test_a_report_of_virgin_rubber_has_lower_values_of_scragged_rubber() -> None:
    virgin = tb.bridge(HDR, MOTIONS, state="virgin", **CASE)
    properties = read_csv_file(build_pieces(virgin), "properties.csv")
    states = set(
        zip(properties["rubber"], properties["ambient_degC"], properties["bound"], strict=True)
    )
    assert states == {("virgin", 23.0, ""), ("virgin", -20.0, "upper"), (SCRAGGED, 23.0, "lower")}


def trial_rows(ratios: dict[str, float]) -> pd.DataFrame:
    row: dict[str, Any] = {"line": "A1"}
    for name, unit in (("displacement", "mm"), ("force", "kN"), ("pier_moment", "kN_m")):
        ratio = ratios.get(name, 1.0)
        row |= {f"{name}_links_{unit}": 100.0 * ratio, f"{name}_coupled_{unit}": 100.0}
        row[f"{name}_ratio"] = ratio
    return pd.DataFrame([row, row | {f"{name}_ratio": 1.0 for name in ratios}])


def test_links_that_understate_a_peak_say_by_how_much() -> None:
    note = shortfall_note(trial_rows({"displacement": 0.77}))
    assert "23 % less displacement" in note
    assert "77 instead of 100 mm" in note
    assert "1.30" in note
    assert "force" not in note
    assert shortfall_note(trial_rows({"force": 0.951, "pier_moment": 1.2})) == ""
    assert shortfall_note(trial_rows({"displacement": np.nan})) == ""


def bridge_case(result: EarthquakeResult) -> Any:
    return make_earthquake_case(tomllib.loads(str(result.dataset.attrs["case"])), "result")


def run_trials(result: EarthquakeResult) -> Any:
    lines = with_bounds(line_properties(result))
    return try_links({str(lines["state"].iloc[0]): settle_bridge(result)}, lines)


def test_what_cannot_have_links_says_so() -> None:
    """A bridge in plan, axial forces, and lines without a yield have no trials but a reason."""
    axial = {"dead_load": "1000 kN"}
    lines = [{"line": "G1-G5", "axial": axial}]
    short: dict[str, Any] = {"motion": "jra-ii-i-1", "ambient": 23.0, "duration": 2}
    plan = {"structure": "five-span-bridge", "components": 1}
    results = [
        tb.bridge(HDR, lines=lines, axial="dead", **short),
        tb.bridge(HDR, **short, **plan),
        tb.bridge(HDR, **short | {"motion": {"name": "jra-ii-i-1", "factor": 0.01}}),
    ]
    for result in results:
        trials = run_trials(result)
        assert trials.rows.empty
        assert (trials.runs, len(trials.reasons)) == (0, 1)
        assert trials.reasons[0] in trials_note(trials)
        pieces = build_pieces(result)
        assert "links.csv" not in pieces.files
        assert trials.reasons[0].split(" (")[0] in " ".join(
            pieces.files["links.txt"].decode().split()
        )
    bilinear = run_trials(tb.bridge("shen-bilinear-bridge", **short))
    assert (bilinear.runs, bilinear.reasons, trials_note(bilinear)) == (0, [], "")


def test_notes_name_what_upper_values_do_not_bound() -> None:
    """Upper values of virgin rubber with a smaller Q_d, and links with less force, than others."""
    shared = {"bearing": "b", "line": "A1", "line_bearing": "b", "ambient_degC": -30.0}
    shared |= {"K_1_kN_mm": 20.0, "lead": ""}
    scragged = {"state": SCRAGGED, "rubber": SCRAGGED, "K_eff_kN_mm": 8.687, "Q_d_kN": 1471.3}
    scragged |= {"K_d_kN_mm": 3.78, "bound": "", "force_links_kN": 2295.0}
    virgin = {"state": "virgin", "rubber": "virgin", "K_eff_kN_mm": 11.857, "Q_d_kN": 1150.8}
    virgin |= {"K_d_kN_mm": 7.33, "bound": "upper", "force_links_kN": 2139.0}
    rows = pd.DataFrame([shared | scragged, shared | virgin])
    rows = rows.assign(displacement_links_mm=[218.0, 135.0], pier_moment_links_kN_m=np.nan)
    note = bounded_note(rows)
    assert "Q_d of b 1150.8 kN, but 1471.3 kN of b at -30 degC, scragged)" in note
    assert "K_eff of b" not in note
    assert "force (A1: 2139 kN, with links of scragged rubber at -30 degC 2295 kN):" in (
        upper_note(rows)
    )
    larger = rows.assign(Q_d_kN=1500.0, force_links_kN=2300.0)
    assert "kN" not in bounded_note(larger)
    assert upper_note(larger) == ""
    assert bounded_note(rows[1:]) == ""  # nothing to compare it with
