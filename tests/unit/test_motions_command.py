"""Ground motions examined and made, in Python and by `thermobearing motions`."""

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import tests.unit.motion_files as files
import thermobearing.motions.run as story
from tests import tolerances as tol
from tests.conftest import COARSE
from tests.unit.inputs import command, content, last_line, summary
from thermobearing.border.errors import InputError
from thermobearing.motions.library import load_motion, save_motion
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.run import make_motion_case, run_motion
from thermobearing.motions.targets import load_spectrum, standard_spectrum, standard_target
from thermobearing.results.writing import write_summary

NAMES = {"motion.csv", "spectrum.csv", "summary.json"}
FIGURES = {f"figures/{name}.{kind}" for name in ("motion", "spectrum") for kind in ("png", "svg")}
KEYS = {"command", "motion", "outcome", "dt_s", "pga_gal", "pgv_cm_s", "pgd_cm", "samples"}
KEYS |= {"end_velocity_cm_s", "end_displacement_cm", "arias_intensity_m_s", "duration_s"}
KEYS |= {"significant_duration_s", "bracketed_duration_s", "cumulative_absolute_velocity_m_s"}
KEYS |= {"standard_spectrum", "description", "citation", "version", "damping"}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("made") / "out"
    done = command("motions", "make", "--kind", "II", "--ground", "I", "--seed", 1, "-o", out)
    assert done.exit_code == 0
    assert "rms over 0.1 to 3 s compared with Level 2 Type II" in " ".join(done.stdout.split())
    return out


@pytest.mark.thorough
def test_make_writes_a_whole_directory(made: Path) -> None:
    assert set(content(made)) == NAMES | FIGURES
    reported = summary(made)
    assert set(reported) == KEYS
    assert (reported["command"], reported["outcome"]) == ("motions make", "completed")
    assert reported["standard_spectrum"]["misfit_rms"] <= tol.MISFIT
    for name in FIGURES:
        head = (made / name).read_bytes()[:24]
        assert min(struct.unpack(">II", head[16:])) > 3 * COARSE  # three inches


def test_written_motion_is_read_back(made: Path) -> None:
    again, stored = load_motion(made / "motion.csv"), load_motion("jra-ii-i-1")
    assert again.dt == stored.dt
    assert_allclose(again.acceleration, stored.acceleration, rtol=0.0, atol=tol.REMADE * stored.pga)
    # Under the name of the directory, which is also that of the result, and with its target.
    assert again.name == summary(made)["motion"] == made.name
    assert again.description == summary(made)["description"]
    assert again.target == standard_target("II", "I")


CODE = {"shape": "aashto", "A_s": "0.4 g", "S_DS": "1 g", "S_D1": "0.6 g"}
LONG_PERIODS = {"shape": "asce-7", "S_DS": "0.5 g", "S_D1": "0.3 g", "T_L": "4 s"}


@pytest.mark.parametrize("shape", ["jra-i-ii", CODE, LONG_PERIODS, "table"])
def test_a_saved_motion_keeps_its_target(shape: str | dict[str, str], tmp_path: Path) -> None:
    site = tmp_path / "site.csv"
    site.write_text("period [s],acceleration [g]\n0.05,0.4\n0.3,1.0\n1,0.6\n4,0.1\n")
    target = load_spectrum(site if shape == "table" else shape, 0.9)
    motion = replace(load_motion("jra-ii-i-1"), target=target, description="fits (seed 1)")
    again = load_motion(save_motion(motion, tmp_path / "mine.csv"))
    assert (again.name, again.description, again.target) == ("mine", "fits (seed 1)", target)
    compared = story.examine_motion(again)
    assert compared.reference == target
    assert compared.misfit == story.misfit(again, target.at)


@pytest.mark.parametrize("text", ["{", '{"name": "a", "words": "b"}', '{"start": NaN}', "[1]"])
def test_a_damaged_target_is_refused_with_its_file(text: str, tmp_path: Path) -> None:
    file = tmp_path / "mine.csv"
    file.write_text(f"# target: {text}\nt_s,acc_gal\n0,0\n0.01,300\n0.02,0\n")
    with pytest.raises(InputError) as raised:
        load_motion(file)
    assert str(file) in str(raised.value)
    assert "# target:" in str(raised.value)


