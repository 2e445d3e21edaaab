"""Detection of a closed loop: a force that a controller computes from the readings.

In an open loop the force does not depend on the readings. In a closed loop the changes of the force follow those of the
readings, except for new setpoints, and the force rests while the readings rest, whatever its level. Or the force
follows the readings more closely than their noise would allow if it merely moved the cart.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.noise import encoder_step, noise_floor
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import FloatArray, Record
from msd_ident.quantity import MAD

#: Fewest changes of force and reading, and what a regression on the readings must explain of the force's changes. Of a
#: cart under a position controller it explains 0.999; of open loops, and of an axis with a moving setpoint < 0.07.
_FEWEST, _EXPLAINED = 50, 0.99
#: Part of the samples in which the reading must rest, and of these in which the force must rest too.
_RESTING, _WITH_IT = 0.2, 0.95
#: Or: the rest must be below this part of what the readings' noise alone would leave.
_BELOW_NOISE = 0.5


def feedback(record: Record, motion: Motion) -> Iterator[Finding]:
    """A force that is computed from the readings, by a proportional or proportional and derivative controller."""
    if not record.shared_clock:
        return
    force, steps = np.diff(record.force), np.diff(record.position)
    columns = np.stack([steps[1:], steps[:-1]], axis=1)
    moving = np.any(columns != 0.0, axis=1) & (force[1:] != 0.0)
    if np.count_nonzero(moving) < _FEWEST:
        return
    now, columns = force[1:][moving], columns[moving]
    weights, rest = np.zeros(2), now
    kept = np.ones(now.size, dtype=bool)
    for _ in range(3):  # a new setpoint is a jump of the force without any of the readings
        weights = np.linalg.lstsq(columns[kept], now[kept], rcond=None)[0]
        rest = now - columns @ weights
        kept = np.abs(rest) <= 6.0 * max(MAD * float(np.median(np.abs(rest))), 1e-300)
    left, noise = float(np.std(rest[kept])), max(noise_floor(record), encoder_step(record) / np.sqrt(12.0))
    follows = float(weights.sum()) < 0.0 and left**2 < (1.0 - _EXPLAINED) * float(np.var(now[kept]))
    if follows and (_rests_with(force, steps) or left < _BELOW_NOISE * float(np.linalg.norm(weights)) * noise):
        yield warning(
            "closed_loop",
            f"the force follows the readings ({float(weights.sum()):.4g} {record.force_unit}/{record.position_unit}): "
            "a controller computes it from them. A spring and a controller then have the same effect, and noise acts "
            "back on the force: if parameters stay uncertain, push with a force that does not depend on the position",
        )


def _rests_with(force: FloatArray, steps: FloatArray) -> bool:
    """Whether the force rests while the readings do, over a good part of the record; (n − 1,) changes of both."""
    resting = steps == 0.0
    share = float(np.mean(resting))
    return share > _RESTING and float(np.mean(force[resting] == 0.0)) > _WITH_IT
