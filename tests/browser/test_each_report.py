"""The report of each kind of result, as a reader has it: opened, used, printed."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import pytest

from docs.builder.chromium import console_messages, grave_faults
from tests.browser.chromium import assert_whole_figures, needs_chromium, printed
from tests.browser.kinds import KINDS
from thermobearing.reporting import make_report

pytestmark = [needs_chromium, pytest.mark.drawn]
BROAD = {"width": 1280, "height": 900}
NARROW = {"width": 400, "height": 800}
WITH_PLOTS = {"cyclic", "bridge", "hybrid", "sequence", "identify", "validate", "motions show"}
WITHOUT_FIGURES = {"identify --check", "design", "lambda", "bounds"}


class Report(NamedTuple):
    kind: str
    page: Any
    reported: list[str]


@pytest.fixture(
    scope="module",
    params=[pytest.param(k, marks=pytest.mark.thorough if k != "cyclic" else ()) for k in KINDS],
)
def report(
    request: pytest.FixtureRequest, chromium: Any, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Report]:
    kind = request.param
    folder = KINDS[kind](tmp_path_factory.mktemp("kind") / "out")
    file = make_report(folder, title={"project": "Bridge 12"}, pdf=False)[0]
    page = chromium.new_page(viewport=NARROW, color_scheme="light")
    reported = console_messages(page)
    page.goto(file.as_uri())
    for plot in page.locator(".plot").all():
        plot.scroll_into_view_if_needed()
        plot.locator(".drawing .line, .drawing .points").first.wait_for(state="attached")
    yield Report(kind, page, reported)
    page.close()


def test_it_opens_without_a_fault(report: Report) -> None:
    page = report.page
    assert page.locator(".plot").count() > 0 or report.kind not in WITH_PLOTS
    for image in page.locator("img").all():
        assert image.evaluate("(image) => image.decode().then(() => image.naturalWidth > 0)")
    assert not report.reported


def test_a_narrow_screen_is_not_scrolled_sideways(report: Report) -> None:
    report.page.set_viewport_size(NARROW)
    width = report.page.evaluate("document.documentElement.scrollWidth")
    assert width <= NARROW["width"]


def test_no_serious_fault_for_those_who_use_it_otherwise(report: Report) -> None:
    dark = list(KINDS).index(report.kind) % 2 == 1
    report.page.set_viewport_size(BROAD)
    report.page.emulate_media(color_scheme="dark" if dark else "light")
    assert not grave_faults(report.page)


def test_paper_has_whole_figures(report: Report) -> None:
    report.page.set_viewport_size(BROAD)
    figures = report.page.locator("figure.figure").count()
    assert figures > 0 or report.kind in WITHOUT_FIGURES
    assert_whole_figures(figures, printed(report.page))


def test_every_table_fits_its_column(report: Report) -> None:
    report.page.set_viewport_size({"width": 1200, "height": 900})
    over = "(part) => part.scrollWidth - part.clientWidth"
    assert max(part.evaluate(over) for part in report.page.locator(".scroll:visible").all()) <= 1
