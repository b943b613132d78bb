"""Tests against bearings as they are: nothing is fitted, everything is judged."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
