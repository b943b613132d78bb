"""Number of threads that BLAS uses in a process."""

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
    """Limit BLAS to one thread unless the environment sets a number; call before numpy is imported.

    The matrix products are small: more threads make them no faster, and waiting threads occupy
    the processors.
    """
    for variable in VARIABLES:
        os.environ.setdefault(variable, "1")
