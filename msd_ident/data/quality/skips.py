"""Time that was lost although the stamps do not show it: a program that counts its samples gives them even stamps.

At each loss the readings go on further ahead, in the direction of the motion and with the same speed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.noise import noise_of
from msd_ident.data.quality.cleaning import sudden
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import Record

#: Fewest losses that are told: a few steps may be jumps of the encoder's zero.
_FEWEST = 4
#: Part of all such steps that must go ahead: those of an encoder that slips go both ways.
_AHEAD = 0.9
#: Samples that one loss may hold: what goes further is another thing, as a cart that breaks away.
_LEAST, _MOST = 0.5, 50.0


def lost_time(record: Record, motion: Motion) -> Iterator[Finding]:
    """Steps ahead in a motion that goes on with the same speed, further than the stamps say."""
    places, noise = sudden(record), noise_of(record)
    if motion.still or places.index.size < _FEWEST:
        return
    slowest = max(noise.floor, 0.5 * noise.step)  # three times what noise makes of the mean of the six steps beside
    index, size, usual = (value[np.abs(places.usual) > slowest] for value in (places.index, places.size, places.usual))
    told = (record.time[index] - record.time[index - 1]) / record.period
    lost = size / usual + 1.0 - told
    held = record.position[index - 1] == record.position[index - 2]  # readings that were held catch up, and lost none
    ahead = (lost > _LEAST) & (lost < _MOST) & ~held
    if np.count_nonzero(ahead) < max(_FEWEST, _AHEAD * places.index.size):
        return
    if np.unique(np.sign(usual[ahead])).size < 2:  # one way, an uneven scale does the same
        return
    yield warning(
        "lost_time",
        f"at {np.count_nonzero(ahead)} places, the first at {record.time[index[ahead][0]]:.3f} s, the position goes "
        "ahead and on with the same speed, as if samples were lost, or read late, that the stamps do not show: about "
        f"{float(np.sum(lost[ahead])) * record.period:.2g} s in all; log the time of each sample in place of counting "
        "them",
    )
