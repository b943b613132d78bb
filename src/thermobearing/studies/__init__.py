"""Studies of very many runs: factors, designs, an engine, a store, and what is drawn from it."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
