"""Studies of very many runs: factors, designs, an engine, a store, and what is drawn from it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
