"""What the missing force depends on: position, velocity, its direction, time or the applied force."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import TENTH
from msd_ident.residuals.disturbance import DisturbanceEstimate


@dataclass(frozen=True)
class Dependence:
    """Share (0 to 1) of the missing force's variance that a smooth function of one signal explains."""

    signal: str
    share: float


def dependences(missing: Sequence[DisturbanceEstimate]) -> tuple[Dependence, ...]:
    """All signals by falling share."""
    force = np.concatenate([part.force for part in missing])
    signals = {
        "position": np.concatenate([part.position for part in missing]),
        "velocity": np.concatenate([part.velocity for part in missing]),
        "time": np.concatenate([part.time for part in missing]),
        "applied force": np.concatenate([part.applied for part in missing]),
    }
    found = [Dependence(name, _share(signal, force)) for name, signal in signals.items()]
    return tuple(sorted(found, key=lambda dependence: -dependence.share))


def _share(signal: FloatArray, force: FloatArray) -> float:
    """Variance between bins of the signal over all variance, corrected for the number of bins (Rice's rule)."""
    if not np.ptp(signal) > 0.0 or not np.ptp(force) > 0.0:
        return 0.0
    bins = 2 * math.ceil(force.size ** (1.0 / 3.0))
    edges = np.unique(np.quantile(signal, np.linspace(0.0, 1.0, bins + 1)[1:-1]))
    place = np.searchsorted(edges, signal, side="right")
    count = np.bincount(place)
    mean = np.bincount(place, weights=force) / np.maximum(count, 1)
    inside = force - mean[place]
    loss = float(np.mean(inside**2)) * force.size / max(force.size - count.size, 1)
    return min(max(1.0 - loss / float(np.var(force)), 0.0), 1.0)


def sentence(missing: Sequence[DisturbanceEstimate]) -> str:
    """Which signals the missing force depends on, in a sentence; empty if on none of them, as most do."""
    known = [item for item in dependences(missing) if item.share >= TENTH]
    if not known:
        return ""
    listed = ", ".join(f"{100.0 * item.share:.0f} % depends on the {item.signal}" for item in known)
    return f"Of its variance, {listed}, each signal taken alone."
