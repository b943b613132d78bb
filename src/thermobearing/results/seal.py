"""A seal on result.nc: a file that was cut off or changed is told before anything reads it.

HDF5 trusts what it finds in a file: a few changed bytes can keep it busy for ever, inside a
call that no signal interrupts. So the digest of the content is appended to the file, where
netCDF readers do not look.
"""

import hashlib
from pathlib import Path

from thermobearing.border.errors import InputError

MARK = b"\nthermobearing sha256 "
DIGEST = 64  # characters
BLOCK = 1 << 20  # bytes read at a time


def _digest(file: Path, size: int) -> bytes:
    """Of the first bytes of a file, as text."""
    found = hashlib.sha256()
    with file.open("rb") as stream:
        while size > 0 and (block := stream.read(min(BLOCK, size))):
            found.update(block)
            size -= len(block)
    return found.hexdigest().encode()


def seal(file: Path) -> None:
    """Append the digest of what a file holds."""
    digest = _digest(file, file.stat().st_size)
    with file.open("ab") as stream:
        stream.write(MARK + digest)


def check_seal(file: Path) -> None:
    """Refuse a file that does not end with the digest of what is before it.

    Raises
    ------
    InputError : it has no seal, or is not as it was when it was sealed.
    """
    try:
        size = file.stat().st_size - len(MARK) - DIGEST
        with file.open("rb") as stream:
            stream.seek(max(size, 0))
            end = stream.read()
        whole = end == MARK + _digest(file, size)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", str(file)) from None
    if not end.startswith(MARK):
        raise InputError(
            "is not a result file of thermobearing, or its end is missing, or another program "
            "(or an earlier version) wrote it; run its case again",
            str(file),
        )
    if not whole:
        raise InputError("is damaged: it was changed after it was written", str(file))
