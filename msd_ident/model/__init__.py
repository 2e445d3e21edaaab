"""Plant, effects and their simulation.

In: ``Plant(mass, damping, stiffness) + CoulombFriction(coulomb_force) + ...``, a ``Model``, and a record's force.
Out: from ``Simulator(model, record)`` the positions that an encoder would read.
Begin with ``plant``, then ``effects.law``, ``effects.base`` and ``simulator``; the compiled solver is ``kernel``.
"""

from __future__ import annotations

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects.base import Effect
from msd_ident.model.plant import Model, Plant
from msd_ident.model.simulator import Simulator, Trajectory, simulate, warm_up

__all__ = ["Effect", "Model", "Parameter", "Plant", "Simulator", "Trajectory", "simulate", "warm_up"]
