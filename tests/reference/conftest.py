"""Doctests are collected from every module: not from one whose package is not installed."""

from importlib.util import find_spec

collect_ignore = [] if find_spec("skfem") else ["fe_heat.py"]
