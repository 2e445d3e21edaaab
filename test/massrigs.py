"""A rig with a second mass, swept."""

from __future__ import annotations

from msd_ident.data.record import Record
from msd_sim import api


def swept(effects: dict[str, dict[str, float]]) -> Record:
    """A rig of 0.96 kg swept from well below its resonance to well above that of its second mass."""
    rig = {
        "mass": 0.96, "damping": 1.35, "stiffness": 712.0, "friction_coefficient": 0.0, "effects": effects,
        "encoder": {"counts_per_metre": 0.0, "noise": 1e-5}, "rate": 500.0, "seed": 5,
        "experiment": {"name": "sweep", "duration": 10.0},
    }  # fmt: skip
    made = api.simulate(rig)
    return Record(made.time, made.position, made.force_time, made.force)
