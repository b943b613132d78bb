"""The border: text with units becomes plain numbers; clear faults."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
