"""A report as a reader has it: opened from a disk by a browser, used, printed."""

import re
import time
from collections.abc import Callable, Iterator
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from PIL import Image

from docs.builder.chromium import console_messages, grave_faults
from tests import tolerances as tol
from tests.browser.chromium import assert_whole_figures, needs_chromium, printed
from tests.browser.document import FORCES, PLACES, document
from thermobearing.report.html import html_page

pytestmark = [needs_chromium, pytest.mark.drawn]
BROAD = {"width": 1280, "height": 900}
NARROW = {"width": 400, "height": 800}
PRINTED = 680.0  # width of the text of an A4 page [px]
PRINTED_TURNED = 1010.0
THEMES = ("light", "dark")
TOP_OF_FIGURES = "document.getElementById('figures').getBoundingClientRect().top"
NEAR = 60.0  # the top of the window [px]
PATIENCE = 10.0  # [s]


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("page") / "report.html"
    file.write_text(html_page(document()), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def opened(chromium: Any, address: str, request: pytest.FixtureRequest) -> Iterator[Any]:
    """The page; whatever goes wrong in it, or is asked of a network, is a fault of the test."""
    look = {"viewport": BROAD, "color_scheme": "light"} | getattr(request, "param", {})
    page = chromium.new_page(**look)
    reported = console_messages(page)
    page.goto(address)
    yield page
    page.close()
    assert not reported


def until(holds: Callable[[], bool]) -> None:
    """Wait for what comes after a movement; the page itself lets no words be run in it."""
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def line(page: Any, figure: int, axis: str = "y", trace: int = 0) -> list[float]:
    page.locator(f"#plot-{figure}").scroll_into_view_if_needed()
    page.locator(f"#plot-{figure} .drawing").wait_for()
    result = page.evaluate(
        f"Array.from(document.getElementById('plot-{figure}').data[{trace}].{axis})"
    )
    return [float(value) for value in result]


def path(page: Any, figure: int) -> str:
    return str(page.locator(f"#plot-{figure} .drawing .line").first.get_attribute("d"))


def column(page: Any, place: int) -> list[str]:
    cells = page.locator(f"#table-2 tbody tr > :nth-child({place})")
    return [text.split(":")[-1].strip() for text in cells.all_inner_texts()]


def test_what_a_user_wrote_stays_text(opened: Any) -> None:
    line(opened, 1)
    assert opened.evaluate("window.hurt") is None
    for place in ("#what-was-asked + p", ".block", "#table-1", "#plot-1 .legend"):
        assert "<script>window.hurt" in opened.locator(place).text_content()
    assert opened.locator("img:not(.drawn), a[href^=http]").count() == 0


def test_the_slider_moves_the_curve(opened: Any) -> None:
    before, at_first = line(opened, 3, "x"), path(opened, 3)
    slider = opened.get_by_label("Time")
    slider.press("End")
    after = line(opened, 3, "x")
    np.testing.assert_allclose(max(before), 20.0, rtol=tol.TYPED_FLOAT)
    assert max(after) > 20.0 + 0.99 * (PLACES - 1)
    assert path(opened, 3) != at_first
    assert slider.get_attribute("aria-valuetext") == f"{PLACES - 1} s"
    assert opened.locator("#figure-3 output").inner_text() == f"{PLACES - 1} s"
    slider.press("ArrowLeft")
    assert max(line(opened, 3, "x")) < max(after)


@pytest.mark.parametrize("opened", [{"viewport": {"width": 1280, "height": 50}}], indirect=True)
def test_a_slider_moved_far_from_the_window_draws_its_plot(opened: Any) -> None:
    assert opened.locator("#plot-3 .drawing").count() == 0
    opened.get_by_label("Time").evaluate(
        "slider => { slider.value = 5; slider.dispatchEvent(new Event('input')); }"
    )
    assert opened.locator("#plot-3 .drawing").count() == 1
    assert max(line(opened, 3, "x")) > 20.0 + 0.99 * 5


def test_the_menu_changes_the_lines(opened: Any) -> None:
    assert max(line(opened, 1, "x")) < 1.01
    assert opened.locator("#plot-1 .band").count() == 0
    opened.locator("#figure-1").get_by_label("Show").select_option("second motion")
    assert max(line(opened, 1, "x")) > 2.99
    assert opened.locator("#plot-1 .band").count() == 2  # not tested, on both sides


def test_equal_scales(opened: Any) -> None:
    line(opened, 4)
    box = opened.locator("#plot-4 .drawing .line").evaluate("(line) => line.getBBox()['height']")
    width = opened.locator("#plot-4 .drawing .line").evaluate("(line) => line.getBBox()['width']")
    assert box == pytest.approx(width, rel=tol.SCALES_ALIKE)  # both from -1 to 1


def test_zoom_by_buttons_a_drag_and_keys(opened: Any) -> None:
    line(opened, 4)
    sheet = opened.locator("#plot-4 .sheet")
    whole = path(opened, 4)
    opened.locator("#plot-4").get_by_label("Zoom in").click()
    nearer = path(opened, 4)
    opened.locator("#plot-4").get_by_label("Whole plot").click()
    assert path(opened, 4) == whole != nearer
    box = sheet.bounding_box()
    opened.mouse.move(box["x"] + 200, box["y"] + 100)
    opened.mouse.down()
    opened.mouse.move(box["x"] + 300, box["y"] + 200)
    assert opened.locator("#plot-4 .zoom").count() == 1
    opened.mouse.up()
    assert path(opened, 4) != whole
    sheet.press("0")
    assert path(opened, 4) == whole
    sheet.press("Shift+ArrowRight")
    assert path(opened, 4) != whole
    sheet.dblclick()
    assert path(opened, 4) == whole


def test_values_at_the_pointer_and_by_keys(opened: Any) -> None:
    line(opened, 4)
    sheet = opened.locator("#plot-4 .sheet")
    sheet.press("ArrowRight")
    sheet.press("ArrowRight")
    assert "x [mm]: 0.9888" in opened.locator("#status").inner_text()
    box = sheet.bounding_box()
    opened.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.45 * box["height"])
    assert "y [mm]: 0.0" in opened.locator("#plot-4 .values").inner_text()
    opened.mouse.move(0, 0)
    assert opened.locator("#plot-4 .values").count() == 0


