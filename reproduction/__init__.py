"""Shen (2023) again: its tables, figures and statements from our data files and code alone.

A program of its own beside the package: `python -m reproduction --help`.
"""
