"""Weather by the hour: real files, synthetic series of a climate, an hour for an earthquake."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
