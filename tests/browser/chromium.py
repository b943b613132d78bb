"""Headless Chromium: the browser of the system, driven by playwright, which brings none here.

Tests that need it carry the mark `needs_chromium`, which skips them with what to install.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

import pytest

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
PACKAGES = ("playwright", "axe_playwright_python", "pypdfium2")
MISSING = (
    "no Chromium to look with: install the system's (Debian: apt-get install chromium) and "
    'pip install "thermobearing[browser]" (make browser)'
)


def program() -> str | None:
    """Path of the browser; None without one."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


needs_chromium = pytest.mark.skipif(
    program() is None or not all(map(find_spec, PACKAGES)), reason=MISSING
)


@contextmanager
def browser() -> Iterator[Any]:
    """A browser without a window, until it is no longer needed."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=program())
        try:
            yield running
        finally:
            running.close()
