"""Input that once ended in a traceback or without end; values of a wrong type."""

import copy
import decimal
import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

import thermobearing as tb
from tests.unit import inputs
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border import opener
from thermobearing.border.errors import InputError
from thermobearing.border.toml import DEEPEST
from thermobearing.border.units import parse_quantity
from thermobearing.commands.check import check_file
from thermobearing.commands.common import GuardedStream, reported
from thermobearing.design.case import load_design_case
from thermobearing.design.factors import _chosen_cycles, scaled_bearing, temperature_factors
from thermobearing.earthquake.case import load_earthquake_case, make_earthquake_case
from thermobearing.identify.case import make_identify_case
from thermobearing.identify.fit.parameters import parameter_set
from thermobearing.identify.records.record import load_test, record_from_arrays
from thermobearing.motions.library import load_motion
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.motions.targets import standard_spectrum
from thermobearing.results.directory import seal
from thermobearing.results.metrics import measure_history
from thermobearing.structure.model import load_structure
from thermobearing.studies.definition.case import load_study
from thermobearing.studies.definition.motions import _read_motions
from thermobearing.tables import columns, text

LOADERS: list[Callable[[Path], Any]] = [
    tb.load_bearing,
    tb.load_case,
    load_bilinear,
    load_structure,
    load_earthquake_case,
    load_design_case,
    load_test,
    check_file,
]
LONG = "x" * 300  # longer than a file system allows
TEST = "time_s,displacement_mm,force_kN\n" + "".join(
    f"{0.1 * k:g},{np.sin(0.3 * k):.6f},{np.sin(0.3 * k + 0.2):.6f}\n" for k in range(100)
)


@pytest.mark.parametrize("key", ["columns", "units"])
@pytest.mark.parametrize(
    "value", ["3", "1979-05-27", "[[1]]", '{value = 3, source = "?", note = "?"}', "true"]
)
def test_columns_and_units_that_are_no_tables(tmp_path: Path, key: str, value: str) -> None:
    (tmp_path / "t.csv").write_text(TEST)
    path = tmp_path / "t.toml"
    path.write_text(f"{key} = {value}\n")
    inputs.assert_refused(lambda: load_test(path), str(path), key, "must be a table")


