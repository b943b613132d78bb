"""The live page as a reader has it: opened from a disk, moved, edited, refused, exported."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import thermobearing as tb
from docs.builder.chromium import console_messages, grave_faults
from tests.browser.chromium import needs_chromium
from thermobearing.border.errors import InputError
from thermobearing.cli import app
from thermobearing.design.codes import published
from thermobearing.live.data import live_module

LARGEST = 1_000_000  # bytes of a page that a mail takes
SPECIMEN = "shen-lhdr-specimen"
NARROW = {"width": 400, "height": 800}
RANGES = {
    "strain": "strain",
    "strain_rate": "strain rate",
    "ambient": "ambient temperature",
    "cycles": "consecutive cycles",
    "lead_temperature": "lead temperature",
}
SHOWN = 0.006  # of a number with three digits
SINGLE = 1e-6  # of the largest, since histories of bridges are kept in single precision
FORCE = 1e-8  # of the largest, since files have nine digits


def is_built() -> bool:
    try:
        live_module()
    except InputError:
        return False
    return True


needs_module = pytest.mark.skipif(
    not is_built(), reason="the kernels for web pages are not built (make kernels)"
)
pytestmark = [needs_chromium, needs_module]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tb.live_page(tmp_path_factory.mktemp("live") / "live.html", SPECIMEN)


@pytest.fixture(scope="module")
def address(file: Path) -> str:
    return file.as_uri()


@pytest.fixture
def opened(chromium: Any, address: str, request: pytest.FixtureRequest) -> Iterator[Any]:
    """The page; whatever goes wrong in it, or is asked of a network, is a fault of the test."""
    page = chromium.new_page(**getattr(request, "param", {}))
    reported = console_messages(page)
    page.goto(address)
    page.locator("#cycles td").first.wait_for()
    yield page
    page.close()
    assert not reported


def redrawn(page: Any) -> int:
    return int(page.evaluate("document.documentElement.dataset.redraws"))


def settle(page: Any) -> None:
    """Wait for two frames, in which the page draws what was asked."""
    page.evaluate("new Promise((end) => requestAnimationFrame(() => requestAnimationFrame(end)))")


def slide(page: Any, temperature: float) -> None:
    page.locator("#slider").fill(str(temperature))
    settle(page)


def show_bridge(page: Any) -> None:
    page.locator("#base").select_option("shen-lhdr-bridge")
    page.locator("#tab-bridge").click()
    settle(page)


def cells(page: Any, table: str = "cycles") -> list[list[str]]:
    rows = page.locator(f"#{table} tbody tr").all()
    return [row.locator("th, td").all_inner_texts() for row in rows]


def number(text: str) -> float:
    return float(text.split(" ")[0].replace("−", "-"))


def test_the_page_is_small(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert len(text.encode()) < LARGEST
    assert not re.findall(r"(?:src|href)=\"https?:", text)


def test_the_table_has_the_numbers_of_python(opened: Any) -> None:
    slide(opened, -25)
    test = tb.cyclic_test(strain=1.75, wave="sine", frequency=0.08, cycles=3)
    cold, warm = (tb.run(SPECIMEN, test, ambient=t).cycles for t in (-25, 23))
    for row, (_, here), (_, there) in zip(
        cells(opened), cold.iterrows(), warm.iterrows(), strict=True
    ):
        assert number(row[1]) == pytest.approx(here["G_eq_MPa"], rel=SHOWN)
        assert number(row[3]) == pytest.approx(here["K_eq_kN_mm"], rel=SHOWN)
        assert number(row[7]) == pytest.approx(here["lead_degC"], rel=SHOWN)
        ratio = float(row[3].split("(")[1].rstrip(")"))
        assert ratio == pytest.approx(here["K_eq_kN_mm"] / there["K_eq_kN_mm"], rel=SHOWN)
    assert "−25\u00a0°C" in opened.locator("#answer").inner_text()


def test_exported_histories_and_case_are_those_of_python(opened: Any, tmp_path: Path) -> None:
    opened.locator("#tab-export").click()
    with opened.expect_download() as actual:
        opened.locator("#save-csv").click()
    table = pd.read_csv(actual.value.path())
    with opened.expect_download() as case:
        opened.locator("#save-toml").click()
    file = tmp_path / "case.toml"
    file.write_bytes(Path(case.value.path()).read_bytes())
    result = tb.run_case(tb.load_case(file))
    for ambient in (-20.0, 23.0):
        here = table[table.ambient_degC == ambient]
        there = result.dataset.sel(ambient=ambient) if "ambient" in result.dataset.dims else None
        assert there is not None
        force = there["force"].to_numpy()
        shown = np.interp(there["time"], here["time_s"], here["force_kN"])
        assert np.abs(shown - force).max() <= FORCE * np.abs(force).max()


def export_wider(page: Any) -> str:
    """Make the bearing 480 mm wide and return its exported file."""
    page.locator("#tab-bearing").click()
    side = page.locator("#size-geometry-plan-side")
    side.fill("480")
    side.press("Enter")
    settle(page)
    page.locator("#tab-export").click()
    settle(page)
    return str(page.locator("#toml-text").inner_text()).split("# case.toml")[0]


def test_an_edited_bearing_scales_and_comes_back_as_a_file(opened: Any, tmp_path: Path) -> None:
    text = export_wider(opened)
    file = tmp_path / f"{SPECIMEN}-changed.toml"
    file.write_text(text, encoding="utf-8")
    made = tb.load_bearing(file)
    before = tb.load_bearing(SPECIMEN)
    net = [one.area - one.lead_area for one in (made, before)]
    assert made.geometry.plan.side == 480.0
    assert made.hysteresis.layer_stiffness / before.hysteresis.layer_stiffness == pytest.approx(
        net[0] / net[1]
    )
    test = tb.cyclic_test(strain=1.75, wave="sine", frequency=0.08, cycles=3)
    opened.locator("#tab-test").click()
    settle(opened)
    expected = tb.run(made, test, ambient=-20).cycles["K_eq_kN_mm"]
    shown = [number(row[3]) for row in cells(opened)]
    assert shown == pytest.approx(list(expected), rel=SHOWN)


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [("strain", "900", "strain = 9:"), ("count", "2.5", "count = 2.5:"), ("frequency", "x", "'x'")],
)
def test_fields_refuse_what_check_refuses(opened: Any, field: str, value: str, says: str) -> None:
    before = cells(opened)
    opened.locator(f"#{field}").fill(value)
    settle(opened)
    words = opened.locator(f"#{field}-error").inner_text()
    assert says in words
    assert "must be" in words
    assert opened.locator(f"#{field}").get_attribute("aria-invalid") == "true"
    assert cells(opened) == before


def test_a_wrong_size_is_refused_in_the_words_of_check(opened: Any) -> None:
    opened.locator("#tab-bearing").click()
    layers = opened.locator("#size-geometry-rubber_layers")
    layers.fill("999")
    layers.press("Enter")
    words = opened.locator("#size-geometry-rubber_layers-error").inner_text()
    with pytest.raises(InputError) as refused:
        tb.changed_bearing(SPECIMEN, geometry={"rubber_layers": 999})
    assert words.split(": ", 1)[1] in str(refused.value)


def test_the_bridge_has_the_numbers_of_python(opened: Any) -> None:
    show_bridge(opened)
    peaks = {row[0]: [number(one) for one in row[1:3]] for row in cells(opened, "peaks")}
    result = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", [-20, 23])
    table = result.table
    for row, name, factor in (
        ("Ductility of the pier [1]", "pier_ductility", 1.0),
        ("Strain of the bearing [%]", "bearing_strain_max", 100.0),
        ("Moment at the pier base [kN m]", "pier_moment_max_kN_m", 1.0),
    ):
        assert peaks[row] == pytest.approx(list(factor * table[name]), rel=SHOWN)
    moments = table.pier_moment_max_kN_m
    more = 100 * (moments.iloc[0] / moments.iloc[1] - 1)
    assert f"{more:.0f}\u00a0%" in opened.locator("#bridge-answer p").inner_text()
    opened.locator("#tab-export").click()
    with opened.expect_download() as actual:
        opened.locator("#save-bridge").click()
    shown = pd.read_csv(actual.value.path())
    for run, ambient in enumerate((-20.0, 23.0)):
        here = shown[shown.ambient_degC == ambient].bearing_force_kN.to_numpy()
        there = result.dataset["bearing_force"].isel(run=run).to_numpy()  # every second step
        assert np.abs(here[::2] - there).max() <= SINGLE * np.abs(there).max()


@pytest.mark.parametrize(
    ("base", "field", "value", "limits"),
    [
        (SPECIMEN, "count", "5", set()),
        (SPECIMEN, "count", "9", {"cycles"}),
        ("shen-hdr-specimen", "strain", "30", {"strain", "strain_rate"}),
    ],
)
def test_warnings_are_those_of_python(
    opened: Any, base: str, field: str, value: str, limits: set[str]
) -> None:
    opened.locator("#base").select_option(base)
    opened.locator(f"#{field}").fill(value)
    settle(opened)
    shown = " ".join(opened.locator("#answer .warn").all_inner_texts())
    test = {"strain": 1.75, "cycles": 3, "frequency": 0.08, "wave": "sine"}
    test |= {"strain": float(value) / 100} if field == "strain" else {"cycles": int(value)}
    result = tb.run(base, tb.cyclic_test(**test, closing_strain=None), [-20, 23])
    rows = result.tested_range
    assert set(rows[rows.outside].limit) == limits
    output = {name for name, words in RANGES.items() if re.search(f": {words} [−\\d]", shown)}
    assert output == limits


def test_a_bearing_that_is_too_small_for_the_bridge_hides_it(opened: Any) -> None:
    strain = tb.bridge(SPECIMEN, "jra-ii-i-1", 23).table.bearing_strain_max.iloc[0]
    assert f"{100 * strain:.0f}\u00a0%" in opened.locator("#unfit").inner_text()
    assert not opened.locator("#tab-bridge").is_visible()
    opened.locator("#tab-bearing").focus()
    opened.keyboard.press("ArrowRight")
    assert opened.locator("#tab-codes").get_attribute("aria-selected") == "true"
    opened.locator("#tab-export").click()
    settle(opened)
    assert "bridge" not in opened.locator("#command-text").inner_text()
    show_bridge(opened)
    assert not opened.locator("#unfit").is_visible()
    opened.locator("#base").select_option(SPECIMEN)
    settle(opened)
    assert opened.locator("#tab-test").get_attribute("aria-selected") == "true"


@pytest.mark.parametrize("opened", [{"viewport": NARROW}], indirect=True)
def test_a_phone_shows_the_main_numbers_without_scrolling(opened: Any) -> None:
    assert SPECIMEN in opened.locator("#bearing-facts").inner_text()
    last = cells(opened)[-1]
    rows = cells(opened, "main-numbers")
    assert rows[2][1] == last[3].split(" ")[0]
    assert f"({rows[2][3]})" in last[3]
    right = opened.evaluate(
        "document.getElementById('main-numbers').getBoundingClientRect().right <= innerWidth"
    )
    assert right


def test_the_rate_of_an_earthquake_is_a_note(opened: Any) -> None:
    show_bridge(opened)
    rows = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", [-20, 23]).tested_range
    fastest = rows[rows.limit == "strain_rate"].demand.max()
    notes = opened.locator("#bridge-answer li:not(.warn)").all_inner_texts()
    assert [float(re.findall(r"[\d.]+", note)[0]) for note in notes] == [
        pytest.approx(fastest, rel=SHOWN)
    ]


@pytest.mark.parametrize("protocol", ["cycles", "table-3.4"])
@pytest.mark.parametrize("wave", ["sine", "triangle"])
def test_every_export_describes_the_same_test(
    opened: Any, tmp_path: Path, protocol: str, wave: str
) -> None:
    opened.locator("#protocol").select_option(protocol)
    opened.locator("#wave").select_option(wave)
    opened.locator("#tab-export").click()
    settle(opened)
    file = tmp_path / "case.toml"
    file.write_text(opened.locator("#toml-text").inner_text(), encoding="utf-8")
    lines = opened.locator("#python-text").inner_text()
    test = eval(re.findall(r"tb\.cyclic_test\(.*?\)", lines)[0], {"tb": tb})
    assert tb.load_case(file).test.steps == test.steps
    words = opened.locator("#command-text").inner_text().split("\n")[0]
    assert f"--wave {test.steps[0].wave}" in words
    assert len(re.findall("--strain", words)) == (1 if protocol == "cycles" else 5)


def test_exports_name_the_file_of_a_bearing_of_the_user(chromium: Any, tmp_path: Path) -> None:
    mine = tb.changed_bearing(SPECIMEN, name="mine", hysteresis={"layer_stiffness": 40.0})
    own = tb.save_bearing(mine, tmp_path / "my-own.toml")
    html = tmp_path / "live.html"
    assert CliRunner().invoke(app, ["live", str(own), "-o", str(html)]).exit_code == 0
    page = chromium.new_page()
    page.goto(html.as_uri())
    page.locator("#cycles td").first.wait_for()
    page.locator("#tab-export").click()
    settle(page)
    case = tmp_path / "case.toml"
    case.write_text(page.locator("#toml-text").inner_text(), encoding="utf-8")
    assert tb.load_case(case).bearing == mine
    assert page.locator("#command-text").inner_text().count("--bearing my-own.toml ") == 1
    assert 'load_bearing("my-own.toml")' in page.locator("#python-text").inner_text()
    text = export_wider(page)
    changed = tmp_path / "mine-changed.toml"
    changed.write_text(text, "utf-8")
    assert tb.load_bearing(changed).geometry.plan.side == 480.0
    page.close()


def test_a_dropped_motion_is_shaken_or_refused(opened: Any, tmp_path: Path) -> None:
    show_bridge(opened)
    time = np.arange(0.0, 10.0, 0.01)
    shown = []
    for name, unit, size in (
        ("a.csv", "gal", 300.0),
        ("b.csv", "m/s^2", 3.0),
        ("c.csv", "gal", 3.0),
    ):
        file = tmp_path / name
        rows = [f"{t:.2f},{size * np.sin(4 * t):.5f}" for t in time]
        file.write_text("\n".join([f"time [s],acceleration [{unit}]", *rows]), encoding="utf-8")
        opened.locator("#file").set_input_files(str(file))
        place = "#file-error" if name == "c.csv" else "#file-name"
        opened.locator(place, has_text=name).wait_for()
        settle(opened)
        shown.append(cells(opened, "peaks"))
    assert shown[0] == shown[1] == shown[2]
    assert len(shown[0]) > 3
    wrong = tmp_path / "wrong.csv"
    wrong.write_text("1,2\nthree", encoding="utf-8")
    opened.locator("#file").set_input_files(str(wrong))
    opened.locator("#file-error", has_text="wrong.csv").wait_for()


def test_the_link_brings_the_state_back_in_japanese(
    chromium: Any, opened: Any, address: str
) -> None:
    opened.locator("#language").click()
    slide(opened, -31.5)
    opened.locator("#tab-codes").click()
    settle(opened)
    opened.locator("#tab-export").click()
    settle(opened)
    link = opened.locator("#link-text").inner_text()
    assert link.startswith(address)
    other = chromium.new_page()
    other.goto(link.replace("view=export", "view=codes"))
    other.locator("#codes td").first.wait_for()
    assert other.evaluate("document.documentElement.lang") == "ja"
    assert other.locator("#slider").input_value() == "-31.5"
    assert other.locator("#tab-codes").get_attribute("aria-selected") == "true"
    other.close()


@pytest.mark.parametrize(
    "opened",
    [pytest.param({}, marks=pytest.mark.thorough), {"viewport": NARROW, "color_scheme": "dark"}],
    indirect=True,
)
def test_every_view_is_usable(opened: Any) -> None:
    opened.locator("#base").select_option("shen-lhdr-bridge")
    for view in ("test", "bearing", "bridge", "codes", "export"):
        tab = opened.locator(f"#tab-{view}")
        tab.focus()
        tab.press("Enter")
        settle(opened)
        assert tab.get_attribute("aria-selected") == "true"
        assert opened.evaluate("document.documentElement.scrollWidth <= innerWidth")
        assert grave_faults(opened) == []


@pytest.mark.parametrize("opened", [{"viewport": NARROW}], indirect=True)
def test_a_table_broader_than_the_screen_says_so(opened: Any) -> None:
    """The table of the cycles of a bearing with lead is; on a broad screen it is not."""
    opened.locator("#base").select_option("shen-lhdr-bridge")
    settle(opened)
    hint = opened.locator(".sideways:has(+ .scroll > #cycles)")
    hint.wait_for(state="visible")
    opened.set_viewport_size({"width": 1200, "height": 900})
    hint.wait_for(state="hidden")


def test_a_stack_with_lead_says_that_rubber_beside_it_is_warmer(opened: Any) -> None:
    for name, visible in (("shen-lhdr-bridge", True), ("shen-hdr-bridge", False)):
        opened.locator("#base").select_option(name)
        settle(opened)
        assert opened.locator("#ring").is_visible() == visible


@pytest.mark.parametrize(("name", "temperatures"), [("shen-lhdr-bridge", 1), ("lrb-example", 2)])
def test_lead_softens_a_bearing_only_where_its_strength_falls(
    opened: Any, name: str, temperatures: int
) -> None:
    """The lead of shen-lhdr-bridge is of constant strength, although it is the warmest part."""
    assert (tb.load_bearing(name).lead.softening > 0.0) == (temperatures == 2)
    opened.locator("#base").select_option(name)
    settle(opened)
    # Of the last cycle, at the cold temperature.
    rubber, lead = (text.split(" |")[0] for text in cells(opened)[-1][-2:])
    words = opened.locator("#answer p").inner_text().split("It softens by ")[1]
    shown = re.findall(r"([−\d.]+)\s°C", words)
    assert shown == ([rubber] if temperatures == 1 else [lead, rubber])


def test_the_factors_state_the_rise_of_the_lead(opened: Any) -> None:
    """Those that Python has, in the same test; no rise without lead."""
    opened.locator("#tab-codes").click()
    opened.locator("#base").select_option("shen-hdr-bridge")
    settle(opened)
    assert " K at" not in opened.locator("#codes-words").inner_text()
    opened.locator("#base").select_option("lrb-example")
    settle(opened)
    table = tb.temperature_factors(
        "lrb-example", reference_temperature=23.0, temperatures=[-20.0], strains=[1.0]
    )
    kinds = opened.locator("#published td:nth-child(2)").all_inner_texts()
    same = [kind == "LRB" for kind in kinds]
    assert same == sorted(same, reverse=True)
    assert same.count(True) == sum("LRB" in item.kinds for item in published().tables)
    shown = re.findall(r"by ([\d.]+) K at", opened.locator("#codes-words").inner_text())
    rises = {row["ambient_degC"]: row["lead_rise_K"] for row in table.attrs["lead_rises"]}
    assert [float(text) for text in shown] == [round(rises[-20.0]), round(rises[23.0])]


def test_keys_move_the_slider_and_the_loops(opened: Any) -> None:
    before, drawn = cells(opened), redrawn(opened)
    opened.locator("#slider").focus()
    for _ in range(4):
        opened.keyboard.press("ArrowRight")
        settle(opened)
    assert redrawn(opened) >= drawn + 3
    assert cells(opened) != before
    assert "−18\u00a0°C" in opened.locator("#cycles-caption").inner_text()


def test_play_moves_the_time(opened: Any) -> None:
    opened.locator("#moment").fill("0")
    opened.locator("#play").click()
    opened.wait_for_timeout(300)
    opened.locator("#play").click()
    assert float(opened.locator("#moment").input_value()) > 0


def test_without_webassembly_the_page_says_so(chromium: Any, address: str) -> None:
    page = chromium.new_page()
    page.add_init_script("delete globalThis.WebAssembly")
    page.goto(address)
    page.locator("#blocked", has_text="WebAssembly").wait_for()
    page.close()
