"""Definition of a study: factors, distributions, columns and designs."""
