"""Inspection of laboratory files: their content, and a sidecar that describes it."""
