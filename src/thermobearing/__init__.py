"""Rubber isolation bearings in the cold: heat conduction coupled to hysteresis.

>>> import thermobearing as tb
>>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1), ambient=-20)
>>> result.outcome
'completed'

The public names are listed in `__init__.pyi`; all else may change without notice. They are imported
when they are first used, so that `import thermobearing` is quick.
"""

import lazy_loader

__version__ = "0.3.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
