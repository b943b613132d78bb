"""Two writers of one study are kept apart.

A study is written by one process, or by several that have a part of it each (`--shard i/n`): then
each part by one. Locks belong to the open file, so that the system lets go of them by itself when
a process is killed. Where there are no locks (Windows, some networks) writers are not told apart:
they would do the same work, and put the same files in place.
"""

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from thermobearing.border.errors import OutputError

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]


@contextmanager
def only_writer(directory: Path, part: str = "") -> Iterator[None]:
    """Keep others from writing the study, or the part of it.

    Parameters
    ----------
    directory : of the study.
    part : such as "3-of-8"; others may then write other parts. The whole by default.

    Raises
    ------
    OutputError : another process writes it.
    """
    with ExitStack() as stack:
        _lock(stack, directory, directory, shared=bool(part))
        if part:
            own = directory / f".part-{part}"
            own.touch()
            _lock(stack, own, directory, shared=False)
            stack.callback(own.unlink, missing_ok=True)
        yield


def _lock(stack: ExitStack, path: Path, directory: Path, *, shared: bool) -> None:
    if fcntl is None:
        return
    handle = os.open(path, os.O_RDONLY)
    stack.callback(os.close, handle)
    try:
        fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        raise OutputError(
            f"{directory}: another process is writing this study; wait for it, or look at it with "
            "`thermobearing study status`"
        ) from None
    except OSError:  # no locks there
        return
