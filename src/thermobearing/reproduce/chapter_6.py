"""What chapter 6 says, computed: a function for each claim of `data/claims/chapter-6.toml`."""
