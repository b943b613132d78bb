"""The header for C: the tables of all faces as structures."""

from typing import Any

ROOM = """/* Kernels of thermobearing %(version)s for C, and for all that can call C. Written by
   `python -m kernels`; do not edit. Units: kN, mm, s, degC. Every field takes eight bytes.
   A function takes one table: arguments first, then its results. */
#ifndef THERMOBEARING_H
#define THERMOBEARING_H
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct { void *data; int64_t shape[1]; } tb_array1; /* contiguous, the last axis fastest */
typedef struct { void *data; int64_t shape[2]; } tb_array2;
typedef struct { void *data; int64_t shape[3]; } tb_array3;
typedef struct { void *data; int64_t shape[4]; } tb_array4;
typedef struct { void *table; int64_t count; } tb_list; /* of records or arrays in a row */

extern const char thermobearing_sources[]; /* the digest of the sources of the kernels */
"""
END = """
#ifdef __cplusplus
}
#endif
#endif
"""
NUMBERS = {"float": "double", "int": "int64_t", "bool": "int64_t"}
ITEMS = {"<f8": "double", "<i8": "int64_t", "<f4": "float", "|b1": "bool, one byte"}


def _field(name: str, kind: Any) -> str:
    if isinstance(kind, str):
        return f"{NUMBERS[kind]} {name};"
    if "record" in kind:
        return f"tb_{kind['record']} {name};"
    if "tuple" in kind:
        inner = kind["tuple"]
        what = f"tb_{inner['record']}" if "record" in inner else f"tb_array{inner['dims']}"
        return f"tb_list {name}; /* {what} */"
    item = ITEMS.get(kind["array"], f"tb_{kind['array']}")
    return f"tb_array{kind['dims']} {name}; /* {item} */"


def _argument(name: str, kind: Any) -> str:
    if isinstance(kind, dict) and "record" in kind:
        return f"tb_{kind['record']} *{name};"
    return _field(name, kind)


def _structure(name: str, fields: list[str]) -> str:
    lines = "\n".join(f"    {field}" for field in fields)
    return f"\ntypedef struct {{\n{lines}\n}} tb_{name};\n"


def _row(row: dict[str, Any]) -> list[str]:
    return [
        f"{ITEMS[item]} {name}{f'[{width[0]}]' if width else ''};"
        for name, item, _, *width in row["fields"]
    ]


def header(described: dict[str, Any], version: str) -> str:
    """Return the text of thermobearing.h; what is for lockstep is left out."""
    parts = [ROOM % {"version": version}]
    for name, row in described["rows"].items():
        if not name.endswith("Lanes"):
            parts.append(_structure(name, _row(row)))
    for name, fields in described["records"].items():
        if "Lanes" not in name:
            parts.append(_structure(name, [_field(*field) for field in fields]))
    for entry in described["entries"].values():
        if any("Lanes" in str(kind) for _, kind in entry["arguments"]):
            continue
        fields = [_argument(*one) for one in entry["arguments"]]
        fields += [f"{NUMBERS[kind]} result{k};" for k, kind in enumerate(entry["results"])]
        name = f"{entry['symbol'].removeprefix('thermobearing_')}_call"
        parts.append(_structure(name, fields))
        parts.append(f"void {entry['symbol']}(tb_{name} *);\n")
    return "".join(parts) + END
