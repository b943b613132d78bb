"""The report of each kind of result, as a reader has it: opened, used, printed."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import pytest

from docs.builder.chromium import grave_faults, told_by
from tests.browser.chromium import assert_whole_figures, needs_chromium, printed
from tests.browser.kinds import KINDS
from thermobearing.reporting import make_report

pytestmark = needs_chromium
BROAD = {"width": 1280, "height": 900}
NARROW = {"width": 400, "height": 800}
WITH_PLOTS = {"cyclic", "bridge", "hybrid", "sequence", "identify", "validate", "motions show"}
WITH_SLIDER = {"cyclic", "bridge"}
WITHOUT_FIGURES = {"identify --check", "design", "lambda", "bounds"}
NUMBERS = "(plot) => plot.data.map((trace) => [...trace.x])"
TOLERANCE = 1.0  # of a place on the page [px]


class Report(NamedTuple):
    """A report of a kind, open in a page that tells what goes wrong in it."""

    kind: str
    page: Any
    told: list[str]


@pytest.fixture(scope="module", params=KINDS)
def report(
    request: pytest.FixtureRequest, chromium: Any, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Report]:
    """Made and opened once: every test says itself how large the window is."""
    kind = request.param
    folder = KINDS[kind](tmp_path_factory.mktemp("kind") / "out")
    file = make_report(folder, title={"project": "Bridge 12"}, pdf=False)[0]
    page = chromium.new_page(viewport=NARROW, color_scheme="light")
    told = told_by(page)
    page.goto(file.as_uri())
    for plot in page.locator(".plot").all():
        plot.scroll_into_view_if_needed()
        plot.locator(".drawing .line, .drawing .points").first.wait_for(state="attached")
    yield Report(kind, page, told)
    page.close()


def test_it_opens_without_a_fault(report: Report) -> None:
    page = report.page
    assert page.locator(".plot").count() > 0 or report.kind not in WITH_PLOTS
    for image in page.locator("img").all():
        assert image.evaluate("(image) => image.decode().then(() => image.naturalWidth > 0)")
    assert not report.told


def test_sliders_move_lines(report: Report) -> None:
    page = report.page
    figures = page.locator("figure", has=page.locator("input[type=range]")).all()
    assert bool(figures) == (report.kind in WITH_SLIDER)
    for figure in figures:
        plot = figure.locator(".plot")
        slider = figure.locator("input[type=range]")
        slider.press("Home")
        at_first = plot.evaluate(NUMBERS)
        slider.press("End")
        assert plot.evaluate(NUMBERS) != at_first
    assert not report.told


def test_a_narrow_screen_is_not_scrolled_sideways(report: Report) -> None:
    report.page.set_viewport_size(NARROW)
    width = report.page.evaluate("document.documentElement.scrollWidth")
    assert width <= NARROW["width"]


def test_the_contents_lead_to_every_chapter(report: Report) -> None:
    page = report.page
    page.set_viewport_size(BROAD)
    contents = page.get_by_role("navigation", name="Contents")
    contents.get_by_role("link").first.wait_for()  # a narrow window keeps them closed
    links = contents.get_by_role("link").all()
    assert len(links) > 2
    for link in (links[0], links[-1]):
        link.click()
        target = page.locator(str(link.get_attribute("href")))
        assert target.inner_text().strip() == link.inner_text().strip()
        assert target.evaluate("(part) => part.getBoundingClientRect().top") < BROAD["height"]
        assert target.evaluate("(part) => part.getBoundingClientRect().top") >= -TOLERANCE
    assert not report.told


def test_a_table_sorts(report: Report) -> None:
    """The longest there is, by the first of its columns that has several values."""
    page = report.page
    tables = page.locator("table", has=page.locator("thead button")).all()
    longest = max(tables, key=lambda table: table.locator("tbody tr").count())
    columns = [
        longest.locator(f"tbody tr > :nth-child({place + 1})")
        for place in range(longest.locator("thead th").count())
    ]
    place = next(k for k, cells in enumerate(columns) if len(set(cells.all_text_contents())) > 1)
    at_first = columns[place].all_text_contents()
    head, orders = longest.locator("thead th").nth(place), {}
    for _ in range(2):
        head.get_by_role("button").press("Enter")
        order = columns[place].all_text_contents()
        assert sorted(order) == sorted(at_first)
        orders[head.get_attribute("aria-sort")] = list(dict.fromkeys(filter(None, order)))
    assert orders["descending"] == orders["ascending"][::-1]
    head.get_by_role("button").press("Enter")
    assert columns[place].all_text_contents() == at_first


def test_no_serious_fault_for_those_who_use_it_otherwise(report: Report) -> None:
    """Every other kind in the dark; the page of all kinds of blocks is looked at in both."""
    dark = list(KINDS).index(report.kind) % 2 == 1
    report.page.set_viewport_size(BROAD)
    report.page.emulate_media(color_scheme="dark" if dark else "light")
    assert not grave_faults(report.page)


def test_paper_has_whole_figures(report: Report) -> None:
    report.page.set_viewport_size(BROAD)
    figures = report.page.locator("figure.figure").count()
    assert figures > 0 or report.kind in WITHOUT_FIGURES
    assert_whole_figures(figures, printed(report.page))
