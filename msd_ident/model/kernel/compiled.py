"""The ways in which the kernel's functions are compiled.

``lean`` and ``inlined`` functions only look at arrays that their callers hold, so they count no references to them:
counting took seven times as long as the physics. They may not make arrays.
"""

from __future__ import annotations

from typing import Any

from numba import njit

#: Sums may be taken in another order and products joined to them; NaN and infinities keep their meaning.
_LOOSE = {"contract", "arcp", "nsz"}

#: A function of its own that makes no arrays.
lean: Any = njit(error_model="numpy", fastmath=_LOOSE, _nrt=False)
#: The same, compiled into its callers.
inlined: Any = njit(error_model="numpy", fastmath=_LOOSE, _nrt=False, forceinline=True)
#: A function that makes arrays.
making: Any = njit(error_model="numpy", fastmath=_LOOSE)
