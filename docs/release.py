"""Write the files of a release that are neither wheel nor source distribution: `make dist`.

`python -m docs.release dist` adds to the folder of both the live page, a report of a bridge as
page and PDF, the table of `thermobearing verify`, the citation, the notes (the newest section of
CHANGELOG.md) and the SHA-256 of all. Nothing is taken from a network.
"""

import argparse
import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
WRITTEN = (  # by this program; `make dist` writes wheel and source distribution before
    "bearing.html",
    "report-example.html",
    "report-example.pdf",
    "verify.html",
    "CITATION.cff",
    "notes.md",
)
SUMS = "SHA256SUMS"
PACKAGES = ("thermobearing-{version}-py3-none-any.whl", "thermobearing-{version}.tar.gz")
# The bridge whose numbers begin the README.
REPORT = (
    "bridge --bearing shen-lhdr-bridge --motion jra-ii-i-1 --ambient 23 --ambient -20 "
    "--no-figures --report -q -o"
)


def release_files(version: str) -> set[str]:
    """Return the names of all files of a release."""
    return {*(name.format(version=version) for name in PACKAGES), *WRITTEN, SUMS}


def release_notes(changelog: str) -> str:
    r"""Return the first section of a changelog that has lines, with its heading.

    Parameters
    ----------
    changelog
        Text whose sections begin with `## `.

    Raises
    ------
    ValueError
        If no section has a line below its heading.

    Examples
    --------
    >>> release_notes("## Unreleased\n\n## 0.4.0\n\n* A line.\n\n## 0.3.0\n")
    '## 0.4.0\n\n* A line.\n'
    """
    for section in re.split(r"^(?=## )", changelog, flags=re.MULTILINE)[1:]:
        heading, _, lines = section.partition("\n")
        if lines.strip():
            return f"{heading}\n\n{lines.strip()}\n"
    raise ValueError("CHANGELOG.md has no section with lines")


def checksums(folder: Path) -> str:
    """Return the SHA-256 of each file of a folder, as `sha256sum -c` reads them."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != SUMS)
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files
    )


def run_program(*words: str) -> None:
    """Run `thermobearing` in a process of its own; its failure ends this one."""
    subprocess.run([sys.executable, "-m", "thermobearing.cli", *words], check=True)


def write_release(folder: Path, documents: str = "") -> None:
    """Write the files of a release beside wheel and source distribution.

    Parameters
    ----------
    folder
        Folder with the two packages.
    documents
        Address of the documentation to which the live page links; no link by default.
    """
    run_program("live", "--overwrite", "-o", str(folder / "bearing.html"), "--documents", documents)
    run_program("verify", "--overwrite", "--html", str(folder / "verify.html"))
    with tempfile.TemporaryDirectory() as name:
        result = Path(name) / "bridge"
        run_program(*REPORT.split(), str(result))
        for suffix in ("html", "pdf"):
            shutil.copyfile(result / f"report.{suffix}", folder / f"report-example.{suffix}")
    shutil.copyfile(ROOT / "CITATION.cff", folder / "CITATION.cff")
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    (folder / "notes.md").write_text(release_notes(changelog), encoding="utf-8")
    (folder / SUMS).write_text(checksums(folder), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--documents", default="", help="address of the documentation")
    arguments = parser.parse_args()
    write_release(arguments.folder, arguments.documents)
