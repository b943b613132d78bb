"""What chapter 7 says, computed: a function for each claim of `data/claims/conclusions.toml`."""
