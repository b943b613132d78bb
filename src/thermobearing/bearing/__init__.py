"""Bearings as data: geometry, materials, calibrated parameters, and the library."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
