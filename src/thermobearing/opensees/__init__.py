"""Bearings as elements of OpenSees models: wire format, server, result, report."""

from thermobearing.opensees.material import Material, add_material, write_material

__all__ = ["Material", "add_material", "write_material"]
