"""A bearing becomes cells, layers and constants of the one coupled step."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
