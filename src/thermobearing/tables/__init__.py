"""Tables of numbers read from files: laboratory tests, motions, weather, spectra."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
