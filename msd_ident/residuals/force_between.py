"""What a measured force leaves open between its samples.

A force that is taken as linear between samples, and bends there, has another impulse. Where it bends within one sample
interval h, the samples give its impulse to about h·abs(F[i+1] - 2·F[i] + F[i-1])/8. Each such error moves the cart as
a blow does, so that a hammer's blows of a few samples, or ramps between plateaus, make a linear rig look like one whose
force has a gain of its own from blow to blow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.signal import correlate

from msd_ident.data.record import FloatArray
from msd_ident.model import Model, Plant, Simulator
from msd_ident.residuals.noise_model import Readings
from msd_ident.tuning import fixed

_BEND = fixed(
    0.125, "mathematics", "impulse of a force that bends anywhere between two samples, in second differences times h"
)


def chi(readings: Sequence[Readings], model: Model) -> float:
    """Chi² that the unknown impulses of measured forces leave, as expected with random signs.

    Args:
        readings: the records. A force that is held, or told more finely than the positions, leaves nothing open.
        model: gives mass, damping and stiffness.
    """
    return sum(_left(part, model) for part in readings if _is_straight(part))


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
        if _is_straight(part):
            struck, (first, impulse) = _blow(part, model), _bends(part)
            seen = correlate(rows * part.root, struck[None, :])[:, struck.size - 1 :]  # of a blow at each sample
            moved = impulse * np.pad(seen, ((0, 0), (0, 1)))[:, first]
            found += moved @ moved.T
    return found


def _is_straight(part: Readings) -> bool:
    return part.record.hold == "linear" and part.record.force.size >= 3


def _left(part: Readings, model: Model) -> float:
    struck, (first, impulse) = _blow(part, model), _bends(part)
    after = np.concatenate(([0.0], np.cumsum(struck**2))) / part.noise**2
    share = part.evidence / part.record.samples  # of a piece of evidence, in a sample
    return share * float(impulse**2 @ after[part.record.samples - first])


def _bends(part: Readings) -> tuple[npt.NDArray[np.intp], FloatArray]:
    """The sample (m,) from which the unknown part of each impulse acts, and its size (m,) [N·s]."""
    record = part.record
    impulse = _BEND * np.diff(record.force_time)[1:] * np.abs(np.diff(record.force, 2))
    return np.searchsorted(record.time, record.force_time[1:-1]), impulse


def _blow(part: Readings, model: Model) -> FloatArray:
    """Positions (n,) of the plant after a blow of 1 N·s at the first sample."""
    plant = Plant(model.mass, model.damping, model.stiffness)
    quiet = replace(part.record, force=np.zeros(part.record.force.size))
    return Simulator(plant, quiet).positions(plant.values, 0.0, 1.0 / plant.mass)
