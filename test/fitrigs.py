"""Records of known rigs for the tests of ``fit``: made by ``msd_sim``, which shares no code with the identifier."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from msd_ident.data.record import Record
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_sim.api import simulate

#: The ECP rig of the paper: m, b, k and µ·m·g.
DEMO = Plant(0.9407, 3.927, 694.1) + CoulombFriction(0.0133 * 0.9407 * 9.81)
COUNTS_PER_METRE = 226600.0
ENCODER = {"counts_per_metre": COUNTS_PER_METRE}


def measured(model: Model, experiment: Mapping[str, Any], *, zero: float = 0.0, **spec: Any) -> Record:
    """A record of a rig with the model's parameters; ``zero`` [m] is added to its readings."""
    effects = {effect.name: dict(zip((p.name for p in effect.parameters), effect.values, strict=True)) for effect in
               model.effects}  # fmt: skip
    plant = {name: model[name] for name in ("mass", "damping", "stiffness")}
    made = simulate({**plant, "effects": effects, "experiment": dict(experiment), **spec})
    return Record(made.time, made.position + zero, made.force_time, made.force, hold=made.hold)


def demo_record(**spec: Any) -> Record:
    """The paper's experiment on the demo rig: 10.425 N for 3 s, 0 for 3 s, 1 kHz, 2266 counts a centimetre."""
    return measured(DEMO, {"name": "paper"}, **{"rate": 1000.0, "encoder": ENCODER, **spec})


def wrong(model: Model, factors: tuple[float, ...] = (1.3, 0.7, 0.7, 1.3)) -> Model:
    """The model with each parameter 30 % off."""
    return model.with_values(model.values * np.resize(factors, model.values.size))
