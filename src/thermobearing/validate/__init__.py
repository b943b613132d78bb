"""Validation of bearings against tests, without calibration."""
