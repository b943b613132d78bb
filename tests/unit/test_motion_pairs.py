"""Pairs of ground motions: rotation, cases of pairs in all spellings, and faults in them."""

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests.shared_data import shared_data
from tests.unit import motion_files as files
from tests.unit.inputs import command, content
from thermobearing.earthquake.case import load_earthquake_case, make_earthquake_case
from thermobearing.earthquake.motions import Motion, rotation_frame
from thermobearing.earthquake.tables import rotation_measures_frame
from thermobearing.motions.pair import MotionPair, distinct_angles, make_pair, rotation_measures

FIRST = tb.load_motion("jra-ii-i-1")
SECOND = tb.load_motion("jra-ii-i-2")
BOTH = {"name": "jra-ii-i-1", "across": "jra-ii-i-2"}
QUICK: dict[str, Any] = {"bearing": "shen-bilinear-bridge", "ambient": 23, "duration": 1.0}


def settled(*motions: Any) -> list[Motion]:
    return make_earthquake_case({}, "test", motions=list(motions)).motions


def test_rotation_is_that_of_the_axes() -> None:
    angle = 37.0
    pair = MotionPair(FIRST, SECOND, angle)
    g1, g2, turned = FIRST.acceleration, SECOND.acceleration, math.radians(angle)
    x, y = pair.rotated().T
    assert_allclose(x, math.cos(turned) * g1 - math.sin(turned) * g2, rtol=1e-13)
    assert_allclose(y, math.sin(turned) * g1 + math.cos(turned) * g2, rtol=1e-13)
    assert_allclose(np.hypot(x, y), np.hypot(g1, g2), rtol=1e-12)
    assert_array_equal(pair.along("y").acceleration, y)


def test_right_angles_are_exact() -> None:
    g1, g2 = FIRST.acceleration, SECOND.acceleration
    expected = {0.0: (g1, g2), 90.0: (-g2, g1), 180.0: (-g1, -g2), -90.0: (g2, -g1)}
    pair = MotionPair(FIRST, SECOND)
    for angle, (x, y) in expected.items():
        assert_array_equal(pair.rotated(angle), np.column_stack([x, y]))


@pytest.mark.parametrize("angle", [math.nan, math.inf, 361.0, "30 deg", True])
def test_angles_that_are_none(angle: Any) -> None:
    with pytest.raises(tb.InputError, match="angle"):
        MotionPair(FIRST, SECOND, angle)


def test_records_that_differ_are_named() -> None:
    longer = tb.GroundMotion("longer", 0.02, np.zeros(7000))
    with pytest.raises(tb.InputError) as caught:
        MotionPair(FIRST, longer)
    steps, lengths = caught.value.problems
    assert "jra-ii-i-1 of 0.01 s and longer of 0.02 s" in steps
    assert "jra-ii-i-1 has 5001 samples" in lengths
    assert "longer has 7000 samples" in lengths
    assert "resample = true" in lengths


def test_resampled_when_reported() -> None:
    time = 0.02 * np.arange(1000)
    slow = tb.motion_from_arrays(3.0 * np.sin(3.0 * time), unit="m/s2", dt=0.02, name="slow")
    pair = make_pair(FIRST, slow, resample=True)
    assert pair.dt == FIRST.dt
    assert len(pair.first.acceleration) == len(pair.second.acceleration) == 1999
    assert_array_equal(pair.second.acceleration[::2], slow.acceleration)
    assert_array_equal(pair.first.acceleration, FIRST.acceleration[:1999])


def test_a_case_at_several_angles_reads_back(tmp_path: Path) -> None:
    angles = ["0 deg", "30 deg", "0.5 rad"]
    case = make_earthquake_case({}, "test", motions=[BOTH | {"angle": angles}, "jra-i-i-1"])
    labels = [f"jra-ii-i-1+jra-ii-i-2 at {angle} deg" for angle in ("0", "30", "28.6479")]
    assert [motion.load().name for motion in case.motions] == [*labels, "jra-i-i-1"]
    assert case.motions[2].angle == pytest.approx(math.degrees(0.5))
    path = tmp_path / "case.toml"
    path.write_text(case.to_toml())
    assert load_earthquake_case(path).motions == case.motions


def test_the_motion_along_the_bridge_is_the_component_in_x() -> None:
    plain, turned = settled(BOTH | {"angle": ["0 deg", "90 deg"]})
    assert_array_equal(plain.load().acceleration, FIRST.acceleration)
    assert_array_equal(turned.load().acceleration, -SECOND.acceleration)
    assert_array_equal(turned.load_pair().rotated()[:, 1], FIRST.acceleration)


