"""The report of each analysis that has words of its own, opened by a browser."""

from collections.abc import Callable
from pathlib import Path

import pytest

import thermobearing as tb
from tests.browser.chromium import browser, needs_chromium
from thermobearing.cyclic.report import pieces_of as cyclic_pieces
from thermobearing.earthquake.report import pieces_of as earthquake_pieces
from thermobearing.report import Pieces, document
from thermobearing.report.html import html_page

pytestmark = needs_chromium
NARROW = 400


def of_cyclic() -> Pieces:
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, dt=0.02)
    return cyclic_pieces(tb.run("shen-lhdr-specimen", test, ambient=[-20.0, 23.0]))


def of_bridge() -> Pieces:
    bearings = ["shen-hdr-bridge", "shen-lhdr-bridge"]
    return earthquake_pieces(tb.bridge(bearings, "jra-ii-i-1", [23.0, -20.0], duration=2.0))


def of_hybrid() -> Pieces:
    return earthquake_pieces(tb.hybrid("shen-lhdr-specimen", ambient=-20.0, duration=2.0))


@pytest.mark.parametrize("made", [of_cyclic, of_bridge, of_hybrid])
def test_it_opens_without_a_fault(made: Callable[[], Pieces], tmp_path: Path) -> None:
    file = tmp_path / "report.html"
    file.write_text(html_page(document(made(), {"Project": "Bridge 12"})), encoding="utf-8")
    with browser() as running:
        page = running.new_page(viewport={"width": NARROW, "height": 800})
        told: list[str] = []
        page.on("console", lambda message: told.append(message.text))
        page.on("pageerror", lambda error: told.append(str(error)))
        page.goto(file.as_uri())
        plots = page.locator(".plot").all()
        for plot in plots:
            plot.scroll_into_view_if_needed()
            plot.locator(".scatterlayer path.js-line, .scatterlayer path.point").first.wait_for(
                state="attached"
            )
        for slider in page.locator("input[type=range]").all():
            slider.press("End")
        assert plots
        assert page.evaluate("document.documentElement.scrollWidth") <= NARROW
        for image in page.locator("img").all():
            assert image.evaluate("(image) => image.decode().then(() => image.naturalWidth > 0)")
    assert not told
