"""What came out: labelled datasets, measures per cycle, figures and files. No physics here."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
