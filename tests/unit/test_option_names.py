"""Messages name what was given: the option on the command line, the keyword in Python, the key of a
file."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from thermobearing.cli import app
from thermobearing.motions.readers import read_motion

TEST = "time_s,displacement_mm,force_kN\n" + "".join(
    f"{0.1 * k},{(k % 20) - 10},{2 * (k % 20) - 20}\n" for k in range(60)
)
STRONG = "time_s,acceleration_gal\n" + "".join(f"{0.01 * k},{5e4 * (-1) ** k}\n" for k in range(99))


def said(folder: Path, *words: str) -> str:
    files = {"t.csv": TEST, "strong.csv": STRONG, "case.toml": "[analysis]\nkeep_every = 0\n"}
    for name, text in files.items():
        (folder / name).write_text(text)
    given = [str(folder / word) if word in files else word for word in words]
    done = CliRunner().invoke(app, [*given, "-o", str(folder / "out")])
    assert done.exit_code == 2, done.output
    assert not (folder / "out").exists()
    return done.stderr


FIT = ("identify", "t.csv", "--bearing", "shen-hdr-specimen")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("cyclic", "--dt", "-1"), "--dt = '-1.0 s': must be"),
        (("cyclic", "--keep-every", "0"), "--keep-every = 0: must be"),
        (("cyclic", "--ambient", "500"), "--ambient = '500.0 degC': must be"),
        (("cyclic", "--strain", "1", "--wave", "saw"), "--wave = 'saw': must be"),
        (("hybrid", "--mode", "q"), "--mode = 'q': must be"),
        (("lambda", "shen-hdr-bridge", "--strain", "-1"), "--strain = -1.0: must be"),
        (("motions", "show", "strong.csv"), "say so with --trust-unit"),
        ((*FIT, "--free", "K_x"), '--free: no parameter "K_x"'),
        ((*FIT, "--free", "sigma_Y"), '--free: "sigma_Y": the bearing'),
        ((*FIT, "--starts", "0"), "--starts = 0: must be"),
        (("cyclic", "case.toml"), "case.toml: analysis.keep_every = 0: must be"),
    ],
    ids=lambda value: " ".join(value[-2:]) if isinstance(value, tuple) else None,
)
def test_the_command_names_its_options(tmp_path: Path, words: tuple[str, ...], told: str) -> None:
    """Before: the keys of files and keywords of Python, "analysis.keep_every", "trust_unit"."""
    assert told in said(tmp_path, *words)


def test_python_names_its_keywords(tmp_path: Path) -> None:
    said(tmp_path, "cyclic", "--dt", "-1")  # a command that ran before leaves nothing behind
    with pytest.raises(tb.InputError, match=r"analysis\.keep_every = 0"):
        tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[1.0], cycles=1), keep=tb.Keep(every=0))
    with pytest.raises(tb.InputError, match="say so with trust_unit"):
        read_motion(tmp_path / "strong.csv")
    with pytest.raises(tb.InputError, match=r'^free: no parameter "K_x"'):
        tb.identify_bearing(tmp_path / "t.csv", "shen-hdr-specimen", free=["K_x"])
