"""Sequences of tests on one specimen: case, run, result, report."""
