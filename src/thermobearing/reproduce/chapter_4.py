"""What chapter 4 says, computed: a function for each claim of `data/claims/chapter-4.toml`."""
