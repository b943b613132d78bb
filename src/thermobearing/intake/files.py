"""Result directory of an intake: what was found, pictures, sidecars."""

import os
from functools import partial
from pathlib import Path

from thermobearing.border.errors import OutputError
from thermobearing.border.text_file import file_names
from thermobearing.intake.result import Intake, Intakes
from thermobearing.intake.sidecar import sidecar_text
from thermobearing.results.directory import FIGURES, SIDECARS, check_target, write_directory
from thermobearing.results.writing import write_summary


def save_intakes(
    found: Intakes,
    directory: Path,
    *,
    force: bool = False,
    figures: bool = True,
    beside: bool = False,
) -> Path:
    """Write summary.json, a sidecar and a picture for each file.

    Parameters
    ----------
    found : from `take_in`.
    directory : made if needed, with its parents.
    force : replace an earlier result directory; never a sidecar beside a file.
    figures : draw the pictures too.
    beside : put each sidecar beside its file too, where `load_test` finds it.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; a sidecar that is there already. Nothing is left.
    """
    check_target(directory, force=force)
    names = file_names(item.file.stem for item in found.files)
    targets = [item.file.with_suffix(".toml") for item in found.files] if beside else []
    there = [str(path) for path in targets if path.exists()]
    if there or len(set(targets)) < len(targets):
        told = there[0] if there else str(targets[0])
        raise OutputError(f"{told}: is there already; correct it, or leave out --beside")

    def fill(folder: Path) -> None:
        write_summary(folder, found.summary())
        (folder / SIDECARS).mkdir()
        for item, name in zip(found.files, names, strict=True):
            text = sidecar_text(item, directory / SIDECARS)
            (folder / SIDECARS / f"{name}.toml").write_text(text, encoding="utf-8")
        if figures:
            from thermobearing.results.drawing import save_figures

            drawn = {
                name: partial(Intake.plot, item)
                for item, name in zip(found.files, names, strict=True)
            }
            save_figures(drawn, folder / FIGURES)

    written = write_directory(directory, fill, force=force)
    for item, path in zip(found.files, targets, strict=False):
        _put(path, sidecar_text(item, path.parent))
    return written


def _put(path: Path, text: str) -> None:
    """A new file, whole or not at all."""
    partial_file = path.with_name(f".{path.name}.partial")
    try:
        partial_file.write_text(text, encoding="utf-8")
        os.link(partial_file, path)  # unlike a replacement it never covers what is there
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        partial_file.unlink(missing_ok=True)
