"""What a law says about its numbers: parameters, a harmonic term, and the scales of records that bound them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import Any

#: What a harmonic term repeats over.
TIME, PLACE = "time", "place"


@dataclass(frozen=True)
class RecordScales:
    """What records show, in their units: what the ranges of parameters are made of, see ``Effect.resolvable``.

    Attributes:
        mass, stiffness: of roughly the base model.
        reach, span: largest position off zero, and largest range of positions [m].
        duration, period: of the longest record, and between the closest samples [s].
        speed, rate: top speed [m/s], and of the plant's motion [rad/s].
        force: largest force [N].
        acceleration: amplitude of a sine with as much of it as the readings have, noise included [m/s²].
        weakest: a tenth of the time in which a force acts it is at most this [N].
        driven: whether a force acts: without one the motion has the plant's own frequency alone.
    """

    mass: float
    stiffness: float
    reach: float
    span: float
    duration: float
    period: float
    speed: float
    rate: float
    force: float
    driven: bool = True
    weakest: float = 0.0
    acceleration: float = 0.0


@dataclass(frozen=True)
class Parameter:
    """One number of a law.

    Attributes:
        name: name in code, results and messages; the same name means the same thing in every effect.
        symbol: as in formulas.
        unit: SI unit in terms of kg, m, s, N; ``1`` for a pure number.
        lower, upper: bounds that physics sets (both may be infinite).
        meaning: a few words for tables.
        advice: what to measure so that the data decides it.
        open_with_zero: said where the data knows it only together with the position's zero.
        open_with_scale: said where the data knows it only together with ``{others}``.
        inertia: it is a mass: what bounds it from below is a swing within a sample.
        holds: a force [N] by which the cart may stand off the balance of all others.
        kinked: the error over it has a valley for every number of half-swings.
        multistable: it gives the cart many places to rest in, so that a small error sends it to another one.
        least, most: smallest and largest size that a record of the motion could tell, as factors of the size that its
            unit has on the rig (``estimate.parameter_units.Magnitudes``).
        ceiling: largest size that a record could tell, in its unit, from duration and sample period [s]; in place of
            ``most``.
        regressor: what its force is proportional to, where the equation of motion is linear in it, as arrays (n,) of
            its arguments: ``direction`` of the motion, ``v`` [m/s] or ``x`` [m] first, or nothing for a constant; then
            ``driven``, and other parameters by name.
        quadrature: where the regressor is a sine of the position from a zero, the same a quarter turn further: both
            together, each with a factor of its own, are a sine from an unknown zero.
        not_below: the parameter of the same law that it is never below; from there on nothing would tell of it.
    """

    name: str
    symbol: str
    unit: str
    lower: float
    upper: float
    meaning: str
    _: KW_ONLY
    advice: str = ""
    open_with_zero: str = ""
    open_with_scale: str = ""
    inertia: bool = False
    holds: bool = False
    kinked: bool = False
    multistable: bool = False
    least: float = -math.inf
    most: float = math.inf
    ceiling: Callable[[float, float], float] | None = None
    regressor: Callable[..., Any] | None = None
    quadrature: Callable[..., Any] | None = None
    not_below: str = ""

    @property
    def is_phase(self) -> bool:
        """Whether it is an angle [rad], which turns round."""
        return self.unit == "rad"


@dataclass(frozen=True)
class Harmonic:
    """A term A·sin(2·pi·s/p + phi) or A·sin(omega·s + phi): names of its parameters, and what s is.

    Attributes:
        amplitude: A [N].
        scanned: omega [rad/s] over ``TIME``, the pitch p [m] over ``PLACE``.
        phase: phi [rad] at s = 0.
        over: ``TIME`` or ``PLACE``.
    """

    amplitude: str
    scanned: str
    phase: str
    over: str

    @property
    def names(self) -> tuple[str, str, str]:
        """The three names."""
        return self.amplitude, self.scanned, self.phase
