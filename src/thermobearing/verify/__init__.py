"""Verification that anyone repeats in a minute: `thermobearing verify`."""
