"""Statistics of the runs of a study."""
