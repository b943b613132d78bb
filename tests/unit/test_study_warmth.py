"""Bearings in the weather of a study: gone through once, by the one who starts."""

import pickle
from pathlib import Path
from typing import Any

import pytest
from numpy.testing import assert_array_equal

import thermobearing.studies.definition.designs as levels
import thermobearing.studies.run.prepare as warmth
from tests.unit.studies import kept
from thermobearing.climate.generator import generate_weather
from thermobearing.studies.definition.case import load_study, make_study
from thermobearing.studies.definition.designs import plan
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.engine import run_study
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.shard import packed
from thermobearing.studies.store import Store

BEARINGS = ["shen-hdr-bridge", "shen-lhdr-bridge", "shen-bilinear-bridge"]
TENTH = {"distribution": "uniform", "low": 0.9, "high": 1.1}
FEW = {"kind": "latin-hypercube", "samples": 3, "paired": False}
KINDS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "all weather before": ({}, {}),
    "a history": ({"history": "2 d"}, {}),
    "own heat": ({"history": "2 d"}, {"bearing.materials.rubber.conductivity": TENTH}),
    "another stiffness": ({}, {"bearing.K_r": TENTH}),
}


@pytest.fixture
def town(tmp_path: Path) -> Path:
    """Two weeks of a town as a file."""
    weather = generate_weather("cold-town", 1, 2)
    rows = [f"{k},{air:.17g}" for k, air in enumerate(weather.temperature[5000:5336])]
    file = tmp_path / "town.csv"
    file.write_text("\n".join(["time_h,temperature_degC", *rows]))
    return file


def weathered(town: Path, kind: str = "all weather before") -> Study:
    """Nine runs of a twentieth of a second, three of a bearing without heat."""
    ambient, others = KINDS[kind]
    factors = {"bearing": BEARINGS, "motion": "jra-ii-i-1"} | others
    factors["ambient"] = {"weather": str(town)} | ambient
    table = {"kind": "study", "name": "warm", "case": {"duration": "0.05 s"}, "design": FEW}
    return make_study(table | {"factors": factors}, "study.toml")


@pytest.mark.parametrize("kind", KINDS)
def test_what_was_foreseen_is_what_a_run_finds_alone(kind: str, town: Path) -> None:
    study = weathered(town, kind)
    runs = plan(study)
    alone, first, worker = (Preparer(study) for _ in range(3))
    first.foresee(runs)
    warm = first.foreseen_temperatures(runs.iloc[2:8])
    worker.take(pickle.loads(pickle.dumps(warm)))
    for row in runs.iloc[1:8].to_dict("records"):  # the first is foreseen by nobody
        one, other, third = (prep.make_task(row).reported for prep in (alone, first, worker))
        assert_array_equal(one.temperature, other.temperature)
        assert_array_equal(one.temperature, third.temperature)
        assert one.lead == other.lead == third.lead


@pytest.mark.parametrize("kind", KINDS)
def test_weather_is_read_and_gone_through_once(
    kind: str, town: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read, through = levels.read_weather, []
    counted: list[str] = []
    monkeypatch.setattr(levels, "read_weather", lambda path: counted.append(path) or read(path))
    for name in ("soaked_hours", "history_weights"):
        call = getattr(warmth, name)
        monkeypatch.setattr(
            warmth, name, lambda *words, call=call: through.append(call) or call(*words)
        )
    run_study(weathered(town, kind), tmp_path / "out", jobs=1, size=2)
    assert counted == [str(town)]
    assert len(through) == (0 if kind == "own heat" else 2)  # bearings with heat
    table = Store(tmp_path / "out").table()
    assert set(table["outcome"]) == {"completed"}
    # A second start that has nothing to do goes through nothing.
    counted.clear()
    through.clear()
    run_study(weathered(town, kind), tmp_path / "out", jobs=1)
    assert (len(counted), len(through)) == (1, 0)


def test_workers_need_no_weather(town: Path, tmp_path: Path) -> None:
    """Neither its file nor its hours are sent; the bits are those of one process."""
    studies = [weathered(town) for _ in range(2)]
    (tmp_path / "study.toml").write_text(studies[0].to_toml())
    assert load_study(tmp_path / "study.toml").factors.ambient.series is not None
    town.unlink()
    run_study(studies[0], tmp_path / "one", jobs=1, size=2)
    run_study(studies[1], tmp_path / "two", jobs=2, size=2)
    assert kept(tmp_path / "one") == kept(tmp_path / "two")
    assert set(Store(tmp_path / "two").table()["outcome"]) == {"completed"}
    assert pickle.loads(packed(studies[0])).factors.ambient.series is None
    assert studies[0].factors.ambient.series is not None


def test_a_shard_is_sent_its_own_hours(town: Path) -> None:
    study = weathered(town)
    runs = plan(study)
    preparer = Preparer(study)
    preparer.foresee(runs)
    warm = preparer.foreseen_temperatures(runs.iloc[:4])
    assert warm is not None
    assert warm.weather is None
    hours = [hours.tolist() for hours, _ in warm.soaked.values()]
    assert hours == [sorted(runs["hour"][:3]), [runs["hour"][3]]]
    plain = make_study(
        {
            "kind": "study",
            "name": "plain",
            "factors": {"bearing": BEARINGS[:1], "motion": "jra-ii-i-1", "ambient": "0 degC"},
        },
        "study.toml",
    )
    assert Preparer(plain).foreseen_temperatures(plan(plain)) is None


def test_lines_with_a_bearing_of_their_own_are_foreseen(
    town: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A line of its own has heat in every run, also where the bearing of the study has none."""
    structure = Path(__file__).parents[1] / "regression" / "inputs" / "two-piers.toml"
    case = {"duration": "0.05 s", "lines": [{"line": "on A", "bearing": "lrb-example"}]}
    factors = {"bearing": BEARINGS[1:], "motion": "jra-ii-i-1", "structure": str(structure)}
    table = {"case": case, "design": FEW, "factors": factors | {"ambient": {"weather": str(town)}}}
    study = make_study({"kind": "study", "name": "two"} | table, "study.toml")
    runs = plan(study)
    alone, first = Preparer(study), Preparer(study)
    first.foresee(runs)
    expected = [alone.make_task(row).lines for row in runs.to_dict("records")]
    monkeypatch.setattr(warmth, "soaked_hours", divmod)  # nothing is left to be found
    for row, lines in zip(runs.to_dict("records"), expected, strict=True):
        for one, other in zip(first.make_task(row).lines, lines, strict=True):
            assert_array_equal(one.temperature, other.temperature)
            assert one.lead == other.lead
