"""The parts of the work, each small enough for a process of its own: claims, figures, tables.

A process keeps its simulations between parts. Whatever breaks comes back as a reason in words.
"""

import io
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import ModuleType

import pandas as pd

from thermobearing.reproduce import joint, slips, tables
from thermobearing.reproduce import slips as slips_figure
from thermobearing.reproduce.claims import (
    PARTS,
    Claim,
    Row,
    Variants,
    load_claims,
    make_row,
    reason,
)
from thermobearing.reproduce.figures import Row as FigureRow
from thermobearing.reproduce.figures import load_figures
from thermobearing.reproduce.runs import Runs

CLAIMS, VERDICTS = "claims", "verdicts"  # kinds of parts, as the next three
FIGURE, TABLES, BOTH = "figure", "tables", "tables and figure"
WITH_TABLES: dict[str, ModuleType] = {"tables": tables, "slips": slips, "joint": joint}
OWN_FIGURES: dict[str, ModuleType] = {"slips": slips_figure}  # drawn beside the tables of that name
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
    kind : "claims" (with their flips), "verdicts" (claims without), "figure", "tables", or
        "tables and figure" of the same numbers.
    names : ids of claims; or of the module alone.
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


def split_parts(chapter: int | None, *, figures: bool, flips: bool = True) -> list[Part]:
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
        both = OWN_FIGURES if figures else {}
        found += [Part(BOTH if name in both else TABLES, (name,)) for name in WITH_TABLES]
    ids = [claim.id for claim in list_claims(chapter)]
    found += [Part(kind, tuple(ids[start : start + CHUNK])) for start in range(0, len(ids), CHUNK)]
    if figures:
        found += [Part(FIGURE, (name,)) for name in report_figures(chapter)]
    return found


def list_claims(chapter: int | None) -> list[Claim]:
    """The claims of one chapter, or all; chapter 7 is "conclusions"."""
    if chapter is None:
        return load_claims()
    part = "conclusions" if chapter == 7 else f"chapter-{chapter}"
    return load_claims(part) if part in PARTS else []


def report_figures(chapter: int | None) -> dict[str, FigureRow]:
    """Return the figures of one chapter, or all, by name.

    Examples
    --------
    >>> next(iter(report_figures(4)))
    'fig_4_01'
    """
    return {
        row.name: row
        for number, row in load_figures().items()
        if chapter in (None, int(number.partition(".")[0]))
    }


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
    (name,) = part.names
    return Done(
        part,
        drawn=draw(name) if part.kind in (FIGURE, BOTH) else None,
        tables=report_tables_by_name(name) if part.kind in (TABLES, BOTH) else None,
    )


def draw(name: str) -> Drawn:
    """A figure by its module."""
    from thermobearing.results.drawing import save_figure

    try:
        picture = io.BytesIO()
        if name in OWN_FIGURES:
            own = OWN_FIGURES[name]
            figure, caption = own.draw(_runs()), str(own.CAPTION)
        else:
            row = report_figures(None)[name]
            figure, caption = row.figure(_runs()), row.caption
        save_figure(figure, picture)
        return Drawn(name, caption, picture.getvalue())
    except Exception as error:  # whatever breaks is told in its place; the others go on
        return Drawn(name, reason(error))


def report_tables_by_name(name: str) -> Mapping[str, pd.DataFrame | str]:
    """The tables of a module by name; the reason instead where it breaks."""
    try:
        found: Mapping[str, pd.DataFrame] = WITH_TABLES[name].all_tables(_runs())
        return dict(found)
    except Exception as error:  # likewise
        return {name: reason(error)}
