"""Equivalent properties of bearing lines and bridges, in tables and for other programs."""
