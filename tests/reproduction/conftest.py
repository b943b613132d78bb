"""Simulations shared by all tests of the reproduction."""

import pytest

from reproduction.runs import Runs


@pytest.fixture(scope="session")
def runs() -> Runs:
    return Runs()
