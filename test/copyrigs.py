"""A small rig whose poor experiments are copied: one step and a ramp."""

from __future__ import annotations

from typing import Any

from msd_ident.data.record import Record
from msd_sim.api import simulate

RUB = frozenset({"coulomb_friction"})
PLANT = {"mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0, "seed": 4, "rate": 200}
RUBS = {"coulomb_friction": {"coulomb_force": 0.3}}
DRAGS = {"quadratic_drag": {"drag_coefficient": 4.0}}
STEP = {"name": "step", "force": 4.0, "hold": 2.0}
RAMP = {"name": "ramp", "force": 4.0, "duration": 4.0, "rate": 25.0}


def measured(experiment: dict[str, Any], effects: dict[str, Any] = RUBS, **encoder: float) -> Record:
    """One experiment on the rig, seen by this encoder."""
    made = simulate({**PLANT, "experiment": experiment, "effects": effects, "encoder": encoder})
    return Record(made.time, made.position, made.force_time, made.force, hold=made.hold)
