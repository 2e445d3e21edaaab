"""The motion that a cause would give a cart at rest, compared with the rest that the record shows before it moves.

A disturbance that rings a free decay rings the cart before the decay too. That stretch cannot be a part of a fit, since
a hand moves the cart between the two; but what it says of the causes that act by themselves counts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from msd_ident.model import Model, Simulator
from msd_ident.residuals.noise_model import Readings


def chi(model: Model, rest: Readings) -> float:
    """Sum of squares, in units of the noise, by which a model moves a cart that stands still.

    It is 0 where nothing in the model acts by itself.

    From rest at the plant's balance, with what acts by itself and what takes energy out of the motion; all else only
    says where the balance is.
    """
    if all(effect.steady for effect in model.effects):
        return 0.0
    kept = tuple(effect for effect in model.effects if not effect.steady or effect.dissipative)
    record = replace(rest.record, force=np.zeros(rest.record.force.size))
    alone = replace(model, effects=kept)
    moved = Simulator(alone, record).trajectory(alone.values, 0.0, 0.0).position
    read = rest.record.position - np.mean(rest.record.position)
    return max(rest.chi(moved - np.mean(moved) - read) - rest.chi(read), 0.0)
