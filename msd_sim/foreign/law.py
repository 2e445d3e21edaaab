"""What a foreign law is: of a cause that rigs have, in a form that no identifier is expected to know."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

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
