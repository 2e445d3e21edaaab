"""What an effect of the rig is: a law in words, and numbers with names, units, ranges and meanings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from msd_sim.errors import RigError

#: Stands for "no limit" in ranges: a bound that ROS parameter descriptors can carry.
ANY = 1e12


@dataclass(frozen=True)
class RigParameter:
    """One number: its name, unit, value when none is given, inclusive range and meaning."""

    name: str
    unit: str
    default: float
    lower: float
    upper: float
    meaning: str
    slot: str = ""  # field of kernel.PARAMETERS, when it is not the name

    def checked(self, value: object, owner: str) -> float:
        """The value as a float.

        Raises:
            RigError: it is no number or out of range.
        """
        if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
            raise RigError(f"{owner} {self.name} is {value!r}; expected a number [{self.unit or '-'}]: {self.meaning}")
        if not self.lower <= value <= self.upper:
            raise RigError(
                f"{owner} {self.name} is {value:g} {self.unit}; expected {self._range(float(value))}: {self.meaning}"
            )
        return float(value)

    def _range(self, value: float) -> str:
        """The range that a value is out of; a bound that stands for none is told only where the value is beyond it."""
        if self.upper >= ANY and not ANY < abs(value) < math.inf:
            return f"{self.lower:g} or more" if self.lower > -ANY else "a finite number"
        return f"{self.lower:g} to {self.upper:g}"


@dataclass(frozen=True)
class RigEffect:
    """One thing that may be wrong with a rig; ``place`` is ``force`` (on the cart), ``input`` or ``sensor``."""

    name: str
    law: str
    parameters: tuple[RigParameter, ...]
    place: str = "force"
    dry_friction: bool = field(default=False)

    def values(self, given: Mapping[str, object]) -> dict[str, float]:
        """Values of all parameters, defaults filled in.

        Raises:
            RigError: a parameter that this effect has not, or a value out of range.
        """
        known = {parameter.name: parameter for parameter in self.parameters}
        for name in given:
            if name not in known:
                raise RigError(f"{self.name} has no parameter {name!r}; expected one of {', '.join(known)}")
        return {name: known[name].checked(given.get(name, known[name].default), self.name) for name in known}


def number(
    name: str, unit: str, default: float, meaning: str, lower: float = -ANY, upper: float = ANY, slot: str = ""
) -> RigParameter:
    return RigParameter(name, unit, default, lower, upper, meaning, slot or name)
