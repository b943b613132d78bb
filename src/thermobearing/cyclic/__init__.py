"""Displacement-controlled tests: case, run, result, views."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
