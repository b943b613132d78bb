"""What the print has wrong, computed: a function for each row of `data/claims/misprints.toml`."""
