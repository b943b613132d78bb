"""How many threads BLAS may use in a process of this program."""

import os

# One for each BLAS that numpy and scipy may have been built with.
VARIABLES = (
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "BLIS_NUM_THREADS",
    "OMP_NUM_THREADS",
)


def one_blas_thread() -> None:
    """Let BLAS use one thread, unless the environment says otherwise; before numpy is imported.

    Its products are small here: with more threads they are no faster, and the threads wait for
    each other in loops that take the processors from everything else.
    """
    for variable in VARIABLES:
        os.environ.setdefault(variable, "1")
