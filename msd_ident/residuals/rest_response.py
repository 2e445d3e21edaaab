"""The motion that a cause would give a cart at rest, compared with the rest that the record shows before it moves.

A disturbance that acts during a free decay acts on the cart before the decay too. That part of the record cannot be
fitted, since a hand moves the cart between the two. But it tells of the causes that act without a force.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from msd_ident.model import Model, Simulator
from msd_ident.residuals.noise_model import Readings


def chi(model: Model, rest: Readings) -> float:
    """Misfit of a model to a cart at rest, in units of the noise; 0 if nothing in the model acts by itself.

    The model is simulated from rest at its balance, without a force, with those of its effects that depend on time and
    those that dissipate energy. The other effects only shift the balance.

    Args:
        model: the model.
        rest: a stretch of readings in which the cart rests.

    Returns:
        Sum of squares of the simulated motion about the readings, minus that of the readings about their mean; at least
        0.
    """
    if all(effect.steady for effect in model.effects):
        return 0.0
    kept = tuple(effect for effect in model.effects if not effect.steady or effect.dissipative)
    record = replace(rest.record, force=np.zeros(rest.record.force.size))
    alone = replace(model, effects=kept)
    moved = Simulator(alone, record).trajectory(alone.values, 0.0, 0.0).position
    read = rest.record.position - np.mean(rest.record.position)
    return max(rest.chi(moved - np.mean(moved) - read) - rest.chi(read), 0.0)
