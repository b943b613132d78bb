"""Structures on bearings: built from bodies and connections, moved by the ground."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
