"""The story: all claims judged, all figures drawn, all tables made, on several processes.

parts of the work -> processes -> rows, figures, tables in the order of the source -> result
"""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

from thermobearing.border.errors import InputError
from thermobearing.reproduce.result import Reproduction
from thermobearing.reproduce.work import CLAIMS, VERDICTS, Done, Part, do, split_parts

Progress = Callable[[int, int], None]
CHAPTERS = (3, 4, 5, 6, 7)
MOST_JOBS = 64


def reproduce_source(
    *,
    chapter: int | None = None,
    figures: bool = True,
    flips: bool = True,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Reproduction:
    """Make the source's tables and figures again, and judge every claim.

    Parameters
    ----------
    chapter : 3 to 7 alone (7: the conclusions), without the tables; all by default.
    figures : draw them too.
    flips : look for the smallest changes that flip a verdict too, which takes most of the time.
    jobs : processes, 1 to 64; as many as there are cores by default.
    progress : called with (parts done, all parts).

    Returns
    -------
    Reproduction : rows that broke are in it, each with its reason.

    Raises
    ------
    InputError : no such chapter, or jobs that no machine has.

    Examples
    --------
    >>> found = reproduce_source(chapter=4, figures=False, flips=False, jobs=1)
    >>> found.counts["failed"]
    0
    """
    if chapter is not None and chapter not in CHAPTERS:
        raise InputError(f"chapter: {chapter} is none of 3, 4, 5, 6, 7", "reproduce_source()")
    if jobs is not None and not 1 <= jobs <= MOST_JOBS:
        raise InputError(f"jobs: {jobs} is not in [1, {MOST_JOBS}]", "reproduce_source()")
    parts = split_parts(chapter, figures=figures, flips=flips)
    done: list[Done] = []
    for item in _carried_out(parts, jobs or os.cpu_count() or 1):
        done.append(item)
        if progress:
            progress(len(done), len(parts))
    return _gathered(chapter, parts, done)


def _carried_out(parts: list[Part], jobs: int) -> Iterator[Done]:
    """What comes of the parts, as they are ready."""
    if jobs == 1:
        yield from map(do, parts)
        return
    # "spawn": a process that is forked while threads run may wait for ever.
    with ProcessPoolExecutor(min(jobs, len(parts) or 1), get_context("spawn")) as pool:
        futures = [pool.submit(do, part) for part in parts]
        try:
            for future in as_completed(futures):
                yield future.result()
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _gathered(chapter: int | None, parts: list[Part], done: Iterable[Done]) -> Reproduction:
    """All in the order of the source."""
    items = list(done)
    rows = {row.claim.id: row for item in items for row in item.rows}
    drawn = {item.drawn.name: item.drawn for item in items if item.drawn}
    tables = {
        name: found
        for item in items
        if item.tables is not None
        for name, found in item.tables.items()
    }
    return Reproduction(
        chapter=chapter,
        rows=[
            rows[name] for part in parts if part.kind in (CLAIMS, VERDICTS) for name in part.names
        ],
        figures=[drawn[name] for name in sorted(drawn)],
        tables={name: tables[name] for name in sorted(tables)},
    )
