"""A cart that rests without a force that changes, and then moves: whatever held it has let go."""

from __future__ import annotations

import numpy as np

from msd_ident.data.noise import Noise
from msd_ident.data.record import MINIMUM_SAMPLES, Record

#: The whole motion must be this many noise floors.
_CLEAR = 20.0
#: Part of the motion within which the cart is where it was held: readings of one at rest may creep.
_PLACE = 0.01


def let_go(record: Record, noise: Noise) -> float | None:
    """Instant [s] from which the cart moves by itself.

    A rig whose force does not change stays at rest. So it was held for as long as it rests at the beginning, if that is
    longer than it then takes for half of its way: one that begins to move in the first sample leaves its place sooner.

    Args:
        record: without a force that changes.
        noise: of the record.

    Returns:
        None where it moves from the start, or never.
    """
    away = np.abs(record.position - np.median(record.position[:MINIMUM_SAMPLES]))
    way = float(np.max(away))
    if way < _CLEAR * noise.floor:
        return None
    left, half = int(np.argmax(away > _PLACE * way)), int(np.argmax(away > 0.5 * way))
    rested, moved = record.time[left] - record.time[0], record.time[half] - record.time[left]
    return float(record.time[left]) if rested > moved and record.samples - left > MINIMUM_SAMPLES else None
