"""What a measured force leaves open between its samples.

A force that is taken as linear between samples, and bends there, has another impulse. Where it bends within one sample
interval h, the samples give its impulse to about h·abs(F[i+1] - 2·F[i] + F[i-1])/8. Each such error moves the cart as
a blow does, so that a hammer's blows of a few samples, or ramps between plateaus, make a linear rig look like one whose
force has a gain of its own from blow to blow. Where a force bends all the time, its many errors make a motion that no
law makes, and what a fit leaves shows them: they count only where a few of them are most of all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import TENTH
from msd_ident.model import Model, Plant, Simulator
from msd_ident.residuals.noise_model import Readings
from msd_ident.tuning import fixed

_BEND = fixed(
    0.125, "mathematics", "impulse of a force that bends anywhere between two samples, in second differences times h"
)
#: Part of the samples in which a force bends, weighted by the square of what is unknown, up to which it bends seldom.
_SELDOM = TENTH


def chi(readings: Sequence[Readings], model: Model) -> float:
    """Chi² that the unknown impulses of measured forces leave, as expected with random signs.

    Args:
        readings: the records. A force that is held, or that bends all the time, leaves nothing open.
        model: gives mass, damping and stiffness.
    """
    return sum(_left(part, model, *bends) for part in readings if (bends := _bends(part)) is not None)


def slopes(readings: Sequence[Readings], model: Model, jacobian: FloatArray) -> FloatArray:
    """Covariance (q, q) of the slopes of chi²/2 over the entries of a fit that these impulses make: the middle of a
    sandwich.

    Args:
        readings, model: as of ``chi``.
        jacobian: (q, n) of the residuals of all records, in units of the noise.
    """
    found = np.zeros((jacobian.shape[0],) * 2)
    ends = np.cumsum([part.record.samples for part in readings])[:-1]
    for part, rows in zip(readings, np.split(jacobian, ends, axis=1), strict=True):
        if (bends := _bends(part)) is not None:
            from scipy.signal import correlate  # imported here: it takes a quarter of a second

            struck, (first, impulse) = _blow(part, model), bends
            seen = correlate(rows * part.root, struck[None, :])[:, struck.size - 1 :]  # of a blow at each sample
            moved = impulse * seen[:, first]
            found += moved @ moved.T
    return found


def _left(part: Readings, model: Model, first: npt.NDArray[np.intp], impulse: FloatArray) -> float:
    after = np.concatenate(([0.0], np.cumsum(_blow(part, model) ** 2))) / part.noise**2
    share = part.evidence / part.record.samples  # of a piece of evidence, in a sample
    return share * float(impulse**2 @ after[part.record.samples - first])


def _bends(part: Readings) -> tuple[npt.NDArray[np.intp], FloatArray] | None:
    """The sample (m,) from which the unknown part of each impulse acts, and its size (m,) [N·s]; None without any."""
    record, told = part.record, slice(None, None, part.record.upsampled)  # as measured: what is between is a guess
    time, force = record.force_time[told], record.force[told]
    if record.hold != "linear" or force.size < 3:
        return None
    inside = (time > record.time[0]) & (time < record.time[-1])
    step = np.diff(time)
    around = 0.5 * (step[1:] + step[:-1])
    impulse = _BEND * around**2 * np.abs(np.diff(np.diff(force) / step)) * inside[1:-1]
    power = impulse**2
    if not power.any() or float(power.sum()) ** 2 > _SELDOM * record.samples * float(power @ power):
        return None
    acting = np.flatnonzero(impulse)
    return np.searchsorted(record.time, time[1:-1][acting]), impulse[acting]


def _blow(part: Readings, model: Model) -> FloatArray:
    """Positions (n,) of the plant after a blow of 1 N·s at the first sample."""
    plant = Plant(model.mass, model.damping, model.stiffness)
    quiet = replace(part.record, force=np.zeros(part.record.force.size))
    return Simulator(plant, quiet).positions(plant.values, 0.0, 1.0 / plant.mass)
