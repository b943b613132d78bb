"""Ground motions: reading, processing, spectra, and spectrum-compatible motions."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
