"""Conversion of a bearing to cells, layers and constants of the coupled step."""
