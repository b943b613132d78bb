"""Ground motions: reading, preparing, spectra, and motions made to fit a spectrum."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
