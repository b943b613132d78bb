"""What came out: labelled datasets, measures per cycle, figures and files. No physics here."""
