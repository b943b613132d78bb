"""The source again: its tables, figures and claims from our data files and code alone."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
