"""Valid input of every kind, drawn from valid.toml, and the files that it names. No tests."""

import copy
import tomllib
from functools import cache
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import tomli_w
from hypothesis import strategies as st

import tests.fuzz.sheets as sheets
import tests.unit.motion_files as motion_files
import thermobearing as tb

Table = dict[str, Any]
ENTRIES = tomllib.loads(Path(__file__).with_name("valid.toml").read_text(encoding="utf-8"))


@cache
def _stored(path: str) -> Table:
    text = resources.files("thermobearing") / "data" / path
    return tomllib.loads(text.read_text(encoding="utf-8"))


def valid(entry: str) -> st.SearchStrategy[Table]:
    """Tables as an entry of valid.toml describes them."""
    return _drawn(ENTRIES[entry])


@st.composite
def _drawn(draw: st.DrawFn, item: Any) -> Any:
    """Draw what an item of valid.toml stands for; see there."""
    match item:
        case list():
            return [draw(_drawn(one)) for one in item]
        case {"pick": items}:
            return draw(_drawn(draw(st.sampled_from(items))))
        case {"some": items}:
            return draw(st.lists(st.sampled_from(items), unique=True))
        case {"low": low, "high": high, **rest}:
            number = round(draw(st.floats(low, high, allow_nan=False)), 4)
            return f"{number} {rest['unit']}" if rest else number
        case {"list": one, "least": least, "most": most, **rest}:
            result = draw(st.lists(_drawn(one), min_size=least, max_size=most))
            return [*rest.values(), *result]
        case {"use": entry}:
            return draw(_drawn(ENTRIES[entry]))
        case {"stored": path}:
            return copy.deepcopy(_stored(path))
        case dict():
            table: Table = {}
            for part in item.get("+", ()):
                _add(table, draw(_drawn(part)))
            for key, value in item.items():
                if key != "+" and not (key.endswith("?") and draw(st.booleans())):
                    _add(table, {key.removesuffix("?"): draw(_drawn(value))})
            return table
    return item


def _add(table: Table, more: Table) -> None:
    """Add the keys of another table, also those of the tables in it."""
    for key, value in more.items():
        if isinstance(value, dict) and isinstance(table.get(key), dict):
            _add(table[key], value)
        else:
            table[key] = value


MOTIONS = {
    "motion.csv": motion_files.csv_text(),
    "motion.txt": motion_files.one_column("% acc in gal, dt = 0.01 s"),
    "motion.at2": motion_files.at2_text(),
    "motion.knet": motion_files.knet_text(),
    "motion.jma": motion_files.jma_text(),
}
TABLES = {
    "test.csv": sheets.TEST,
    "moved.csv": sheets.MOVED,
    "night.csv": sheets.NIGHT,
    "measured.csv": sheets.MEASURED,
}


@cache
def earlier_result() -> bytes:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05)
    with TemporaryDirectory() as folder:
        saved = tb.run("shen-hdr-specimen", test, ambient=-20).save(f"{folder}/out", figures=False)
        return Path(saved, "result.nc").read_bytes()


@cache
def companions() -> dict[str, bytes]:
    texts = {
        **TABLES,
        **MOTIONS,
        "bearing.toml": tomli_w.dumps(_stored("bearings/shen-hdr-specimen.toml")),
        "structure.toml": tomli_w.dumps(_stored("structures/hybrid-pier.toml")),
    }
    return {name: text.encode() for name, text in texts.items()} | {"earlier.nc": earlier_result()}
