"""The command: exit status, messages, JSON, files; the same bits again from the resolved case."""

import json
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
from typer.testing import Result

import thermobearing as tb
import thermobearing.cyclic.history
from tests.quick import quick_cases
from tests.unit import inputs
from thermobearing.commands.common import ProgressLines

CYCLE_KEYS = {"amplitude_strain", "cycle", "G_eq_MPa", "h_eq", "stress_max_MPa", "stress_min_MPa"}
CYCLE_KEYS |= {"energy_kN_mm", "rubber_degC", "lead_degC"}
ENERGY_KEYS = {"work_in_kN_mm", "heat_released_kN_mm", "recoverable_kN_mm", "heat_stored_kN_mm"}
ENERGY_KEYS |= {"heat_lost_ends_kN_mm", "heat_lost_sides_kN_mm"}
ENERGY_KEYS |= {"mechanical_residual", "thermal_residual"}
HEADER = "ambient_degC,time_s,displacement_mm,force_kN,stress_MPa,strain,"
HEADER += "rubber1_degC,rubber2_degC,rubber3_degC,lead_degC"


@pytest.fixture
def case(tmp_path: Path) -> Path:
    return inputs.quick_case(tmp_path / "case.toml")


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    folder = tmp_path_factory.mktemp("saved")
    path = inputs.quick_case(folder / "case.toml")
    words = ["--ambient", -20, "--ambient", 23, "-o", folder / "out", "--json"]
    return folder / "out", inputs.command("cyclic", path, *words)


def test_good_run_writes_all_files_and_ends_with_json(saved: tuple[Path, Result]) -> None:
    directory, done = saved
    assert done.exit_code == 0
    figures = {name for name in inputs.content(directory) if name.startswith("figures/")}
    assert len(figures) >= 5
    assert set(inputs.content(directory)) == {*inputs.FILES, *figures}
    assert inputs.last_line(done) == {
        "outcome": "completed",
        "exit_status": 0,
        "output": str(directory),
        "files": sorted(inputs.content(directory)),
    }
    assert [path.name for path in directory.parent.iterdir() if path.name.startswith(".")] == []


def test_result_reads_back(saved: tuple[Path, Result]) -> None:
    result = tb.load_result(saved[0])
    assert result.outcome == "completed"
    assert result.summary() == inputs.summary(saved[0])


def test_quiet_says_nothing(case: Path, tmp_path: Path) -> None:
    done = inputs.cyclic(case, "-o", tmp_path / "out", "-q")
    assert (done.exit_code, done.stdout, done.stderr) == (0, "", "")
    loud = inputs.cyclic(case, "-o", tmp_path / "out", "--overwrite")
    assert "G_e" in loud.stdout
    size = sum(path.stat().st_size for path in (tmp_path / "out").iterdir())
    assert loud.stdout.endswith(f"written: {tmp_path / 'out'} ({size / 1e6:.1f} MB)\n")


def test_overrides(case: Path, tmp_path: Path) -> None:
    words = ["--dt", 0.02, "--ambient", 5, "--ambient", -5, "--bearing", "shen-hdr-bridge"]
    for option in ("scheme=published", "integrator=euler", "heat_source=dissipation"):
        words += ["--model-option", option]
    done = inputs.cyclic(case, *words, "--keep-every", 2, "-o", tmp_path / "out", "-q")
    assert done.exit_code == 0
    resolved = tb.load_case(tmp_path / "out" / "case.resolved.toml")
    assert resolved.test.dt == 0.02
    assert resolved.ambient == [5.0, -5.0]
    assert resolved.bearing.name == "shen-hdr-bridge"
    analysis = resolved.analysis
    chosen = (analysis.scheme, analysis.integrator, analysis.heat_source, analysis.keep_every)
    assert chosen == ("published", "euler", "dissipation", 2)
    reported = inputs.summary(tmp_path / "out")
    assert [run["ambient_degC"] for run in reported["runs"]] == [5.0, -5.0]


