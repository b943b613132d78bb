"""Every figure of every command, small, on one page: `python docs/contact.py`.

Runs the commands below in an empty folder and shrinks what they draw.
"""

import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).parent
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


def run(name: str, words: str, folder: Path) -> list[Path]:
    """The figures that a command leaves in `folder`/NAME."""
    program = [sys.executable, "-m", "thermobearing.cli"]
    command = [*program, name, *shlex.split(words), "-q", "-o", name]
    subprocess.run(command, check=True, cwd=folder, stdout=subprocess.DEVNULL)
    return sorted((folder / name / "figures").glob("*.png"))


def one_temperature(folder: Path) -> None:
    """A record of one test, from the history of the cyclic result that has two."""
    head, *rows = (folder / "cyclic" / "history.csv").read_text().splitlines()
    kept = [row for row in rows if row.startswith("23,")]
    (folder / "cyclic-23.csv").write_text("\n".join([head, *kept]) + "\n")


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


def main() -> None:
    """Run, shrink, write the page."""
    SHEET.mkdir(parents=True, exist_ok=True)
    for old in SHEET.glob("*.png"):
        old.unlink()
    page = ["---\norphan: true\n---", "", "# Every figure", ""]
    page += ["What each command draws, made by `python docs/contact.py`.", ""]
    with tempfile.TemporaryDirectory() as made:
        for name, words in COMMANDS:
            figures = run(name, words, Path(made))
            if name == "cyclic":
                one_temperature(Path(made))
            for figure in figures:
                shrunk(figure, SHEET / f"{name}-{figure.name}")
            page += section(name, words, figures)
    PAGE.write_text("\n".join(page), encoding="utf-8")


if __name__ == "__main__":
    main()
