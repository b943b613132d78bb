"""What a designer needs: sizing, the design loop, temperature factors and bounds."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