def test_a_click_on_the_legend_hides_a_line(opened: Any) -> None:
    line(opened, 1)
    button = opened.locator("#plot-1 .legend button").first
    assert opened.locator("#plot-1 .drawing .line").count() == 2
    button.click()
    assert opened.locator("#plot-1 .drawing .line").count() == 1
    assert button.get_attribute("aria-pressed") == "false"
    with opened.expect_download() as saved:
        opened.locator("#plot-1").get_by_label("Save as SVG").click()
    assert saved.value.suggested_filename == "plot-1.svg"


@pytest.mark.parametrize("opened", [{"viewport": {"width": 1200, "height": 800}}], indirect=True)
def test_the_last_column_of_each_table_is_reached_by_scrolling(opened: Any) -> None:
    for table in opened.locator(".scroll:visible").all():
        table.evaluate("(table) => { table.scrollLeft = table.scrollWidth; }")
        edge = table.bounding_box()
        last = table.locator("thead th").last.bounding_box()
        assert last["x"] + last["width"] <= edge["x"] + edge["width"] + 1.0


def test_the_contents_list_jumps_and_follows(opened: Any) -> None:
    contents = opened.get_by_role("navigation", name="Contents")
    current = contents.locator("a[aria-current=true]")
    assert current.all_inner_texts() == ["What was asked"]
    contents.get_by_role("link", name="Figures").click()
    until(lambda: 0.0 <= opened.evaluate(TOP_OF_FIGURES) < NEAR)
    until(lambda: current.all_inner_texts() == ["Figures"])
    assert contents.is_visible()  # it stays next to the text


def test_tables_sort_by_click_and_by_key(opened: Any) -> None:
    head = opened.locator("#table-2 thead th").nth(1)
    at_first = column(opened, 2)
    upwards = [f"{force:.0f}".replace("-", "−") for force in sorted(FORCES[:3])] + [""]
    head.get_by_role("button").click()
    assert column(opened, 2) == upwards
    assert head.get_attribute("aria-sort") == "ascending"
    assert "Force" in opened.locator("#status").inner_text()
    opened.keyboard.press("Enter")  # what is empty stays below
    assert column(opened, 2) == [*upwards[2::-1], ""]
    assert head.get_attribute("aria-sort") == "descending"
    opened.keyboard.press("Space")
    assert column(opened, 2) == at_first
    assert head.get_attribute("aria-sort") is None
    opened.locator("#table-2 thead button").first.press("Enter")
    assert column(opened, 1) == ["run a", "run b", "run c", "run d"]


@pytest.mark.parametrize("opened", [{"color_scheme": theme} for theme in THEMES], indirect=True)
def test_light_and_dark(opened: Any) -> None:
    line(opened, 1)
    system = opened.evaluate("matchMedia('(prefers-color-scheme: dark)').matches")
    button = opened.get_by_role("button", name="Dark colours")
    for dark in (system, not system, system):
        assert button.get_attribute("aria-pressed") == str(dark).lower()
        assert (_ground(opened, "body") < 0.5) == dark
        ink = opened.locator("#plot-1 .drawing .line").nth(1)  # black on white
        stroke = ink.evaluate("(line) => getComputedStyle(line)['stroke']")
        assert stroke.startswith("oklch(0.72 ") if dark else stroke == "rgb(26, 26, 26)"
        button.click()


def _ground(page: Any, place: str) -> float:
    return _brightness(page.locator(place).first, "background-color")


