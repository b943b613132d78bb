"""What can go wrong with a file: wrong values in a table, wrong cells in rows, wrong bytes.

A TOML table is changed as a tree and then as text; rows of numbers cell by cell; whatever it
was, its bytes at last. No tests.
"""

import copy
import re
from typing import Any

import tomli_w
from hypothesis import strategies as st

UNITS = [
    "mm", "m", "s", "ms", "kN", "N", "MPa", "degC", "K", "kg", "Hz", "1/K", "rad", "furlong",
    "mm/s", "kN/mm", "kN mm/rad", "kN s^2/mm", "W/(m K)", "%", "mm**9**9", "°C", "tonf", "",
]  # fmt: skip
# Pieces of TOML in place of a value.
PIECES = [
    "3", "-1", "0", "1.0", "2.5", "true", "false", "1979-05-27", "1979-05-27T07:32:00Z",
    "07:32:00", "nan", "inf", "-inf", "5e-324", "1e308", "-1e308", "1e-12", "1e12", "1e400",
    "0x7fffffffffffffff",
    "9223372036854775808", "1" + "0" * 400, "0x" + "f" * 5000, "0o17", "1_000",
    '""', '"x"', '" "', '"免震"', '"\\u0000"', '"\\ud7ff"', '"' + "x" * 300 + '"', '"../a.toml"',
    '"/dev/null"', '"."', '"a.csv"', '"jra-ii-i-1"', '"shen-hdr-specimen"', '"nan mm"', '"inf s"',
    '"1e999 mm"', '"5e-324 m"', '"1,5 mm"', '"-0 mm"', '"1e-300 s"', '"true"',
    "[]", "[1]", "[[1]]", '["a"]', "[1, 'a']", "[nan]", "[{}]", "[{x = 1}]", "[1979-05-27]",
    "{}", "{x = 1}", '{value = 3, source = "?"}', '{value = {a = 1}, note = "?"}', "{sorce = 1}",
    '{value = "5 mm", source = 3}', '{step = "rest"}', '{shape = "square"}', "[{value = 1}]",
]  # fmt: skip
CELLS = [
    "", " ", "nan", "NaN", "inf", "-inf", "1e999", "1e308", "-1e308", "1e-320", "5e-324", "0", "-0",
    "1e12", "1e13", "x", "1,5", "1_0", "0x10", "1D2", "--", "#", '"', "'", "1" * 400, "²",
    "１", "免",
    "1.234,5", "1,234", "31.02.2024 12:00", "12:00:61", "23:59", "2024-13-01T00:00", "CH1", "[s]",
    "1e-9", "-5", "1e5", "=1+1", ";", "\t", "a" * 5000, "1.7.2", "+", "e5", "1e", "None",
]  # fmt: skip
NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(.*)$", re.IGNORECASE)


def plain_numbers() -> st.SearchStrategy[float]:
    edges = [0.0, -0.0, 1e-323, 1e-12, 1e-9, 0.5, 1.0, -1.0, 1e6, 1e9, 1e12, 1e16, 1e300]
    return st.one_of(st.sampled_from(edges), st.floats())


@st.composite
def pieces(draw: st.DrawFn) -> str:
    kind = draw(st.integers(0, 9))
    if kind <= 4:
        return draw(st.sampled_from(PIECES))
    number = draw(plain_numbers())
    if kind == 5:
        return repr(number)
    if kind <= 7:
        return f'"{number!r} {draw(st.sampled_from(UNITS))}"'
    if kind == 8:
        return tomli_w.dumps({"x": draw(st.text(max_size=20))})[4:].strip()
    return repr(draw(st.integers(-(2**70), 2**70)))


def _places(table: Any) -> list[tuple[Any, Any]]:
    items = table.items() if isinstance(table, dict) else enumerate(table)
    result: list[tuple[Any, Any]] = []
    for key, value in items:
        result.append((table, key))
        if isinstance(value, dict | list):
            result += _places(value)
    return result


def _scaled(value: Any, power: int) -> Any:
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return float(value) * 10.0**power
    match = NUMBER.match(value) if isinstance(value, str) else None
    return f"{float(match[1]) * 10.0**power!r} {match[2]}" if match else value


