"""Dry friction that changes with time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.coulomb_friction import COULOMB_FORCE
from msd_ident.model.effects.law import RUBS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class FrictionDrift(Effect):
    """Coulomb friction that falls as grease warms up and a seal runs in, or grows as a guide dries out."""

    coulomb_force: float
    friction_drift_rate: float

    name = "friction_drift"
    parameters = (
        COULOMB_FORCE,
        Parameter(
            "friction_drift_rate", "q", "1/s", -math.inf, math.inf, "relative drift of the dry friction",
            advice="repeat the first record last",
        ),
    )  # fmt: skip
    prior_odds = 1.0 / 40.0
    acts_on = "force"
    law = "Fc·(1 + q·t)·sign(v), nowhere below 0, t from where the used part of the record begins"
    source = "Coulomb friction, first order in time as grease warms up"
    neutral = (("coulomb_force", 0.0),)
    family = "dry friction"
    form_of = "coulomb_friction"
    dissipative = True
    steady = False
    dry_limit = "coulomb_force"
    ring_down = {RUBS: (1,)}
    measured_by = "pull the cart slowly with a spring balance, before and after an hour of running"

    @staticmethod
    def friction(t: float, coulomb_force: float, friction_drift_rate: float) -> float:
        """Kinetic friction [N]."""
        return coulomb_force * max(1.0 + friction_drift_rate * t, 0.0)

    @staticmethod
    def breakaway(t: float, coulomb_force: float, friction_drift_rate: float) -> float:
        """Largest force [N] that it holds at rest."""
        return coulomb_force * max(1.0 + friction_drift_rate * t, 0.0)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"friction_drift_rate": (-1.0 / seen.duration, 5.0 / seen.duration)}

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[FrictionDrift, ...]:
        """The constant friction, and one that grows or falls by a third over the record."""
        del plant
        return tuple(cls(simple.values[0], change / record.duration) for change in (0.0, 0.3, -0.3))

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[FrictionDrift, ...]:
        """The same force all the time."""
        del record, plant
        return (cls(force, 0.0),)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[FrictionDrift, ...]:
        """A twentieth of the largest force, growing and falling by a third over the record."""
        force, rate = 0.05 * typical.force(record, plant), 0.3 / record.duration
        return cls(force, rate), cls(force, -rate)
