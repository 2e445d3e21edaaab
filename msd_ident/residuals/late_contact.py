"""What the instant leaves open at which a stop's force begins with a jump.

A law lets the force jump where the cart touches the stop. On a rig it does so later: a controller, or a simulator of
another make, acts at fixed instants, and a bumper takes a while to be pressed. Within one sample interval h the record
does not tell when. A force that jumps by f at an instant that may be anywhere within h has an impulse with a standard
deviation of f·h/√12, of any sign. Contacts follow each other, so their errors move the fitted parameters together, by
more than noise does. Errors that would show in what the fit leaves are not there: they count as far as they hide in the
scatter of chi², √(2 N) for N pieces of evidence.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Simulator
from msd_ident.residuals.blows import Blows, each
from msd_ident.residuals.noise_model import Readings
from msd_ident.tuning import fixed

_ANYWHERE = fixed(1.0 / math.sqrt(12.0), "mathematics", "standard deviation of an instant anywhere within an interval")


def slopes(readings: Sequence[Readings], model: Model, initial: Sequence[Initial], jacobian: FloatArray) -> FloatArray:
    """Covariance (q, q) of the slopes of chi²/2 over the entries of a fit that late contacts make.

    Args:
        readings: the records.
        model: the fitted model. Only effects whose force ``jumps`` at a knee leave anything open.
        initial: state of each record at its first sample.
        jacobian: (q, n) of the residuals of all records, in units of the noise.
    """
    found = np.zeros((jacobian.shape[0],) * 2)
    if not any(effect.jumps for effect in model.effects):
        return found
    blows = [_contacts(part, model, start) for part, start in zip(readings, initial, strict=True)]
    chi = sum(one.chi(part, model) for one, part in zip(blows, readings, strict=True))
    if chi > 0.0:
        hidden = math.sqrt(2.0 * sum(part.evidence for part in readings)) / chi
        for one, (part, rows) in zip(blows, each(readings, jacobian), strict=True):
            found += min(hidden, 1.0) * one.slopes(part, model, rows)
    return found


def _contacts(part: Readings, model: Model, start: Initial) -> Blows:
    """The unknown part of the impulse of each contact."""
    path = Simulator(model, part.record).trajectory(model.values, start.position, start.velocity)
    x, v, interval = path.position, path.velocity, np.diff(part.record.time)
    found: list[tuple[int, float]] = []
    for effect in model.effects:
        for place, side in effect.knee_places() if effect.jumps else ():
            beyond = side * (x - place) > 0.0
            for i in np.flatnonzero(beyond[1:] & ~beyond[:-1]):
                net = path.force[i] - model.damping * v[i] - model.stiffness * place
                found.append((i + 1, _ANYWHERE * interval[i] * abs(effect.begins_with(place, float(v[i]), float(net)))))
    first, impulse = zip(*found, strict=True) if found else ((), ())
    return Blows(np.array(first, dtype=np.intp), np.array(impulse))
