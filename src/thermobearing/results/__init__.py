"""What came out: labelled datasets, measures per cycle, figures and files. No physics here."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