@pytest.mark.parametrize(
    "text", ["value = 3\n", "value = [1]\n", 'value = {x = 1}\nsource = "?"\n', "[geometry]\n"]
)
@pytest.mark.parametrize("load", LOADERS)
def test_file_that_is_one_value(load: Callable[[Path], Any], text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(text)
    inputs.assert_refused(lambda: load(path), str(path))


@pytest.mark.parametrize(
    ("text", "piece"),
    [
        ("name = 0x" + "f" * 4000, "name: an integer of more than 64 bits"),
        ("[[test.steps]]\ncount = 1" + "0" * 400, "test.steps[0].count: an integer"),
        ("a" + ".a" * DEEPEST + " = 1", f"deeper than {DEEPEST} levels"),
        ("count = 1" + "0" * 5000, "cannot be read"),
    ],
    ids=["hexadecimal", "decimal", "nested", "thousands of digits"],
)
@pytest.mark.parametrize("load", LOADERS)
def test_numbers_and_nesting_beyond_toml(
    load: Callable[[Path], Any], text: str, piece: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.toml"
    path.write_text(text)
    inputs.assert_refused(lambda: load(path), str(path), piece)


@pytest.mark.parametrize("value", [[1], {"x": 1}, False, 3.5])
def test_command_that_is_no_word(value: Any, tmp_path: Path) -> None:
    path = inputs.write_toml(tmp_path / "case.toml", {"command": value})
    inputs.assert_refused(lambda: load_earthquake_case(path), "command = ", '"bridge" or "hybrid"')
    inputs.assert_refused(lambda: check_file(path), "command = ", '"bridge" or "hybrid"')


def test_tables_of_a_study_that_are_none() -> None:
    table = {"command": "hybrid", "analysis": 3, "laboratory": 4}
    inputs.assert_refused(
        lambda: make_earthquake_case(table, "t", dt=0.01), "analysis = 3", "laboratory = 4"
    )
    inputs.assert_refused(lambda: make_earthquake_case({"duration": True}, "t"), "duration = True")


def test_whole_number_with_a_point_is_that_number(tmp_path: Path) -> None:
    step = {"step": "cycles", "strain": 1.0, "speed": "60 mm/s", "count": 1.0}
    case = tb.load_case(inputs.quick_case(tmp_path / "case.toml", test={"steps": [step]}))
    assert repr(case.test.steps[0].count) == "1"  # type: ignore[union-attr]


def test_false_for_a_file(tmp_path: Path) -> None:
    path = inputs.quick_case(
        tmp_path / "case.toml", test={"steps": [{"step": "recorded", "file": False}]}
    )
    inputs.assert_refused(lambda: tb.load_case(path), "file = False", "must be text")
    inputs.write_toml(tmp_path / "t.toml", {"file": False, "blocks": [{"file": False}]})
    inputs.assert_refused(
        lambda: load_test(tmp_path / "t.toml"), "file = False", "blocks[0].file = False"
    )


@pytest.mark.parametrize(
    "call",
    [
        lambda folder: load_test(folder / f"{LONG}.csv"),
        lambda folder: load_test(""),
        lambda folder: load_motion(LONG),
        lambda folder: load_motion(f"{LONG}.at2"),
        lambda folder: tb.load_result(folder / LONG),
        lambda folder: tb.load_result("a\0b"),
        lambda folder: tb.load_bearing(f"{LONG}.toml"),
        lambda folder: make_earthquake_case({"motions": [LONG]}, "t"),
        lambda folder: make_earthquake_case({"bearings": [f"{LONG}.toml"]}, "t"),
        lambda folder: make_earthquake_case({"weather": LONG}, "t"),
        lambda folder: tb.load_case(inputs.quick_case(folder / "case.toml", initial_result=LONG)),
    ],
    ids=range(11),
)
def test_names_longer_than_the_system_allows(call: Callable[[Path], Any], tmp_path: Path) -> None:
    inputs.assert_refused(lambda: call(tmp_path))


def test_files_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "LARGEST_FILE", 1000)
    endless = Path("/dev/zero")
    if endless.exists():
        inputs.assert_refused(lambda: text.read_text(endless), "is a device")
    (tmp_path / "large.csv").write_text("1" * 1001)
    inputs.assert_refused(lambda: text.read_text(tmp_path / "large.csv"), "is larger than")
    assert opener.read_bytes(tmp_path / "large.csv", 1001) == b"1" * 1001


def test_text_that_is_too_long_to_be_searched(tmp_path: Path) -> None:
    """The patterns for units take time that grows with the square of such a text."""
    inputs.assert_refused(
        lambda: parse_quantity("1 mm" + " " * 500 + "s", "mm"), "not a number with a unit"
    )
    path = tmp_path / "t.csv"
    path.write_text("time_s,displacement" + " " * 500 + "_mm\n0,0\n1,1\n")
    inputs.assert_refused(lambda: columns.read_columns(path, {"displacement": "mm"}), "no column")


@pytest.mark.parametrize("options", [["--duration", 1e-9], ["--dt", 1e-9], ["--dt", "nan"]])
@pytest.mark.parametrize("name", ["bridge", "hybrid"])
def test_studies_of_no_step_or_of_too_many(
    name: str, options: list[object], tmp_path: Path
) -> None:
    done = inputs.command(name, *options, "-o", tmp_path / "out")
    assert done.exit_code == 2
    assert str(options[0])[2:] in done.stderr
    assert not (tmp_path / "out").exists()


def test_cycles_in_digits_that_are_none(tmp_path: Path) -> None:
    done = inputs.command("lambda", "shen-hdr-bridge", "--cycles", "²,3", "-o", tmp_path / "out")
    assert done.exit_code == 2
    assert 'cycles = "²,3"' in done.stderr


@pytest.mark.parametrize("tie", ["n_T=e*m_T", "n_T = 1e400 * m_T", "n_T = 0 * m_T", "n_T=-*m_T"])
def test_tie_by_what_is_no_number(tie: str) -> None:
    bearing = tb.load_bearing("shen-hdr-specimen")
    inputs.assert_refused(
        lambda: parameter_set(bearing, ["K_r", tie], [0]), f'"{tie}"', "multiplied"
    )


SPECIMEN_TEST = record_from_arrays(*np.array([[0, 1, 2], [0, 1, 0], [0, 2, 0]]), 23.0)


@pytest.mark.parametrize(
    ("call", "pieces"),
    [
        (lambda: record_from_arrays(1.0, 2.0, "x", 23.0), ["test: force", "list of numbers"]),
        (lambda: record_from_arrays([0, 1], [0, 1e300], [0, 1], 0), ["displacement: 1e+300"]),
        (lambda: record_from_arrays([0, 1], [0, 1], [0, np.nan], 0), ["force: nan at place 2"]),
        (lambda: record_from_arrays([0, 1], [0, 1], [0, 1], [23.0]), ["test: ambient"]),
        (lambda: tb.Ambient.series([0, 10**400], [0, 1]), ["two lists of numbers"]),
        (lambda: tb.Ambient.constant([5.0]), ["expected a temperature"]),
        (lambda: scaled_bearing("shen-hdr-specimen", [0.5]), ["factor = [0.5]"]),
        (lambda: measure_history([0, 1e300], [0, 1], area=1.0, total_rubber_thickness=1.0),
         ["displacement reaches 1e+300"]),
        (lambda: temperature_factors("shen-hdr-specimen", reference_temperature=0, strains=9.0),
         ["strains = 9.0"]),
        (lambda: _chosen_cycles(2.5), ["cycles = [2.5]"]),
        (lambda: make_identify_case(SPECIMEN_TEST, "shen-hdr-specimen", loss=3), ["loss"]),
        (lambda: make_identify_case(SPECIMEN_TEST, "shen-hdr-specimen", seed=-1), ["seed = -1"]),
        (lambda: make_identify_case(SPECIMEN_TEST, "shen-hdr-specimen", starts=10**6),
         ["starts = 1000000", "from 1 to 100"]),
        (lambda: make_identify_case(SPECIMEN_TEST, "shen-hdr-specimen", starts=10**400),
         ["starts", "from 1 to 100"]),
        (lambda: standard_spectrum("II", "I", [1e-300]), ["periods"]),
        (lambda: response_spectrum(tb.load_motion("jra-ii-i-1"), "x"), ["periods", "numbers"]),
    ],
    ids=range(16),
)  # fmt: skip
def test_python_arguments_of_another_kind(call: Callable[[], Any], pieces: list[str]) -> None:
    inputs.assert_refused(call, *pieces)


def test_one_number_stands_for_a_list_of_one() -> None:
    options = {"reference_temperature": 0.0, "strains": 1.0, "temperatures": 0.0, "cycles": 1}
    assert len(temperature_factors("shen-hdr-specimen", **options)) == 15  # type: ignore[arg-type]


def test_messages_do_not_move_the_cursor(tmp_path: Path) -> None:
    path = tmp_path / "免震.toml"
    path.write_text('kind = "\\u001b[2J"\nname = "\\u202e"')
    with pytest.raises(InputError) as caught:
        tb.load_bearing(path)
    assert "免震.toml" in str(caught.value)
    assert r"\x1b[2J" in str(caught.value)
    assert "\x1b" not in str(caught.value)
    done = inputs.command("cyclic", "--dt", 0.1, "-o", "case\udc80.toml" * 40, "-q")
    assert done.exit_code == 2
    assert r"case\udc80.toml" in done.stderr


WRONG: dict[str, Any] = {
    "text": "x",
    "list": [1.0],
    "array": np.array([1.0]),
    "table": {},
    "complex": 1j,
    "decimal": decimal.Decimal(1),
    "date": np.datetime64("NaT", "s"),
    "true": True,
    "object": object(),
}


@pytest.fixture(scope="module")
def element() -> tb.BearingElement:
    return tb.element("shen-hdr-bridge")


@pytest.mark.parametrize("kind", WRONG)
def test_a_trial_takes_numbers_only(kind: str, element: tb.BearingElement) -> None:
    value = WRONG[kind]
    for words in ((value, 0.1), (1.0, value), (1.0, 0.1, value)):
        with pytest.raises(tb.InputError, match="set_trial"):
            element.set_trial(*words)
    with pytest.raises(tb.InputError, match="restore"):
        element.restore(value)


def test_a_trial_of_numbers_of_numpy_is_the_same(element: tb.BearingElement) -> None:
    plain = element.set_trial(1.0, 1.0, 0.0)
    for kind in (int, np.float32, np.int64, np.float64):
        assert element.set_trial(kind(1), kind(1), kind(0)) == plain


def test_impossible_steps_are_refused(element: tb.BearingElement) -> None:
    for words in ((1.0, 1e300), (1.0, float("nan")), (1.0, 0.0), (1.0, 0.1, 1e6)):
        with pytest.raises(tb.InputError, match="set_trial"):
            element.set_trial(*words)
    with pytest.raises(tb.InputError, match="restore"):
        element.restore(tb.element("shen-lhdr-bridge").save())


def test_a_copy_of_an_element_moves_by_itself() -> None:
    one = tb.element("shen-hdr-bridge")
    twin = copy.copy(one)
    fresh = one.set_trial(5.0, 0.1).force
    one.commit()
    assert twin.set_trial(5.0, 0.1).force == fresh
    assert one.set_trial(5.0, 0.1).force != fresh


@pytest.mark.parametrize("kind", WRONG)
def test_analyses_refuse_wrong_types(kind: str) -> None:
    value = WRONG[kind]
    with pytest.raises(tb.InputError):
        tb.bridge(bearing=value, motion="jra-ii-i-1", ambient=0.0, duration=0.1)
    with pytest.raises(tb.InputError):
        tb.sequence(value)
    with pytest.raises(tb.InputError):
        tb.load_result(value)


def test_workers_and_callbacks_are_checked_before_a_run() -> None:
    rest = {"parts": [{"part": "rest", "duration": "1 h"}]}
    with pytest.raises(tb.InputError, match="executor"):
        tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 0.0, duration=0.1, executor=5)
    with pytest.raises(tb.InputError, match="progress"):
        tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 0.0, duration=0.1, progress=5)
    with pytest.raises(tb.InputError, match="progress"):
        tb.sequence(rest, progress=5)
    test = tb.cyclic_test(strain=[0.5], cycles=1)
    with pytest.raises(tb.InputError, match="keep_every"):
        tb.run("shen-hdr-specimen", test, keep=tb.Keep(every=10**400))


