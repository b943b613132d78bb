"""What tests of pages share: the mark of those that need a browser, and what paper shows.

Tests that need it carry the mark `needs_chromium`, which skips them with what to install.
"""

from typing import Any

import pytest

from docs.builder.chromium import MISSING, is_there

needs_chromium = pytest.mark.skipif(not is_there(), reason=MISSING)


def printed(page: Any) -> list[str]:
    """Text of the pages of paper; above each figure stands a word that tells its place."""
    import pypdfium2

    over = "@media print { figure.figure::before { content: 'over-' attr(id) '.' } }"
    page.add_style_tag(content=over)
    document = pypdfium2.PdfDocument(page.pdf(prefer_css_page_size=True))
    return [" ".join(sheet.get_textpage().get_text_bounded().split()) for sheet in document]


def assert_whole_figures(count: int, pages: list[str]) -> None:
    """Where the word above a figure and its caption are not on one page, the figure is cut."""
    for number in range(1, count + 1):
        words = (f"over-figure-{number}.", f"Figure {number}.")
        where = [{k for k, page in enumerate(pages) if word in page} for word in words]
        assert len(where[0]) == 1
        assert where[0] == where[1]
