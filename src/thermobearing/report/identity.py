"""What makes a result again: version, hash of what went in, the command."""

import hashlib


def identity_of(
    version: str, went_in: str, again: str, what: str = "case.resolved.toml"
) -> dict[str, str]:
    """Rows of the last table of a document.

    Parameters
    ----------
    version : of thermobearing.
    went_in : text whose bits make the result: the resolved case.
    again : the command.
    what : the text is.

    Examples
    --------
    >>> identity_of("0.2.0", "", "thermobearing cyclic case.resolved.toml")["Version"]
    'thermobearing 0.2.0'
    """
    digest = hashlib.sha256(went_in.encode("utf-8", "surrogateescape")).hexdigest()
    return {
        "Version": f"thermobearing {version}",
        f"Input (SHA-256 of {what})": digest,
        "Command": again,
    }
