"""How kernels are run: by libraries that are built ahead of time, by numba, or as plain Python."""

from thermobearing.core.compiled.kernel import REGISTERED
from thermobearing.core.compiled.runners import RUNNERS

REGISTERED[:] = [RUNNERS]
