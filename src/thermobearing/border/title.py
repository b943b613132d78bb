"""The title block of a document: whose bridge, for whom, by whom; read from a case or options."""

from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import Annotated, Any

import tomli_w
from pydantic import BeforeValidator, Field

from thermobearing.border.errors import InputError, nearest, printable
from thermobearing.border.library import Library
from thermobearing.border.opener import is_file, read_bytes
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml, split_sources

KEY = "report"  # the table of a case file
LARGEST_LOGO = 2_000_000  # bytes
PNG = b"\x89PNG\r\n\x1a\n"


def _line(value: Any) -> Any:
    """Return the text of one line; a date of TOML as text."""
    if isinstance(value, date):
        return value.isoformat()
    return " ".join(printable(value).split()) if isinstance(value, str) else value


Words = Annotated[str, Field(min_length=1, max_length=300), BeforeValidator(_line)]


class TitleBlock(Strict):
    """What stands at the head of a document; the table `[report]` of a case file.

    Words of a line each; `checked` and `approved` name who did so, `number` is that of the
    document, `logo` a PNG or SVG file.
    """

    project: Words | None = None
    structure: Words | None = None
    client: Words | None = None
    author: Words | None = None
    checked: Words | None = None
    approved: Words | None = None
    number: Words | None = None
    revision: Words | None = None
    date: Words | None = None
    logo: Words | None = None

    def words(self) -> dict[str, str]:
        """Return what is given, by the word that stands before it."""
        values = self.model_dump(exclude_none=True, exclude={"logo"})
        # Where the key is not the word.
        labels = {"number": "Document", "checked": "Checked by", "approved": "Approved by"}
        return {labels.get(key, key.capitalize()): value for key, value in values.items()}

    def logo_bytes(self) -> bytes | None:
        """Return the picture."""
        if self.logo is None:
            return None
        raw = read_bytes(Path(self.logo), LARGEST_LOGO)
        if not logo_kind(raw):
            raise InputError("a logo is a PNG or an SVG picture", self.logo)
        return raw

    def over(self, below: "TitleBlock") -> "TitleBlock":
        """Return this title block, with missing values from another one."""
        return below.model_copy(update=self.model_dump(exclude_none=True))

    def to_toml(self) -> str:
        """Return as a file that `read_title` reads."""
        return tomli_w.dumps({KEY: self.model_dump(exclude_none=True)})


def logo_kind(raw: bytes) -> str:
    """Return what a picture is: "png", "svg", or "" where it is neither.

    An SVG that declares entities is none: they can grow without end.
    """
    if raw.startswith(PNG):
        return "png"
    return "svg" if b"<svg" in raw[:4096] and b"<!ENTITY" not in raw else ""


def title_given(words: Sequence[str]) -> TitleBlock:
    """Return the title block of words such as "project=Bridge 12"."""
    table: dict[str, Any] = {}
    for word in words:
        key, equals, value = word.partition("=")
        key = key.strip()
        if not equals:
            raise InputError(f'--title "{word}": give KEY=VALUE, such as project="Bridge 12"')
        if key in table:
            raise InputError(f'--title "{word}": {key} is given more than once')
        if key not in TitleBlock.model_fields:
            raise InputError(f'--title "{word}": no "{key}"{nearest(key, TitleBlock.model_fields)}')
        table[key] = value
    return validated(TitleBlock, table, "--title")


def case_table(path: Path) -> dict[str, Any]:
    """Return the table of a case file without its title block, which no run knows of."""
    table = _read_case(path)
    if KEY in table:
        _title_in(table, path)
        del table[KEY]
    return table


def read_title(path: Path | None) -> TitleBlock:
    """Return the title block of a case file, or of report.toml; an empty one without."""
    if path is None:
        return TitleBlock()
    table = _read_case(path)
    return _title_in(table, path) if KEY in table else TitleBlock()


def _read_case(path: Path) -> dict[str, Any]:
    """Return the table of a file without sources; a name of the library is not a case file."""
    if str(path) in Library("bearing", "bearings").names() and not is_file(path):
        hint = f"a bearing of this name is in the library; choose it with --bearing {path}"
        raise InputError(f"no such file; {hint}", str(path))
    return dict(split_sources(read_toml(path))[0])


def _title_in(table: dict[str, Any], path: Path) -> TitleBlock:
    """Return the title block of a file; its logo is in the same folder."""
    try:
        title = validated(TitleBlock, table[KEY], "")
    except InputError as error:
        raise InputError(error.lines(KEY), str(path)) from None
    if title.logo is None:
        return title
    return title.model_copy(update={"logo": str((path.parent / title.logo).absolute())})