def test_spectrum_csv_holds_the_standard_one(made: Path) -> None:
    header = (made / "spectrum.csv").read_text().splitlines()[0].split(",")
    table = np.loadtxt(made / "spectrum.csv", delimiter=",", skiprows=1)
    columns = dict(zip(header, table.T, strict=True))
    wanted = standard_spectrum("II", "I", columns["period_s"]) / 10.0
    assert_allclose(columns["standard_gal"], wanted, rtol=1e-4)
    inside = (columns["period_s"] > 0.1) & (columns["period_s"] < 3.0)
    ratio = columns["acceleration_gal"] / columns["standard_gal"]
    assert np.sqrt(np.mean((ratio[inside] - 1.0) ** 2)) < tol.MISFIT


@pytest.mark.thorough
def test_make_keeps_the_phases_of_a_record(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["--record", "jra-ii-i-3", "--kind", 2, "--ground", 2, "--dt", 0.02]
    done = command("motions", "make", *words, "-o", out, "--no-figures", "--json")
    assert done.exit_code == 0
    assert last_line(done)["files"] == sorted(NAMES)
    reported = summary(out)
    assert (reported["motion"], reported["dt_s"]) == (out.name, 0.02)
    assert abs(reported["end_velocity_cm_s"]) < tol.QUIET_END


def test_poor_fit_is_an_outcome_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(story, "LARGEST_MISFIT", 0.001)
    out = tmp_path / "out"
    done = command("motions", "make", "--dt", 0.02, "-o", out, "--no-figures", "-q")
    assert done.exit_code == 4
    assert "poor_fit: the search ended with a misfit of 1.5 % rms" in done.stderr
    assert summary(out)["outcome"] == "poor_fit"


@pytest.mark.parametrize(
    ("words", "piece"),
    [
        (["--kind", "III"], 'type of earthquake: "III" is not one of I, II'),
        (["--ground", "IV"], 'ground: "IV"'),
        (["--seed", -1], "seed: -1"),
        (["--dt", 1], "dt: 1 s is outside"),
        (["--zone-factor", 9], "--zone-factor: 9"),
        (["--record", "jra-ii-i-1", "--seed", 2], "give --seed or --record, not both"),
        (["--unit", "gal"], "require a record"),
        (["--record", "jra-ii-i-9"], 'no motion is named "jra-ii-i-9"'),
    ],
)
def test_bad_options_of_make(words: list[object], piece: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = command("motions", "make", *words, "-o", out)
    assert done.exit_code == 2
    assert piece in done.stderr
    assert not out.exists()


def test_show_prints_and_writes_only_if_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = files.write(tmp_path / "tilted.csv", files.csv_text())
    done = command("motions", "show", path, "--json")
    assert done.exit_code == 0
    assert "Peak ground acceleration 300.0 gal" in " ".join(done.stdout.split())
    assert last_line(done)["standard_spectrum"] is None
    assert [item.name for item in tmp_path.iterdir()] == ["tilted.csv"]
    out = tmp_path / "out"
    done = command("motions", "show", path, "--baseline", "--kind", "I", "-o", out, "-q")
    assert (done.exit_code, done.stdout) == (0, "")
    assert set(content(out)) == NAMES | FIGURES
    assert abs(summary(out)["end_displacement_cm"]) < tol.QUIET_END


TILTED = GroundMotion("tilted", 0.01, np.sin(np.arange(2000) * 0.05) + 0.01)


def test_a_built_in_motion_is_compared_with_what_it_was_made_for() -> None:
    examined = story.examine_motion(load_motion("jra-i-iii-2"))
    assert examined.reference == load_spectrum("jra-i-iii")
    assert examined.misfit is not None
    assert 0.0 < examined.misfit < 0.03
    asked = story.examine_motion(load_motion("jra-i-iii-2"), ground="II")
    assert asked.reference == load_spectrum("jra-ii-ii")
    assert story.examine_motion(TILTED).reference is None


def test_a_base_line_is_corrected_if_asked_for() -> None:
    assert story.examine_motion(TILTED).motion is TILTED
    for options in ({"baseline": True}, {"high_pass": 0.1}):
        ended = story.examine_motion(TILTED, **options).measures.end_displacement
        assert abs(ended) < 1e-6 < abs(story.examine_motion(TILTED).measures.end_displacement)


def test_a_case_names_its_directory() -> None:
    assert story.make_motion_case("ii", 3, seed=7).name == "jra-ii-iii-7"
    odd = GroundMotion("El Centro/NS", 0.01, np.ones(10))
    assert story.make_motion_case("I", "I", record=odd).name == "el-centro-ns-as-i-i"


@pytest.mark.parametrize(("kind", "other"), [(None, "--kind I "), ("I", "--kind II ")])
def test_a_motion_for_a_spectrum_of_a_code_says_its_kind_and_how_to_choose(
    kind: str | None, other: str
) -> None:
    target = load_spectrum({"shape": "aashto", "A_s": "0.4 g", "S_DS": "1 g", "S_D1": "0.6 g"})
    case = make_motion_case(kind, spectrum=target, dt=0.02)
    assert other in run_motion(case).notes()[-1]
    assert "--kind" not in " ".join(run_motion(make_motion_case(kind, dt=0.02)).notes())


def test_a_case_is_checked_before_its_record_is_read() -> None:
    with pytest.raises(InputError, match='type of earthquake: "V"'):
        story.make_motion_case("V", record="not-there.csv")


def test_a_name_that_is_no_text_is_written_as_json(tmp_path: Path) -> None:
    name = "地震\udc80"
    write_summary(tmp_path, {"motion": name, "misfit": float("nan")})
    text = (tmp_path / "summary.json").read_text(encoding="utf-8")
    assert "地震" in text
    assert json.loads(text) == {"motion": name, "misfit": None}


def test_a_pair_has_measures_of_both_records_and_of_rotation(tmp_path: Path) -> None:
    paths = []
    for end, direction in (("NS2", "4"), ("EW2", "5")):
        paths.append(files.write(tmp_path / f"ABCH01.{end}", files.knet_text(direction=direction)))
    out = tmp_path / "out"
    words = ["motions", "show", paths[0], "--across", paths[1], "-o", out, "--no-figures"]
    done = command(*words, "--report")
    assert done.exit_code == 0
    reported = summary(out)
    assert reported["motion"] == "ABCH01"
    assert reported["records"] == ["NS", "EW"]
    assert reported["across"]["pga_gal"] == pytest.approx(reported["pga_gal"])
    table = pd.read_csv(out / "spectrum.csv")
    assert_allclose(table["across_acceleration_gal"], table["acceleration_gal"], rtol=1e-5)
    # Equal records are a motion along the line between them, sqrt(2) as large as each.
    assert_allclose(table["rotd100_gal"], np.sqrt(2.0) * table["acceleration_gal"], rtol=1e-5)
    assert_allclose(table["rotd50_gal"], table["acceleration_gal"], rtol=1e-5)
    assert_allclose(
        table["rotd100_pseudo_gal"], np.sqrt(2.0) * table["pseudo_acceleration_gal"], rtol=1e-5
    )
    assert_allclose(table["rotd100_cm"], np.sqrt(2.0) * table["displacement_cm"], rtol=1e-5)
    both = [load_motion(out / "motion.csv", component=name) for name in ("acc", "across")]
    assert_allclose(both[0].acceleration, both[1].acceleration)


def test_bad_pairs_of_the_command(tmp_path: Path) -> None:
    pair = ["motions", "spectrum", "jra-ii-i-1", "--across"]
    for words, piece in (
        ([*pair, "jra-i-i-1"], "11001 samples"),
        ([*pair, "jra-ii-i-9"], "jra-ii-i-9"),
        ([*pair, "jra-ii-i-2", "--unit", "gal"], "unit"),
    ):
        done = command(*words)
        assert (done.exit_code, piece in done.stderr) == (2, True)
    assert command(*pair, "jra-i-i-1", "--resample").exit_code == 0
