"""Simulations shared by all tests of the reproduction."""

import pytest

from reproduction.runs import Runs


@pytest.fixture(scope="session")
def runs() -> Runs:
    """One for all tests, as in a process of the program."""
    return Runs()
