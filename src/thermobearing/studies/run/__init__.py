"""Execution of a study on processes."""
