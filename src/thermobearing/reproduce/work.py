"""The parts of the work, each small enough for a process of its own: claims, figures, tables.

A process keeps its simulations between parts. Whatever breaks comes back as a reason in words.
"""

import io
import pkgutil
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module

import pandas as pd

from thermobearing.reproduce import figures as room
from thermobearing.reproduce.claims import PARTS, Claim, load_claims
from thermobearing.reproduce.flips import Variants
from thermobearing.reproduce.rows import ROOM, Row, make_row
from thermobearing.reproduce.runs import Runs

FIGURE = "fig_"  # how the modules of figures begin
TABLES = ("tables", "slips", "joint")  # modules with tables, where they are there
CLAIMS, VERDICTS = "claims", "verdicts"
CHUNK = 5  # claims of one part of the work: neighbours ask for the same simulations


@dataclass(frozen=True)
class Drawn:
    """A figure of the source, drawn again.

    Attributes
    ----------
    name : "fig_4_07".
    caption : what is run and what is drawn; the reason where it could not be drawn.
    image : the PNG file; none where it could not be drawn.
    """

    name: str
    caption: str
    image: bytes | None = None


@dataclass(frozen=True)
class Part:
    """A part of the work: claims to judge, a figure to draw, or the tables of a module.

    Attributes
    ----------
    kind : "claims" (with their flips), "verdicts" (claims without), "figure" or "tables".
    names : ids of claims; of a figure or of tables the module.
    """

    kind: str
    names: tuple[str, ...]


@dataclass(frozen=True)
class Done:
    """What came of a part: rows, or a figure, or tables by name (words where one broke)."""

    part: Part
    rows: tuple[Row, ...] = ()
    drawn: Drawn | None = None
    tables: Mapping[str, pd.DataFrame | str] | None = None


def parts_of(chapter: int | None, *, figures: bool, flips: bool = True) -> list[Part]:
    """All there is to do, the longest first.

    Parameters
    ----------
    chapter : 3 to 7 alone; all by default. The misprints come with all.
    figures : draw them too.
    flips : look for what flips a verdict too.
    """
    found = []
    kind = CLAIMS if flips else VERDICTS
    if chapter is None:
        found += [Part("tables", (name,)) for name in TABLES if _is_there(name)]
    ids = [claim.id for claim in claims_of(chapter)]
    found += [Part(kind, tuple(ids[start : start + CHUNK])) for start in range(0, len(ids), CHUNK)]
    if figures:
        drawn = [name for name in figure_names() if chapter in (None, chapter_of(name))]
        found += [Part("figure", (name,)) for name in drawn]
    return found


def claims_of(chapter: int | None) -> list[Claim]:
    """The claims of one chapter, or all; chapter 7 is "conclusions"."""
    if chapter is None:
        return load_claims()
    part = "conclusions" if chapter == 7 else f"chapter-{chapter}"
    return load_claims(part) if part in PARTS else []


def figure_names() -> list[str]:
    """Modules of figures, in the order of the source."""
    found = [item.name for item in pkgutil.iter_modules(room.__path__)]
    return sorted(name for name in found if name.startswith(FIGURE))


def chapter_of(figure: str) -> int:
    """Of a module's name.

    Examples
    --------
    >>> chapter_of("fig_4_07")
    4
    """
    return int(figure.split("_")[1])


def _is_there(module: str) -> bool:
    package = import_module(ROOM)
    return any(item.name == module for item in pkgutil.iter_modules(package.__path__))


@cache
def _runs() -> Runs:
    return Runs()


@cache
def _variants() -> Variants:
    return Variants(_runs())


@cache
def _known() -> dict[str, Claim]:
    return {claim.id: claim for claim in load_claims()}


def do(part: Part) -> Done:
    """Carry out a part; never raises for what breaks in it."""
    if part.kind in (CLAIMS, VERDICTS):
        variants = _variants() if part.kind == CLAIMS else None
        claims = [_known()[name] for name in part.names]
        return Done(part, rows=tuple(make_row(claim, _runs(), variants) for claim in claims))
    if part.kind == "figure":
        return Done(part, drawn=draw(part.names[0]))
    return Done(part, tables=tables_of(part.names[0]))


def draw(name: str) -> Drawn:
    """A figure by its module."""
    from thermobearing.results.drawing import save_figure

    try:
        module = import_module(f"{room.__name__}.{name}")
        picture = io.BytesIO()
        save_figure(module.draw(_runs()), picture)
        return Drawn(name, str(module.CAPTION), picture.getvalue())
    except Exception as error:
        return Drawn(name, reason(error))


def tables_of(module: str) -> Mapping[str, pd.DataFrame | str]:
    """The tables of a module by name; the reason instead where it breaks."""
    try:
        found: Mapping[str, pd.DataFrame] = import_module(f"{ROOM}.{module}").all_tables(_runs())
        return dict(found)
    except Exception as error:
        return {module: reason(error)}


def reason(error: Exception) -> str:
    """What broke, in a line."""
    told = str(error).splitlines()[0] if str(error) else "no reason given"
    return f"failed: {type(error).__name__}: {told}"
