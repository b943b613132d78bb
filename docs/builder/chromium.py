"""Headless Chromium: the browser of the system, driven by playwright, which brings none here."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
PACKAGES = ("playwright", "axe_playwright_python", "pypdfium2")
MISSING = (
    "no Chromium to look with: install the system's (Debian: apt-get install chromium) and "
    'pip install "thermobearing[browser]" (make browser)'
)
ALIKE = "tbody tr:nth-child(n+5)"  # rows of a table that look as those above them


def program() -> str | None:
    """Path of the browser; None without one."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


def is_there() -> bool:
    """Whether there are a browser and what drives it."""
    return program() is not None and all(map(find_spec, PACKAGES))


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


def console_messages(page: Any) -> list[str]:
    """What a page says in the console, or asks of a network, from now on: its faults."""
    reported: list[str] = []
    page.on("console", lambda message: reported.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: reported.append(str(error)))
    page.on("request", lambda asked: reported.append(asked.url) if _is_outside(asked.url) else None)
    return reported


def _is_outside(url: str) -> bool:
    return not url.startswith(("file:", "data:", "blob:"))


def grave_faults(page: Any, without: str = ALIKE) -> list[tuple[str, str]]:
    """Serious and critical faults for those who see, hear or use a page otherwise (axe-core).

    Parameters
    ----------
    page : as it is open.
    without : parts that are not looked at, as CSS names them.
    """
    from axe_playwright_python.sync_playwright import Axe

    context = {"exclude": [[without]]} if without else None
    options = {"resultTypes": ["violations"]}
    faults = Axe().run(page, context=context, options=options).response["violations"]
    grave = [fault for fault in faults if fault["impact"] in ("serious", "critical")]
    return [(fault["id"], fault["nodes"][0]["html"]) for fault in grave]