def test_a_single_record_at_an_angle() -> None:
    (motion,) = settled({"name": "jra-ii-i-1", "angle": "60 deg"})
    assert motion.title == "jra-ii-i-1 at 60 deg"
    assert settled(motion) == settled(motion.model_copy(update={"label": None})) == [motion]
    assert settled({"name": "jra-ii-i-1", "angle": "0 deg"})[0].title == "jra-ii-i-1"
    x, y = motion.load_pair().rotated().T
    assert_allclose(x, 0.5 * FIRST.acceleration, rtol=1e-12)
    assert_allclose(y, math.sqrt(0.75) * FIRST.acceleration, rtol=1e-12)


def test_pairs_in_python_are_those_of_the_library() -> None:
    pair = MotionPair(FIRST, SECOND, 30.0)
    named = settled(BOTH | {"angle": "30 deg"})[0].load_pair()
    given = settled(pair, replace(pair, angle=45.0))
    assert [motion.label for motion in given] == [f"{pair.name} at {a} deg" for a in (30, 45)]
    assert_array_equal(given[0].load_pair().rotated(), named.rotated())
    again = settled(given[0])[0]
    assert again == given[0]


def test_components_of_files(tmp_path: Path) -> None:
    for end, direction in (("EW2", "5"), ("NS2", "4")):
        (tmp_path / f"ABCH01.{end}").write_text(files.knet_text(direction=direction))
    rows = [f"{0.01 * k:.2f},{value},{-0.5 * value}" for k, value in enumerate(files.shaking())]
    (tmp_path / "both.csv").write_text("\n".join(["t_s,NS [gal],EW [gal]", *rows]))
    table = {
        "motions": [
            {"name": "ABCH01.NS2", "across": "ABCH01.EW2"},
            {"name": "both.csv", "component": "NS", "across_component": "EW"},
        ]
    }
    case = make_earthquake_case(table, "test", tmp_path)
    station, columns = (motion.load_pair() for motion in case.motions)
    assert station.name == "ABCH01"
    assert (station.first.component, station.second.component) == ("NS", "EW")
    assert_allclose(columns.second.acceleration, -0.5 * columns.first.acceleration)


def test_recorded_pairs() -> None:
    kobe = shared_data("motions/jma_kobe_ns_ew_gal_dt0.005.txt")
    tokyo = [shared_data(f"motions/TKYH121103111446.{end}") for end in ("NS2", "EW2")]
    given = settled(
        {"name": str(kobe), "component": "NS", "across_component": "EW"},
        {"name": str(tokyo[0]), "across": str(tokyo[1])},
    )
    peaks = [
        record.pga / 10.0
        for motion in given
        for record in (motion.load_pair().first, motion.load_pair().second)
    ]
    assert_allclose(peaks, [825.0, 619.0, 157.2, 105.9], rtol=2e-3)


