"""Conversion of a bearing to cells, layers and constants of the coupled step."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
