"""Text of a file, whatever a laboratory's programs wrote it in."""

import codecs
import re
from pathlib import Path

from thermobearing.border.errors import InputError, read_bytes, shortened

LARGEST_FILE = 100_000_000  # bytes; in memory, cell by cell, it is ten times that
LOOKED_AT = 20_000  # bytes of lines that are not plain ASCII: enough to tell an encoding
# What Windows writes in Japan and in Western Europe. More would be worse: a head of a few words
# says little, and with all encodings to choose from "初期" is taken for Korean.
LEGACY = ("cp932", "cp1252")
# One half-width katakana among plain letters: "°" or "²" of cp1252 read as cp932.
_LONE_KATAKANA = re.compile(r"(?<![^\x00-\x7f])[｡-ﾟ](?![^\x00-\x7f])")


def read_text(path: Path, encoding: str | None = None) -> str:
    """Text of a file: UTF-8, UTF-16 with its mark, cp932 or cp1252, or as told.

    Parameters
    ----------
    path : the file, of 100 MB at most.
    encoding : as Python names it, if the user tells it.

    Raises
    ------
    InputError : it cannot be read, is no text, or in none of these encodings.
    """
    return decoded(read_bytes(path, LARGEST_FILE), str(path), encoding)


def decoded(raw: bytes, where: str, encoding: str | None = None) -> str:
    """Bytes as text; `where` names them in messages. See `read_text`."""
    if encoding is not None:
        return _as_told(raw, where, encoding)
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return _as_told(raw, where, "utf-16")
    if b"\0" in raw:
        raise InputError("is not a text file: it holds null bytes", where)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return _as_told(raw, where, _legacy(raw, where))


def _as_told(raw: bytes, where: str, encoding: str) -> str:
    try:
        text = raw.decode(encoding)
    except (UnicodeError, LookupError):
        raise InputError(f'is no text in the encoding "{shortened(encoding)}"', where) from None
    if "\0" in text:
        raise InputError("is not a text file: it holds null bytes", where)
    return text


def _legacy(raw: bytes, where: str) -> str:
    """The older encoding that the lines with more than ASCII are in."""
    from charset_normalizer import from_bytes

    telling = b"\n".join(line for line in raw.splitlines() if not line.isascii())[:LOOKED_AT]
    best = from_bytes(telling, cp_isolation=list(LEGACY)).best()
    if best is None:
        raise InputError(
            "is neither UTF-8 nor cp932 nor cp1252 text; save it as UTF-8, or give encoding in "
            "its sidecar",
            where,
        )
    if best.encoding == "cp932":
        strange = re.findall(r"[^\x00-\x7f]", str(best))
        if len(_LONE_KATAKANA.findall(str(best))) == len(strange):
            return "cp1252"
    return str(best.encoding)
