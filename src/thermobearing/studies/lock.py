"""Two writers of one study are kept apart.

A study is written by one process, or by several that have a part of it each (`--shard i/n`): then
each part by one. Locks belong to the open file, so that the system lets go of them by itself when
a process is killed. Where there are no locks (Windows, some networks) writers are not told apart:
they would do the same work, and put the same files in place.
"""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from thermobearing.border.errors import OutputError
from thermobearing.results.swap import locked


@contextmanager
def only_writer(directory: Path, part: str = "") -> Iterator[None]:
    """Keep others from writing the study, or the part of it.

    Parameters
    ----------
    directory : of the study.
    part : such as "3-of-8"; others may then write other parts. The whole by default.

    Raises
    ------
    OutputError : another process writes it, or nobody can.
    """
    with ExitStack() as stack:
        _lock(stack, directory, directory, shared=bool(part))
        if part:
            own = directory / f".part-{part}"
            try:
                own.touch()
            except OSError as error:
                told = error.strerror or error
                raise OutputError(f"{directory}: cannot be written: {told}") from None
            _lock(stack, own, directory, shared=False)
            stack.callback(own.unlink, missing_ok=True)
        yield


def _lock(stack: ExitStack, path: Path, directory: Path, *, shared: bool) -> None:
    if stack.enter_context(locked(path, wait=False, shared=shared)) is False:
        raise OutputError(
            f"{directory}: another process is writing this study; wait for it, or look at it with "
            "`thermobearing study status`"
        )
