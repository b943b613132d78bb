"""What a bearing is: geometry, materials, identified parameters, and the library of them."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
