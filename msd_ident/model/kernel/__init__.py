"""The solver, for numba to compile. Only ``places`` is imported without numba."""
