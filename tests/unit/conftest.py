"""Fixtures of several files of unit tests."""

from collections.abc import Iterator
from pathlib import Path

import pytest


@pytest.fixture
def no_other_laws(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Begin without registered laws, and leave none that bearings loaded later would get."""
    from thermobearing import laws

    monkeypatch.setattr(laws, "_REGISTERED", {})
    yield
    assert not laws.laws_to_apply()


@pytest.fixture
def law_file(tmp_path: Path) -> Path:
    """File that registers a law."""
    from tests.unit.laws import ARRHENIUS

    path = tmp_path / "my_law.py"
    path.write_text(ARRHENIUS)
    return path
