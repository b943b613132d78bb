"""A text file of the user's: written whole or not at all, and never over one by accident."""

import os
import secrets
from pathlib import Path

from thermobearing.border.errors import OutputError


def write_text_file(target: Path, text: str, *, force: bool) -> None:
    """A whole file or none; an earlier one only with `force`.

    Raises
    ------
    OutputError : it exists, or cannot be written.
    """
    try:
        if target.is_dir():
            raise OutputError(f"{target}: is a directory; name a file (-o FILE for a command)")
        part = target.with_name(f".{target.name}-{secrets.token_hex(4)}")
        if target.exists() and not force:
            raise OutputError(
                f"{target}: exists; give --force (in Python force=True) to replace it, or "
                "choose another file"
            )
        try:
            part.write_text(text, encoding="utf-8")
            os.replace(part, target)
        finally:
            part.unlink(missing_ok=True)
    except (OSError, ValueError) as error:  # no such directory, a null byte in the name
        told = getattr(error, "strerror", None) or error
        raise OutputError(f"{target}: cannot be written: {told}") from None
