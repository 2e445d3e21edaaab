"""The sine of the compiled laws: a polynomial that becomes part of its callers.

A call of the C library's sine takes longer than the rest of a law, for the caller has to put away all it holds in
registers. (The exponential was tried as well, and gained nothing.)
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math
import types
from collections.abc import Callable
from typing import Any

from msd_ident.model.kernel.compiled import inlined

#: Pi in parts (Cody and Waite 1980): multiples of all but the last are exact, up to 22 bits of the multiple.
_PI = (3.1415926218032837, 3.1786509424591713e-08, 1.2246467991473532e-16)
_PER_PI = 1.0 / math.pi
#: Added and taken away again, it leaves the nearest whole number (of numbers below 2^51).
_ROUND = 1.5 * 2.0**52
#: Chebyshev interpolation of sin(r)/r in r² up to pi/2, within 2e-16.
_C0, _C1, _C2, _C3 = 0.9999999999999999, -0.1666666666666607, 0.008333333333282452, -0.00019841269824780153
_C4, _C5, _C6, _C7 = 2.755731659866929e-06, -2.5051881272501282e-08, 1.6048146803827966e-10, -7.374119385051447e-13


@inlined
def sine(angle):
    """sin(angle) to 4e-16 for angles up to some 1e5 rad; not finite where the angle is not."""
    turns = (angle * _PER_PI + _ROUND) - _ROUND
    r = ((angle - turns * _PI[0]) - turns * _PI[1]) - turns * _PI[2]
    s = r * r
    q = s * s
    low = (_C0 + _C1 * s) + q * (_C2 + _C3 * s)
    high = (_C4 + _C5 * s) + q * (_C6 + _C7 * s)
    # The sign last: what it takes to know it goes on beside the polynomial.
    side = 1.0 - 2.0 * abs(turns - 2.0 * ((0.5 * turns + _ROUND) - _ROUND))
    return (side * r) * (low + q * q * high)


def with_own_sine(law: Callable[..., float]) -> Callable[..., float]:
    """The law with ``math.sin`` in its text read as ``sine``."""
    if "sin" not in law.__code__.co_names:
        return law
    ours: Any = types.ModuleType("math")
    ours.__dict__.update(vars(math), sin=sine)
    return types.FunctionType(law.__code__, {**law.__globals__, "math": ours}, law.__name__)
