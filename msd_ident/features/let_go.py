"""A cart that rests without a force that changes, and then moves: whatever held it has let go."""

from __future__ import annotations

import numpy as np

from msd_ident.data.noise import Noise
from msd_ident.data.record import MINIMUM_SAMPLES, Record

#: The whole motion must be this many noise floors.
_CLEAR = 20.0
#: Part of the motion within which the cart is where it was held, since readings of one at rest may creep; or so many
#: noise floors and an encoder step.
_PLACE, _STILL = 0.01, 5.0
#: Part of the readings before it moves that are at the place; some may be off.
_STAYS = 0.9


def let_go(record: Record, noise: Noise) -> float | None:
    """Instant [s] from which the cart moves by itself.

    A rig whose force does not change stays at rest. So it was held for as long as it rests at the beginning, if that is
    longer than it then takes for half of its way: one that begins to move in the first sample leaves its place sooner.
    One that comes back rested by itself, and a hand pushed it later.

    Args:
        record: without a force that changes.
        noise: of the record.

    Returns:
        None where it moves from the start, or never, or comes back.
    """
    first, last = np.median(record.position[:MINIMUM_SAMPLES]), np.median(record.position[-MINIMUM_SAMPLES:])
    away = np.abs(record.position - first)
    way = float(np.max(away))
    if way < _CLEAR * noise.floor or abs(last - first) < 0.5 * way:
        return None
    half = int(np.argmax(away > 0.5 * way))
    near = np.flatnonzero(away[:half] <= max(_PLACE * way, _STILL * noise.floor + noise.step))
    left = int(near[-1]) + 1 if near.size else 0
    if near.size < _STAYS * left:
        return None  # it only comes by its first place again
    rested, moved = record.time[left] - record.time[0], record.time[half] - record.time[left]
    return float(record.time[left]) if rested > moved and record.samples - left > MINIMUM_SAMPLES else None
