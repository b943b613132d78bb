"""Hourly weather: files, synthetic series of a climate, and hours of earthquakes."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
