"""Motions of a study that are made to fit a spectrum: once, kept, and the same wherever it runs."""

import json
import pickle
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from typer.testing import CliRunner

import thermobearing.studies.definition.motions as made
import thermobearing.studies.run.engine as engine
from tests.unit.inputs import assert_refused
from tests.unit.studies import kept, small_study
from thermobearing.border.errors import InputError, OutputError
from thermobearing.cli import app
from thermobearing.commands.check import check_file
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import LARGEST_MISFIT, misfit
from thermobearing.motions.targets import STANDARD_NAMES, load_spectrum, standard_spectrum
from thermobearing.studies.definition import motions
from thermobearing.studies.definition.case import load_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.engine import forecast, repeat_run, run_study, study_status
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.shard import packed
from thermobearing.studies.store import Store

# Coarse steps, and motions that are near the spectrum already: a fit takes a third of a second.
FITS = {"matched": "jra-ii-ii", "levels": ["jra-ii-ii-1", "jra-ii-ii-2"], "dt": "0.02 s"}
NAMES = ["jra-ii-ii-1-as-ii-ii", "jra-ii-ii-2-as-ii-ii"]
MADE: dict[str, Any] = {}  # motions by the key of their recipe: each fit is computed once here
MADE_UP = {"matched": "jra-ii-i", "count": 3}


@pytest.fixture(autouse=True)
def fits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> "Counter[str]":
    monkeypatch.setattr(made, "cache_directory", lambda: tmp_path / "cache")
    counted: Counter[str] = Counter()
    make = motions.Recipe.make

    def counting(self: motions.Recipe, progress: Any = None) -> Any:
        counted[self.name] += 1
        if self.key not in MADE:
            MADE[self.key] = make(self, progress)
        return MADE[self.key]

    monkeypatch.setattr(motions.Recipe, "make", counting)
    return counted


def matched(motion: dict[str, Any] | None = None, **changes: Any) -> Study:
    one = {"bearing": "shen-bilinear-bridge", "ambient": "0 degC", "motion": motion or FITS}
    return small_study(**(one | changes))


def test_motions_fit_and_are_the_levels(fits: "Counter[str]") -> None:
    study = matched()
    runs = Plan(study).runs
    assert runs["motion"].tolist() == [NAMES[0]] * 2 + [NAMES[1]] * 2
    assert runs["id"].is_unique
    for motion in motions.factor_motions(study.factors.motion):
        assert motion.dt == 0.02
        error = misfit(motion, lambda t: standard_spectrum("II", "II", t))
        assert error <= LARGEST_MISFIT
    assert fits == dict.fromkeys(NAMES, 1)
    assert Plan(matched()).runs.equals(runs)  # from the cache
    assert fits == dict.fromkeys(NAMES, 1)


def test_random_phases_have_a_name_and_a_key_of_their_own(tmp_path: Path) -> None:
    study = matched(MADE_UP)
    assert study.factors.motion.names == ["jra-ii-i-1", "jra-ii-i-2", "jra-ii-i-3"]
    file = tmp_path / "site.csv"
    file.write_text("period [s];Sa [g]\n0.05;0.5\n0.5;1\n4;0.1\n")
    others = [
        MADE_UP | {"seed": 4},
        MADE_UP | {"zone_factor": 0.85},
        MADE_UP | {"dt": "0.005 s"},
        MADE_UP | {"matched": "jra-ii-ii"},
        {"matched": str(file), "count": 3},
        {"matched": str(file), "count": 3, "phases": "jra-i-i"},
    ]
    keys = [recipe.key for one in [MADE_UP, *others] for recipe in motions._recipes(_factor(one))]
    assert len(set(keys)) == 3 * len(others) + 3
    named = _factor(others[-1])
    assert named.names == ["site-1", "site-2", "site-3"]
    before = motions._recipes(named)[0].key
    file.write_text("period [s];Sa [g]\n0.05;0.5\n0.5;1.01\n4;0.1\n")
    assert motions._recipes(named)[0].key != before
    assert motions._recipes(_factor(MADE_UP | {"seed": 2}))[0].key == keys[1]


def _factor(motion: dict[str, Any]) -> Any:
    return matched(motion).factors.motion


def test_a_table_is_a_spectrum(tmp_path: Path) -> None:
    """Straight between its points where both axes are logarithmic; in any unit."""
    file = tmp_path / "site.csv"
    file.write_text("period_s,acceleration_gal\n0.1,400\n0.4,800\n3,100\n")
    result = load_spectrum(file, 2.0).at(np.array([0.05, 0.2, 0.4, 6.0]))
    assert_allclose(result, 20.0 * np.array([400.0, 800.0 / np.sqrt(2.0), 800.0, 50.0]))
    assert STANDARD_NAMES[3] == "jra-ii-i"
    standard = load_spectrum("jra-ii-iii", 0.7).at(np.array([0.3, 1.0, 2.0]))
    assert_array_equal(standard, standard_spectrum("II", "III", [0.3, 1.0, 2.0], zone_factor=0.7))


