"""Test records: reading, checks, treatment and measures."""
