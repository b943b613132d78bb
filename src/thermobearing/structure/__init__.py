"""Structures on bearings: built from bodies and connections, moved by the ground."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
