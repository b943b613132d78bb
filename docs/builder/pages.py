"""Can a built site be read? A page of each kind opened by a browser, broad, narrow, light and dark.

`python docs/builder/pages.py build/site` prints what is wrong, and ends with 1 if anything is.
Without a browser it says so, and looks at nothing; in CI that is a fault.
"""

import os
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))

from docs.builder.chromium import MISSING, browser, console_messages, grave_faults, is_there

PAGES = (
    "index.html",
    "guide/tutorial.html",
    "guide/bridge.html",
    "gallery/index.html",
    "gallery/plot_01_loops.html",
    "gallery/plot_05_bridge.html",
    "api/thermobearing.html",
    "theory.html",
    "verification.html",
)
LOOKS: tuple[dict[str, Any], ...] = (
    {"viewport": {"width": 1280, "height": 900}, "color_scheme": "light"},
    {"viewport": {"width": 400, "height": 800}, "color_scheme": "dark"},
)
OF_NO_MATTER = ("log: ", "info: ", "debug: ")  # kinds of messages
OF_THE_THEME = "body > :not(.bd-container), .bd-header, .bd-sidebar-primary, .bd-sidebar-secondary"


def faults(site: Path, running: Any) -> list[str]:
    """A sentence for each fault of the pages of a site.

    Parameters
    ----------
    site : folder of a built site.
    running : browser.
    """
    missing = [name for name in PAGES if not (site / name).is_file()]
    if missing:
        return [f"{name}: is not there" for name in missing]
    return [
        f"{name}: {fault}"
        for look in LOOKS
        for name in PAGES
        for fault in _find_faults(running, site.resolve() / name, look)
    ]


def _find_faults(running: Any, file: Path, settings: dict[str, Any]) -> list[str]:
    page = running.new_page(**settings)
    reported = console_messages(page)
    page.goto(file.as_uri())
    width = settings["viewport"]["width"]
    messages = [f"console: {text}" for text in reported if not text.startswith(OF_NO_MATTER)]
    # A page that is wider than the screen has to be scrolled sideways on a phone.
    broad = page.evaluate("document.documentElement.scrollWidth")
    if broad > width:
        messages.append(f"{broad} px wide, on a screen of {width} px")
    if not page.locator("h1").first.is_visible():
        messages.append("its title is not seen")
    messages += [
        f"{name} ({settings['color_scheme']}): {html}"
        for name, html in grave_faults(page, without=OF_THE_THEME)
    ]
    page.close()
    return messages


def main(site: Path) -> int:
    """What is wrong, printed; the exit status."""
    if not is_there():
        print(f"pages are not looked at: {MISSING}")
        return int(bool(os.environ.get("CI")))
    with browser() as running:
        wrong = faults(site, running)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
