"""A constant force besides the commanded one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _constant() -> float:
    """It is proportional to nothing that moves."""
    return 1.0


def _bends(law: type[Effect]) -> bool:
    """Whether it is a spring of another shape, of which nothing repeats along the travel, or has a knee in it."""
    return (law.stores_only() or law.has_knee()) and law.harmonic is None and not law.angular


def _place(other: Effect, model: Model) -> float:
    """F0/k [m] of the constant force that drifts like a sensor beside the model's stiffness drift; 0 without both."""
    drift: float = getattr(other, "sensor_drift_rate", 0.0)
    aging = math.fsum(getattr(effect, "stiffness_drift_rate", 0.0) for effect in model.effects)
    return drift / aging if aging != 0.0 and model.stiffness > 0.0 else 0.0


@dataclass(frozen=True)
class ForceOffset(Effect):
    """F0 on the left-hand side: a tilted rail, a preload, a motor's bias."""

    offset_force: float

    name = "force_offset"
    parameters = (
        Parameter(
            "offset_force", "F0", "N", -math.inf, math.inf, "constant force against +x",
            advice="read the encoder with the spring relaxed, or turn the rig round and repeat",
            open_with_zero="shift the rest position in the same way, so only their sum is known (F0/k + zero)",
            regressor=_constant,
        ),
    )  # fmt: skip
    prior_odds = 1.0 / 10.0
    acts_on = "force"
    law = "F0"
    source = "Janot, Gautier, Brunot 2019 (EMPS benchmark): the drive's offset"
    neutral = (("offset_force", 0.0),)
    mirror = False
    piecewise_linear = True
    measured_by = "tilt the rig by a known angle or turn it round, and read the encoder with the spring relaxed"

    @staticmethod
    def constant(offset_force: float) -> float:
        """Force [N] against +x."""
        return offset_force

    def same_as_beside(self, model: Model) -> str:
        """Beside dry friction, that which is more one way than the other."""
        dry = [effect.name for effect in model.effects if effect.family == "dry friction"]
        if not dry:
            return ""
        return (
            f"force_offset beside {dry[0]} is equivalent to asymmetric friction (more one way than the other): "
            "no record of force and position tells them apart; turn the rig round and repeat."
        )

    @classmethod
    def is_shape_beside(cls, others: Iterable[type[Effect]]) -> bool:
        """Beside bent springs and stops alone: together they are a spring of another shape about the place of rest, or
        stops whose middle is not there.
        """
        placed = [other for other in others if other.placed() or other.shows_zero]
        return bool(placed) and all(_bends(other) for other in placed)

    def same_as(self, model: Model) -> str:
        """A shifted zero, where nothing shows where the spring's is; beside a bent spring, one of another shape."""
        placed = [type(effect) for effect in model.effects if effect.placed() or effect.shows_zero]
        if not model.stiffness > 0.0 or not all(map(_bends, placed)):
            return ""
        if placed:
            as_well = "a spring of another shape about the place of rest"
            if placed[0].has_knee():
                as_well = "stops, or bends of the spring, whose middle is off the place of rest"
            return (
                f"force_offset beside {placed[0].name} is equivalent to {as_well}, without a constant force, so it is "
                "not certain. Read the encoder with the spring relaxed to tell them apart."
            )
        return (
            "With a linear spring a force offset is the same as a position zero shifted by F0/k: read the encoder with "
            "the spring relaxed to tell them apart."
        )

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """Beside a stiffness k·(1 + r·t), a constant force F0 is one of -F0·r·t about a place F0/k further: slow motion
        drifts by F0·r/k a second, as with a sensor that drifts.
        """
        place = _place(other, model)
        if place == 0.0:
            return None
        rest = tuple(effect for effect in model.effects if effect.name not in (other.name, cls.name))
        return replace(model, effects=(*rest, cls(model.stiffness * place)))

    def zero_in(self, model: Model) -> float:
        """Where the constant force holds the cart that was taken for a drifting sensor's."""
        return math.fsum(_place(effect, model) for effect in model.effects)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ForceOffset, ...]:
        """A little either way; the error has one minimum."""
        return (cls(0.01 * typical.force(record, plant)),)
