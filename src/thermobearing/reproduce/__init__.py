"""The source again: its tables, figures and claims from our data files and code alone."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
