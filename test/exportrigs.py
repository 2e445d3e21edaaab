"""Saved results of known models and records for the tests of ``export``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from msd_ident.data.record import Record
from msd_ident.model import Model, Simulator
from msd_ident.model.effects import LIBRARY
from msd_ident.quantity import Quantity
from msd_ident.workflow.saved_model import SavedModel, from_json_dict

#: Noise of a reading [m].
NOISE = 2e-5


def result(model: Model, *, std: float = 0.001, unit: str = "N", position: str = "m", **keys: Any) -> dict[str, Any]:
    """A diagnosis in the JSON contract, as far as an export reads it; each ``std`` is a part of the value."""
    told = {
        p.name: {"value": float(v) if np.isfinite(v) else None, "std": std * abs(v) if np.isfinite(v) else 0.0,
                 "unit": p.unit}
        for p, v in zip(model.parameters, model.values, strict=True)
    }  # fmt: skip
    plain = {name: told[name] for name in ("mass", "damping", "stiffness")}
    return {
        "schema": "msd.diagnosis/2", "path": "rig.csv", "effects": list(model.effect_names),
        "causes": [{"name": name} for name in model.effect_names], "noise_floor_m": NOISE,
        "base": {"parameters": plain, "see_m": 1e-4}, "extended": {"parameters": told, "see_m": NOISE},
        "data": [{"force_unit": unit, "position_unit": position, "rate_hz": 1000.0, "force_hold": "zero"}],
        "initial": [{"position_m": 0.0, "velocity_m_s": 0.0, "zero_m": 0.0}], "rivals": [], **keys,
    }  # fmt: skip


def saved(model: Model, **keys: Any) -> SavedModel:
    """The same, read back."""
    return from_json_dict(result(model, **keys))


def measured(model: Model, force: Record, seed: int = 1) -> Record:
    """What an encoder with noise reads of a model under the force of a record."""
    clean = Simulator(model, force).positions(model.values)
    noise = NOISE * np.random.default_rng(seed).standard_normal(clean.size)
    return Record(force.time, clean + noise, force.force_time, force.force, hold=force.hold, name="rig")


def pushes(duration: float = 6.0) -> Record:
    """Steps of several sizes in both directions at 1 kHz, which tell laws of friction apart."""
    time = np.arange(round(1000.0 * duration) + 1) / 1000.0
    levels = np.array([10.4, -6.0, 3.0, -10.4, 6.0, 0.0])
    force = levels[np.minimum((levels.size * time / duration).astype(int), levels.size - 1)]
    return Record(time=time, position=0.0 * time, force_time=time, force=force)


def quantities(model: Model) -> Mapping[str, Quantity]:
    """Values with a narrow interval."""
    return {
        p.name: Quantity(float(v), 0.001 * abs(float(v)), p.unit)
        for p, v in zip(model.parameters, model.values, strict=True)
    }


ALL = tuple(effect.name for effect in LIBRARY)
