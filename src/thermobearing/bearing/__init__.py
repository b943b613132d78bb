"""Bearings as data: geometry, materials, calibrated parameters, and the library."""
