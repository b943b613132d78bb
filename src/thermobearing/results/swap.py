"""A new directory takes the place of an earlier one, whoever else is writing or is killed.

The new directory is made beside the final one under a hidden name, and locked while its
process lives: what is not locked was left over by a process that was killed, and the next run
takes it away. Locks belong to the open file, so that the system lets go of them by itself.
"""

import ctypes
import hashlib
import os
import secrets
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: two runs with one target are then not told apart
    fcntl = None  # type: ignore[assignment]

# Writers of results have a folder for milliseconds, a study for as long as it runs.
PATIENCE, POLL = 2.0, 0.05  # [s]
AT_FDCWD, RENAME_EXCHANGE = -100, 2  # of renameat2(2)


def _marks(final: Path) -> tuple[str, str]:
    """How the hidden siblings of a directory begin: one being written, one being replaced."""
    short = hashlib.sha256(os.fsencode(final.name)).hexdigest()[:12]  # a name may be long
    return f".thermobearing-writing-{short}-", f".thermobearing-old-{short}-"


@contextmanager
def locked(path: Path, *, wait: bool = True, shared: bool = False) -> Iterator[bool | None]:
    """Keep others from the same file or directory; whether that was possible.

    Parameters
    ----------
    path : that is there.
    wait : until nobody else has it, `PATIENCE` at most.
    shared : with others that share it too.

    Returns
    -------
    context : of True; of False where somebody has it; of None where there are no locks.
    """
    with ExitStack() as stack:
        held: bool | None = True
        try:
            handle = os.open(path, os.O_RDONLY)
            stack.callback(os.close, handle)
            how = fcntl.LOCK_SH if shared else fcntl.LOCK_EX
            until = time.monotonic() + (PATIENCE if wait else 0.0)
            while not (held := _taken(handle, how)) and time.monotonic() < until:
                time.sleep(POLL)
        except (OSError, AttributeError):  # not readable; no locks there, or none at all
            held = None
        yield held


def _taken(handle: int, how: int) -> bool:
    """Whether nobody else has the lock."""
    try:
        fcntl.flock(handle, how | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


@contextmanager
def new_sibling(final: Path) -> Iterator[Path]:
    """An empty hidden directory beside `final`; what killed runs left there is removed.

    A folder that another process keeps to itself (a running study) is written into as well, so
    that no result is lost; nothing is then removed from it.
    """
    partial = final.parent / f"{_marks(final)[0]}{secrets.token_hex(4)}"
    with ExitStack() as alive:
        with locked(final.parent) as alone:
            if alone:
                _clean(final)
            partial.mkdir()
            alive.enter_context(locked(partial))
        yield partial


def _clean(final: Path) -> None:
    """Take away what killed runs left, and bring back a result that one was replacing."""
    writing, old = _marks(final)
    for path in list(final.parent.iterdir()):
        if path.name.startswith(writing):
            with locked(path, wait=False) as abandoned:
                if abandoned:
                    shutil.rmtree(path, ignore_errors=True)
        elif path.name.startswith(old):
            if final.exists():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.rename(final)


def put_in_place(partial: Path, final: Path, check: Callable[[], None]) -> None:
    """Make a finished directory the final one; an earlier one is then under the hidden name.

    Parameters
    ----------
    partial : from `new_sibling`.
    final : there or not; the earlier one comes back whatever stops this.
    check : raises if `final` must not be replaced.
    """
    with locked(final.parent):
        check()
        if not final.exists():
            partial.rename(final)
        elif not _exchange(partial, final):
            _replace(partial, final)


def _exchange(first: Path, second: Path) -> bool:
    """Swap two directories in one step; False where the system cannot."""
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError, TypeError):  # not Linux
        return False
    names = os.fsencode(first), os.fsencode(second)
    return bool(renameat2(AT_FDCWD, names[0], AT_FDCWD, names[1], RENAME_EXCHANGE) == 0)


def _replace(partial: Path, final: Path) -> None:
    """The same in two steps, between which `_clean` of the next run would find the earlier one."""
    old = final.parent / f"{_marks(final)[1]}{secrets.token_hex(4)}"
    try:
        final.rename(old)
        partial.rename(final)
    except BaseException:  # Ctrl-C too
        if old.exists() and not final.exists():
            old.rename(final)
        raise
    shutil.rmtree(old, ignore_errors=True)
