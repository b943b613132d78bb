"""Every figure of every command, small, on one page.

Runs the commands below in an empty folder and shrinks what they draw.
"""

import contextlib
import shlex
import tempfile
from pathlib import Path

from PIL import Image

from docs.builder import outputs, pictures

DOCS = Path(__file__).parents[1]
SHEET, PAGE = DOCS / "figures" / "contact", DOCS / "appendix" / "contact-sheet.md"
ACROSS = 2  # pictures in a row of the page
WIDE, COLOURS = 560, 32  # of a picture [pixel]; of its palette
COMMANDS = (
    ("cyclic", "--bearing shen-lhdr-specimen --ambient 23 --ambient -20 --compare"),
    ("bridge", ""),
    ("hybrid", "--bearing shen-hdr-specimen --bearing shen-lhdr-specimen --mode rt --mode pd"),
    ("identify", "cyclic-23.csv --bearing shen-lhdr-specimen --starts 1"),
    ("validate", "shen-lhdr-specimen cyclic-23.csv"),
    ("intake", "cyclic-23.csv"),
    ("lambda", "shen-lhdr-bridge"),
    ("bounds", "--bearing shen-hdr-bridge --motion jra-i-i-1 --motion jra-ii-i-1"),
    ("design", "--motion jra-ii-i-1"),
    ("motions", "show jra-ii-i-1"),
    ("structures", "show pier-p1"),
)


def run(name: str, words: str) -> dict[Path, pictures.Panels]:
    """Return what the figures show that a command leaves in NAME, by their files."""
    with pictures.recorded() as shown:
        result = outputs.run_command(name, *shlex.split(words), "-q", "-o", name)
    if result.exit_code != 0:
        raise ValueError(f"{name} {words}: {result.stderr}")
    return {path: shown[path] for path in sorted(Path(name).glob("figures/*.png"))}


def run_all() -> dict[str, dict[Path, pictures.Panels]]:
    """Run the commands in the working directory; return what their figures show."""
    results = {}
    for name, words in COMMANDS:
        results[name] = run(name, words)
        if name == "cyclic":
            one_temperature(Path.cwd())
    return results


def shown_by_commands(results: dict[str, dict[Path, pictures.Panels]]) -> pictures.Shown:
    """Return what the pictures of the sheet show."""
    return {
        f"contact/{name}-{path.name}": pictures.without_extent(panels)
        for name, figures in results.items()
        for path, panels in figures.items()
    }


def one_temperature(folder: Path) -> None:
    """A record of one test, from the history of the cyclic result that has two."""
    head, *rows = (folder / "cyclic" / "history.csv").read_text().splitlines()
    selected = [row for row in rows if row.startswith("23,")]
    (folder / "cyclic-23.csv").write_text("\n".join([head, *selected]) + "\n")


def shrunk(figure: Path, to: Path) -> None:
    """The picture as wide as half a page, with few colours."""
    picture = Image.open(figure).convert("RGB")
    size = (WIDE, round(picture.height * WIDE / picture.width))
    small = picture.resize(size, Image.Resampling.LANCZOS)
    small.quantize(COLOURS, dither=Image.Dither.NONE).save(to, optimize=True)


def section(name: str, words: str, figures: list[Path]) -> list[str]:
    """A part of the page: the command and its pictures, some in a row."""
    lines = [f"## `thermobearing {name} {words}".rstrip() + "`", ""]
    lines += ["| | |", "|---|---|"]
    cells = [f"`{f.stem}` ![{f.stem}](../figures/contact/{name}-{f.stem}.png)" for f in figures]
    cells += [""] * (-len(cells) % ACROSS)
    rows = [cells[k : k + ACROSS] for k in range(0, len(cells), ACROSS)]
    return [*lines, *(f"| {' | '.join(row)} |" for row in rows), ""]


def draw() -> None:
    """Run, shrink, write the page."""
    SHEET.mkdir(parents=True, exist_ok=True)
    page = ["---\norphan: true\n---", "", "# Every figure", ""]
    page += [f"What each command draws, made by `{pictures.REDRAW}`.", ""]
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        results = run_all()
        # Figures that no command draws any more must not stay on the sheet.
        for old in SHEET.glob("*.png"):
            old.unlink()
        for name, words in COMMANDS:
            for figure in results[name]:
                shrunk(figure, SHEET / f"{name}-{figure.name}")
            page += section(name, words, list(results[name]))
    pictures.update_shown(shown_by_commands(results))
    PAGE.write_text("\n".join(page), encoding="utf-8")
