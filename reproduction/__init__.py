"""Reproduction of the tables, figures and statements of Shen (2023) from our data files and code.

It is a separate program next to the package: `python -m reproduction --help`.
"""
