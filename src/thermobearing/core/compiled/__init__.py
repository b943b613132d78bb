"""How kernels are run: by libraries that are built ahead of time, by numba, or as plain Python."""
