"""Signed numbers that were read as unsigned ones: raw registers of a servo are logged with 65535 in the place of -1."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray

#: Bits of the numbers that drives send. With 8, a force that steps between two levels with noise would look alike.
_BITS = (16, 32)
#: Fewest different values on each side of zero: a drive that is fully on or off has one.
_FEWEST = 8
#: Part of all numbers within which values lie on both sides of zero: a signal passes through it.
_NEAR_ZERO = 1.0 / 256.0


def signed(values: FloatArray, heading: str) -> tuple[FloatArray, str]:
    """The values with their sign, and a note; as they are, and no note, where none lost it.

    They are whole, and lie in the lowest and in the highest quarter of what so many bits can hold, with nothing
    between, and next to both ends.

    Args:
        values: (n,) numbers of the column as they stand in the file; NaN where there is none.
        heading: of the column, for the note.
    """
    known = values[np.isfinite(values)]
    if not known.size or np.any(known < 0.0) or np.any(known != np.rint(known)):
        return values, ""
    for bits in _BITS:
        whole = 2.0**bits
        high, low = known >= 0.75 * whole, known < 0.25 * whole
        several = min(np.unique(known[high]).size, np.unique(known[low]).size) >= _FEWEST
        through = np.any(known <= _NEAR_ZERO * whole) and np.any((known >= (1.0 - _NEAR_ZERO) * whole) & high)
        if several and through and np.all(high | low) and np.all(known < whole):
            note = (
                f"Column {heading} holds {np.count_nonzero(high)} values from {known[high].min():.0f} to "
                f"{known[high].max():.0f} and else none above {known[low].max():.0f}: they are taken as negative, as "
                f"signed numbers of {bits} bits are that were read as unsigned ones ({known[high].max():.0f} is "
                f"{known[high].max() - whole:.0f})."
            )
            return np.where(values >= 0.75 * whole, values - whole, values), note
    return values, ""