def assert_same_bits(path: Path, again: Path, words: list[Any]) -> None:
    assert inputs.cyclic(path, *words, "-o", again / "one", "-q").exit_code == 0
    resolved = again / "one" / "case.resolved.toml"
    assert inputs.cyclic(resolved, "-o", again / "two", "-q").exit_code == 0
    one, two = inputs.content(again / "one"), inputs.content(again / "two")
    assert sorted(one) == inputs.FILES
    for name in one:
        assert one[name] == two[name], f"{name} differs"


def test_resolved_case_gives_the_same_bits(case: Path, tmp_path: Path) -> None:
    words = ["--dt", 0.013, "--ambient", -11.3, "--model-option", "scheme=published"]
    assert_same_bits(case, tmp_path, words)


def test_resolved_case_finds_its_files_from_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Recordings, series and bearings are named relative to the case; the resolved one moved."""
    folder = tmp_path / "given"
    folder.mkdir()
    (folder / "moved.csv").write_text("time_s,displacement_cm\n0,0\n1,3\n2,0\n3,-3\n4,0\n")
    (folder / "night.csv").write_text("time_h,temperature_degF\n0,32\n1,14\n")
    table = inputs.changed_table(
        inputs.specimen_table(), {"name": "mine/first", "geometry.rubber_layers": 5}
    )
    inputs.write_toml(folder / "mine.toml", table)
    path = inputs.write_toml(
        folder / "case.toml",
        {
            "bearing": "mine.toml",
            "ambient_series": "night.csv",
            "initial": "3.3 degC",
            "test": {"dt": "10 ms", "steps": [{"step": "recorded", "file": "moved.csv"}]},
        },
    )
    monkeypatch.chdir(tmp_path)
    assert_same_bits(path.relative_to(tmp_path), Path("results"), [])
    reported = inputs.summary(Path("results/one"))["runs"][0]
    assert reported["ambient_degC"] == pytest.approx(0.0, abs=1e-9)  # 32 degF, offset and all
    assert reported["cycles"][0]["amplitude_strain"] == pytest.approx(30.0 / 25.0)


def test_ambient_on_the_command_line_replaces_a_series(tmp_path: Path) -> None:
    (tmp_path / "night.csv").write_text("time_h,temperature_degC\n0,0\n1,-10\n")
    table = {"ambient_series": "night.csv", "test": {"dt": "10 ms", "steps": [inputs.CYCLES]}}
    path = inputs.write_toml(tmp_path / "case.toml", table)
    assert inputs.cyclic(path, "--ambient", 7, "-o", tmp_path / "out", "-q").exit_code == 0
    assert inputs.summary(tmp_path / "out")["runs"][0]["ambient_degC"] == 7.0


def test_initial_temperature_on_the_command_line_is_the_key_of_a_case(tmp_path: Path) -> None:
    table = inputs.QUICK_CASE | {"initial": "20 degC"}
    folders = [tmp_path / name for name in ("option", "file")]
    path = inputs.write_toml(tmp_path / "quick.toml", table)
    for folder, words in zip(folders, (["--initial", -3.5], []), strict=True):
        assert inputs.cyclic(path, *words, "-o", folder, "-q").exit_code == 0
        table["initial"] = "-3.5 degC"
        inputs.write_toml(path, table)
    first, second = (tb.load_result(folder) for folder in folders)
    assert (first["initial_temperature"].values == -3.5).all()
    assert (first["force"].values == second["force"].values).all()


def test_default_target_is_named_after_the_bearing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    bearing = inputs.write_toml(
        tmp_path / "b.toml", inputs.changed_table(inputs.specimen_table(), {"name": "../G1 (new)"})
    )
    path = inputs.quick_case(tmp_path / "case.toml", bearing=bearing.name)
    assert inputs.cyclic(path, "-q").exit_code == 0
    assert sorted(inputs.content(tmp_path / "cyclic-..-G1-new-")) == inputs.FILES


@pytest.mark.parametrize("name", quick_cases(["[bold]", "x[/y]", "[/]"], 0))
def test_names_are_no_markup(tmp_path: Path, name: str) -> None:
    """rich would swallow [bold] and crash on [/y]."""
    table = inputs.changed_table(inputs.specimen_table(), {"name": name})
    path = inputs.quick_case(tmp_path / "case[red].toml", bearing=table)
    for done in (inputs.cyclic(path, "-o", tmp_path / "out"), inputs.command("check", path)):
        assert done.exit_code == 0
        assert name in done.stdout
    assert "case[red].toml" in done.stdout.replace("\n", "")


@pytest.mark.parametrize(
    ("name", "kind"),
    [("shen-hdr-bridge", "bearing"), ("shen-hdr", "compound"), ("pier-p1", "structure")],
)
def test_check_takes_names_of_the_library(name: str, kind: str) -> None:
    done = inputs.command("check", name, "--json")
    assert done.exit_code == 0, done.output
    assert json.loads(done.output.splitlines()[-1])["kind"] == kind


def test_check_of_a_bilinear_bearing(tmp_path: Path) -> None:
    library = Path(str(resources.files("thermobearing"))) / "data" / "bilinear"
    done = inputs.command("check", library / "shen-bilinear-bridge.toml")
    assert done.exit_code == 0, done.output
    lines = [" ".join(line.split()) for line in done.output.splitlines()]
    assert "K_1, K_2 9.51, 1.81 kN/mm" in lines
    assert "Q_d 125.4 kN" in lines


def test_check_shows_what_lines_have_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "bridge.toml"
    path.write_text(
        'command = "bridge"\nstructure = "five-span-bridge"\nbearings = ["shen-hdr-bridge"]\n'
        'motions = [{ name = "jra-ii-i-1", angle = "30 deg" }]\nambient = ["0 degC"]\n'
        'axial_force = "800 kN"\n[analysis]\ncomponents = 1\n'
        '[[lines]]\nline = "A1"\nambient = "-5 degC"\naxial_force = "400 kN"\n'
    )
    output = " ".join(inputs.command("check", path).output.split())
    assert "motions jra-ii-i-1 at 30 deg ambient 0 degC axial force 800 kN" in output
    assert "line A1 -5 degC, 400 kN runs 2, average" in output


def test_the_list_of_structures_parts_names_and_descriptions() -> None:
    rows = inputs.command("structures", "list").output.splitlines()
    assert {"five-span-bridge", "pier-p1"} <= {row.partition("  ")[0] for row in rows}


def test_check_counts_the_runs_of_a_study(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(
        'command = "bridge"\nbearings = ["shen-hdr-bridge"]\n'
        'motions = ["jra-ii-i-1", "jra-ii-i-2"]\nambient = ["0 degC", "5 degC", "10 degC"]\n'
    )
    done = inputs.command("check", path)
    assert done.exit_code == 0, done.output
    assert "runs 6, average-acceleration" in " ".join(done.output.split())


@pytest.mark.parametrize(
    "words",
    [
        ["cyclic", "--dt", "soon"],
        ["cyclic", "--nonsense"],
        ["cyclic", "a.toml", "b.toml"],
        ["measure", "m.csv"],
        ["nonsense"],
    ],
    ids=["text for a number", "unknown option", "too many", "missing option", "unknown command"],
)
def test_wrong_usage(words: list[str]) -> None:
    done = inputs.command(*words, "--json")
    assert done.exit_code == 2
    assert inputs.last_line(done)["outcome"] == "bad_input"
    assert inputs.last_line(done)["message"]
    plain = inputs.command(*words)
    assert (plain.exit_code, plain.stdout) == (2, "")
    assert plain.stderr


@pytest.mark.parametrize(
    ("words", "pieces"),
    [
        (["--ambient", "500"], ["--ambient = '500.0 degC'", "at most 100 degC"]),
        (["--ambient", "nan"], ["--ambient = ", "not a finite number"]),
        (["--dt", "-1"], ["--dt = '-1.0 s'", "at least 1e-06"]),
        (
            ["--model-option", "scheme=publishd"],
            ["--model-option scheme = 'publishd'", '"published"?'],
        ),
        (
            ["--model-option", "side.film=-1 W/(m^2 K)"],
            ["--model-option side.film = '-1 W/(m^2 K)'", "at least 0"],
        ),
        (["--bearing", "shen-hdr-brige"], ['"shen-hdr-bridge"?']),
        (["--bearing", "none.toml"], ["none.toml: no such file"]),
        (["--keep-every", "0"], ["--keep-every = 0", "at least 1"]),
    ],
    ids=lambda value: value[0].strip("-") + value[1] if value[0].startswith("--") else "",
)
def test_bad_option_value(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], pieces: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    done = inputs.cyclic(*words, "--json")
    assert done.exit_code == 2
    for piece in ["command line: ", *pieces]:
        assert piece in inputs.last_line(done)["message"]
    assert list(tmp_path.iterdir()) == []


DIRECTORIES = [
    ["cyclic", "--bearing", "dir"],
    ["bridge", "--bearing", "dir"],
    ["bridge", "--motion", "dir"],
    ["bridge", "--weather", "dir"],
    ["lambda", "shen-hdr-bridge", "--weather", "dir"],
    ["live", "shen-hdr-specimen", "-o", "dir"],
]


@pytest.mark.parametrize("words", DIRECTORIES, ids=" ".join)
def test_a_directory_in_place_of_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dir").mkdir()
    done = inputs.command(*words)
    assert done.exit_code == 2
    assert "dir: is a directory" in done.stderr


@pytest.mark.parametrize("command", ["cyclic", "bridge"])
def test_a_bearing_in_place_of_a_case_file_suggests_the_option(command: str) -> None:
    done = inputs.command(command, "lrb-example", "--json")
    assert done.exit_code == 2
    assert "--bearing lrb-example" in inputs.last_line(done)["message"]


def test_no_memory_is_reported(case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_: Any) -> None:
        raise MemoryError

    monkeypatch.setattr(thermobearing.cyclic.history, "march", exhausted)
    done = inputs.cyclic(case, "-o", tmp_path / "out", "--json")
    assert done.exit_code == 2
    assert "(--keep-every) or use a larger --dt" in inputs.last_line(done)["message"]
    assert not (tmp_path / "out").exists()


def test_version_and_help() -> None:
    assert inputs.command("--version").stdout == f"thermobearing {tb.__version__}\n"
    for words in (["-h"], ["cyclic", "--help"], ["check", "-h"]):
        assert inputs.command(*words).exit_code == 0


def test_progress_without_a_terminal_is_a_few_lines(capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing within 10 s, then one line a minute, with the rest of the time."""
    now = [0.0]
    lines = ProgressLines("stepping", clock=lambda: now[0])
    for second in range(1, 101):
        now[0] = float(second)
        lines.show(second, 100)
    shown = capsys.readouterr().err.splitlines()
    assert shown == ["stepping: 10 of 100, about 90 s left", "stepping: 70 of 100, about 30 s left"]


