"""All claims judged, all figures drawn, all tables made, on several processes.

The work has parts, each small enough for a process of its own, which keeps its simulations between
parts. Whatever breaks comes back as a reason in words.
"""

import io
import os
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import pandas as pd

from reproduction import joint, slips, tables
from reproduction.claims import PARTS, Claim, Row, Variants, failure, load_claims, make_row
from reproduction.figures import Row as FigureRow
from reproduction.figures import load_figures
from reproduction.records import check_records
from reproduction.report import Drawn, Reproduction
from reproduction.runs import Runs
from thermobearing.border.errors import InputError
from thermobearing.results.drawing import holds_data, save_figure

CLAIMS, VERDICTS = "claims", "verdicts"  # kinds of parts, as the next three
FIGURE, TABLES, BOTH = "figure", "tables", "tables and figure"
WITH_TABLES: dict[str, ModuleType] = {"tables": tables, "slips": slips, "joint": joint}
CHUNK = 5  # claims of one part of the work: neighbours ask for the same simulations
CHAPTERS = (3, 4, 5, 6, 7)
MOST_JOBS = 64


class Part(NamedTuple):
    """Claims to judge by id (with flips, or "verdicts" alone), a figure, or tables of a module."""

    kind: str
    names: tuple[str, ...]


class Done(NamedTuple):
    """What came of a part: rows, or a figure, or tables by name (words where one broke)."""

    part: Part
    rows: tuple[Row, ...] = ()
    drawn: Drawn | None = None
    tables: Mapping[str, pd.DataFrame | str] = {}


def split_parts(chapter: int | None, *, figures: bool, flips: bool = True) -> list[Part]:
    """Return all there is to do for a chapter, or for all with tables and misprints."""
    parts = []
    if chapter is None:
        parts += [Part(BOTH if figures and k == "slips" else TABLES, (k,)) for k in WITH_TABLES]
    ids = [claim.id for claim in list_claims(chapter)]
    kind = CLAIMS if flips else VERDICTS
    parts += [Part(kind, tuple(ids[start : start + CHUNK])) for start in range(0, len(ids), CHUNK)]
    return parts + [Part(FIGURE, (name,)) for name in list_figures(chapter) if figures]


def list_claims(chapter: int | None) -> tuple[Claim, ...]:
    """Return the claims of one chapter, or all; chapter 7 is "conclusions"."""
    if chapter is None:
        return load_claims()
    part = "conclusions" if chapter == 7 else f"chapter-{chapter}"
    return load_claims(part) if part in PARTS else ()


def list_figures(chapter: int | None) -> dict[str, FigureRow]:
    """Return the figures of one chapter, or all, by name ("fig_4_01")."""
    rows = [row for row in load_figures().values() if chapter in (None, int(row.number[0]))]
    return {row.name: row for row in rows}


@cache
def _runs(records: Path | None = None) -> Runs:
    return Runs(records=records)


@cache
def _variants(records: Path | None) -> Variants:
    return Variants(_runs(records))


@cache
def _claims_by_id() -> dict[str, Claim]:
    return {claim.id: claim for claim in load_claims()}


def carry_out(part: Part, records: Path | None = None) -> Done:
    """Carry out a part, with a folder of records or none; never raise for what breaks in it."""
    if part.kind in (CLAIMS, VERDICTS):
        variants = _variants(records) if part.kind == CLAIMS else None
        rows = tuple(
            make_row(_claims_by_id()[name], _runs(records), variants) for name in part.names
        )
        return Done(part, rows)
    (name,) = part.names
    drawn = draw(name) if part.kind in (FIGURE, BOTH) else None
    return Done(part, (), drawn, make_tables(name) if part.kind in (TABLES, BOTH) else {})


def draw(name: str) -> Drawn:
    """Draw a figure by its name."""
    try:
        picture = io.BytesIO()
        if name == "slips":
            rows = _runs().once(slips.slip_rows, "slips")
            figure, caption = slips.draw_slips(rows), slips.CAPTION
        else:
            row = list_figures(None)[name]
            figure, caption = row.figure(_runs()), row.caption
        if not holds_data(figure):
            raise ValueError(f"the figure {name} holds no data")
        save_figure(figure, picture)
        return Drawn(name, caption, picture.getvalue())
    except Exception as error:  # whatever breaks is said in its place; the others go on
        return Drawn(name, failure(error))


def make_tables(name: str) -> Mapping[str, pd.DataFrame | str]:
    """Return the tables of a module by name; the reason instead where it breaks."""
    try:
        tables: Mapping[str, pd.DataFrame | str] = WITH_TABLES[name].all_tables(_runs())
        return tables
    except Exception as error:  # likewise
        return {name: failure(error)}


def reproduce(
    *,
    chapter: int | None = None,
    figures: bool = True,
    flips: bool = True,
    records: Path | None = None,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Reproduction:
    """Make the tables and figures of Shen (2023) again, and judge every claim.

    Parameters
    ----------
    chapter : 3 to 7 alone (7: the conclusions), without the tables; all by default.
    figures : draw them too.
    flips : look for the smallest changes that flip a verdict too, which takes most of the time.
    records : folder of records of the tests, which judge the rows that need them.
    jobs : processes, 1 to 64; as many as there are cores by default.
    progress : called with (parts done, all parts).
    """
    if chapter is not None and chapter not in CHAPTERS:
        raise InputError(f"chapter: {chapter} is none of 3, 4, 5, 6, 7", "reproduce()")
    if jobs is not None and not 1 <= jobs <= MOST_JOBS:
        raise InputError(f"jobs: {jobs} is not in [1, {MOST_JOBS}]", "reproduce()")
    files = check_records(records) if records else {}
    parts = split_parts(chapter, figures=figures, flips=flips)
    finished: dict[Part, Done] = {}

    def note(item: Done) -> None:
        finished[item.part] = item
        if progress:
            progress(len(finished), len(parts))

    if jobs == 1:
        for part in parts:
            note(carry_out(part, records))
    else:
        _spread(parts, records, jobs or os.cpu_count() or 1, note)
    items = [finished[part] for part in parts]
    drawn = [item.drawn for item in items if item.drawn]
    tables = {name: table for item in items for name, table in item.tables.items()}
    return Reproduction(
        chapter=chapter,
        rows=[row for item in items for row in item.rows],
        figures=sorted(drawn, key=lambda item: item.name),
        tables_by_name=dict(sorted(tables.items())),
        records=files,
    )


def _spread(
    parts: list[Part], records: Path | None, jobs: int, note: Callable[[Done], None]
) -> None:
    # "spawn": a process that is forked while threads run may wait for ever.
    with ProcessPoolExecutor(min(jobs, len(parts) or 1), get_context("spawn")) as pool:
        futures = [pool.submit(carry_out, part, records) for part in parts]
        try:
            for future in as_completed(futures):
                note(future.result())
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
