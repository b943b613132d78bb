"""Names of earlier versions work for a while, with one warning each."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from thermobearing.cli import app


def test_keyword_force_is_overwrite_with_one_warning(tmp_path: Path) -> None:
    bearing = tb.load_bearing("shen-hdr-specimen")
    path = tb.save_bearing(bearing, tmp_path / "mine.toml")
    with pytest.warns(DeprecationWarning, match="overwrite=") as warned:
        tb.save_bearing(bearing, path, **{"force": True})
    assert len(warned) == 1
    assert Path(warned[0].filename) == Path(__file__)


def test_option_force_is_overwrite_and_hidden(tmp_path: Path) -> None:
    out = str(tmp_path / "hz.toml")
    words = [
        "new",
        "hz",
        "-o",
        out,
        *("--compound", "jra-hdr-g10", "--plan", "500x500mm"),
        *("--layers", "10x8mm", "--shim", "3mm"),
    ]
    first, again, forced = (
        CliRunner().invoke(app, [*words, *more, "-q"]) for more in ([], [], ["--force"])
    )
    assert (first.exit_code, again.exit_code, forced.exit_code) == (0, 2, 0), first.output
    assert "deprecated" in forced.stderr
    assert "--force " not in CliRunner().invoke(app, ["new", "--help"]).output
