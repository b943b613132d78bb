"""Bearings as elements of OpenSees models: wire format, server, result, report."""

from typing import TYPE_CHECKING

import lazy_loader  # type: ignore[import-untyped]

if TYPE_CHECKING:
    from thermobearing.opensees.line import Line as Line
    from thermobearing.opensees.line import ServingError as ServingError
    from thermobearing.opensees.line import replace_elements as replace_elements
    from thermobearing.opensees.line import serve as serve
    from thermobearing.opensees.material import Material as Material
    from thermobearing.opensees.material import add_material as add_material
    from thermobearing.opensees.material import write_material as write_material
    from thermobearing.opensees.script import write_structure as write_structure

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "line": ["Line", "ServingError", "replace_elements", "serve"],
        "material": ["Material", "add_material", "write_material"],
        "script": ["write_structure"],
    },
)
