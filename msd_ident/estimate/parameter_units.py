"""Units of a parameter on a given rig, and the size that a parameter of some unit naturally has there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Protocol

import numpy as np

from msd_ident.data.record import Record
from msd_ident.model import Model
from msd_ident.tuning import fixed

_POWERS = fixed({"²": 2, "³": 3, "⁴": 4}, "mathematics", "raised digits of a unit")


def _factors(product: str) -> dict[str, int]:
    found: dict[str, int] = {}
    for token in product.strip("() ").split("·"):
        power = _POWERS.get(token[-1:], 1)
        name = token[:-1] if token[-1:] in _POWERS else token
        if name and name not in ("1", "–", "-"):
            found[name] = found.get(name, 0) + power
    return found


@cache
def exponents(unit: str) -> Mapping[str, int]:
    """Exponents of the base units in a unit such as ``N·s²/m²``; ``kg`` counts as N·s²/m."""
    numerator, _, denominator = unit.partition("/")
    total = _factors(numerator)
    for name, power in _factors(denominator).items():
        total[name] = total.get(name, 0) - power
    mass = total.pop("kg", 0)
    for name, power in (("N", mass), ("s", 2 * mass), ("m", -mass)):
        total[name] = total.get(name, 0) + power
    return MappingProxyType({name: power for name, power in total.items() if power})


@dataclass(frozen=True)
class Magnitudes:
    """Typical force, length and time of a set of records, from which parameters get their natural sizes.

    Attributes:
        force: [N].
        length: [m].
        time: [s].
    """

    force: float
    length: float
    time: float

    def of(self, unit: str) -> float:
        """Natural size of a parameter with this unit (1 for an angle)."""
        power = exponents(unit)
        base = {"N": self.force, "m": self.length, "s": self.time}
        size = 1.0
        for name, exponent in power.items():
            size *= base.get(name, 1.0) ** exponent
        return size


def in_force_unit(model: Model, factor: float) -> dict[str, float]:
    """Finite parameters of a model, converted to another unit of force.

    Args:
        model: its values are in newtons.
        factor: new units of force per newton. Each parameter is multiplied by the power of it that its unit contains.

    Returns:
        Values by name; infinite limits are left out.
    """
    values = {p.name: model[p.name] * factor ** exponents(p.unit).get("N", 0) for p in model.parameters}
    return {name: value for name, value in values.items() if math.isfinite(value)}


def magnitudes(records: tuple[Record, ...], mass: float) -> Magnitudes:
    """Typical force, length and time of a set of records.

    Length is the largest standard deviation of a position. Time is length over the largest root mean square speed.
    Force is the largest force of all records.

    Args:
        records: the records.
        mass: [kg], gives the typical force as mass · length / time² if no force acts in any record.
    """
    length = max(float(np.std(record.position)) for record in records) or 1e-9
    speed = max(_typical_speed(record) for record in records) or length
    time = length / speed
    force = max(float(np.max(np.abs(record.force))) for record in records)
    return Magnitudes(force or mass * length / time**2, length, time)


def _typical_speed(record: Record) -> float:
    """Root mean square speed over the shortest span in which motion outgrows noise."""
    position, time = record.position, record.time
    noise = float(np.mean(np.diff(position, 2) ** 2)) / 6.0
    span = 1
    while True:
        change = position[span:] - position[:-span]
        if float(np.mean(change**2)) > 40.0 * noise or 4 * span > record.samples:
            return float(np.sqrt(np.mean((change / (time[span:] - time[:-span])) ** 2)))
        span *= 2


class HasUnits(Protocol):
    """A record, or a result of one: it has the units of a rig."""

    @property
    def force_unit(self) -> str:
        """Unit of the force."""

    @property
    def position_unit(self) -> str:
        """Unit of the position."""


def unit_in(unit: str, rig: HasUnits) -> str:
    """Unit of a parameter on a rig.

    Args:
        unit: SI unit of the library for a linear axis, such as ``kg`` or ``N·s/m``.
        rig: gives the units of force and position: N and m, N·m and rad, or unknown ones such as V and count.

    Returns:
        For example ``kg·m²`` for ``kg`` on a revolute joint, or ``V·s²/count``.
    """
    force, length = rig.force_unit, rig.position_unit
    if (force, length) == ("N", "m"):
        return unit
    if unit == "kg":
        return "kg·m²" if (force, length) == ("N·m", "rad") else f"{force}·s²/{length}"
    numerator, slash, denominator = unit.partition("/")
    below = _rename(denominator, force, length)
    if denominator == "N" and "·" in below:
        below = f"({below})"
    return _rename(numerator, force, length) + slash + below


def _rename(product: str, force: str, length: str) -> str:
    words = []
    for token in product.split("·"):
        tail = token[-1:] if token[-1:] in _POWERS else ""
        name = token[: len(token) - len(tail)]
        name = {"N": f"({force})" if tail and "·" in force else force, "m": length}.get(name, name)
        words.append(name + tail)
    return "·".join(words)
