"""Results: labelled datasets, measures per cycle, figures and files."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
