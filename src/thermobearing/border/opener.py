"""Files that somebody gives: opened here only, as regular files of limited size.

A named pipe waits for a writer, a terminal for a line, a device is endless. They are recognised
once the file is open, so that nothing can be put in its place after the check.
"""

import errno
import hashlib
import io
import json
import os
import select
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO

from thermobearing.border.errors import (
    LONGEST_NAME,
    STEM_SIMILARITY,
    InputError,
    shortened,
    suggestion,
)

MOST_SIBLINGS = 2000  # files of a folder that are searched for a similar name
LARGEST_MEMBER = 100_000_000  # bytes of a summary, a table or a picture in a result directory
LARGEST_STORE = 20_000_000_000  # bytes of a netCDF or Parquet file, which are read in parts
PATIENCE = 30.0  # [s] that a pipe of the shell may stay without data
BLOCK = 1 << 16  # bytes of a pipe that are read at a time
# A pipe does not wait for its writer; a terminal does not become that of the process.
FLAGS = (
    os.O_RDONLY
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_NOCTTY", 0)
    | getattr(os, "O_CLOEXEC", 0)
    | getattr(os, "O_BINARY", 0)
)
PIPES = ("/dev/fd/", "/dev/stdin", "/proc/self/fd/")  # `<(command)` and `-` of a shell
KINDS = (
    (stat.S_ISDIR, "is a directory, not a file"),
    (stat.S_ISFIFO, "is a named pipe, not a file"),
    (stat.S_ISSOCK, "is a socket, not a file"),
    (stat.S_ISCHR, "is a device, not a file"),
    (stat.S_ISBLK, "is a device, not a file"),
)


@contextmanager
def opened(path: Path, limit: int) -> Iterator[BinaryIO]:
    """Open a regular file of at most `limit` bytes for reading.

    Raises
    ------
    InputError : no such file, with the nearest name; a directory, pipe, socket or device; a file
        that is larger than the limit or cannot be read, also where its reader raises OSError.
    """
    name = shortened(str(path), LONGEST_NAME)
    try:
        with _open(path, limit, name) as file:
            yield file
    except OSError as error:  # a failing disk
        raise InputError(f"cannot be read: {error.strerror or error}", name) from None


def _open(path: Path, limit: int, name: str) -> BinaryIO:
    """Return the open file, or what a pipe of the shell holds."""
    try:
        handle = os.open(path, FLAGS)
    except FileNotFoundError:
        raise InputError(f"no such file{_similar_name(path)}", name) from None
    except (IsADirectoryError, PermissionError) as error:  # Windows refuses to open a directory
        fault = f"cannot be read: {error.strerror}"
        raise InputError(KINDS[0][1] if is_folder(path) else fault, name) from None
    except OSError as error:  # a name too long, a loop of links
        is_socket = error.errno == errno.ENXIO
        fault = f"cannot be read: {error.strerror or error}"
        raise InputError("is a socket, not a file" if is_socket else fault, name) from None
    except ValueError as error:  # a null byte in the path
        raise InputError(f"cannot be read: {error}", repr(name)) from None
    try:
        status = os.fstat(handle)
        if stat.S_ISFIFO(status.st_mode) and str(path).startswith(PIPES):
            content = _read_pipe(handle, limit, name)
            os.close(handle)
            return io.BytesIO(content)
        if not stat.S_ISREG(status.st_mode):
            kinds = (words for is_kind, words in KINDS if is_kind(status.st_mode))
            raise InputError(next(kinds, "is not a regular file"), name)
        _refuse_large(status.st_size, limit, name)
        return os.fdopen(handle, "rb")
    except BaseException:
        os.close(handle)
        raise


def _read_pipe(handle: int, limit: int, name: str) -> bytes:
    """Return what another program writes into a pipe of the shell."""
    content = bytearray()
    while select.select([handle], [], [], PATIENCE)[0]:
        block = os.read(handle, BLOCK)
        if not block:
            return bytes(content)
        content += block
        _refuse_large(len(content), limit, name)
    raise InputError(f"is a pipe without data for {PATIENCE:g} s", name)


def _refuse_large(size: int, limit: int, name: str) -> None:
    if size > limit:
        raise InputError(f"is larger than {limit / 1e6:g} MB", name)


def _similar_name(path: Path) -> str:
    """Return a clause with a file of nearly that name, or nothing."""
    with suppress(OSError, ValueError):
        siblings = sorted(islice(path.parent.iterdir(), MOST_SIBLINGS))
        siblings.sort(key=lambda item: item.suffix == path.suffix)  # the last of a stem counts
        names = {item.stem: item.name for item in siblings}
        return suggestion(path.stem, names, STEM_SIMILARITY)
    return ""


def read_bytes(path: Path, limit: int) -> bytes:
    """Return the content of a file of at most `limit` bytes; see `opened`."""
    with opened(path, limit) as file:
        # Files of the system state no size; one byte more than allowed shows that one is too large.
        raw = file.read(limit + 1) or b""
    _refuse_large(len(raw), limit, shortened(str(path), LONGEST_NAME))
    return raw


def file_digest(path: Path, limit: int) -> str:
    """Return the SHA-256 of a file of at most `limit` bytes, as `sha256sum` prints it."""
    with opened(path, limit) as file:
        digest = hashlib.sha256()
        while block := file.read(BLOCK):
            digest.update(block)
    return digest.hexdigest()


def read_json(path: Path, limit: int = LARGEST_MEMBER) -> Any:
    """Return the content of a JSON file; InputError if it is none, see also `opened`."""
    raw = read_bytes(path, limit)
    try:
        return json.loads(raw)
    except (ValueError, RecursionError) as error:  # a number of thousands of digits, nesting
        name = shortened(str(path), LONGEST_NAME)
        raise InputError(f"is not valid JSON: {shortened(str(error))}", name) from None


def append_text(path: Path, text: str) -> None:
    """Append to a file, created where there is none; OSError for one that nobody reads from."""
    flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_NONBLOCK", 0)
    with os.fdopen(os.open(path, flags, 0o666), "a", encoding="utf-8") as file:
        file.write(text)


def is_file(path: Path) -> bool:
    """Return whether a file exists; False for impossible names, such as too long ones."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_folder(path: Path) -> bool:
    """Return whether a folder exists; False for impossible names."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False
