"""Weather by the hour: real files, synthetic series of a climate, an hour for an earthquake."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
