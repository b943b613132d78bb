"""One browser for all tests of a process that need one."""

from collections.abc import Iterator
from typing import Any

import pytest

from docs.builder.chromium import browser


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    with browser() as running:
        yield running
