"""Saved results to export: of a fit of the right structure, or of a diagnosis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from msd_ident.data.datasheet import data_sheet
from msd_ident.data.record import Record
from msd_ident.estimate import FitResult, fit
from msd_ident.model import Model, Plant
from msd_ident.model.effects import by_name
from msd_ident.workflow.identification import initial_dict, quantities_dict
from msd_ident.workflow.saved_model import SavedModel, from_json_dict
from msd_sim.api import Simulated, simulate
from msd_sim.lottery import draw

#: What stands beside the hidden effect of a drawn rig.
FRICTION = "coulomb_friction"


def drawn(seed: int, hidden: str, experiment: str = "steps") -> tuple[Model, Record, float]:
    """A rig by lot with Coulomb friction and a hidden effect: truth, record, and noise of a reading [m]."""
    rig = draw(seed, hidden, hidden != FRICTION, experiment)
    made = simulate(rig.spec)
    return truth(rig.spec), recorded(made, f"seed {seed}"), rig.noise


def truth(spec: Mapping[str, Any]) -> Model:
    """The rig of a spec as a model."""
    model = Plant(spec["mass"], spec["damping"], spec["stiffness"])
    for name, values in spec["effects"].items():
        model = model + by_name(name)(**values)
    return model


def recorded(made: Simulated, name: str) -> Record:
    """What the rig's encoder wrote."""
    return Record(made.time, made.position, made.force_time, made.force, hold=made.hold, name=name)


def fitted(model: Model, record: Record) -> SavedModel:
    """The result of a fit of this structure, from these values, as JSON would carry it."""
    return saved(fit(model, record, search="near"), record)


def saved(found: FitResult, record: Record) -> SavedModel:
    """A fit in the form of a saved diagnosis."""
    base = {name: found.quantities[name] for name in ("mass", "damping", "stiffness")}
    sheet = {**data_sheet(record).to_json_dict()}
    told = {
        "schema": "msd.diagnosis/2", "path": record.name, "effects": list(found.model.effect_names), "causes": [],
        "extended": {"parameters": quantities_dict(found.quantities), "see_m": found.see},
        "base": {"parameters": quantities_dict(base), "see_m": found.see}, "noise_floor_m": found.noise_floor,
        "initial": [initial_dict(start) for start in found.initial], "data": [sheet],
    }  # fmt: skip
    return from_json_dict(told)
