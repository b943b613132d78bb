"""Files that are written whole or not at all; the user's never over one by accident."""

import os
import secrets
from pathlib import Path

from thermobearing.border.errors import OutputError


def write_whole(target: Path, content: bytes) -> None:
    """Put a file in place when all of it is on the disk, whatever was there before.

    A power cut leaves the earlier one or the new one; a killed program may leave a file beside it,
    whose name begins with a point.
    """
    part = target.with_name(f".{target.name}-{secrets.token_hex(4)}")
    try:
        with part.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, target)
    finally:
        part.unlink(missing_ok=True)


def write_text_file(target: Path, text: str, *, force: bool) -> None:
    """A whole file or none; an earlier one only with `force`.

    Raises
    ------
    OutputError : it exists, or cannot be written.
    """
    try:
        if target.is_dir():
            raise OutputError(f"{target}: is a directory; name a file (-o FILE for a command)")
        if target.exists() and not force:
            raise OutputError(
                f"{target}: exists; give --force (in Python force=True) to replace it, or "
                "choose another file"
            )
        write_whole(target, text.encode("utf-8"))
    except (OSError, ValueError) as error:  # no such directory, a null byte in the name
        told = getattr(error, "strerror", None) or error
        raise OutputError(f"{target}: cannot be written: {told}") from None
