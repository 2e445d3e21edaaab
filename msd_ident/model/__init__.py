"""Plant, effects and the simulation of both.

``Plant(mass, damping, stiffness) + CoulombFriction(coulomb_force) + ...`` makes a ``Model``; ``Simulator(model,
record)`` computes the positions that an encoder would read under the record's force.
"""

from __future__ import annotations

from msd_ident.model.effects.base import Effect, Parameter
from msd_ident.model.plant import Model, Plant
from msd_ident.model.simulator import Simulator, Trajectory, simulate, warm_up

__all__ = ["Effect", "Model", "Parameter", "Plant", "Simulator", "Trajectory", "simulate", "warm_up"]