def test_made_once_and_kept_in_the_directory(
    tmp_path: Path, fits: "Counter[str]", monkeypatch: pytest.MonkeyPatch
) -> None:
    one, out = tmp_path / "one", tmp_path / "out"
    run_study(matched(), one, jobs=1, size=1)
    whole = kept(one)
    assert set(motions._read_motions(one / motions.MOTIONS_FILE)) == {
        recipe.key for recipe in motions._recipes(_factor(FITS))
    }
    run_study(matched(), out, jobs=1, size=1, shard="1/2")
    assert study_status(out).done == 2
    monkeypatch.setattr(made, "cache_directory", lambda: None)  # another machine
    run_study(matched(), out, jobs=1, shard="2/2")
    assert fits == dict.fromkeys(NAMES, 1)
    assert kept(out) == whole
    # Read back, for one run in full or for figures: nothing is made, and the samples go with it.
    study = load_study(out / "study.toml")
    rows = Plan(study).runs.to_dict("records")
    assert [row["id"] for row in rows] == Store(out).table()["id"].tolist()
    (motion,) = Preparer(Plan(study)).make_task(rows[3]).case.motions
    assert motion.load().name == NAMES[1]
    stored = motions._read_motions(out / motions.MOTIONS_FILE)[
        motions._recipes(_factor(FITS))[1].key
    ]
    assert_array_equal(motion.acceleration, stored.acceleration)
    assert repeat_run(study, 3).table["motion"].tolist() == [NAMES[1]]
    assert fits == dict.fromkeys(NAMES, 1)


def test_workers_are_sent_what_was_made(tmp_path: Path) -> None:
    run_study(matched(), tmp_path / "two", jobs=2, size=1)
    two = kept(tmp_path / "two")
    study = motions.with_matched(matched())
    sent = pickle.loads(packed(Plan(study)))[0].study.factors.motion.matched_motions()
    for here, there in zip(motions.factor_motions(study.factors.motion), sent, strict=True):
        assert_array_equal(here.acceleration, there.acceleration)
    for file in (tmp_path / "cache").rglob("*.npz"):
        file.unlink()
    run_study(matched(), tmp_path / "one", jobs=1, size=1)
    assert kept(tmp_path / "one") == two


def test_another_part_that_was_quicker_has_the_motions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its machine ends fits in other bits: the directory's are taken, by whoever comes later."""
    out, make, asked = tmp_path / "out", engine.with_matched, []

    def late(study: Study, *words: Any, **others: Any) -> Study:
        asked.append(study)
        if len(asked) > 1:
            return make(study, *words, **others)
        result = make(study)
        other = [
            replace(m, acceleration=m.acceleration + 1e-9)
            for m in motions.factor_motions(result.factors.motion)
        ]
        changed = result.model_copy(deep=True)
        changed.factors.motion.matched_motions(other)
        run_study(changed, out, jobs=1, shard="1/2")
        return result

    monkeypatch.setattr(engine, "with_matched", late)
    assert run_study(matched(), out, jobs=1, shard="2/2").done > 0
    assert len(asked) > 1
    assert (
        Plan(load_study(out / "study.toml")).runs["id"].tolist()
        != Plan(matched()).runs["id"].tolist()
    )


