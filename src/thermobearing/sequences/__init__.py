"""Tests one after the other on one specimen: case, run, result, views."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
