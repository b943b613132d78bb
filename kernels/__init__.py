"""Build time only: libraries of the kernels, for callers without a compiler."""
