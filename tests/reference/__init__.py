"""Second implementations to compare the package with; written from the equations, not its code."""
