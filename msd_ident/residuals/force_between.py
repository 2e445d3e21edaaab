"""What a measured force leaves open between its samples.

A force that is taken as linear between samples, and bends there, has another impulse. Where it bends within one sample
interval h, the samples give its impulse to about h·abs(F[i+1] - 2·F[i] + F[i-1])/8. Each such error moves the cart as
a blow does, so that a hammer's blows of a few samples, or ramps between plateaus, make a linear rig look like one whose
force has a gain of its own from blow to blow. Where a force bends all the time, its many errors make a motion that no
law makes, and what a fit leaves shows them: they count only where a few of them are most of all.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import TENTH
from msd_ident.model import Model
from msd_ident.residuals.blows import Blows, each
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
    return sum(bends.chi(part, model) for part in readings if (bends := _bends(part)) is not None)


def slopes(readings: Sequence[Readings], model: Model, jacobian: FloatArray) -> FloatArray:
    """Covariance (q, q) of the slopes of chi²/2 over the entries of a fit that these impulses make.

    Args:
        readings, model: as of ``chi``.
        jacobian: (q, n) of the residuals of all records, in units of the noise.
    """
    found = np.zeros((jacobian.shape[0],) * 2)
    for part, rows in each(readings, jacobian):
        if (bends := _bends(part)) is not None:
            found += bends.slopes(part, model, rows)
    return found


def _bends(part: Readings) -> Blows | None:
    """The unknown part of each impulse; None without any."""
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
    return Blows(np.searchsorted(record.time, time[1:-1][acting]), impulse[acting])
