"""Structures on bearings in earthquakes: case, run, result, views."""
