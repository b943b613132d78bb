"""Uncertainty of calibrated parameters, and agreement with the tests."""
