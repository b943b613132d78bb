"""Validation of bearings against tests, without calibration."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
