"""Damping by the drive while it is on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _driven(v: Any, driven: Any) -> Any:
    """v [m/s] while the drive is on."""
    return v * driven


@dataclass(frozen=True)
class DriveDamping(Effect):
    """bd·v while a force is commanded: the back-EMF of a motor that a voltage drives, an amplifier that brakes."""

    drive_damping: float

    name = "drive_damping"
    parameters = (
        Parameter(
            "drive_damping", "bd", "N·s/m", -math.inf, math.inf, "damping that the drive adds while it is on",
            regressor=_driven,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "bd·v while the commanded force is not 0"
    source = "back-EMF damping Kt·Ke/R of a voltage-driven motor"
    neutral = (("drive_damping", 0.0),)

    @staticmethod
    def force(v: float, driven: float, drive_damping: float) -> float:
        """Force [N] against +x."""
        return drive_damping * v * driven

    @classmethod
    def fits(cls, record: Record) -> bool:
        """Whether the force is on for a part of the record and off for another."""
        on = np.asarray(record.force_at(record.time)) != 0.0
        return bool(np.any(on)) and not bool(np.all(on))

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[DriveDamping, ...]:
        """As strong as the plant's own damping, and a twentieth of the largest force at top speed."""
        size = 0.05 * typical.force(record, plant) / typical.speed(record)
        return cls(max(plant["damping"], size)), cls(-0.5 * max(plant["damping"], size))
