"""Inspection of laboratory files: their content, and a sidecar that describes it."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
