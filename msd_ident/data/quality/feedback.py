"""Detection of a closed loop: a force that a controller computes from the readings.

In an open loop the force does not depend on the readings. In a closed loop the changes of the force follow those of the
readings, except for new setpoints, and the force rests while the readings rest, whatever its level. Or the force
follows the readings more closely than their noise would allow if it merely moved the cart. Where the setpoint moves all
the time, as smoothly as the cart, higher differences leave only the noise of the readings, and what it makes of the
force.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.noise import encoder_step, noise_floor
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import FloatArray, Record
from msd_ident.quantity import MAD

_CODE = "closed_loop"
#: Fewest changes of force and reading, and what a regression on the readings must explain of the force's changes. Of a
#: cart under a position controller it explains 0.999; of open loops, and of an axis with a moving setpoint < 0.07.
_FEWEST, _EXPLAINED = 50, 0.99
#: Part of the samples in which the reading must rest, and of these in which the force must rest too.
_RESTING, _WITH_IT = 0.2, 0.95
#: Or: the rest must be below this part of what the readings' noise alone would leave.
_BELOW_NOISE = 0.5
#: Orders of differences that are tried, readings that a controller may look back, and times the variance of noise that
#: the differences of readings may have where noise makes them.
_ORDERS, _MEMORY, _NOISY = (1, 2, 3, 4), 4, 2.0


def feedback(record: Record, motion: Motion) -> Iterator[Finding]:
    """A force that is computed from the readings, by a proportional or proportional and derivative controller."""
    if (gain := feedback_gain(record)) < 0.0:
        yield warning(
            _CODE,
            f"the force follows the readings ({gain:.4g} {record.force_unit}/{record.position_unit}): "
            "a controller computes it from them. A spring and a controller then have the same effect, and noise acts "
            "back on the force: if parameters stay uncertain, push with a force that does not depend on the position",
        )


def feedback_gain(record: Record) -> float:
    """Gain [N/m] by which the force follows the readings, negative; 0 where no controller computes it from them."""
    if not record.shared_clock:
        return 0.0
    noise = max(noise_floor(record), encoder_step(record) / np.sqrt(12.0))
    return _gain_of_changes(record, noise) or _gain_of_noise(record, noise)


def steered(findings: Iterable[Finding]) -> bool:
    """Whether a controller computes the force of a record with these findings."""
    return any(finding.code == _CODE for finding in findings)


def _gain_of_changes(record: Record, noise: float) -> float:
    """Gain [N/m] by which the force's changes follow those of the readings between new setpoints; 0 if they do not."""
    force, steps = np.diff(record.force), np.diff(record.position)
    columns = np.stack([steps[1:], steps[:-1]], axis=1)
    moving = np.any(columns != 0.0, axis=1) & (force[1:] != 0.0)
    if np.count_nonzero(moving) < _FEWEST:
        return 0.0
    weights, left, follows = _regressed(force[1:][moving], columns[moving])
    follows = follows and (_rests_with(force, steps) or left < _BELOW_NOISE * float(np.linalg.norm(weights)) * noise)
    return min(float(weights.sum()), 0.0) if follows else 0.0


def _gain_of_noise(record: Record, noise: float) -> float:
    """Gain [N/m] by which the force follows the noise of the readings; 0 if it does not, or if motion hides it."""
    for order in _ORDERS:
        rough = np.diff(record.position, order)
        noisy = float(np.var(rough)) < _NOISY * math.comb(2 * order, order) * noise**2
        force = np.diff(record.force, order)[_MEMORY - 1 :]
        if not noisy or np.count_nonzero(force) < max(_FEWEST, force.size // 2):
            continue
        weights, _, follows = _regressed(force, np.lib.stride_tricks.sliding_window_view(rough, _MEMORY))
        if follows and weights.sum() < 0.0:
            return float(weights.sum())
    return 0.0


def _regressed(now: FloatArray, columns: FloatArray) -> tuple[FloatArray, float, bool]:
    """Weights (q,) of the columns (n, q), the standard deviation of what they leave of the force's changes (n,), and
    whether that is next to nothing. A new setpoint is a jump of the force without any of the readings: it is left out.
    """
    weights: FloatArray = np.zeros(columns.shape[1])
    rest = now
    kept = np.ones(now.size, dtype=bool)
    for _ in range(3):
        weights = np.asarray(np.linalg.lstsq(columns[kept], now[kept], rcond=None)[0], dtype=np.float64)
        rest = now - columns @ weights
        kept = np.abs(rest) <= 6.0 * max(MAD * float(np.median(np.abs(rest))), 1e-300)
    left = float(np.std(rest[kept]))
    return weights, left, left**2 < (1.0 - _EXPLAINED) * float(np.var(now[kept]))


def _rests_with(force: FloatArray, steps: FloatArray) -> bool:
    """Whether the force rests while the readings do, over a good part of the record; (n − 1,) changes of both."""
    resting = steps == 0.0
    share = float(np.mean(resting))
    return share > _RESTING and float(np.mean(force[resting] == 0.0)) > _WITH_IT
