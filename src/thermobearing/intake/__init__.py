"""A laboratory's files looked at: what is in them, and the sidecar that describes it."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
