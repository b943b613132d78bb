"""pandas and xarray, each imported when an attribute of it is first used.

Together they take as long to import as all else that `tb.run` needs. Modules write

    from thermobearing.border.lazy import pd, xr

and quote annotations ("pd.DataFrame"), which are evaluated where a function is defined.
"""

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

__all__ = ["pd", "xr"]


class _Lazy(ModuleType):
    """A module that is imported when an attribute of it is first used.

    `lazy_loader.load` puts its modules into `sys.modules`, where other packages would import them
    on looking for a DataFrame, and is not safe with threads before Python 3.12.3.
    """

    def __getattr__(self, name: str) -> Any:
        value = getattr(import_module(self.__name__), name)
        setattr(self, name, value)
        return value


if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
else:
    pd, xr = _Lazy("pandas"), _Lazy("xarray")
