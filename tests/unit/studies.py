"""A small study that takes a blink, and what its directory holds."""

from pathlib import Path
from typing import Any

from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.record import Study

SHORT: dict[str, Any] = {"duration": "0.5 s"}
FACTORS: dict[str, Any] = {
    "bearing": ["shen-hdr-bridge", "shen-bilinear-bridge"],
    "motion": ["jra-ii-i-1"],
    "ambient": ["23 degC", "-20 degC"],
    "scale": [0.5, 1.0],
}


def small_study(case: dict[str, Any] | None = None, **changes: Any) -> Study:
    keep, design = changes.pop("keep", "none"), changes.pop("design", {})
    table = {"kind": "study", "name": "small", "case": SHORT | (case or {})}
    table |= {"factors": FACTORS | changes, "keep": {"histories": keep}}
    table |= {"design": design} if design else {}
    return make_study(table, "study.toml")


def kept(directory: Path) -> dict[str, bytes]:
    files = [path for path in sorted(directory.rglob("*")) if path.is_file()]
    return {
        str(path.relative_to(directory)): path.read_bytes()
        for path in files
        if path.name != "study.log"
    }
