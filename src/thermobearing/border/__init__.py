"""Input of files and values: units, strict schemas, and error messages."""
