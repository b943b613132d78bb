"""`intake` and `measure`: columns, units, blocks, rests, spikes, drift, ambient, the sidecar."""

import dataclasses
import json
import re
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from tests.unit.inputs import command
from thermobearing.cyclic.result import history_columns
from thermobearing.identify.records.figures import _time_axis
from thermobearing.identify.records.record import load_test
from thermobearing.intake.run import _example_places, write_template

BEARING = "shen-hdr-specimen"
Floats = NDArray[np.float64]


def history(rest: int = 800) -> tuple[Floats, Floats, Floats]:
    """Four times two cycles at 20 Hz with rests after them, jitter, three spikes and a drift."""
    rng = np.random.default_rng(2)
    turn = np.linspace(0.0, 4.0 * np.pi, 801)[:-1]
    x = np.concatenate([np.sin(turn), np.zeros(rest)] * 4) * 40.0
    f = np.concatenate([70.0 * np.sin(turn) + 15.0 * np.cos(turn), np.zeros(rest)] * 4)
    t = 0.05 * np.arange(len(x))
    x += 0.02 * rng.normal(size=len(x))
    f += 0.05 * rng.normal(size=len(x)) + 10.0 * t / t[-1]
    f[[150, 300, 1700]] += 300.0
    return t, x, f


def laboratory(path: Path) -> Path:
    """Semicolons, decimal commas, a clock over midnight, units below, force the other way."""
    t, x, f = history()
    clock = (86_390.0 + t) % 86_400.0
    lines = [
        "Prüfung 7;Operator",
        "# Kommentar",
        "",
        "Zeit;Weg SPS;Kraft;Kammer;T Pb;T3 [°C];Notiz",
    ]
    lines.append("hh:mm:ss;mm;kN;°C;°C;;")
    for s, a, b in zip(clock, x, f, strict=True):
        stamp = f"{int(s // 3600):02d}:{int(s % 3600 // 60):02d}:{s % 60:05.2f}"
        lines.append(f"{stamp};{a:.4f};{-b:.4f};-19.8;-18.0;-18.5;".replace(".", ","))
    path.write_text("\n".join(lines), encoding="cp1252")
    return path


def invoke(*words: object) -> tuple[int, str]:
    done = command(*words)
    return done.exit_code, done.output


def test_what_is_found(tmp_path: Path) -> None:
    file = laboratory(tmp_path / "lab day 1.csv")
    status, shown = invoke("intake", file, "--bearing", BEARING, "-o", tmp_path / "out")
    assert status == 0, shown
    output = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["files"][0]
    assert {c["title"]: c["holds"] for c in output["columns"]} == {
        "Zeit": "time",
        "Weg SPS": "displacement",
        "Kraft": "force",
        "Kammer": "ambient",
        "T Pb": "temperature",
        "T3 [°C]": "temperature",
        "Notiz": "nothing",
    }
    assert (output["separator"], output["decimal"]) == (";", ",")
    assert output["ambient_degC"] == pytest.approx(-19.8)
    assert output["unused_columns"] == ["T3 [°C]"]
    assert output["treatment"]["rests"] == 4
    assert output["treatment"]["spikes"] == {"displacement": 0, "force": 3}
    assert_allclose(output["treatment"]["drift"]["force_kN"], 10.0, rtol=tol.DRIFT_FOUND)
    assert (tmp_path / "out" / "figures" / "lab-day-1.png").exists()
    for word in ("T3 [°C]", "not used", "decimal comma", "3 spikes", "4 rests", "drifts by"):
        assert word in shown


