"""Ground motions: reading, preparing, spectra, and motions made to fit a spectrum."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
