"""Displacement-controlled tests: case, run, result, views."""
