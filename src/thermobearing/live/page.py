"""The live page as one HTML file: page, kernels and data in it, no network, no server."""

import base64
import gzip
import json
import re
import tomllib
from collections.abc import Iterable
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import Any

from thermobearing.bearing.library import as_bearing, list_bearings
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import EXPONENTS
from thermobearing.border.arguments import checked
from thermobearing.border.library import data_path
from thermobearing.border.schema import field_limits
from thermobearing.border.text_file import check_file, write_file
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.case import Case
from thermobearing.cyclic.protocol import Cycles
from thermobearing.earthquake.measures import LARGEST_DAMPING_SHARE
from thermobearing.live.data import engine_source, live_data, live_module
from thermobearing.model.outcomes import temperature_limits
from thermobearing.motions.record import ACCELERATION_UNITS, ASSERTED
from thermobearing.quantities.governing import SLACK_KELVIN
from thermobearing.report.pieces import policy_digest
from thermobearing.results.ranges import EXTREME, REST, SLACK

START = "shen-hdr-bridge"  # the bearing that the page opens with
# The test that the page opens with: its rates lie inside those of the tests of START. 23 degC is
# the reference of most published factors.
OPENING = {"strain": 1.75, "frequency": 0.08, "count": 3, "reference": 23}
MOTIONS = ("jra-ii-i-1", "jra-ii-ii-1", "jra-i-i-1")
SCRIPTS = ("draw.js", "app.js")  # after the engine, each after what it imports
STYLES = (("report-page", "page.css"), ("live", "page.css"))
IMPORT = re.compile(r"^import .*? from .*?;\n", re.MULTILINE | re.DOTALL)
EXPORT = re.compile(r"^export ", re.MULTILINE)
# In the template, a word follows the tag that names it, and other values stand in double braces.
WORDED = re.compile(r'<[^>]* data-word="(\w+)"[^>]*>')
VALUE = re.compile(r"\{\{ (\w+) \}\}")
EXPORTED = re.compile(r"^export (?:async )?(?:function|const|class) (\w+)", re.MULTILINE)


@checked
def live_page(
    path: str | Path,
    bearing: Bearing | str | Path | None = None,
    *,
    overwrite: bool = False,
    documents: str = "",
) -> Path:
    """Write a page in which the browser computes tests of a bearing and a bridge.

    The page is one HTML file that opens from a disk, a mail attachment or a phone. It contains
    the kernels of this package as WebAssembly and needs no network.

    Parameters
    ----------
    path : of the HTML file.
    bearing : the Bearing, library name or TOML file that the page opens with; those of the
        library can be chosen in any case.
    overwrite : replace an existing file.
    documents : address of the documentation that the page links to, such as "../index.html".

    Returns
    -------
    Path : of the file.

    Raises
    ------
    InputError : an unknown bearing, or kernels that are not built (`make kernels`).
    OutputError : the file exists, or cannot be written.

    Examples
    --------
    >>> import thermobearing as tb
    >>> tb.live_page("bearing.html", "shen-lhdr-specimen")  # doctest: +SKIP
    PosixPath('bearing.html')
    """
    file = Path(path)
    check_file(file, overwrite=overwrite)  # before the page, which takes a second
    write_file(file, page_html(bearing, documents), overwrite=overwrite)
    return file


def page_html(bearing: Bearing | str | Path | None = None, documents: str = "") -> str:
    """Return the live page as HTML; `documents` as of `live_page`."""
    chosen = START if bearing is None else bearing
    start = as_bearing(chosen)
    module = live_module()
    names = list_bearings()
    library: list[Bearing | str] = [name for name in names if name != start.name]
    data = live_data([start, *library], MOTIONS)
    if isinstance(chosen, Bearing):
        file = start.name if start.name in names else f"{start.name}.toml"
    else:
        file = Path(chosen).name  # without its folder, since pages are sent to others
    return assemble(data, module, engine_source(), start.name, file, documents)


def assemble(
    data: dict[str, Any],
    module: bytes,
    engine: str,
    start: str,
    start_file: str,
    documents: str = "",
) -> str:
    """Return the page with some data, module and source of the engine.

    `start` names the bearing that the page opens with; `start_file` is what a command calls it.
    """
    words = tomllib.loads(data_path("live", "words.toml").read_text(encoding="utf-8"))
    script = _bundle([engine, *(_text("live", name) for name in SCRIPTS)])
    css = "\n".join(_text(*parts) for parts in STYLES)
    limits = temperature_limits()
    page = {
        "labels": words.pop("labels"),
        "outcomes": words.pop("outcomes"),
        "words": words,
        "start": start,
        "start_file": start_file,
        "version": version("thermobearing"),
        "slack": SLACK,
        "slack_kelvin": SLACK_KELVIN,
        "damping_share": LARGEST_DAMPING_SHARE,
        "counting": {"extreme": EXTREME, "rest_s": REST},
        "fitting": _fitting(),
        "warm_lead": limits.lead_near_melting * limits.lead_melts,
        "fields": _test_fields(),
        "scaling": EXPONENTS,
        "accelerations": ACCELERATION_UNITS,
        "peaks_gal": ASSERTED,
        "defaults": OPENING,
    }
    texts = {name: escape(word["en"]) for name, word in words.items()}
    link = (
        f'<p><a href="{escape(documents)}" target="_top" data-word="documents"></a></p>'
        if documents
        else ""
    )
    values = texts | {
        "documents_link": WORDED.sub(lambda tag: tag[0] + texts[tag[1]], link),
        "css": css,
        "style_digest": policy_digest(css),
        "script": script,
        "script_digest": policy_digest(script),
        "page_data": json.dumps(page, ensure_ascii=False).replace("<", "\\u003c"),
        "engine_data": pack(json.dumps(data, separators=(",", ":")).encode()),
        "engine_module": pack(module),
    }
    template = WORDED.sub(lambda tag: tag[0] + texts[tag[1]], _text("live", "page.html"))
    return VALUE.sub(lambda place: values[place[1]], template)


def live_script(name: str) -> str:
    """Return a script of `data/live` with the engine and the drawings, which it imports."""
    return _bundle([engine_source(), *(_text("live", file) for file in (SCRIPTS[0], name))])


def _text(*parts: str) -> str:
    return data_path(*parts).read_text(encoding="utf-8")


def _bundle(modules: Iterable[str]) -> str:
    """Return ES modules, which a page on a disk cannot import, as one with separate names."""
    parts = []
    for module in modules:
        names = ", ".join(EXPORTED.findall(module))
        body = EXPORT.sub("", IMPORT.sub("", module))
        parts.append(f"const {{ {names} }} = (() => {{\n{body}\nreturn {{ {names} }};\n}})();")
    return "\n".join(parts)


def pack(raw: bytes) -> str:
    """Return bytes as text for a page: gzip in base64, which `unpacked` of the engine reads."""
    return base64.b64encode(gzip.compress(raw, 9, mtime=0)).decode("ascii")


def _fitting() -> dict[str, Any]:
    """Return the strain [1] above which a bearing is too small for the bridge, and whose it is."""
    code = read_toml(data_path("design", "provisions.toml"))["codes"][0]
    limits = [check["limit"] for check in code["checks"] if check["measure"] == "shear_strain"]
    return {"strain": max(limits), "code": code["title"], "bearing": START}


def _test_fields() -> dict[str, dict[str, Any]]:
    """Return the ranges of the fields of a test, as `check` has them."""
    cycles = {key: field_limits(Cycles, key) for key in ("strain", "frequency", "count")}
    return cycles | {"ambient": field_limits(Case, "initial")}
