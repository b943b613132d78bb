"""Atomic writing of files; existing files are only replaced on request."""

import errno
import os
import re
import secrets
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from thermobearing.border.errors import OutputError


def write_through(file: Path, raw: bytes) -> None:
    """Write a file and flush it to disk: some disks report late that they are full."""
    with file.open("wb") as stream:
        if stream.write(raw) != len(raw):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        stream.flush()
        os.fsync(stream.fileno())


@contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """Yield a hidden temporary file that replaces the target (which need not exist) at the end.

    A killed program may leave it behind; its name begins with a point.
    """
    part = target.with_name(f".{target.name}-{secrets.token_hex(4)}")
    try:
        yield part
        os.replace(part, target)
    finally:
        part.unlink(missing_ok=True)


def write_whole(target: Path, content: bytes) -> None:
    """Move a file into place after it has been flushed to disk.

    After a power cut the earlier or the new file exists.
    """
    with replacing(target) as part:
        write_through(part, content)


def file_names(names: Iterable[str]) -> list[str]:
    """Return unique names that are valid file names on any system.

    >>> file_names(["HDR 1/6", "HDR 1:6", "\u514d\u9707"])
    ['HDR-1-6', 'HDR-1-6-2', '\u514d\u9707']
    """
    unique_names: list[str] = []
    for name in names:
        stem = re.sub(r"[^\w.+-]+", "-", name)[:80] or "file"
        count = sum(earlier == stem or earlier.startswith(f"{stem}-") for earlier in unique_names)
        unique_names.append(stem if stem not in unique_names else f"{stem}-{count + 1}")
    return unique_names


def check_file(target: Path, *, overwrite: bool) -> None:
    """Refuse a file that exists (without `overwrite`), and a directory in its place."""
    try:
        if target.is_dir():
            raise OutputError(f"{target}: is a directory; name a file (-o FILE for a command)")
        if target.exists() and not overwrite:
            raise OutputError(
                f"{target}: exists; give --overwrite (in Python overwrite=True) to replace it, or "
                "choose another file"
            )
    except (OSError, ValueError) as error:  # a name too long, a null byte in it
        raise _write_error(target, error) from None


def write_file(target: Path, content: str | bytes, *, overwrite: bool) -> None:
    """Write a file atomically; OutputError if it exists (without `overwrite`) or on failure."""
    check_file(target, overwrite=overwrite)
    try:
        write_whole(target, content.encode("utf-8") if isinstance(content, str) else content)
    except (OSError, ValueError) as error:  # no such directory, a full disk
        raise _write_error(target, error) from None


def _write_error(target: Path, error: Exception) -> OutputError:
    """Return the error for a file that the system does not write."""
    return OutputError(f"{target}: cannot be written: {getattr(error, 'strerror', None) or error}")
