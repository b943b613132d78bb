"""Before any test, and before the workers of pytest-xdist start, which inherit it."""

from thermobearing.commands.threads import one_blas_thread

one_blas_thread()
