"""Small errors put into the code on purpose: do the tests notice?

`make mutants` takes the kept list (kept/ROOM.toml, written and checked by hand), applies one
change at a time in a scratch copy of the tree, and runs the nearest tests. `RANDOM=40 SEED=1`
makes changes by chance instead.
"""