FAULTS: dict[str, tuple[dict[str, Any], str]] = {
    "number": (BOTH | {"angle": 30}, "no unit"),
    "text": (BOTH | {"angle": "30"}, "30 deg"),
    "length": (BOTH | {"angle": "30 mm"}, "cannot be converted to deg"),
    "share": (BOTH | {"angle": "30 percent"}, "cannot be converted to deg"),
    "finite": (BOTH | {"angle": "nan deg"}, "finite"),
    "range": (BOTH | {"angle": "400 deg"}, "-360"),
    "none": (BOTH | {"angle": []}, "0 angles"),
    "many": (BOTH | {"angle": ["1 deg"] * 361}, "361 angles"),
    "second": (BOTH | {"angle": ["0 deg", "10"]}, r"angle\[1\]"),
    "twice": (BOTH | {"angle": ["5 deg", "5 deg"]}, "more than once"),
    "itself": ({"name": "jra-ii-i-1", "across": "jra-ii-i-1"}, "across: is the record of name"),
    "length of motion": ({"name": "jra-ii-i-1", "across": "jra-i-i-1"}, "11001 samples"),
    "unknown": ({"name": "jra-ii-i-1", "across": "jra-ii-i-9"}, "jra-ii-i-9"),
    "resample": ({"name": "jra-ii-i-1", "resample": True}, "resample"),
    "samples": (BOTH | {"across_acceleration": [0.0, 1.0]}, "across_acceleration"),
    "across": ({"name": "jra-ii-i-1", "angle": "90 deg"}, "acts across the bridge"),
    "list": ({"name": "jra-ii-i-1", "across": ["jra-ii-i-2"]}, "across"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults(name: str) -> None:
    table, words = FAULTS[name]
    with pytest.raises(tb.InputError, match=words) as caught:
        settled(table)
    assert len(caught.value.problems) == 1


def test_faults_after_a_motion_with_angles_have_the_number_of_the_item() -> None:
    with pytest.raises(tb.InputError, match=r"motions\[1\]\.factor"):
        settled(BOTH | {"angle": ["0 deg", "30 deg"]}, {"name": "jra-i-i-1", "factor": -1})


def test_pairs_on_the_command_line(tmp_path: Path) -> None:
    words = ["--bearing", "shen-bilinear-bridge", "--ambient", 23, "--duration", 1, "--no-figures"]
    pair = ["--motion", "jra-ii-i-1", "--across", "jra-ii-i-2"]
    out = tmp_path / "out"
    done = command("bridge", *words, *pair, "--angle", "0 deg", "--angle", "30 deg", "-o", out)
    assert done.exit_code == 0
    again = load_earthquake_case(out / "case.resolved.toml")
    assert [motion.angle for motion in again.motions] == [0.0, 30.0]
    assert "table.csv" in content(out)
    for bad in (
        ["--across", "jra-ii-i-2"],
        [*pair, "--across", "jra-ii-i-3"],
        ["--angle", "0 deg"],
    ):
        assert command("bridge", *words, *bad).exit_code == 2
    assert "30 deg" in command("bridge", *words, *pair, "--angle", 30).stderr
    unequal = ["--motion", "jra-ii-i-1", "--across", "jra-i-i-1"]
    assert "--resample" in command("bridge", *words, *unequal, "-o", tmp_path / "no").stderr
    done = command("bridge", *words, *unequal, "--resample", "-o", tmp_path / "resampled")
    assert done.exit_code == 0, done.stderr
    output = command("bridge", out / "case.resolved.toml", "--angle", "30 deg").stderr
    assert "case.resolved.toml states" in output.replace("\n", " ")
    checked = command("check", tmp_path / "resampled" / "case.resolved.toml").output
    assert "1, average-acceleration" in checked


def test_angles_half_a_turn_apart_count_once() -> None:
    angles = [0.0, 90.0, 180.0, 45.0, -90.0, 360.0]
    assert distinct_angles(angles) == [0, 1, 3]
    measures = rotation_measures([[1.0], [4.0], [9.0], [2.0], [9.0], [9.0]], angles)
    assert (measures.rotd50[0], measures.rotd100[0]) == (2.0, 4.0)
    assert np.isnan(rotation_measures([1.0, np.nan, 2.0]).rotd50)


def test_rotation_measures_of_an_analysis_are_over_its_angles() -> None:
    motions = [BOTH | {"angle": ["0 deg", "60 deg", "120 deg", "180 deg"]}, "jra-ii-i-3"]
    result = tb.bridge("shen-bilinear-bridge", motions, [23, 0], duration=15)
    case = tomllib.loads(result.dataset.attrs["case"])
    name = "bearing_strain_max"
    actual = rotation_frame(result.table, case["motions"], ["bearing", "ambient_degC"], [name])
    runs = result.table[result.table["ambient_degC"] == 0.0]
    peaks = dict(zip(runs["motion"], runs[name], strict=True))
    turned = [peaks[f"jra-ii-i-1+jra-ii-i-2 at {angle} deg"] for angle in (0, 60, 120, 180)]
    assert turned[0] == turned[3]
    assert len(set(turned)) == 3
    cold = actual[actual["ambient_degC"] == 0.0].set_index("measure")
    assert list(cold["motion"]) == ["jra-ii-i-1+jra-ii-i-2"] * 2
    assert list(cold["angles"]) == [3, 3]
    assert cold[name].to_dict() == {"RotD50": np.median(turned[:3]), "RotD100": max(turned)}
    failed = result.table.assign(outcome="pier_beyond_limit")
    assert rotation_frame(failed, case["motions"], ["bearing"], [name])[name].isna().all()
    assert not len(rotation_frame(result.table, case["motions"][:1], ["bearing"], [name]))
    pd.testing.assert_frame_equal(
        rotation_measures_frame(result)[["motion", "measure", name]],
        actual[["motion", "measure", name]],
    )


def test_a_structure_in_one_direction_says_what_moves_it(tmp_path: Path) -> None:
    alone = tb.bridge("shen-bilinear-bridge", [BOTH, "jra-ii-i-3"], 23, duration=2)
    plain = tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", 23, duration=2)
    assert_array_equal(alone.table["bearing_strain_max"][0], plain.table["bearing_strain_max"][0])
    assert [text for text in alone.warnings if "1 of 2 motions" in text]
    assert not [text for text in plain.warnings if "motions" in text]
    alone.save(tmp_path / "out", figures=False)
    assert not (tmp_path / "out" / "rotation.csv").exists()


def test_a_structure_in_plan_has_measures_of_each_direction() -> None:
    motion = BOTH | {"angle": ["0 deg", "90 deg"]}
    result = tb.bridge("shen-bilinear-bridge", motion, 23, duration=2, structure="five-span-bridge")
    actual = rotation_measures_frame(result).set_index(["direction", "measure"])
    runs = result.by_direction()
    for direction in ("x", "y", "resultant"):
        peaks = runs.loc[runs["direction"] == direction, "bearing_strain_max"]
        assert actual.loc[(direction, "RotD100"), "bearing_strain_max"] == peaks.max()
        assert actual.loc[(direction, "RotD50"), "bearing_strain_max"] == peaks.median()
    assert not [note for note in result.notes() if "motions" in note]
