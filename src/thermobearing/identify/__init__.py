"""From a laboratory's tests to a bearing: records, checks, fit, uncertainty, report."""

from thermobearing.border.deprecated import find_moved

__getattr__ = find_moved(__name__)