@pytest.mark.thorough
def test_the_sidecar_reads_what_was_found(tmp_path: Path) -> None:
    file = laboratory(tmp_path / "lab.csv")
    bare = load_test(file)
    assert_allclose(bare.force, history()[2], atol=tol.FOUR_DECIMALS)
    (result,) = tb.inspect_files(file).files
    assert (
        invoke("intake", file, "--write-sidecars", "--no-figures", "-o", tmp_path / "a/b/out")[0]
        == 0
    )
    for path in (file, tmp_path / "a/b/out/sidecars/lab.toml"):
        record = load_test(path)
        assert_allclose(record.displacement, history()[1], atol=tol.FOUR_DECIMALS)
        assert_allclose(record.force, history()[2], atol=tol.FOUR_DECIMALS)
        assert_allclose(record.time, history()[0], atol=tol.FOUR_DECIMALS)
        assert record.ambient == pytest.approx(-19.8)
        assert record.places == {"T Pb": "lead"}
        assert record.unused == result.record.unused == ("T3 [°C]",)
    # What it suggests is valid once its mark is taken away.
    text = file.with_suffix(".toml").read_text(encoding="utf-8")
    for line in ("# despike = true", '# detrend = "force"', '# "T3 [°C]" = "rubber 1"'):
        assert line in text
        text = text.replace(line, line.removeprefix("# "))
    file.with_suffix(".toml").write_text(text, encoding="utf-8")
    corrected = load_test(file)
    assert (corrected.despike, corrected.detrend) == (True, "force")
    assert corrected.places == {"T Pb": "lead", "T3 [°C]": "rubber 1"}


def test_a_sidecar_that_is_there_wins_and_stays(tmp_path: Path) -> None:
    file = laboratory(tmp_path / "lab.csv")
    kept = 'ambient = "5 degC"\nflip_force = false\n[columns]\nforce = "T3 [°C]"\n'
    kept += '[units]\nforce = "kN"\n'
    file.with_suffix(".toml").write_text(kept, encoding="utf-8")
    status, shown = invoke("intake", file, "--write-sidecars", "-o", tmp_path / "out")
    assert status == 2
    assert "exists; correct it" in shown
    assert not (tmp_path / "out").exists()
    assert file.with_suffix(".toml").read_text(encoding="utf-8") == kept
    file.with_suffix(".toml").write_text('ambient = "5 degC"\nflip_force = false\n')
    (result,) = tb.inspect_files(file).files
    assert result.record.ambient == 5.0
    assert "flip_force" not in result.sidecar or result.sidecar["flip_force"] is False
    assert result.sidecar["columns"]["force"] == "Kraft"


def test_a_date_of_toml_and_the_strains_of_a_bearing(tmp_path: Path) -> None:
    """TOML has dates without quotes; 40 mm are 133 % of the 30 mm of rubber of this bearing."""
    file = laboratory(tmp_path / "lab.csv")
    file.with_suffix(".toml").write_text("date = 2024-11-05\n", encoding="utf-8")
    status, _ = invoke("intake", file, "--bearing", BEARING, "-o", tmp_path / "out")
    assert status == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    (item,) = summary["files"]
    assert item["sidecar"]["date"] == load_test(file).about["date"] == "2024-11-05"
    (levels,) = (result for result in item["findings"] if result["check"] == "strain")
    assert re.search(r"amplitude 40 mm is 133 % .* 30 mm of rubber", levels["sentence"])


def test_columns_without_titles_and_units(tmp_path: Path) -> None:
    t, x, f = history()
    path = tmp_path / "bare.txt"
    np.savetxt(path, np.column_stack([f[:1600], t[:1600], x[:1600]]), fmt="%.5f")
    (result,) = tb.inspect_files(path).files
    assert [column.holds for column in result.columns] == ["force", "time", "displacement"]
    assert result.sidecar["units"] == {"time": "s", "displacement": "mm", "force": "kN"}


def test_blocks_and_sheets(tmp_path: Path) -> None:
    t, x, f = (values[:800] for values in history())
    rows = "".join(f"{a:.3f},{b:.3f},{c:.3f}\n" for a, b, c in zip(t, x, f, strict=True))
    path = tmp_path / "two.csv"
    path.write_text(("time_s,disp_mm,load_kN\n" + rows) * 2)
    (result,) = tb.inspect_files(path).files
    assert result.blocks == 2
    assert [block.get("rest_before") for block in result.sidecar["blocks"]] == [None, "0 s"]
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    book = openpyxl.Workbook()
    for name in ("50%", "100%"):
        sheet = book.create_sheet(name)
        sheet.append(["時間(秒)", "変位計", "荷重計[tonf]", "室温(℃)"])
        for a, b, c in zip(t, x, f, strict=True):
            sheet.append([float(a), float(b), float(c) / 9.80665, 21.5])
    book.save(tmp_path / "book.xlsx")
    result = tb.inspect_files([path, tmp_path / "book.xlsx"]).files[1]
    assert [block["sheet"] for block in result.sidecar["blocks"]] == ["50%", "100%"]
    assert result.record.ambient == 21.5
    assert_allclose(result.record.force[:800], f, atol=tol.FOUR_DECIMALS)


