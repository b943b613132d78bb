"""What chapter 5 says, computed: a function for each claim of `data/claims/chapter-5.toml`."""
