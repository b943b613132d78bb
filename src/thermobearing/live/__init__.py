"""The live page: the bearing computes itself in the reader's browser."""
