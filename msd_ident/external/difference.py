"""One difference between a simulation and a rig."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from msd_ident.data.record import Record
from msd_ident.estimate import FitResult
from msd_ident.model import Model, Simulator
from msd_ident.model.effects import spoken
from msd_ident.quantity import Quantity, probability

#: Standard deviations from which on two values differ.
SIGMAS = 3.0
#: What a difference does to the motion, in noise floors, from which on it is worth a word.
VISIBLE = 0.5

Kind = Literal["lacks", "has", "value"]


@dataclass(frozen=True)
class Difference:
    """An effect that only one of them has, or a parameter that differs.

    Attributes:
        kind: ``lacks``: the simulation has not what the rig has; ``has``: the other way round; ``value``.
        name: effect, or parameter.
        rig, simulation: the quantity that shows it.
        does: what it does to the simulated motion, root mean square in the position unit.
        probability: that the rig has the effect; NaN for a parameter.
    """

    kind: Kind
    name: str
    rig: Quantity
    simulation: Quantity
    does: float
    probability: float = math.nan

    @property
    def percent(self) -> Quantity:
        """How far the simulation's value is off [%], with the interval that both leave."""
        ratio = self.simulation.value / self.rig.value if self.rig.value else math.nan
        if not self.simulation.value:
            return Quantity(100.0 * (ratio - 1.0), math.nan, "%")
        parts = math.hypot(self.simulation.std / self.simulation.value, self.rig.std / self.rig.value)
        return Quantity(100.0 * (ratio - 1.0), abs(100.0 * ratio * parts), "%")

    @property
    def sentence(self) -> str:
        """For the terminal."""
        words = self.name.replace("_", " ")
        sure = f" (probability {probability(self.probability)})" if math.isfinite(self.probability) else ""
        if self.kind == "lacks":
            return f"It lacks {spoken(self.name)}{sure}: {_with_interval(self.rig)} on the rig"
        if self.kind == "has":
            return f"It has {spoken(self.name)} that the rig does not show: {_with_interval(self.simulation)}"
        off = self.percent
        size = f"{abs(off.value):.3g} ± {1.96 * off.std:.2g} % " if math.isfinite(off.std) else ""
        side = "too large" if abs(self.simulation.value) > abs(self.rig.value) else "too small"
        values = f"{_with_interval(self.simulation)} against {_with_interval(self.rig)} on the rig"
        return f"Its {words} is {size}{side}: {values}"


def _with_interval(quantity: Quantity) -> str:
    interval = f" ± {1.96 * quantity.std:.2g}" if quantity.known and quantity.std else ""
    return f"{quantity.value:.4g}{interval} {quantity.unit}"


def differences(
    rig: FitResult, simulation: FitResult, records: Sequence[Record], floor: float, sure: dict[str, float]
) -> tuple[Difference, ...]:
    """All that differs, the largest part of the motion first.

    Args:
        rig: the model fitted to what was measured.
        simulation: the same structure fitted to what was simulated.
        records: their force.
        floor: noise of a reading, in the position unit.
        sure: effect → probability that the rig has it.
    """
    found: list[Difference] = []
    names = {p.name: effect.name for effect in rig.model.effects for p in effect.parameters}
    named: set[str] = set()
    for effect in rig.model.effects:
        one = _effect(effect.name, rig, simulation, records, floor)
        if one is not None:
            known = sure.get(effect.name, math.nan) if one.kind == "lacks" else math.nan
            found.append(replace(one, probability=known))
            named |= {name for name, owner in names.items() if owner == effect.name}
    for name in rig.free:
        if name in named:
            continue
        one = _value(name, rig, simulation, records)
        if one is not None and one.does > VISIBLE * floor:
            found.append(one)
    return tuple(sorted(found, key=lambda difference: -difference.does))


def _effect(
    name: str, rig: FitResult, simulation: FitResult, records: Sequence[Record], floor: float
) -> Difference | None:
    """An effect that does something to the motion of one of them and nothing to that of the other."""
    effect = rig.model.effect(name)
    here = _moves(rig.model, rig.model.without(name), rig, records)
    there = _moves(simulation.model, simulation.model.without(name), simulation, records)
    weak, strong = sorted((here, there))
    if strong <= VISIBLE * floor or weak > 0.2 * strong:
        return None
    shown = effect.parameters[0].name
    kind: Kind = "lacks" if here > there else "has"
    both = rig.quantities[shown], simulation.quantities[shown]
    return Difference(kind, name, *both, strong)


def _value(name: str, rig: FitResult, simulation: FitResult, records: Sequence[Record]) -> Difference | None:
    one, other = rig.quantities[name], simulation.quantities.get(name)
    if other is None or not (one.known and other.known):
        return None
    if abs(one.value - other.value) <= SIGMAS * math.hypot(one.std, other.std):
        return None
    moved = simulation.model.with_values({name: one.value})
    return Difference("value", name, one, other, _moves(simulation.model, moved, simulation, records))


def _moves(one: Model, other: Model, fitted: FitResult, records: Sequence[Record]) -> float:
    """Root mean square by which two models' motions differ under the records' forces."""
    parts = []
    for record, start in zip(records, fitted.initial, strict=True):
        runs = [Simulator(m, record).positions(m.values, start.position, start.velocity) for m in (one, other)]
        parts.append(np.nan_to_num(runs[0] - runs[1], nan=1e6))
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
