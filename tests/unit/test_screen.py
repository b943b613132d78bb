"""Tables on the screen: every number whole, in any width, and plain text in a pipe."""

import itertools
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import command
from thermobearing.results.screen import laid_out, print_table, say

HEADS = ("motion", "degC", "strain", "force kN", "lead degC")
ROWS = [("jra-ii-ii-1", "-20", "175%", "1234.5", "161.25"), ("x", "23", "9%", "7.0", "-3.10")]
FRAMES = re.compile(r"[\x1b\u2500-\u257f…]")  # colours, boxes, what was cut


@pytest.mark.parametrize("width", [1, 20, 27, 40, 80, None])
def test_blocks_hold_every_number_once_and_the_keys_in_each(width: int | None) -> None:
    blocks = laid_out(HEADS, ROWS, 2, width)
    for line, row in enumerate([HEADS, *ROWS]):
        shown = [block[line] for block in blocks]
        for key in row[:2]:
            assert all(key in text for text in shown)
        for number in row[2:]:
            assert sum(number in text for text in shown) == 1
    narrowest = max(len("jra-ii-ii-1  degC  ") + len(head) for head in HEADS[2:])
    if width is None:
        assert len(blocks) == 1
    elif width >= narrowest:
        assert max(map(len, itertools.chain(*blocks))) <= width
        assert len(blocks) == (1 if width == 80 else len(blocks))


def test_nothing_is_markup_or_cut(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    say("a bearing [bold] of " + 60 * "many words ")
    print_table(HEADS, ROWS, title="[red]", keys=2, styles=["red", ""])
    shown = capsys.readouterr().out
    assert "[bold]" in shown
    assert "[red]" in shown
    assert not FRAMES.search(shown)
    assert len(shown.splitlines()) == 6  # the sentence is one of them: a pipe has no width


def test_table_of_cycles_is_whole_and_has_the_lead(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.02)
    result = tb.run("shen-lhdr-specimen", test, ambient=-20)
    row = result.cycles.iloc[0]
    stiffness = 1e-3 * row["G_eq_MPa"] * 240.0**2 / 30.0  # of the specimen [kN/mm]
    assert row["K_eq_kN_mm"] == pytest.approx(stiffness, rel=tol.ROUNDING)
    numbers = {f"{row['G_eq_MPa']:.3f}", f"{1e-3 * row['energy_kN_mm']:.2f}", f"{stiffness:.3f}"}
    numbers |= {f"{row[name]:.1f}".replace("-", "−") for name in result.cycles.columns[-4:]}
    for columns in ("", "50", "80"):
        monkeypatch.setenv("COLUMNS", columns)
        result.show()
        shown = capsys.readouterr().out
        assert not FRAMES.search(shown)
        assert "Lead [°C]" in shown
        assert numbers <= set(shown.split())
        if columns == "80":
            assert max(len(line) for line in shown.splitlines() if "%" in line) <= 80
            assert "G_e [MPa]  K_eq [kN/mm]" in shown


def test_study_shows_rubber_and_lead_in_a_pipe(tmp_path: Path) -> None:
    words = ["--bearing", "shen-lhdr-bridge", "--motion", "jra-ii-i-1", "--duration", "2"]
    done = command("bridge", *words, "--no-figures", "-o", tmp_path / "out")
    assert not FRAMES.search(done.stdout)
    for head in ("Strain [%]", "Ductility", "Viscous", "Rubber [°C]", "Lead [°C]"):
        assert head in done.stdout


def test_a_program_in_a_pipe_writes_plain_text() -> None:
    """The real program, with a wrong option: neither frames nor colours."""
    plain = {k: v for k, v in os.environ.items() if not k.startswith(("FORCE", "TERM", "GITHUB"))}
    words = [sys.executable, "-m", "thermobearing.cli", "cyclic", "--wrong"]
    done = subprocess.run(words, capture_output=True, text=True, env=plain, check=False)
    assert "Usage" in done.stderr
    assert not FRAMES.search(done.stdout + done.stderr)


@pytest.mark.parametrize(("ambients", "shown"), [((0,), False), ((0, 23), True)])
def test_of_warm_needs_a_warmer_run(tmp_path: Path, ambients: tuple[int, ...], shown: bool) -> None:
    """Before: a column of 100 % where there is one temperature."""
    words = ["--bearing", "shen-hdr-bridge", "--motion", "jra-ii-i-1", "--duration", "0.5"]
    words += [word for at in ambients for word in ("--ambient", str(at))]
    done = command("bridge", *words, "--no-figures", "-o", tmp_path / "out")
    assert ("Of warmest" in done.stdout) is shown
