"""Signed numbers that were read as unsigned ones: raw registers of a servo are logged with 65535 in the place of -1."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray

#: Bits of the numbers that drives send. With 8, a force that steps between two levels with noise would look alike.
_BITS = (16, 32)
#: Fewest different values on each side of zero: a drive that is fully on or off has one.
_FEWEST = 8
#: Part of the range that the usual step through zero is at most: a force with noise between both ends of what the
#: numbers hold has larger ones, once it is taken as signed.
_STEP = 0.1


def signed(values: FloatArray, heading: str) -> tuple[FloatArray, str]:
    """The values with their sign, and a note; as they are, and no note, where none lost it.

    They are whole, and lie in the lowest and in the highest quarter of what so many bits can hold, with nothing
    between, and pass through zero in small steps, once they have their sign.

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
        if several and np.all(high | low) and np.all(known < whole) and _passes_zero(known, whole):
            note = (
                f"Column {heading} holds {np.count_nonzero(high)} values from {known[high].min():.0f} to "
                f"{known[high].max():.0f} and else none above {known[low].max():.0f}: they are taken as negative, as "
                f"signed numbers of {bits} bits are that were read as unsigned ones ({known[high].max():.0f} is "
                f"{known[high].max() - whole:.0f})."
            )
            return np.where(values >= 0.75 * whole, values - whole, values), note
    return values, ""


def _passes_zero(known: FloatArray, whole: float) -> bool:
    """Whether the usual step through zero is small beside the range, once the values have their sign."""
    true = np.where(known >= 0.5 * whole, known - whole, known)
    through = np.flatnonzero(np.diff(true < 0.0))
    return bool(through.size) and float(np.median(np.abs(np.diff(true))[through])) < _STEP * float(np.ptp(true))
