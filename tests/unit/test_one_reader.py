"""Every command reads a laboratory's table in the same way, without a sidecar."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import steps_case
from thermobearing.cli import app
from thermobearing.identify.records.record import load_test

BEARING = "shen-hdr-specimen"
TURN = np.linspace(0.0, 4.0 * np.pi, 401)
TIME, WAY = 0.05 * np.arange(401), 30.0 * np.sin(TURN)
FORCE = 60.0 * np.sin(TURN) + 15.0 * np.cos(TURN)


def laboratory(path: Path, *, strain: float | None = None, head: str = "") -> Path:
    """Semicolons, decimal commas, cm and tonf, the force against the displacement, a chamber."""
    more = "" if strain is None else ";shear_strain"
    lines = [head or f"Zeit [s];Weg SPS [cm];Kraft [tonf];Chamber temp.{more}"]
    for t, x, f in zip(TIME, WAY, FORCE, strict=True):
        cells = [f"{t:.2f}", f"{x / 10.0:.5f}", f"{-f / 9.80665:.6f}", "-20,0"]
        cells += [] if strain is None else [f"{x / strain:.6f}"]
        lines.append(";".join(cells).replace(".", ","))
    path.write_text("\n".join(lines), encoding="cp1252")
    return path


def command(*words: object) -> tuple[int, dict[str, Any]]:
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, {"text": done.output}


def test_every_command_takes_the_column_of_the_chamber(tmp_path: Path) -> None:
    file, out = laboratory(tmp_path / "lab.csv"), tmp_path / "out"
    (taken,) = tb.take_in(file).files
    record = load_test(file)
    assert record.ambient == taken.record.ambient == -20.0
    assert_allclose(record.force, FORCE, atol=tol.FOUR_DECIMALS)
    assert_allclose(record.displacement, WAY, atol=tol.FOUR_DECIMALS)
    status, _ = command("validate", BEARING, file, "-o", out, "--no-figures", "-q")
    said = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert status in (0, 4)
    assert said["comparisons"][0]["ambient_degC"] == -20.0
    status, shown = command("identify", file, "--bearing", BEARING, "--check")
    assert "no ambient temperature" not in shown["text"]
    assert command("measure", file, "--bearing", BEARING)[0] == 0


def test_a_reversed_force_is_reported_by_every_command(tmp_path: Path) -> None:
    file, out = laboratory(tmp_path / "lab.csv"), tmp_path / "out"
    assert sum("opposite sign" in text for text in load_test(file).assumptions) == 1
    for words in (
        ("intake", file, "-o", tmp_path / "taken", "--no-figures"),
        ("identify", file, "--bearing", BEARING, "--check"),
        ("measure", file, "--bearing", BEARING),
    ):
        status, shown = command(*words)
        assert (status, "opposite sign" in shown["text"].replace("\n", " ")) == (0, True), shown
    command("validate", BEARING, file, "-o", out, "--no-figures", "-q")
    said = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert any("opposite sign" in text for text in said["warnings"])
    taken = json.loads((tmp_path / "taken" / "summary.json").read_text(encoding="utf-8"))
    assert taken["files"][0]["sidecar"]["flip_force"] is True


def test_a_sign_that_the_sidecar_states_is_kept(tmp_path: Path) -> None:
    file = laboratory(tmp_path / "lab.csv")
    file.with_suffix(".toml").write_text("flip_force = false\n")
    assert_allclose(load_test(file).force, -FORCE, atol=tol.FOUR_DECIMALS)


def test_an_unknown_ambient_temperature_is_a_warning(tmp_path: Path) -> None:
    file = tmp_path / "bare.csv"
    rows = "".join(f"{t},{x},{f}\n" for t, x, f in zip(TIME, WAY, FORCE, strict=True))
    file.write_text("time_s,displacement_mm,force_kN\n" + rows)
    command("validate", BEARING, file, "-o", tmp_path / "out", "--no-figures", "-q")
    said = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert any("23 degC assumed" in text for text in said["warnings"])


def test_strains_are_compared_with_the_displacement(tmp_path: Path) -> None:
    """The specimen has 30 mm of rubber; a column of strains tells how much the file has."""
    right, wrong = (
        tb.check_test(laboratory(tmp_path / f"{size}.csv", strain=size), BEARING)
        for size in (30.0, 25.0)
    )
    assert_allclose(wrong.record.rubber_thickness, 25.0, rtol=tol.FOUR_DECIMALS)
    levels = [
        [f.level for f in report.findings if f.check == "rubber"] for report in (right, wrong)
    ]
    assert levels == [["note"], ["note", "warning"]]
    percent = laboratory(tmp_path / "percent.csv", strain=0.25)
    assert_allclose(load_test(percent).rubber_thickness, 25.0, rtol=tol.FOUR_DECIMALS)


def test_a_recording_reads_the_same_table(tmp_path: Path) -> None:
    laboratory(tmp_path / "lab.csv")
    case = tb.load_case(steps_case(tmp_path / "case.toml", {"step": "recorded", "file": "lab.csv"}))
    gaps, way, assumed = case.test.steps[0].points(0.0)
    assert_allclose(way, WAY, atol=tol.FOUR_DECIMALS)
    assert_allclose(gaps, 0.05, rtol=tol.FOUR_DECIMALS)
    assert assumed == []


def test_what_a_recording_assumes_is_a_warning(tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text("Zeit;Weg\n0;0\n1;10\n2;0\n")
    case = steps_case(tmp_path / "case.toml", {"step": "recorded", "file": "h.csv"})
    result = tb.run_case(tb.load_case(case))
    assert sum("has no unit" in text for text in result.warnings) == 2


@pytest.mark.parametrize(
    ("titles", "rows", "air"),
    [
        ("Datum;Uhrzeit;Lufttemperatur [°C];Feuchte", "01.02.2024;{h:02d}:00;-{h},5;80", -1.5),
        ("Zeit [h];T_amb [°C]", "{h};-{h},5", -1.5),
        ("Messzeit [h];Kanal 4 [°C]", "{h};-{h},5", -1.5),
    ],
)
def test_weather_reads_the_same_tables(tmp_path: Path, titles: str, rows: str, air: float) -> None:
    file = tmp_path / "town.csv"
    file.write_text("\n".join([titles, *(rows.format(h=h) for h in range(1, 6))]))
    weather = tb.read_weather(file)
    assert weather.temperature[0] == air
    assert len(weather) == 5


def test_weather_with_two_air_temperatures_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "town.csv"
    file.write_text("time [h];air 1 [degC];air 2 [degC]\n1;2;3\n2;3;4\n")
    with pytest.raises(tb.InputError, match="may each be"):
        tb.read_weather(file)


MOTIONS = {
    "German": "Zeit (s);Beschleunigung (cm/s2)\n{rows}",
    "units below": "Zeit;Beschleunigung\ns;cm/s2\n{rows}",
    "title above": "Messung 3\nZeit [ms];Beschleunigung [gal]\n{ms}",
    "time last": "Beschleunigung [gal];Zeit [s]\n{turned}",
}


@pytest.mark.parametrize("form", MOTIONS)
def test_a_motion_reads_the_same_tables(tmp_path: Path, form: str) -> None:
    values = 300.0 * np.sin(0.3 * np.arange(40))
    pairs = [(0.01 * k, a) for k, a in enumerate(values)]
    text = MOTIONS[form].format(
        rows="\n".join(f"{t:.2f};{a:.4f}" for t, a in pairs).replace(".", ","),
        ms="\n".join(f"{1e3 * t:.0f};{a:.4f}" for t, a in pairs).replace(".", ","),
        turned="\n".join(f"{a:.4f};{t:.2f}" for t, a in pairs).replace(".", ","),
    )
    file = tmp_path / "wave.csv"
    file.write_text(text)
    motion = tb.load_motion(file)
    assert motion.dt == 0.01
    assert_allclose(motion.acceleration, 10.0 * values, atol=1e-3)


def test_a_motion_in_a_workbook(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    book = openpyxl.Workbook()
    book.active.append(["時間(s)", "加速度(gal)"])
    values = 300.0 * np.sin(0.3 * np.arange(40))
    for k, a in enumerate(values):
        book.active.append([0.01 * k, float(a)])
    book.save(tmp_path / "wave.xlsx")
    assert_allclose(tb.load_motion(tmp_path / "wave.xlsx").acceleration, 10.0 * values, rtol=1e-12)


def test_a_guessed_place_that_the_bearing_does_not_have_is_not_used(tmp_path: Path) -> None:
    """A title with "core" is no lead in a bearing without; a sidecar that says so is refused."""
    file = laboratory(tmp_path / "lab.csv")
    lines = file.read_text(encoding="cp1252").splitlines()
    more = [f"{lines[0]};core [degC];rubber 9 [degC];layer 2 [degC]"]
    file.write_text("\n".join(more + [f"{line};-19;-19;-19" for line in lines[1:]]))
    record = load_test(file)
    assert len(record.places) == 3
    assert record.of_bearing(tb.load_bearing(BEARING)).places == {"layer 2 [degC]": "rubber 2"}
    found = tb.validate_bearing(BEARING, file)
    assert list(found.thermocouples["thermocouple"]) == ["layer 2 [degC]"]
    file.with_suffix(".toml").write_text('[thermocouples]\n"core [degC]" = "lead"\n')
    with pytest.raises(tb.InputError, match="no lead"):
        tb.validate_bearing(BEARING, file)
