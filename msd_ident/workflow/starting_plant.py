"""Plants that fits start from."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import Record
from msd_ident.features import StandardForm
from msd_ident.model import Model, Plant


def typical_plant(record: Record) -> Model:
    """A plant of the record's typical force, length and time, to start from where there are no features."""
    force = max(float(np.ptp(record.force_at(record.time))), 1e-9)
    length = max(float(np.ptp(record.position)), 1e-12)
    stiffness = force / length
    mass, damping = stiffness * (record.duration / 20.0) ** 2, 0.1 * stiffness * record.duration
    return Plant(mass=mass, damping=damping, stiffness=stiffness)


def plant_of(form: StandardForm) -> Model:
    """The plant of a standard form, by eqs. 11 to 13; with a mass of 1 kg if there is no static gain."""
    if form.physical is not None:
        return Plant(**{name: quantity.value for name, quantity in form.physical.quantities.items()})
    frequency, ratio = form.natural_frequency.value, form.damping_ratio.value
    return Plant(mass=1.0, damping=2.0 * ratio * frequency, stiffness=frequency**2)
