"""Inputs of the runs of a study, loaded or computed once."""