def _change(draw: st.DrawFn, table: dict[str, Any], marks: list[str]) -> None:
    """One change of a table, in place; pieces of TOML are marked, to be put in later."""
    places = _places(table)
    if not places:
        return
    holder, key = places[draw(st.integers(0, len(places) - 1))]
    kind = draw(st.integers(0, 13))
    value = holder[key]
    if kind <= 5:
        marks.append(draw(pieces()))
        holder[key] = f"@{len(marks) - 1}@"
    elif kind <= 7:
        holder[key] = _scaled(value, draw(st.sampled_from([-12, -6, -3, -1, 1, 3, 6, 12])))
    elif kind == 8:
        del holder[key]
    elif kind == 9 and isinstance(holder, dict):
        name = draw(st.sampled_from([f"{key}s", key[:-1] or "x", key.upper(), "zzz", f"{key} "]))
        holder[name] = holder.pop(key)
    elif kind == 10 and isinstance(holder, dict):
        marks.append(draw(pieces()))
        holder[draw(st.sampled_from(["zzz", "value", "kind", "name", "免震"]))] = (
            f"@{len(marks) - 1}@"
        )
    elif kind == 11:
        holder[key] = [value] if draw(st.booleans()) else {"value": value, "source": "?"}
    elif kind == 12 and isinstance(value, str):
        match = NUMBER.match(value)
        unit = draw(st.sampled_from(UNITS))
        holder[key] = f"{match[1]} {unit}" if match else f"{value}{unit}"
    elif isinstance(holder, list):
        holder.append(copy.deepcopy(value))
    else:
        other, where = places[draw(st.integers(0, len(places) - 1))]
        if where in other if isinstance(other, dict) else where < len(other):
            holder[key] = copy.deepcopy(other[where])


@st.composite
def toml_files(draw: st.DrawFn, table: dict[str, Any], *, calm: bool = False) -> bytes:
    """A table as TOML, right or changed in up to three places; if calm, in one at most."""
    table, marks = copy.deepcopy(table), []
    for _ in range(draw(st.sampled_from([0, 0, 1] if calm else [0, 0, 1, 1, 1, 1, 2, 3]))):
        _change(draw, table, marks)
    text = tomli_w.dumps(table)
    for number, piece in enumerate(marks):
        text = text.replace(f'"@{number}@"', piece)
    if calm:
        return text.encode()
    if draw(st.integers(0, 15)) == 0:  # a key twice
        lines = text.splitlines()
        lines.insert(0, lines[draw(st.integers(0, len(lines) - 1))] if lines else "")
        text = "\n".join(lines)
    return draw(damaged(text.encode()))


@st.composite
def rows_of_numbers(draw: st.DrawFn, text: str) -> bytes:
    lines = text.splitlines()
    for _ in range(draw(st.sampled_from([0, 1, 1, 1, 2, 3]))):
        at = min(draw(st.one_of(st.integers(0, 3), st.integers(0, len(lines)))), len(lines) - 1)
        kind = draw(st.integers(0, 9))
        cells = re.split("([,;\t ]+)", lines[at])
        if kind <= 4:
            cell = draw(st.one_of(st.sampled_from(CELLS), plain_numbers().map(repr)))
            cells[draw(st.integers(0, len(cells) - 1))] = cell
            lines[at] = "".join(cells)
        elif kind == 5:
            lines[at] = "".join(cells[:-1])
        elif kind == 6:
            lines[at] += draw(st.sampled_from([",", ",1", " ", "\t", "," * 500, " " * 5000]))
        elif kind == 7:
            lines.insert(at, lines[draw(st.integers(0, len(lines) - 1))])
        elif kind == 8:
            del lines[at]
        else:
            mark = draw(st.sampled_from([";", "\t", " ", ", "]))
            lines = [line.replace(",", mark) for line in lines]
        if not lines:
            return b""
    end = draw(st.sampled_from(["\n", "\n", "\n", "\r\n", "\r", "\n\n"]))
    return draw(damaged(end.join(lines).encode() + end.encode()))


@st.composite
def damaged(draw: st.DrawFn, raw: bytes) -> bytes:
    """Bytes as they are, or (one in five) as a bad disk, editor or transfer leaves them."""
    kind = draw(st.integers(0, 59))
    if kind >= 12 or not raw:
        return raw
    at = draw(st.integers(0, len(raw) - 1))
    size = draw(st.sampled_from([1, 1, 4, 64]))
    if kind <= 1:
        return raw[:at]
    if kind <= 3:
        bit = 1 << draw(st.integers(0, 7))
        return raw[:at] + bytes([raw[at] ^ bit]) + raw[at + 1 :]
    if kind == 4:
        return raw[:at] + raw[at + size :]
    if kind == 5:
        return raw[:at] + draw(st.binary(max_size=size)) + raw[at:]
    if kind == 6:
        return raw[:at] + raw[max(0, at - size) : at] * 3 + raw[at:]
    if kind == 7:
        return b"\xef\xbb\xbf" + raw
    if kind == 8:
        return raw.replace(b"\n", b"\r\n")
    if kind == 9:
        return raw[:at] + b"\0" * size + raw[at + size :]
    encoding = draw(st.sampled_from(["utf-16", "cp932", "utf-16-le", "utf-8-sig", "shift-jis"]))
    return raw.decode("utf-8", "replace").encode(encoding, "replace")
