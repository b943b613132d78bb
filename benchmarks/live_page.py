"""The live page in headless Chromium: from opening to the first loops, redraws, a bridge."""

import tempfile
from pathlib import Path

import thermobearing as tb
from benchmarks.rows import Row, at_least, at_most, failed, plain
from docs.builder.chromium import MISSING, browser, is_there
from thermobearing.border.errors import InputError

REDRAWS, BRIDGE_MS, PAGE_MB = 20.0, 100.0, 1.0
OPENINGS, POSITIONS = 5, 40
# Moves the slider and waits for each redraw; returns redraws per second and the times of each [ms].
MOVE = """async (positions) => {
  const slider = document.getElementById("slider"), each = [], begun = performance.now();
  for (let k = 0; k < positions; k++) {
    slider.value = k - 40;
    slider.dispatchEvent(new Event("input"));
    await new Promise(requestAnimationFrame);
    await new Promise((done) => setTimeout(done));
    each.push(Number(document.documentElement.dataset.redrawMs));
  }
  return [(1000 * positions) / (performance.now() - begun), each];
}"""


def rows() -> list[Row]:
    """Return the size of the page and the times in it; the fastest of several."""
    if not is_there():
        return [failed("the live page", MISSING)]
    with tempfile.TemporaryDirectory() as name:
        try:
            file = tb.live_page(Path(name) / "live.html", "lrb-example")
        except InputError as error:
            return [failed("the live page", str(error))]
        with browser() as running:

            def opened(state: str, table: str) -> tuple[float, list[float]]:
                page = running.new_page(viewport={"width": 1280, "height": 900})
                page.goto(f"{file.as_uri()}#{state}")
                page.locator(f"#{table} td").first.wait_for()
                first = float(page.evaluate("document.documentElement.dataset.firstLoop"))
                rate, redraws = page.evaluate(MOVE, POSITIONS)
                page.close()
                return rate, [first, *redraws]

            tests = [opened("view=test", "cycles") for _ in range(OPENINGS)]
            bridge = opened("view=bridge&base=shen-lhdr-bridge", "peaks")[1][1:]
        size = file.stat().st_size / 1e6
    first = min(times[0] for _, times in tests) / 1e3
    rate = max(rate for rate, _ in tests)
    drawn = min(min(times[1:]) for _, times in tests)
    note = f"a redraw takes {drawn:.1f} ms; the screen has 60 per second"
    return [
        at_most("live page, one file", size, PAGE_MB, "MB"),
        plain("live page, from opening to the first loops", first, "s", f"fastest of {OPENINGS}"),
        at_least("live page, redraws of a 3-cycle test", rate, REDRAWS, "1/s", note),
        at_most("live page, a bridge of 50 s, drawn", min(bridge), BRIDGE_MS, "ms"),
    ]