BAD = [
    ("words", "a,b,c\n" + "x,y,z\n" * 20, "0 rows of numbers"),
    ("short", "time_s,displacement_mm,force_kN\n0,0,0\n1,1,1\n", "2 rows of numbers"),
    ("no force", "time_s,a_mm\n" + "".join(f"{k},{k % 7}\n" for k in range(20)), "as force"),
    ("no unit of force", "time_s,a_mm,Kraft [t]\n" + "1,2,3\n2,3,4\n" * 20, '"t" cannot be'),
    ("empty", "", "is empty"),
    ("binary", bytes(range(1, 256)) * 3, "neither UTF-8"),
]


@pytest.mark.parametrize(
    ("content", "reported"), [case[1:] for case in BAD], ids=[c[0] for c in BAD]
)
def test_bad_files(tmp_path: Path, content: str | bytes, reported: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    status, shown = invoke("intake", path, "-o", tmp_path / "out")
    assert (status, reported in shown) == (2, True), shown
    assert [item.name for item in tmp_path.iterdir()] == ["bad.csv"]


def test_a_recorded_history_reads_the_sidecar(tmp_path: Path) -> None:
    file = laboratory(tmp_path / "lab.csv")
    assert (
        invoke("intake", file, "--write-sidecars", "--no-figures", "-o", tmp_path / "out")[0] == 0
    )
    case = tmp_path / "case.toml"
    case.write_text(
        f'bearing = "{BEARING}"\nambient = ["0 degC"]\n[test]\n'
        'steps = [{ step = "recorded", file = "lab.csv" }]\n'
    )
    status, shown = invoke("check", case)
    assert status == 0, shown


def test_one_bad_file_does_not_stop_the_others(tmp_path: Path) -> None:
    good, bad = laboratory(tmp_path / "good.csv"), tmp_path / "bad.csv"
    bad.write_text("a,b\nx,y\n")
    words = ("intake", bad, good, tmp_path / "none.csv", "-o", tmp_path / "out", "--no-figures")
    status, shown = invoke(*words, "--json")
    assert status == 2, shown
    assert "bad.csv: " in shown
    assert "none.csv: no such file" in shown
    output = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert output["outcome"] == json.loads(shown.splitlines()[-1])["outcome"] == "files_left_out"
    assert [Path(item["file"]).name for item in output["files"]] == ["good.csv"]
    assert len(output["problems"]) == 2
    assert [item.name for item in (tmp_path / "out" / "sidecars").iterdir()] == ["good.toml"]
    assert invoke("intake", bad, "-o", tmp_path / "other")[0] == 2
    assert not (tmp_path / "other").exists()


@pytest.mark.parametrize(
    ("warmer", "reported"),
    quick_cases(
        [(0.3, ""), (0.5, ""), (0.8, "rises from"), (-1.0, "falls from"), (2.0, "rises from")],
        0,
        1,
    ),
)
def test_a_chamber_that_warms_is_reported(tmp_path: Path, warmer: float, reported: str) -> None:
    """Thermocouples read to a tenth, noise of 0.1 K."""
    t, x, f = history()
    noise = 0.1 * np.random.default_rng(3).normal(size=len(t))
    rows = zip(t, x, f, -20.0 + warmer * t / t[-1] + noise, strict=True)
    path = tmp_path / "warms.csv"
    path.write_text(
        "time_s,displacement_mm,force_kN,chamber_degC\n"
        + "".join(f"{a:.2f},{b:.4f},{c:.3f},{d:.1f}\n" for a, b, c, d in rows)
    )
    status, shown = invoke("intake", path, "-o", tmp_path / "out", "--no-figures")
    assert status == 0, shown
    assert ("the ambient temperature" in shown) is bool(reported)
    assert reported in shown
    if reported:
        begin, end = map(float, re.findall(r"from (-?\d+\.\d) to (-?\d+\.\d) degC", shown)[0])
        assert end - begin == pytest.approx(warmer, abs=0.11)
    status, shown = invoke("identify", path, "--check")
    assert (status, reported in shown) == (0, True), shown


def test_rests_do_not_fill_the_picture(tmp_path: Path) -> None:
    """Four rests of 75 s between loadings of 40 s had two thirds of its time axis; a rest of an
    hour all of it."""
    (result,) = tb.inspect_files(laboratory(tmp_path / "lab.csv")).files
    axis = _time_axis(result.report)
    rests = [s for s in axis.stretches if s.rest]
    assert len(rests) == 4
    assert sum(s.width for s in rests) < 0.5 * axis.end
    assert all(s.shortened for s in rests)
    figure = result.plot()
    assert "shortened" in figure.axes[0].get_xlabel()
    drawn = figure.axes[0].lines[0].get_xdata()
    assert drawn[0] == 0.0
    assert drawn[-1] == pytest.approx(axis.end, rel=tol.DRIFT_FOUND)
    assert (np.diff(drawn) >= 0.0).all()


STRENGTH = 30.0  # [kN]


def logged(path: Path, *, separator: str = ",", comma: bool = False) -> Path:
    """A logger of 20 Hz through three cycles with rests in which the force is lost."""
    rng = np.random.default_rng(1)
    turn = np.linspace(0.0, 2.0 * np.pi, 201)[:-1]
    x, force = 30.0 * np.sin(turn), 60.0 * np.sin(turn) + STRENGTH * np.cos(turn)
    still = np.arange(800)
    lost = STRENGTH * np.exp(-still / 100.0)
    ways = np.concatenate([np.concatenate([x, 0.0 * still])] * 3)
    forces = np.concatenate([np.concatenate([force, lost])] * 3)
    ways, forces = (
        ways + 0.02 * rng.normal(size=len(ways)),
        forces + 0.1 * rng.normal(size=len(ways)),
    )
    lines = [separator.join(["Zeit [s]", "Weg (mm)", "Last", "T_3"])]
    for k, (a, b) in enumerate(zip(ways, forces, strict=True)):
        line = separator.join([f"{0.05 * k:.2f}", f"{a:.4f}", f"{-1e3 * b:.3f}", "1"])
        lines.append(line.replace(".", ",") if comma else line)
    path.write_text("\n".join(lines))
    path.with_suffix(".toml").write_text(
        'flip_force = true\n[columns]\ndisplacement = "Weg (mm)"\nforce = "Last"\n'
        '[units]\nforce = "N"\n'
    )
    return path


@pytest.mark.parametrize("ending", [".csv", ".toml"])
@pytest.mark.parametrize(("separator", "comma"), quick_cases([(",", False), (";", True)], 1))
def test_sidecar_and_rests(tmp_path: Path, ending: str, separator: str, comma: bool) -> None:
    path = logged(tmp_path / "t.csv", separator=separator, comma=comma).with_suffix(ending)
    done = command("measure", path, "--bearing", BEARING, "--json")
    assert done.exit_code == 0, done.output
    output = json.loads(done.stdout.splitlines()[-1])
    strengths = [cycle["characteristic_strength_kN"] for cycle in output["cycles"]]
    assert_allclose(strengths, STRENGTH, rtol=tol.FORCE_AT_A_REST)
    assert [cycle["ends"] for cycle in output["cycles"]] == ["rest"] * 3
    assert "columns not used: T_3" in output["notes"]
    assert "columns not used: T_3" in done.stdout


def test_a_unit_that_no_bearing_can_have_is_refused(tmp_path: Path) -> None:
    path = logged(tmp_path / "t.csv")
    sidecar = path.with_suffix(".toml")
    sidecar.write_text(sidecar.read_text().replace('"N"', '"kN"'))
    done = command("measure", path, "--bearing", BEARING)
    assert (done.exit_code, done.stdout) == (2, "")
    assert "force in N labelled kN" in done.stderr


def test_written_like_the_others(tmp_path: Path) -> None:
    path, out = logged(tmp_path / "t.csv"), tmp_path / "out"
    words = ["measure", path, "--bearing", BEARING, "-o", out]
    done = command(*words, "--json")
    assert done.exit_code == 0, done.output
    output = json.loads(done.stdout.splitlines()[-1])
    assert output["output"] == str(out)
    saved = tb.load_result(out)
    assert (saved.command, saved.outcome) == ("measure", "completed")
    table = saved["cycles"]
    assert table["cycle"].tolist() == [1, 2, 3]
    assert table["ends"].tolist() == ["rest"] * 3
    reported = [cycle["stiffness_kN_mm"] for cycle in output["cycles"]]
    assert_allclose(table["K_eq_kN_mm"], reported, rtol=tol.ROUNDING)
    assert_allclose(table["strain"], 1.0, rtol=tol.FORCE_AT_A_REST)
    assert [path.name for path in saved.figures] == ["loops.png"]
    assert "columns not used: T_3" in saved.summary["notes"]
    again = command(*words)
    assert (again.exit_code, "--overwrite" in again.output) == (2, True), again.output
    quiet = command(*words, "--overwrite", "-q", "--no-figures")
    assert (quiet.exit_code, quiet.output) == (0, "")
    assert not (out / "figures").exists()


@pytest.mark.parametrize(
    ("title", "values", "result"),
    [
        ("Temperatura", 21.0, "ambient"),
        ("Temperature [K]", 253.15, "ambient"),
        ("温度", -30.0, "ambient"),
        ("Temp. oil", 80.0, "temperature"),  # no ambient temperature
        ("Temperatur Blei", 21.0, "temperature"),
        ("Temperature", np.linspace(21.0, 40.0, 401), "temperature"),  # of rubber that warms
    ],
)
def test_a_constant_temperature_is_proposed_as_ambient(
    tmp_path: Path, title: str, values: Any, result: str
) -> None:
    t = np.linspace(0.0, 4.0, 401)
    x = 30.0 * np.sin(2.0 * np.pi * t)
    rows = np.column_stack([t, x, 2.0 * x, np.broadcast_to(values, t.shape)])
    file = tmp_path / "lab.csv"
    lines = [f"time [s],displacement [mm],force [kN],{title}"]
    lines += [",".join(f"{number:.6g}" for number in row) for row in rows]
    file.write_text("\n".join(lines), encoding="utf-8")
    (item,) = tb.inspect_files(file).files
    assert item.columns[3].holds == result
    assert item.sidecar["columns"].get("ambient") == (title if result == "ambient" else None)
    if result == "ambient":
        unit = 273.15 if "[K]" in title else 0.0
        assert item.record.ambient == pytest.approx(values - unit)


def disorder(name: str) -> list[Floats]:
    """Time, displacement and force of four cycles at 100 Hz with one fault."""
    t = np.linspace(0.0, 4.0, 401)
    x = 30.0 * np.sin(2.0 * np.pi * t)
    f = 60.0 * np.sin(2.0 * np.pi * t + 0.3)
    rng = np.random.default_rng(0)
    if name == "shuffled":
        return list(rng.permutation(np.column_stack([t, x, f])).T)
    if name == "exchanged":  # two quarters of the rows, below the even clock of the file
        order = np.r_[0:100, 220:320, 100:220, 320:401]
        return [t, x[order], f[order]]
    if name == "late":  # the force lags behind the displacement
        return [t, x, 60.0 * np.sin(2.0 * np.pi * t - 0.3)]
    if name == "late once":
        return [t, x, np.where(t < 1.0, 60.0 * np.sin(2.0 * np.pi * t - 0.1), f)]
    return [1000.0 * t, x, f]  # milliseconds


@pytest.mark.parametrize(
    ("name", "check"),
    [("shuffled", "time"), ("exchanged", "rows"), ("late", "columns"), ("late once", "energy")],
)
def test_every_command_refuses_rows_out_of_order(tmp_path: Path, name: str, check: str) -> None:
    columns = [*disorder(name), np.full(401, 23.0)]
    file = tmp_path / "lab.csv"
    head = "time [s],displacement [mm],force [kN],ambient [degC]"
    np.savetxt(file, np.column_stack(columns), delimiter=",", header=head, comments="", fmt="%.6f")
    (item,) = tb.inspect_files(file, BEARING).files
    refused = [finding.check for finding in item.report.findings if finding.level == "refused"]
    assert check in refused
    for words in (
        ("measure", file, "--bearing", BEARING),
        ("validate", BEARING, file, "-o", tmp_path / "out"),
        ("identify", file, "--bearing", BEARING, "--check"),
    ):
        assert command(*words).exit_code == 2, words
    assert not (tmp_path / "out").exists()


def test_milliseconds_and_kelvin_are_recognised(tmp_path: Path) -> None:
    t, x, f = disorder("milliseconds")
    record = tb.record_from_arrays(t, x, f, -10.0)
    speeds = [one for one in tb.check_test(record, BEARING).findings if one.check == "speed"]
    assert [(one.level, "ms labelled s" in one.sentence) for one in speeds] == [("warning", True)]
    warm = dataclasses.replace(
        tb.record_from_arrays(t / 1000.0, x, f, -10.0),
        temperatures={"T1": 263.15 + 0.001 * t},
        places={"T1": "rubber 1"},
    )
    (kelvin,) = (one for one in tb.check_test(warm, BEARING).findings if one.level == "refused")
    assert kelvin.check == "thermocouple"


def chamber_file(path: Path, title: str, values: Any, name: str = "lab.csv") -> Path:
    """Four cycles at 100 Hz with one more column, in a file without a sidecar."""
    t = np.linspace(0.0, 4.0, 401)
    x = 30.0 * np.sin(2.0 * np.pi * t)
    f = 20.0 * np.sin(2.0 * np.pi * t + 0.3)
    rows = np.column_stack([t, x, f, np.broadcast_to(values, t.shape)])
    lines = [f"Zeit [s],Weg [mm],Kraft [kN],{title}"]
    lines += [",".join(f"{number:.6g}" for number in row) for row in rows]
    (path / name).write_text("\n".join(lines), encoding="utf-8")
    return path / name


@pytest.mark.parametrize("title", ["Kammertemperatur", "Klimakammertemperatur", "ChamberTemp"])
def test_a_chamber_in_one_word_is_the_ambient(tmp_path: Path, title: str) -> None:
    assert load_test(chamber_file(tmp_path, title, -10.0)).ambient == -10.0


@pytest.mark.parametrize(
    ("title", "values"),
    [
        ("Kanal 7", -10.0),  # neither name nor unit
        ("Gummi 1 [°C]", np.linspace(-10.0, 4.0, 401)),  # of a specimen that was in a chamber
        ("Temperatur", 263.15),  # in kelvin, without saying so
    ],
)
def test_23_is_not_assumed_against_a_column(tmp_path: Path, title: str, values: Any) -> None:
    file = chamber_file(tmp_path, title, values)
    with pytest.raises(
        tb.InputError, match=f'"{title.replace("[", ".").replace("]", ".")}"'
    ) as why:
        load_test(file)
    # A column that varies by more than a chamber does is not offered: it would be refused next.
    assert ("Set ambient" in str(why.value)) == (np.ptp(values) == 0.0)
    (item,) = tb.inspect_files(file).files
    assert item.report.outcome == "refused"
    assert item.summary()["ambient_degC"] is None
    assert "ambient" not in item.sidecar
    file.with_suffix(".toml").write_text('ambient = "-10 degC"', encoding="utf-8")
    assert load_test(file).ambient == -10.0


def test_23_is_assumed_with_a_warning_where_no_column_contradicts(tmp_path: Path) -> None:
    record = load_test(chamber_file(tmp_path, "Gummi 1 [°C]", np.linspace(22.0, 31.0, 401)))
    assert record.ambient == 23.0
    assert any("23 degC" in text for text in record.assumptions)


def fill_template(path: Path, record: tb.TestRecord, about: dict[str, object]) -> None:
    """Fill in a template as a laboratory does, with samples and thermocouples of a test."""
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    book = openpyxl.load_workbook(path)
    heads = [cell.value for cell in book["Test"][3]]
    titles = {f"{place.capitalize()} [°C]": title for title, place in record.places.items()}
    for k in range(len(record.time)):
        row = [record.time[k], record.displacement[k], record.force[k]]
        row += [record.temperatures[titles[h]][k] if h in titles else None for h in heads[3:]]
        book["Test"].append([None if value is None else float(value) for value in row])
    for key, value, *_ in book["Description"].iter_rows(min_row=4):
        value.value = about.get(key.value, value.value)
    book.save(path)


def test_a_template_is_read_without_questions(tmp_path: Path) -> None:
    """Samples, temperatures and description come back exactly, and nothing is assumed."""
    pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    path = tmp_path / "test.xlsx"
    status, _ = invoke("intake", "--template", path, "--bearing", "shen-lhdr-specimen")
    assert status == 0
    steps = tb.cyclic_test(strain=[0.5], cycles=2, rest=None)
    record = tb.synthetic_record("shen-lhdr-specimen", -20.0, steps)
    warm = {"T1": -20.0 + 0.1 * record.time, "T2": -20.0 + 2.0 * record.time}
    places = {"T1": "rubber 1", "T2": "lead"}
    record = dataclasses.replace(record, temperatures=warm, places=places)
    about = {"name": "低温 20", "ambient": -20, "laboratory": "Prüfstelle Málaga", "scragged": "no"}
    fill_template(path, record, about | {"specimen": "S-7", "date": datetime(2026, 10, 2)})
    (result,) = tb.inspect_files(path, "shen-lhdr-specimen").files
    read = result.record
    assert read.assumptions == ()
    assert {finding.level for finding in result.report.findings} == {"note"}
    assert not any(column.assumed for column in result.columns)
    assert_allclose(read.time, record.time, rtol=1e-15)
    assert_allclose(read.force, record.force, rtol=1e-15)
    assert_allclose(read.temperatures["Lead [°C]"], warm["T2"], rtol=1e-15)
    assert set(read.places.values()) == {"rubber 1", "lead"}
    assert (read.name, read.ambient, read.bearing) == ("低温 20", -20.0, "shen-lhdr-specimen")
    about = {"specimen": "S-7", "laboratory": "Prüfstelle Málaga", "date": "2026-10-02"}
    assert read.about == about | {"scragged": False}
    path.with_suffix(".toml").write_text('ambient = "-10 degC"')  # a sidecar goes first
    assert load_test(path).ambient == -10.0


def test_a_template_has_the_temperatures_of_a_history(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    bearing = "shen-lhdr-specimen"
    run = tb.run(bearing, tb.cyclic_test(strain=[0.5], cycles=1, rest=None), ambient=-20)
    names = [name for name in history_columns(run, 0) if name.endswith("_degC")]
    book = openpyxl.load_workbook(write_template(tmp_path / "test.xlsx", bearing))
    heads = [cell.value for cell in book["Test"][3]][3:]
    assert heads == ["Rubber 1 [°C]", "Rubber 2 [°C]", "Rubber 3 [°C]", "Lead [°C]"]
    assert names == ["rubber1_degC", "rubber2_degC", "rubber3_degC", "lead_degC"]


@pytest.mark.parametrize(
    ("key", "value", "reported"),
    [
        ("scragged", "maybe", 'scragged = "maybe": must be yes or no'),
        ("ambient", "cold", "ambient"),
        ("ambient", -300, "ambient"),
    ],
)
def test_a_template_with_a_wrong_value(
    tmp_path: Path, key: str, value: object, reported: str
) -> None:
    pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    path = write_template(tmp_path / "test.xlsx")
    t = np.linspace(0.0, 4.0, 200)
    x = 30.0 * np.sin(np.pi * t)
    fill_template(path, tb.record_from_arrays(t, x, 2.0 * x, 23.0), {key: value})
    with pytest.raises(tb.InputError, match=reported):
        load_test(path)
    status, output = invoke("intake", "--template", path)
    assert (status, "exists" in output) == (2, True)
    with pytest.raises(tb.InputError, match=r"must end with \.xlsx"):
        write_template(tmp_path / "test.csv")


def headed_file(path: Path, lines: list[str], separator: str = ";", column: str = "") -> Path:
    """Write a test below lines of text, with a decimal comma where the separator is no comma."""
    t = np.linspace(0.0, 4.0, 401)
    columns = {"Zeit [s]": t, "Weg [mm]": 10.0 * np.sin(2.0 * np.pi * t)}
    columns["Kraft [kN]"] = 20.0 * np.sin(2.0 * np.pi * t + 0.3)
    columns |= {column: np.full(401, -20.0)} if column else {}
    rows = [separator.join(f"{v:.6g}" for v in row) for row in zip(*columns.values(), strict=True)]
    text = "\n".join(rows)
    text = text if separator == "," else text.replace(".", ",")
    head = [*lines, separator.join(columns)]
    file = path / "t.csv"
    file.write_text("\n".join([*head, text]), encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("line", "separator", "ambient"),
    [
        ("Raumtemperatur 23,0 °C", ";", 23.0),
        ("Raumtemperatur 23,5 °C", ",", 23.5),
        ("# Kammertemperatur: -20 °C", ";", -20.0),
        ("Room temperature;23,5;degC", ";", 23.5),
        ("Chamber temperature,-10.5,C", ",", -10.5),
        ("Chamber: 253.15 K", ";", -20.0),
        ("Ambient temp. 23 ± 2 °C", ";", 23.0),
        ("Prüftemperatur: -5", ";", -5.0),
        ("室温：２３．５℃", ";", 23.5),
        ("恒温槽温度 -30 度", ";", -30.0),
        ("試験温度\t0 ℃", "\t", 0.0),
    ],
)
def test_a_temperature_above_the_table_is_read(
    tmp_path: Path, line: str, separator: str, ambient: float
) -> None:
    file = headed_file(tmp_path, ["Protokoll 17", line], separator)
    (item,) = tb.inspect_files(file).files
    assert item.record.ambient == ambient
    (note,) = (f for f in item.report.findings if f.check == "ambient")
    assert (note.level, "line 2" in note.sentence) == ("note", True)
    assert not item.record.assumptions
    assert item.sidecar["ambient"] == f"{ambient:g} degC"


@pytest.mark.parametrize(
    "line",
    ["Kammer Nr. 3", "Raum 23", "Raumtemperatur 20 bis 25 °C", "Date of chamber temp 2026-11-03"],
)
def test_a_line_without_one_temperature_of_the_chamber_states_none(
    tmp_path: Path, line: str
) -> None:
    """23 degC is assumed with a warning, and stands in the sidecar as a comment only."""
    file = headed_file(tmp_path, [line])
    (item,) = tb.inspect_files(file).files
    assert (item.record.ambient, item.record.ambient_from) == (23.0, "")
    assert len(item.record.assumptions) == 1
    assert "ambient" not in item.sidecar
    item_text = item._sidecar_text(tmp_path)
    assert [text for text in item_text.splitlines() if text.startswith("ambient")] == []
    assert '# ambient = "23 degC"' in item_text


def test_temperatures_that_contradict_each_other_are_refused(tmp_path: Path) -> None:
    lines = ["Raumtemperatur 23 °C", "Kammertemperatur -20 °C"]
    with pytest.raises(tb.InputError, match=r"line 1.*line 2"):
        load_test(headed_file(tmp_path, lines))
    with pytest.raises(tb.InputError, match=r"line 1.*Kanal 7"):
        load_test(headed_file(tmp_path, lines[:1], column="Kanal 7"))
    chamber = headed_file(tmp_path, lines[:1], column="Kammer [°C]")
    assert load_test(chamber).ambient == -20.0  # the column goes first


def test_each_thermocouple_has_its_own_example_of_a_place(tmp_path: Path) -> None:
    t = np.linspace(0.0, 4.0, 401)
    x, f = 10.0 * np.sin(2.0 * np.pi * t), 20.0 * np.sin(2.0 * np.pi * t + 0.3)
    rows = np.column_stack([t, x, f, 23.0 + t, 23.0 + 2.0 * t])
    lines = [",".join(f"{number:.6g}" for number in row) for row in rows]
    head = "time [s],displacement [mm],force [kN],TE1 [°C],TE2 [°C]"
    (tmp_path / "t.csv").write_text("\n".join([head, *lines]), encoding="utf-8")
    (item,) = tb.inspect_files(tmp_path / "t.csv").files
    places = re.findall(r'^# "TE\d \[°C\]" = "(rubber \d)"', item._sidecar_text(tmp_path), re.M)
    assert places == ["rubber 1", "rubber 2"]


@pytest.mark.parametrize(("layers", "middle"), [(6, 3), (7, 4), (0, 2)])
def test_a_thermocouple_in_the_middle_is_in_the_middle_layer(layers: int, middle: int) -> None:
    """Without a bearing the places are examples in the order of the columns."""
    places = _example_places(["TC1 außen", "TC2 Mitte"], layers)
    assert places == {"TC1 außen": "rubber 1", "TC2 Mitte": f"rubber {middle}"}