def test_a_list_as_a_limit_of_a_distribution(tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text(
        'kind = "study"\nname = "s"\n[case]\ncommand = "bridge"\nbearings = ["shen-hdr-bridge"]\n'
        '[factors."bearing.hysteresis.K_r"]\ndistribution = "uniform"\nlow = [0, 1]\nhigh = 2\n'
    )
    assert "low" in inputs.refusal(file, load_study)


def test_a_result_that_was_changed_and_sealed_again(tmp_path: Path) -> None:
    import xarray as xr

    from thermobearing.results.writing import write_dataset

    test = tb.cyclic_test(strain=[0.5], cycles=1, rest=None)
    path = tb.run("shen-hdr-specimen", test).save(tmp_path / "out", figures=False)
    file = path / "result.nc"
    whole = xr.load_dataset(file)
    write_dataset(whole.drop_vars("softened_steps"), file)
    seal(file)
    with pytest.raises(tb.InputError, match="inconsistent"):
        tb.make_report(path, pdf=False)
    file.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(3000))
    seal(file)
    with pytest.raises(tb.InputError, match="cannot be read"):
        tb.load_result(path)


def test_motions_of_which_a_bit_was_changed_are_made_again(tmp_path: Path) -> None:
    stream = io.BytesIO()
    np.savez(stream, about=np.array(json.dumps({})), a=np.arange(4.0))
    whole, path = stream.getvalue(), tmp_path / "motions.npz"
    for at in range(0, len(whole), 3):
        for bit in (1, 8, 64):
            path.write_bytes(whole[:at] + bytes([whole[at] ^ bit]) + whole[at + 1 :])
            assert _read_motions(path) == {}


