"""The least-squares calibration of parameters."""
