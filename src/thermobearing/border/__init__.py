"""Input of files and values: units, strict schemas, and error messages."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