def test_a_few_runs_say_nothing_about_the_rest(capsys: pytest.CaptureFixture[str]) -> None:
    """Of 1152 runs, 32 have ended after 10 s and 400 after 70 s."""
    now = [0.0]
    lines = ProgressLines("runs", clock=lambda: now[0])
    for second, done in ((1.0, 16), (10.0, 32), (70.0, 400)):
        now[0] = second
        lines.show(done, 1152)
    shown = capsys.readouterr().err.splitlines()
    assert shown == ["runs: 32 of 1152", "runs: 400 of 1152, about 2 minutes left"]


def test_runs_of_an_earlier_start_are_not_taken_for_the_rate(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Of 2000 runs, 500 are there; processes start within 50 s, then 10 runs a second end."""
    now = [0.0]
    lines = ProgressLines("runs", clock=lambda: now[0], resumes=True)
    for second, done in ((0.0, 500), (50.0, 510), (60.0, 610), (110.0, 1110)):
        now[0] = second
        lines.show(done, 2000)
    shown = capsys.readouterr().err.splitlines()
    assert shown == ["runs: 510 of 2000", "runs: 1110 of 2000, about 89 s left"]


def test_the_start_of_a_command_is_not_taken_for_the_rate(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The first of 30 runs is done after 40 s of compiling, the others take one second each."""
    now = [40.0]
    lines = ProgressLines("runs", clock=lambda: now[0] - 40.0)
    now[0] = 80.0
    lines.show(1, 30)
    assert capsys.readouterr().err == "runs: 1 of 30\n"
    for done in range(2, 30):
        now[0] += 5.0
        lines.show(done, 30)
    assert "runs: 13 of 30, about 85 s left" in capsys.readouterr().err
