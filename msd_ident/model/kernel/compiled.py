"""The ways in which the kernel's functions are compiled.

``lean`` and ``inlined`` functions only look at arrays that their callers hold, so they count no references to them:
counting took seven times as long as the physics. They may not make arrays, nor return one, alone or in a named tuple,
to a function that counts.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import functools
import math
from typing import Any

import numba

#: Sums may be taken in another order and products joined to them; NaN and infinities keep their meaning.
_LOOSE = {"contract", "arcp", "nsz"}

#: Only the entries are called from Python; a wrapper for each function took a tenth of the time to compile.
_jit: Any = functools.partial(numba.njit, no_cpython_wrapper=True, no_cfunc_wrapper=True)

#: A function of its own that makes no arrays.
lean: Any = _jit(error_model="numpy", fastmath=_LOOSE, _nrt=False)
#: The same, compiled into its callers.
inlined: Any = _jit(error_model="numpy", fastmath=_LOOSE, _nrt=False, forceinline=True)
#: A function that is called in one place only: it becomes part of its caller before anything is compiled, which for the
#: small laws and for the outermost levels saves a fifth of the time.
joined: Any = _jit(error_model="numpy", fastmath=_LOOSE, inline="always")
#: A function whose sums are those that are written, term by term.
plain: Any = _jit(error_model="numpy", _nrt=False)
#: A function that makes arrays.
making: Any = _jit(error_model="numpy", fastmath=_LOOSE)


@lean
def give_up(out, first):
    """Fill ``out`` with NaN from index ``first`` on."""
    for j in range(first, out.size):
        out[j] = math.nan
