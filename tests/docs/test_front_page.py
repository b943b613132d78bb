"""What leads a reader: the front page, the commands of the gallery, and words that are searched."""

import re
import shlex
from functools import cache
from pathlib import Path

import pytest

from tests.docs.test_coverage import OF_THE_USER, nothing_wrong_with_command
from tests.unit.inputs import command

DOCS = Path(__file__).parents[2] / "docs"
INDEX = (DOCS / "index.md").read_text(encoding="utf-8")
DOORS = re.findall(r"::::\{grid-item-card\} (\w+)\n(.*?)\n::::\n", INDEX, re.DOTALL)
EXAMPLES = sorted((DOCS / "examples").glob("plot_*.py"))
# What a bridge engineer types, and a page that answers it.
SEARCHED = {
    "lambda": "guide/temperature_factors.md",
    "property modification factor": "nomenclature.md",
    "bounding": "guide/temperature_factors.md",
    "uplift": "guide/vertical.md",
    "buckling": "guide/vertical.md",
    "cavitation": "guide/vertical.md",
    "LRB": "nomenclature.md",
    "isolator": "nomenclature.md",
    "G-value": "nomenclature.md",
    "scragged": "nomenclature.md",
    "Q_d": "nomenclature.md",
    "ductility": "guide/bridge.md",
    "damping": "guide/bridge_table.md",
    "MCE": "guide/motions.md",
    "DBE": "guide/motions.md",
    "K-NET": "guide/motions.md",
    "PEER": "guide/motions.md",
    "response spectrum": "guide/motions.md",
    "TCL": "guide/opensees_element.md",
    "LeadRubberX": "guide/opensees_space.md",
    "SAP2000": "guide/exchange.md",
    "midas": "guide/exchange.md",
    "pelicun": "guide/simcenter.md",
    "EPW": "guide/climate.md",
    "crystallize": "guide/climate.md",
    "fragility": "guide/parameter_studies.md",
    "AASHTO": "guide/temperature_factors.md",
    "damper": "guide/devices.md",
    "certificate": "guide/report.md",
}


# A word in the title of a page puts the page first among the results of a search.
TITLES = {"lambda", "uplift", "buckling", "K-NET", "PEER", "fragility", "pelicun"}


@cache
def words_of(page: str) -> str:
    """Return the text of a page in lower case."""
    return (DOCS / page).read_text(encoding="utf-8").lower()


@pytest.mark.parametrize(("searched", "page"), SEARCHED.items())
def test_a_searched_word_leads_to_its_page(searched: str, page: str) -> None:
    text = words_of(page).partition("\n")[0] if searched in TITLES else words_of(page)
    assert re.search(rf"(?<!\w){re.escape(searched.lower())}(?!\w)", text)


def test_the_site_opens_with_a_sentence_a_picture_and_three_doors() -> None:
    title, sentence, picture, *others = INDEX.partition(":::::{grid}")[0].strip().split("\n\n")
    assert title.startswith("# ")
    assert others == []
    assert len(re.findall(r"\.(?:\s|$)", sentence)) == 1
    assert picture.startswith("![")
    assert [name for name, _ in DOORS] == ["Laboratory", "Bridge", "Research"]


@pytest.mark.parametrize(("name", "text"), DOORS)
def test_a_door_leads_to_a_result(name: str, text: str) -> None:
    """Its first link is a section with blocks to paste, and with what they print."""
    match = re.search(r"\]\((\S+\.md)#(\S+)\)", text)
    assert match, name
    sections = re.split(r"^## ", (DOCS / match[1]).read_text(encoding="utf-8"), flags=re.MULTILINE)
    (section,) = (part for part in sections if anchor(part.partition("\n")[0]) == match[2])
    assert "```bash" in section or "```python" in section
    assert section.rindex("```text") > section.index("```")


def anchor(heading: str) -> str:
    """Return the anchor of a heading."""
    return re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_of_the_gallery_states_its_command(path: Path) -> None:
    header = path.read_text(encoding="utf-8").split('"""')[1]
    match = re.search(r"^Command: (?:``thermobearing ([^`]+)``|none, )", header, re.MULTILINE)
    assert match, path.name
    if match[1]:
        nothing_wrong_with_command(shlex.split(match[1]))


def own_commands() -> list[list[str]]:
    """Return the words of those commands of examples that need no file of the user."""
    texts = [path.read_text(encoding="utf-8") for path in EXAMPLES]
    lines = re.findall(r"^Command: ``thermobearing ([^`]+)``", "\n".join(texts), re.MULTILINE)
    commands = [shlex.split(line) for line in lines]
    return [words for words in commands if not OF_THE_USER & set(words)]


@pytest.mark.thorough
@pytest.mark.parametrize("words", own_commands(), ids=" ".join)
def test_a_command_of_the_gallery_runs(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = command(*words, "--no-figures", "--quiet")
    assert done.exit_code == 0, done.stderr
    assert any((tmp_path / words[-1]).iterdir())
