"""What a foreign law is: of a cause that rigs have, in a form that no identifier is expected to know."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from msd_sim.errors import RigError
from msd_sim.strengths import Sizes

FloatArray = npt.NDArray[np.float64]
Values = Mapping[str, float]
#: (values, t [s], x [m], v [m/s], inner states, command [N]).
Force = Callable[[Values, float, float, float, Sequence[float], float], float]
Rates = Callable[[Values, float, float, float, Sequence[float], float], tuple[float, ...]]


@dataclass(frozen=True)
class ForeignLaw:
    """A law that acts on a rig m x'' + b x' + k x + force = command.

    Attributes:
        name: of the law.
        law: in words, for tables.
        strengths: values by lot, relative to the plant.
        force: on the left-hand side [N]; ``None`` for none.
        rates: time derivatives of the inner states, which begin at 0.
        states: how many there are.
        hangs: whether the first inner state is the place of a second mass, which begins where the cart does.
        commands: what the drive makes of the (p,) commands, one after the other.
        reading: what the sensor has before it: (values, time, position, velocity, random numbers) -> position [m].
        encoder: further parameters of the encoder: (lot, level of the noise [m]) -> values.
        experiments: in which it shows.
    """

    name: str
    law: str
    strengths: Callable[[Sizes], dict[str, float]]
    force: Force | None = None
    rates: Rates | None = None
    states: int = 0
    hangs: bool = False
    commands: Callable[[Values, FloatArray], FloatArray] | None = None
    reading: Callable[[Values, FloatArray, FloatArray, FloatArray, np.random.Generator], FloatArray] | None = None
    encoder: Callable[[Sizes, float], dict[str, float]] | None = None
    experiments: tuple[Literal["steps", "release", "tones"], ...] = ("steps", "release")


def nothing(sizes: Sizes) -> dict[str, float]:
    """No values."""
    del sizes
    return {}


def both(one: ForeignLaw, two: ForeignLaw) -> ForeignLaw:
    """Two laws on one rig: their forces add up, a command goes through the first drive and then through the second.

    Names of values begin with that of their law and a full stop.

    Raises:
        RigError: no experiment shows both, or both have a sensor or a second mass.
    """
    experiments = tuple(name for name in one.experiments if name in two.experiments)
    sensors = [law for law in (one, two) if law.reading is not None or law.encoder is not None]
    if not experiments or len(sensors) > 1 or (one.hangs and two.hangs):
        raise RigError(f"{one.name} and {two.name} cannot act on one rig")
    sensor = sensors[0] if sensors else ForeignLaw("", "", nothing)
    ahead, behind = (two, one) if two.hangs else (one, two)  # the place of a second mass is the first inner state
    parts = (ahead, slice(ahead.states)), (behind, slice(ahead.states, None))

    def force(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
        return sum(law.force(_own(p, law), t, x, v, z[own], u) for law, own in parts if law.force is not None)

    def rates(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> tuple[float, ...]:
        moved = (law.rates(_own(p, law), t, x, v, z[own], u) for law, own in parts if law.rates is not None)
        return tuple(rate for inner in moved for rate in inner)

    def commands(p: Values, made: FloatArray) -> FloatArray:
        for law in (one, two):
            made = law.commands(_own(p, law), made) if law.commands is not None else made
        return made

    def reading(p: Values, time: FloatArray, x: FloatArray, v: FloatArray, rng: np.random.Generator) -> FloatArray:
        return sensor.reading(_own(p, sensor), time, x, v, rng) if sensor.reading is not None else x

    return ForeignLaw(
        name=f"{one.name}+{two.name}",
        law=f"{one.law}; {two.law}",
        strengths=lambda sizes: {
            f"{law.name}.{name}": value for law in (one, two) for name, value in law.strengths(sizes).items()
        },
        force=force,
        rates=rates,
        states=one.states + two.states,
        hangs=ahead.hangs,
        commands=commands,
        reading=reading,
        encoder=sensor.encoder,
        experiments=experiments,
    )


def _own(values: Values, law: ForeignLaw) -> Values:
    """Values of one law of two."""
    head = f"{law.name}."
    return {name[len(head) :]: value for name, value in values.items() if name.startswith(head)}
