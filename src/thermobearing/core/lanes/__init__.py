"""Several runs in lockstep: a vector of numbers where a kernel has one number.

Read `choose.py` first: what a kernel says in place of `if`. `kinds.py` has the two numba types,
`arithmetic.py` and `functions.py` what can be done with them, `memory.py` the way from arrays.
"""
