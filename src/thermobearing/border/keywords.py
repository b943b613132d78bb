"""Former names of keywords and options, and their present form."""

from collections.abc import Iterable


def renamed(name: str, accepted: Iterable[str]) -> str:
    """Return a clause with the new name of an old one that is among the known; else nothing.

    >>> renamed("--force", ["--overwrite", "--json"])
    '; it is called "--overwrite" since version 0.3.0'
    >>> renamed("scheme", ["bearing", "model"])
    '; give it in model = tb.ModelOptions(scheme=...)'
    >>> renamed("--lead-ends", ["--bearing", "--model-option"])
    '; give it as --model-option lead_ends=VALUE'
    """
    # Only a refusal needs these, and a command that prints its help imports none of them.
    from thermobearing.border.library import data_path
    from thermobearing.border.toml import read_toml

    names = list(accepted)
    table = read_toml(data_path("renamed.toml"))
    for row in table["names"]:
        if row["old"] == name and row["new"] in names:
            return f'; it is called "{row["new"]}" since version {row["version"]}'
    key = name.removeprefix("--").replace("-", "_")
    for row in table["grouped"]:
        for new, form in row["forms"].items():
            same_kind = name.startswith("--") == new.startswith("--")
            if key in row["old"] and new in names and same_kind:
                return f"; give it {form.format(key=key)}"
    return ""
