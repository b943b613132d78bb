"""Rubber isolation bearings in the cold: heat conduction coupled to hysteresis.

>>> import thermobearing as tb
>>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1), ambient=-20)
>>> result.outcome
'completed'

The public names are listed in `__init__.pyi`; all else may change without notice. They are imported
when they are first used, so that `import thermobearing` is quick.
"""

from typing import Any

import lazy_loader

__version__ = "0.3.0"

_public_name, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Return a public name; the error for a former one states the present one."""
    if name not in __all__ and not name.startswith("_"):
        from thermobearing.border.keywords import renamed

        if clause := renamed(name, __all__):
            raise AttributeError(f'module "{__name__}" has no attribute "{name}"{clause}')
    return _public_name(name)
