"""A force that was recorded and never changes, which is often another signal than the one that drives the cart."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray


def notes(signal: str, force: FloatArray, unit: str, position: FloatArray) -> list[str]:
    """A sentence for a force that is one value over the whole record while the position changes, else none.

    A single command that a bag holds is no record of a force.

    Args:
        signal: the column or topic, in words.
        force: (p,) as recorded, in ``unit``.
        unit: of the force.
        position: (n,) in any unit.
    """
    if force.size < MINIMUM_SAMPLES or np.ptp(force) or not position.size or not np.ptp(position):
        return []
    return [
        f"{signal} is {force[0]:.4g} {unit} in all {force.size} samples while the cart moves: check that it is the "
        "force (--force NAME), or give --force none if nothing drives the cart."
    ]