def _brightness(part: Any, style: str) -> float:
    reported = part.evaluate(f"(part) => getComputedStyle(part).getPropertyValue('{style}')")
    return sum(map(float, re.findall(r"[\d.]+", reported)[:3])) / 3.0 / 255.0


@pytest.mark.parametrize("opened", [{"viewport": NARROW}], indirect=True)
def test_a_narrow_screen_is_not_scrolled_sideways(opened: Any) -> None:
    line(opened, 4)
    assert opened.evaluate("document.documentElement.scrollWidth") <= NARROW["width"]
    contents = opened.get_by_role("navigation", name="Contents")
    assert not contents.get_by_role("link", name="Figures").is_visible()
    contents.locator("summary").press("Enter")
    contents.get_by_role("link", name="Figures").press("Enter")
    until(lambda: 0.0 <= opened.evaluate(TOP_OF_FIGURES) < NEAR)


@pytest.mark.parametrize("opened", [{"viewport": NARROW}], indirect=True)
def test_a_shadow_shows_on_which_side_a_table_goes_on(opened: Any) -> None:
    tables = opened.locator(".scroll:visible").all()
    broad = next(t for t in tables if t.evaluate("(t) => t.scrollWidth - t.clientWidth") > NEAR)

    def _dark() -> list[bool]:
        """Whether the left and the right edge are darker than paper, below the head."""
        pixels = np.asarray(Image.open(BytesIO(broad.screenshot())).convert("L"))
        below = pixels[len(pixels) // 2 :]
        return [bool(np.median(below[:, k]) < 0.9 * below.max()) for k in (3, -4)]

    assert _dark() == [False, True]
    broad.evaluate("(table) => { table.scrollLeft = table.scrollWidth; }")
    assert _dark() == [True, False]


@pytest.mark.parametrize("opened", [{"viewport": BROAD}, {"viewport": NARROW}], indirect=True)
def test_no_column_covers_another(opened: Any) -> None:
    """Cells of a row lie side by side, also where a table is scrolled."""
    overlaps = opened.locator(".scroll").evaluate_all(
        """(tables) => tables.map((table) => Math.max(0, ...[...table.querySelectorAll("tr")].map(
            (row) => Math.max(0, ...[...row.children].slice(1).map((cell, k) =>
                row.children[k].getBoundingClientRect().right - cell.getBoundingClientRect().left
            ))
        )))"""
    )
    assert overlaps
    assert max(overlaps) < 1.0


LOOKS = [  # the first as in test_each_report.py
    pytest.param("light", BROAD, id="light", marks=pytest.mark.thorough),
    pytest.param("dark", NARROW, id="dark"),
]


@pytest.mark.parametrize(("theme", "viewport"), LOOKS)
def test_no_serious_fault_for_those_who_use_it_otherwise(
    chromium: Any, address: str, theme: str, viewport: dict[str, int]
) -> None:
    page = chromium.new_page(viewport=viewport, color_scheme=theme)
    page.goto(address)
    for figure in (1, 3, 4, 5):
        line(page, figure)
    grave = grave_faults(page, without="")
    page.close()
    assert not grave


def test_a_keyboard_reaches_everything(opened: Any) -> None:
    opened.keyboard.press("Tab")
    assert opened.evaluate("document.activeElement.className") == "skip"
    opened.keyboard.press("Enter")
    assert opened.evaluate("document.activeElement.id") == "content"
    reached = set()
    for _ in range(40):
        opened.keyboard.press("Tab")
        reached.add(opened.evaluate("document.activeElement.id || document.activeElement.tagName"))
    assert {"plot-1-menu", "plot-3-slider", "BUTTON"} <= reached


@pytest.mark.parametrize("opened", [{"color_scheme": "dark"}], indirect=True)
def test_paper_has_whole_figures_and_heads_on_every_page(opened: Any) -> None:
    opened.locator("#figure-1").get_by_label("Show").select_option("second motion")
    pages = printed(opened)
    assert_whole_figures(opened.locator("figure.figure").count(), pages)
    assert "second motion" in "".join(pages)  # what the menu shows
    assert "time 0 s" in "".join(pages)
    assert sum("Quantity 17 [kN/mm]" in page for page in pages) > 1
    assert "72839.500" in "".join(pages)  # of a folded row
    assert any("again Run it again" in page for page in pages)  # a heading and what it is of
    assert "How to make it again" in pages[0]  # the contents


def test_nothing_is_cut_at_the_side_of_paper(opened: Any) -> None:
    opened.set_viewport_size({"width": int(PRINTED), "height": 900})
    opened.emulate_media(media="print", color_scheme="dark")
    edges = opened.evaluate(
        "[...document.querySelectorAll('main > *, main figure, main img, .drawing, table')]"
        ".map((part) => [part.closest('.broad') !== null, part.getBoundingClientRect().right])"
    )
    assert len(edges) > 10
    for broad, right in edges:
        assert right <= (PRINTED_TURNED if broad else PRINTED) + 1.0
    assert _ground(opened, "body") > 0.9  # paper is light
