"""The live section of a report in a browser: the numbers of Python, moved, hidden, printed."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from docs.builder.chromium import console_messages, grave_faults
from tests.browser.chromium import needs_chromium
from tests.browser.test_live_page import needs_module
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.model.options import ModelOptions, Side
from thermobearing.model.stack import EndFace
from thermobearing.reporting import make_report

pytestmark = [needs_chromium, needs_module]
COST = 300_000  # bytes of the section with one motion
SAME = 1e-9  # of a number: the engine differs from Python in rounding
KEPT = 0.1  # temperatures of a bridge are kept every other step, in single precision [K]
LHDR, HDR, LRB = "shen-lhdr-specimen", "shen-hdr-specimen", "lrb-example"
SHORT = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, dt=0.02)
STEPS: list[Any] = [
    {"step": "cycles", "amplitude": "20 mm", "period": "3 s", "count": 2, "wave": "sine"},
    {"step": "rest", "within": "2 K"},
    {"step": "cycles", "strain": 1.1, "frequency": "0.4 Hz", "count": 1},
    {"step": "rest", "duration": "600 s"},
    {"step": "cycles", "strain": 0.5, "speed": "40 mm/s", "count": 2, "closing_strain": 0.1},
]
ONE_SIDED: dict[str, Any] = {"upper_face": EndFace(eta=1.0), "side": Side(film=12.0, cover=5.0)}
PUBLISHED = ModelOptions(scheme="published", integrator="euler")
CLOSED = ModelOptions(hardening="monotone", small_loops="closed")
TESTS: dict[str, tuple[str, CyclicTest, dict[str, Any]]] = {
    "steps": (LHDR, CyclicTest(steps=STEPS, dt=0.01), {}),
    "half-space": (LHDR, SHORT, {"model": ModelOptions(lead_ends="half-space", clock="lead")}),
    "published": (HDR, SHORT, {"model": PUBLISHED, "dt": 0.005}),
    "faces": (LRB, SHORT, {"model": ModelOptions(heat_source="work", **ONE_SIDED)}),
    "loops": (HDR, SHORT, {"model": CLOSED, "keep": ["cells"]}),
    "one temperature": (LHDR, SHORT, {"model": "single-temperature"}),
    "lead alone": (LHDR, SHORT, {"model": "lead-alone"}),
}
TWO_PIERS = Path(__file__).parents[1] / "regression" / "inputs" / "two-piers.toml"
BRIDGES: dict[str, dict[str, Any]] = {
    "cut": {"duration": 8.005},
    "two piers": {"duration": 6.0, "structure": TWO_PIERS, "dt": 0.01},
    "options": {"duration": 6.0, "fixed_base": True, "damping": "rayleigh", "mass": "published",
                "method": "linear-acceleration", "dt": 0.004,
                "model": ModelOptions(lead_ends="half-space")},
}  # fmt: skip

QUICK = {"steps"}  # the others show the same on more, bridges in test_live_page.py too
Open = Callable[..., Any]


def each(cases: dict[str, Any]) -> list[Any]:
    return [pytest.param(k, marks=() if k in QUICK else pytest.mark.thorough) for k in cases]


@pytest.fixture
def report(chromium: Any, tmp_path: Path) -> Iterator[Open]:
    """Open the report of a result; whatever goes wrong in it is a fault of the test."""
    opened: list[tuple[Any, list[str]]] = []

    def _open(result: Any, **look: Any) -> Any:
        saved = result.save(tmp_path / "out", figures=False)
        (file,) = make_report(saved, pdf=False)
        page = chromium.new_page(**look)
        opened.append((page, console_messages(page)))
        page.goto(file.as_uri())
        page.locator("#live").wait_for()
        return page

    yield _open
    for page, reported in opened:
        page.close()
        assert not reported


def run_test(name: str, ambient: Any) -> Any:
    bearing, test, options = TESTS[name]
    return tb.run(bearing, test, ambient=ambient, **options)


def shown(page: Any) -> dict[str, Any]:
    """What the section shows, after the frames in which it draws what was asked."""
    page.evaluate("new Promise((end) => requestAnimationFrame(() => requestAnimationFrame(end)))")
    result: dict[str, Any] = page.evaluate(
        "(({ live, same, moved }) => ({ same, moved, numbers: live.numbers, outcome: live.outcome, "
        "force: Array.from(live.y) }))(document.getElementById('live').shown)"
    )
    return result


def assert_test(actual: dict[str, Any], result: Any) -> None:
    """The live numbers and forces are those of a result with one run."""
    force = result["force"].values[0]
    assert actual["outcome"] == str(result["outcome"].values[0])
    assert np.abs(np.array(actual["force"]) - force).max() <= SAME * np.abs(force).max()
    cycles = result.cycles
    row = cycles[cycles["amplitude_strain"] >= 0.999 * cycles["amplitude_strain"].max()].iloc[-1]
    live = {key.removeprefix("last."): value for key, value in actual["numbers"].items()}
    expected = [row["G_eq_MPa"], row["K_eq_kN_mm"], row["h_eq"], row["energy_kN_mm"]]
    keys = ("G_eq_MPa", "stiffness_kN_mm", "h_eq", "energy_kN_mm")
    assert [live[key] for key in keys] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("name", each(TESTS))
def test_a_test_has_the_numbers_of_the_report_and_of_python(report: Open, name: str) -> None:
    result = run_test(name, [5.0, -20.0])
    page = report(result)
    actual = shown(page)
    assert actual["same"]
    assert not actual["moved"]
    assert_test(actual, run_test(name, 5.0))
    page.locator("#live-run").select_option("−20 °C")
    actual = shown(page)
    assert actual["same"]
    assert_test(actual, run_test(name, -20.0))


def test_the_conditions_move_and_return(report: Open) -> None:
    page = report(run_test("half-space", 23.0))
    before = shown(page)["numbers"]
    page.locator("#live-ambient").fill("-25")
    page.locator("#live-strain").fill("60")
    result = shown(page)
    options = TESTS["half-space"][2]
    test = tb.cyclic_test(strain=[0.6], cycles=2, rest=None, dt=0.02)
    assert_test(result, tb.run(LHDR, test, ambient=-25.0, **options))
    cells = page.locator("#live-table tbody tr").first.locator("th, td").all_inner_texts()
    assert float(cells[1]) == pytest.approx(before["force"], abs=0.5)
    assert float(cells[2]) == pytest.approx(result["numbers"]["force"], abs=0.5)
    assert "outside the calibration range" in page.locator("#live-words").inner_text()
    page.locator("#live-back").click()
    assert shown(page)["numbers"] == before
    assert "calibration" not in page.locator("#live-words").inner_text()


@pytest.mark.thorough  # the whole motion
def test_the_section_is_small(tmp_path: Path) -> None:
    saved = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23.0).save(tmp_path / "out", figures=False)
    sizes = [make_report(saved, pdf=False, live=on)[0].stat().st_size for on in (True, False)]
    assert 0 < sizes[0] - sizes[1] < COST


def assert_bridge(actual: dict[str, Any], result: Any) -> None:
    row = result.table.iloc[0]
    live = actual["numbers"]
    keys = {
        "bearing_strain": "bearing_strain_max",
        "bearing_force_kN": "bearing_force_max_kN",
        "pier_displacement_mm": "pier_displacement_max_mm",
        "deck_mm": "deck_displacement_max_mm",
        "pier_ductility": "pier_ductility",
    }
    assert actual["outcome"] == row["outcome"]
    for key, name in keys.items():
        assert live[key] == pytest.approx(row[name], rel=1e-6)
    hottest = result.hottest(0)
    assert live["layer_temperature_degC"] == pytest.approx(hottest["rubber"], abs=KEPT)
    assert live["lead_temperature_degC"] == pytest.approx(hottest["lead"], abs=KEPT)


@pytest.mark.parametrize("name", each(BRIDGES))
def test_a_bridge_has_the_numbers_of_the_report_and_of_python(report: Open, name: str) -> None:
    bearings = ["shen-bilinear-bridge", "shen-lhdr-bridge"]
    motions = [{"name": "jra-ii-i-1", "factor": 0.8}, "jra-ii-ii-1"]
    page = report(tb.bridge(bearings, motions, [23.0, -20.0], **BRIDGES[name]))
    runs = page.locator("#live-run option").all_inner_texts()
    assert len(runs) == 4
    assert shown(page)["same"]
    page.locator("#live-run").select_option(runs[2])
    assert shown(page)["same"]
    assert_bridge(shown(page), tb.bridge(bearings[1], motions[1], 23.0, **BRIDGES[name]))
    page.locator("#live-run").select_option(runs[1])
    page.locator("#live-ambient").fill("-7.5")
    result = shown(page)
    assert result["moved"]
    assert_bridge(result, tb.bridge(bearings[1], motions[0], -7.5, **BRIDGES[name]))


LOOKS: list[Any] = [{"viewport": {"width": 400, "height": 800}, "color_scheme": "dark"}]
LOOKS += [pytest.param({}, marks=pytest.mark.thorough)]  # as test_no_serious_fault of each report


@pytest.mark.parametrize("look", LOOKS)
def test_the_section_is_usable(report: Open, look: dict[str, Any]) -> None:
    page = report(run_test("loops", [-20.0, 23.0]), **look)
    before = shown(page)["numbers"]
    page.locator("#live-ambient").focus()
    for _ in range(3):
        page.keyboard.press("ArrowLeft")
    result = shown(page)["numbers"]
    assert result["last.stiffness_kN_mm"] > before["last.stiffness_kN_mm"]
    assert page.locator("#live-ambient").get_attribute("aria-valuetext").startswith("−21.5")
    assert grave_faults(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_paper_and_browsers_without_webassembly_have_no_section(
    report: Open, chromium: Any
) -> None:
    page = report(run_test("loops", 23.0))
    assert page.locator("nav .live-only").is_visible()
    page.emulate_media(media="print")
    assert page.locator(".live-only:visible").count() == 0
    other = chromium.new_page()
    other.add_init_script("delete globalThis.WebAssembly")
    with other.expect_console_message(lambda message: "live" in message.text):
        other.goto(page.url)
    assert other.locator(".live-only:visible").count() == 0
    other.locator("#inputs").scroll_into_view_if_needed()
    other.evaluate("document.getElementById('inputs').scrollIntoView()")
    other.locator("a[aria-current]", has_text="Inputs").wait_for()
    other.close()
