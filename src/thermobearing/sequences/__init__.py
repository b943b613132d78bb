"""Sequences of tests on one specimen: case, run, result, report."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
