"""The pair of docs/guide/why_not.md: one bearing in `LeadRubberX` and here, by stored numbers."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from docs.builder.outputs import FILE, blocks
from tests import tolerances as tol
from tests.opensees import needs_opensees
from thermobearing.verify.references import script_digest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "guide" / "why_not.md"
CLOSE = {  # relative differences of the element, by the run here
    "20 degC": {"displacement_mm": 0.02, "force_kN": 0.02},
    "20 degC, heat as there": {"displacement_mm": 0.01, "force_kN": 0.01, "lead_rise_K": 0.05},
}
RUN = """
from pathlib import Path
from thermobearing.verify.references import preload_opensees
preload_opensees()
exec(compile(Path("lead_rubber_x.py").read_text(encoding="utf-8"), "lead_rubber_x.py", "exec"))
"""


@pytest.fixture(scope="module")
def files() -> dict[str, str]:
    """Files of the page, by name."""
    texts = [block["text"] for block in blocks(PAGE)]
    return {match[1]: text for text in texts if (match := FILE.match(text))}


def test_stored_numbers_are_of_the_script_of_the_page(files: dict[str, str]) -> None:
    stored = tomllib.loads(files["lead_rubber_x.toml"])
    assert stored["script"] == script_digest(files["lead_rubber_x.py"])


def test_both_agree_at_20_degC_as_the_page_says() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for run, limits in CLOSE.items():
        (line,) = re.findall(rf"^{run} +(displacement.*)$", text, re.MULTILINE)
        differences = dict(re.findall(r"(\w+) [\d.]+ \(([-+][\d.]+)%\)", line))
        for name, limit in limits.items():
            assert abs(float(differences[name])) < 100.0 * limit


@needs_opensees
def test_opensees_gives_the_stored_numbers(files: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "lead_rubber_x.py").write_text(files["lead_rubber_x.py"], encoding="utf-8")
    ended = subprocess.run(
        [sys.executable, "-c", RUN], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    numbers = [float(text) for text in ended.stdout.split()]
    stored = tomllib.loads(files["lead_rubber_x.toml"])
    names = ("displacement_mm", "force_kN", "lead_rise_K")
    assert dict(zip(names, numbers, strict=True)) == pytest.approx(
        {name: stored[name] for name in names}, rel=tol.OPENSEES_STORED
    )
