"""Values of a wrong type, changed files and a strange environment end with a sentence."""

import copy
import decimal
import io
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.inputs import refusal
from thermobearing.commands.common import Patient
from thermobearing.results.directory import seal
from thermobearing.studies.definition.case import load_study
from thermobearing.studies.definition.motions import read_made

WRONG: dict[str, Any] = {
    "text": "x",
    "list": [1.0],
    "array": np.array([1.0]),
    "table": {},
    "complex": 1j,
    "decimal": decimal.Decimal(1),
    "date": np.datetime64("NaT"),
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
    assert "low" in refusal(file, load_study)


def test_a_result_that_was_changed_and_sealed_again(tmp_path: Path) -> None:
    import xarray as xr

    from thermobearing.results.writing import write_dataset

    test = tb.cyclic_test(strain=[0.5], cycles=1, rest=None)
    path = tb.run("shen-hdr-specimen", test).save(tmp_path / "out", figures=False)
    file = path / "result.nc"
    whole = xr.load_dataset(file)
    write_dataset(whole.drop_vars("softened_steps"), file)
    seal(file)
    with pytest.raises(tb.InputError, match="do not fit together"):
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
            assert read_made(path) == {}


def test_output_on_a_full_disk_is_noted_and_not_raised() -> None:
    class Full(io.StringIO):
        def write(self, text: str) -> int:
            raise OSError(28, "No space left on device")

        def fileno(self) -> int:
            return os.open(os.devnull, os.O_WRONLY)

    stream = Patient(Full())
    assert stream.write("text") == 4
    assert stream.lost == "No space left on device"


@pytest.mark.parametrize(
    ("variable", "value", "status"),
    [("SOURCE_DATE_EPOCH", "x", 2), ("SOURCE_DATE_EPOCH", "100", 0), ("MPLBACKEND", "nope", 0)],
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
