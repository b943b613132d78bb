"""What looks at the pages of the built site, on pages with and without faults."""

from pathlib import Path
from typing import Any

import pytest

from docs.builder import pages
from tests.browser.chromium import needs_chromium

PAGE = (
    '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>A page</title>'
    '<link rel="icon" href="data:,"></head><body><div class="bd-container"><main><h1>Words</h1>'
    "{}</main></div></body></html>"
)


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(pages, "PAGES", ("index.html",))
    (tmp_path / "index.html").write_text(PAGE.format("<p>All is well.</p>"), encoding="utf-8")
    return tmp_path


@needs_chromium
@pytest.mark.thorough  # of a tool that builds the site, as CI does
def test_faults_are_found(site: Path, chromium: Any) -> None:
    assert pages.faults(site, chromium) == []
    faulty = (
        "<script>console.log('told'); console.error('broken')</script>"
        '<div style="width: 500px">broad</div><img src="data:," hidden><a href="#x"></a>'
    )
    (site / "index.html").write_text(PAGE.format(faulty), encoding="utf-8")
    reported = pages.faults(site, chromium)
    assert [line.split(": ", 1)[1][:12] for line in reported] == [
        "console: err",
        "link-name (l",
        "console: err",
        "508 px wide,",
        "link-name (d",
    ]


def test_a_page_that_is_not_there_is_a_fault(site: Path) -> None:
    (site / "index.html").unlink()
    assert pages.faults(site, None) == ["index.html: is not there"]


@pytest.mark.parametrize(("ci", "status"), [("", 0), ("true", 1)])
def test_without_a_browser(
    ci: str, status: int, site: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr(pages, "is_there", lambda: False)
    monkeypatch.setenv("CI", ci)
    assert pages.main(site) == status
    assert "apt-get install chromium" in capsys.readouterr().out
