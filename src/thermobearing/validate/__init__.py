"""Tests against bearings as they are: nothing is fitted, everything is judged."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
