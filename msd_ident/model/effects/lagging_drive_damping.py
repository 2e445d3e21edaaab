"""Damping by a drive that follows the velocity with a lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.drive_damping import DriveDamping
from msd_ident.model.effects.law import VELOCITY_LAG
from msd_ident.model.effects.relaxing_spring import STARTS, RelaxingSpring

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class LaggingDriveDamping(Effect):
    """bd·w while a force is commanded, with T·w' + w = v: the back-EMF of a motor whose current lags.

    Such a brake is a damper in series with a spring bd/T: it stiffens the axis while the drive is on.
    """

    drive_damping: float
    relaxation_time: float

    name = "lagging_drive_damping"
    parameters = (*DriveDamping.parameters, RelaxingSpring.parameters[-1])
    acts_on = "force"
    law = "bd·w while the commanded force is not 0, with T·w' + w = v and w = 0 at the start"
    source = "back-EMF of a motor with inductance, L·i' + R·i = u - Ke·v"
    neutral = (("drive_damping", 0.0),)
    form_of = DriveDamping.name
    prior_odds = 1.0 / 100.0
    family = RelaxingSpring.family
    structure = VELOCITY_LAG

    @staticmethod
    def force(lagged_v: float, driven: float, drive_damping: float) -> float:
        """Force [N] against +x."""
        return drive_damping * lagged_v * driven

    @classmethod
    def fits(cls, record: Record) -> bool:
        """See the simple law."""
        return DriveDamping.fits(record)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """As of any damper behind a spring."""
        return RelaxingSpring.resolvable(seen)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[LaggingDriveDamping, ...]:
        """Next to the simple law's strength."""
        return cls.from_simple(DriveDamping.guess(record, plant)[0], record, plant)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[LaggingDriveDamping, ...]:
        """The same damping at the plant's frequency: behind no spring, and behind two others."""
        rate = typical.natural_frequency(record, plant)
        return tuple(cls(simple.values[0] * (1.0 + turn**2), turn / rate) for turn in (0.0, *STARTS))