def test_a_damaged_copy_is_made_again(tmp_path: Path, fits: "Counter[str]") -> None:
    out = tmp_path / "out"
    run_study(matched(), out, jobs=1)
    raw = (out / motions.MOTIONS_FILE).read_bytes()
    for content in (raw[: len(raw) // 2], b"", b"nothing", raw[:-400] + bytes(400)):
        (out / motions.MOTIONS_FILE).write_bytes(content)
        assert motions._read_motions(out / motions.MOTIONS_FILE) == {}
        assert run_study(matched(), out, jobs=1).outcome == "completed"
    assert fits == dict.fromkeys(NAMES, 1)


def test_what_does_not_fit_is_named_and_nothing_is_left(tmp_path: Path) -> None:
    starts: tuple[Callable[[Study], Any], ...] = (
        lambda study: Plan(study).runs,
        forecast,
        lambda study: run_study(study, tmp_path / "out", jobs=1),
    )
    for start in starts:
        with pytest.raises(InputError) as caught:
            start(matched(FITS | {"tolerance": 0.001}))
        text = str(caught.value)
        assert f"factors.motion: {NAMES[0]} has" in text
        assert "ground II, c_z = 1, more than 0.1 %" in text
        assert "tolerance = 0.0" in text
    assert [path.name for path in tmp_path.iterdir()] == ["cache"]
    assert len(Plan(matched(FITS | {"tolerance": 0.05})).runs) == 4


def test_words_are_refused_before_anything_is_made(tmp_path: Path, fits: "Counter[str]") -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError, match=r"contains .*thesis\.tex"):
        run_study(matched(), tmp_path, jobs=1)
    with pytest.raises(InputError, match="shard"):
        run_study(matched(), tmp_path / "out", shard="3/2")
    assert not fits


def test_a_dry_run_makes_one_motion(tmp_path: Path, fits: "Counter[str]") -> None:
    result = forecast(matched(), jobs=1)
    assert (result.runs, result.motions, result.failed) == (4, 1, 0)
    assert result.motion_seconds > 0.0
    assert result.whole_seconds > result.motion_seconds
    assert fits == {NAMES[0]: 1}
    assert len(Plan(matched()).runs)
    assert forecast(matched()).motions == 0
    # Looking at a study makes none at all.
    file = tmp_path / "study.toml"
    file.write_text(matched(MADE_UP).to_toml())
    reported = check_file(file)
    assert "6" in reported.facts["runs"]
    assert set(fits) == set(NAMES)


def test_command(tmp_path: Path, fits: "Counter[str]") -> None:
    file, out = tmp_path / "study.toml", tmp_path / "out"
    file.write_text(matched().to_toml())
    done = CliRunner().invoke(app, ["study", str(file), "--dry-run", "--json"])
    reported = json.loads(done.stdout.splitlines()[-1])
    assert (reported["runs"], reported["motions_to_make"]) == (4, 1)
    done = CliRunner().invoke(app, ["study", str(file), "-o", str(out), "--jobs", "1"])
    assert done.exit_code == 0
    assert "runs    4 of 4" in done.stdout
    assert "1 motion will be generated once to fit jra-ii-ii" in done.stderr
    again = CliRunner().invoke(app, ["study", str(file), "-o", str(out), "--jobs", "1"])
    assert "to be made" not in again.stderr
    assert fits == dict.fromkeys(NAMES, 1)


BAD: list[tuple[dict[str, Any], str]] = [
    ({"matched": "jra-ii-iv", "count": 2}, 'did you mean "jra-ii-i"'),
    ({"matched": "site.csv", "count": 2}, "site.csv: no such file"),
    ({"matched": "jra-ii-i"}, "matched: give count, or levels"),
    ({"matched": "jra-ii-i", "count": 0}, "count = 0"),
    ({"count": 3}, "count: only with"),
    ({"random": False}, 'missing key "levels"'),
    (FITS | {"count": 2, "seed": 1}, "seed: only with"),
    (FITS | {"levels": ["jra-ii-i-9"]}, "levels[0]"),
    (MADE_UP | {"phases": "jra-iii-i"}, '"jra-iii-i"'),
    (MADE_UP | {"dt": "0.1 s"}, "at most 0.02 s"),
    (MADE_UP | {"zone_factor": 3.0}, "at most 2"),
    (MADE_UP | {"sed": 3}, 'did you mean "seed"'),
    (MADE_UP | {"weights": [1, 2], "random": True}, "for 3 motions"),
]


@pytest.mark.parametrize(("motion", "word"), BAD)
def test_bad_input(motion: dict[str, Any], word: str) -> None:
    assert_refused(lambda: matched(motion), "factors.motion", word)


SPECTRA = {
    "period,acceleration\n0.1,1\n3,1\n": 'column "acceleration" has no unit',
    "a,b\n0.1,1\n3,1\n": 'no column "period"',
    "period,Sa [kN]\n0.1,1\n3,1\n": 'unknown unit of acceleration "kN"',
    "period,Sa [g]\n0.1,1\n3,1\n2,1\n": "do not increase from 3 to 2 s",
    "period,Sa [g]\n-0.1,1\n3,1\n": "must be greater than 0",
    "period,Sa [g]\n0.2,1\n2,1\n": "add a row at 0.1 s or less and 3 s or more",
    "period,Sa [g]\n0,1\n0.12,1\n4,1\n": "a row of period 0, and after it reaches from 0.12 to 4 s",
    "period [ms],Sa [g]\n0.1,1\n3,1\n": "periods are in s",
}


@pytest.mark.parametrize(("text", "word"), SPECTRA.items())
def test_bad_spectrum(text: str, word: str, tmp_path: Path) -> None:
    (tmp_path / "site.csv").write_text(text)
    with pytest.raises(InputError, match=r"site\.csv") as caught:
        matched({"matched": str(tmp_path / "site.csv"), "count": 2})
    assert word in str(caught.value)


def test_short_records_are_reported(tmp_path: Path) -> None:
    record = tmp_path / "short.csv"
    values = load_motion("jra-ii-ii-1").acceleration[:300] / 10.0
    record.write_text("\n".join(f"{value:.6f}" for value in values))
    motion = {"name": str(record), "unit": "gal", "dt": "0.01 s"}
    with pytest.raises(InputError, match=r"factors\.motion: short: lasts 2\.99 s; at least 5 s"):
        matched({"matched": "jra-ii-i", "levels": [motion]})
