"""Results: labelled datasets, measures per cycle, figures and files."""
