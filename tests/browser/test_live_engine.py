"""The engine of the live page in a browser: the cases of verification/test_live_engine.py."""

import base64
import json
from pathlib import Path
from typing import Any

import pytest

import thermobearing as tb
from tests.browser.chromium import needs_chromium
from tests.verification import test_live_engine as cases
from thermobearing.live import data as live

pytestmark = needs_chromium
SCRIPT = """async ([engine, runner, module, data, cases]) => {
  const load = (text) => import(URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
  const { createEngine } = await load(engine);
  const { runCases } = await load(runner);
  const bytes = Uint8Array.from(atob(module), (letter) => letter.charCodeAt(0));
  return runCases(await createEngine(bytes, data), cases);
}"""


@pytest.mark.thorough
def test_browser_and_python_agree(chromium: Any) -> None:
    try:
        module = base64.b64encode(live.live_module()).decode("ascii")
    except tb.InputError as error:
        pytest.skip(str(error))
    runner = Path(cases.__file__).with_name("live_cases.mjs").read_text(encoding="utf-8")
    arguments = [
        live.engine_source(),
        runner,
        module,
        live.live_data(cases.KNOWN),
        list(cases.CASES.values()),
    ]
    page = chromium.new_page()
    computed = json.loads(page.evaluate(SCRIPT, arguments))
    page.close()
    cases.assert_alike(computed["results"])
    assert computed["grown"] == 0
