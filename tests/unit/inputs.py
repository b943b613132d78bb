"""What the tests of the border share: files to write, right or broken, and refusals. No tests."""

import json
import tomllib
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner, Result

import thermobearing as tb
from thermobearing.cli import app

Row = tuple[str, dict[str, Any], list[str]]

SPECIMEN = "shen-hdr-specimen"
# Files of a result without figures.
FILES = [
    "case.resolved.toml",
    "cycles.csv",
    "history.csv",
    "result.nc",
    "summary.json",
    "tested_range.csv",
]
WITHOUT_CYCLES = [name for name in FILES if name != "cycles.csv"]  # ended in its first cycle
REMOVED = object()  # in place of a value: take the key away
CYCLES = {"step": "cycles", "strain": 1.0, "speed": "60 mm/s", "count": 1}
# One cycle of 2 s in 200 steps: small enough to be run hundreds of times.
QUICK_CASE = {
    "bearing": SPECIMEN,
    "ambient": "-20 degC",
    "test": {"name": "quick", "dt": "10 ms", "steps": [CYCLES]},
}


def specimen_table() -> dict[str, Any]:
    text = resources.files("thermobearing") / "data" / "bearings" / f"{SPECIMEN}.toml"
    return tomllib.loads(text.read_text(encoding="utf-8"))


def changed_table(table: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    for key, value in changes.items():
        *parents, name = key.split(".")
        holder = table
        for parent in parents:
            holder = holder.setdefault(parent, {})
        if value is REMOVED:
            del holder[name]
        else:
            holder[name] = value
    return table


def write_test(folder: Path, record: tb.TestRecord, name: str = "", sidecar: str = "") -> Path:
    path = folder / f"{name or record.name}.csv"
    rows = np.column_stack([record.time, record.displacement, record.force])
    np.savetxt(path, rows, delimiter=",", header="time_s,displacement_mm,force_kN", comments="")
    settings = f'ambient = "{record.ambient} degC"\nbearing = "{SPECIMEN}"\n{sidecar}'
    path.with_suffix(".toml").write_text(settings)
    return path


def write_toml(path: Path, table: dict[str, Any]) -> Path:
    path.write_text(tomli_w.dumps(table), encoding="utf-8")
    return path


def quick_case(path: Path, **changes: Any) -> Path:
    return write_toml(path, {**QUICK_CASE, **changes})


def steps_case(path: Path, *steps: dict[str, Any], **test: Any) -> Path:
    return quick_case(path, test={"dt": "10 ms", **test, "steps": list(steps)})


def refusal(path: Path, load: Any) -> str:
    """The message with which a file is refused, by the library and by the command alike."""
    with pytest.raises(tb.InputError) as caught:
        load(path)
    message = str(caught.value)
    done = CliRunner().invoke(app, ["check", str(path)])
    assert done.exit_code == 2
    assert done.stderr == f"thermobearing: {message}\n"
    assert isinstance(done.exception, SystemExit)  # anything else would be a traceback
    return message


def by_name(rows: list[Any]) -> list[Any]:
    """Rows (name, what, pieces) as parameters of a test, the name for its id."""
    return [pytest.param(*row[1:], id=row[0]) for row in rows]


def assert_mentions(message: str, pieces: list[str]) -> None:
    for piece in pieces:
        assert piece in message, f"{piece!r} is not in: {message}"


def assert_refused(call: Callable[[], Any], *pieces: str) -> None:
    with pytest.raises(tb.InputError) as caught:
        call()
    assert_mentions(str(caught.value), list(pieces))


def command(*words: Any) -> Result:
    """Run the command in this process; whatever it raises must have become an exit status."""
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exception is None or isinstance(done.exception, SystemExit)
    assert "Traceback" not in done.output
    return done


def cyclic(*words: Any) -> Result:
    return command("cyclic", "--no-figures", *words)


def last_line(done: Result) -> dict[str, Any]:
    line = done.stdout.splitlines()[-1]
    return dict(json.loads(line, parse_constant=lambda word: pytest.fail(f"{word} in JSON")))


def summary(directory: Path) -> dict[str, Any]:
    return dict(json.loads((directory / "summary.json").read_text()))


def content(directory: Path) -> dict[str, bytes]:
    files = sorted(path for path in directory.rglob("*") if path.is_file())
    return {str(path.relative_to(directory)): path.read_bytes() for path in files}


# The bearing of the real test in the shared data: 156 mm of rubber is known, the rest assumed.