def test_output_on_a_full_disk_is_noted_and_not_raised() -> None:
    class Full(io.StringIO):
        def write(self, text: str) -> int:
            raise OSError(28, "No space left on device")

        def fileno(self) -> int:
            return os.open(os.devnull, os.O_WRONLY)

    stream = GuardedStream(Full())
    assert stream.write("text") == 4
    assert stream.lost == "No space left on device"


@pytest.mark.parametrize(
    ("variable", "value", "status"),
    [
        ("SOURCE_DATE_EPOCH", "x", 2),
        pytest.param("SOURCE_DATE_EPOCH", "100", 0, marks=pytest.mark.thorough),
        pytest.param("MPLBACKEND", "nope", 0, marks=pytest.mark.thorough),
    ],
)
def test_a_strange_environment(variable: str, value: str, status: int) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "thermobearing.cli", "list"],
        env=os.environ | {variable: value},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == status
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
def test_a_log_on_a_full_disk() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "thermobearing.cli", "list"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        SystemError("error return without exception set"),
        ImportError("lib.so: failed to map segment from shared object"),
        OSError(12, "Cannot allocate memory"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_too_little_memory_is_one_message(
    error: Exception, capsys: pytest.CaptureFixture[str]
) -> None:
    """As imports end with `ulimit -v 600000`; other errors of these types are not hidden."""

    def command() -> dict[str, Any]:
        raise error

    with pytest.raises(typer.Exit) as ended:
        reported(command)(as_json=True)
    assert ended.value.exit_code == 2
    assert "not enough memory" in json.loads(capsys.readouterr().out)["message"]
    with pytest.raises(OSError, match="other"):
        reported(lambda: (_ for _ in ()).throw(OSError("other")))(as_json=True)
