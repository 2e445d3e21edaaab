"""Compiled functions, called without numba.

In: functions that numba can compile, in modules of their own. Out: machine code on disk, functions that take arrays.
Begin with ``function.Library``; ``build`` alone imports numba.
"""

from msd_ident.compiled.function import Function, Library, Prepared

__all__ = ["Function", "Library", "Prepared"]
