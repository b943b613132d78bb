"""A laboratory's files looked at: what is in them, and the sidecar that says so."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
