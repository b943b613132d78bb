"""Threads and buffers that BLAS uses in a process."""

import mmap
import os
import sys

# One for each BLAS that numpy and scipy may have been built with.
VARIABLES = (
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "BLIS_NUM_THREADS",
    "OMP_NUM_THREADS",
)
# Bytes of an analysis with its figures and files: 620 MB of address space in all measured on Linux.
# With less, imports, HDF5 and Pillow fail in the middle: some with a message, some for ever.
NEEDED = 560_000_000
ORDER = 300  # of matrices that are multiplied in blocks


def one_blas_thread() -> None:
    """Limit BLAS to one thread unless the environment sets a number; call before numpy is imported.

    The matrix products are small: more threads make them no faster, and waiting threads occupy
    the processors.
    """
    for variable in VARIABLES:
        os.environ.setdefault(variable, "1")


def reserve_blas() -> str | None:
    """Load numpy and scipy now, with the buffers of their BLAS, where address space is limited.

    OpenBLAS asks for a buffer for ever where there is none left, so that a process with
    `ulimit -v` hangs in an import. Returns a sentence where the limit is too small even for this.
    """
    if sys.platform == "win32":
        return None
    import resource

    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit == resource.RLIM_INFINITY:
        return None
    try:
        mmap.mmap(-1, NEEDED).close()
    except OSError:
        return (
            f"not enough memory: the limit of address space is {limit / 1e6:.0f} MB, of which "
            f"{NEEDED / 1e6:.0f} MB must be free at the start; raise it (ulimit -v)"
        )
    import numpy as np
    from scipy import linalg

    # The first products and factorisations take the buffers, which the process then keeps.
    square = np.eye(ORDER)
    np.linalg.solve(square, square @ square)
    linalg.solve(square, square)
    return None
