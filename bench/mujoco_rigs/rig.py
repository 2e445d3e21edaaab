"""A random rig with MuJoCo's own parameters: one slide joint, one actuator, an encoder, an experiment."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

#: What may be wrong with a rig; ``frictionloss`` may also stand beside each of the others.
FAULTS = ("frictionloss", "limit", "lag", "saturation", "dead_zone")
#: What a rig without a drive cannot show.
OF_DRIVE = ("lag", "saturation", "dead_zone")
#: Experiments, with samples a second [Hz].
EXPERIMENTS = {"steps": 1000.0, "sweep": 500.0, "step": 1000.0, "release": 1000.0}
#: Faults that show only under several sizes of command.
LEVELS = ("saturation", "dead_zone")


@dataclass(frozen=True)
class Limit:
    """A joint's range and its constraint parameters.

    MuJoCo blends: acceleration = (1 - d) * unconstrained - d/d1 * (b v + k r d/d1) at a depth r beyond the range, as
    long as that pushes back; (-k, -b) is ``solref`` in its direct form, d the impedance of ``solimp`` and d1 its value
    deep inside. A small d is a spring and a damper beside all other forces; with d near 1 they stand in their place.

    Attributes:
        low, high: ends of the range [m].
        stiffness: k [1/s^2].
        damping: b [1/s].
        impedance: d at the range's end and deep inside it.
        width: depth [m] over which d goes from one to the other.
    """

    low: float
    high: float
    stiffness: float
    damping: float
    impedance: tuple[float, float]
    width: float


@dataclass(frozen=True)
class Rig:
    """Everything about a rig and what is done to it; SI units.

    Attributes:
        seed: what it was drawn from.
        faults: what is wrong with it.
        mass, armature, damping, stiffness: of the joint; its inertia is mass + armature.
        gain: force made of a unit of command.
        frictionloss: largest force of dry friction.
        lag: time constant of the actuator's filter.
        saturation: largest command that counts; infinite without a limit.
        dead_zone: command that does nothing, either way.
        limit: of the range, or none.
        experiment: one of ``EXPERIMENTS``.
        start: position at the first sample.
        commands: one a sample, held until the next.
        rate: samples a second.
        noise, count: standard deviation of the readings, encoder step (0: none) [m].
    """

    seed: int
    faults: tuple[str, ...]
    mass: float
    armature: float
    damping: float
    stiffness: float
    gain: float
    frictionloss: float
    lag: float
    saturation: float
    dead_zone: float
    limit: Limit | None
    experiment: str
    start: float
    commands: tuple[float, ...]
    rate: float
    noise: float
    count: float

    @property
    def plant(self) -> dict[str, float]:
        """Mass, damping and stiffness as they are seen by who knows commands and positions only."""
        return {
            "mass": (self.mass + self.armature) / self.gain,
            "damping": self.damping / self.gain,
            "stiffness": self.stiffness / self.gain,
        }

    @property
    def noise_level(self) -> float:
        """Standard deviation of a reading [m], rounding included."""
        return math.hypot(self.noise, self.count / math.sqrt(12.0))


class _Lot:
    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 90210])

    def even(self, low: float, high: float) -> float:
        return float(self._rng.uniform(low, high))

    def log(self, low: float, high: float) -> float:
        return math.exp(self.even(math.log(low), math.log(high)))

    def one(self, *choices: str) -> str:
        return str(self._rng.choice(choices))

    def order(self, values: list[float]) -> list[float]:
        return [float(value) for value in self._rng.permutation(values)]


def draw(seed: int, fault: str | None, beside: bool, experiment: str) -> Rig:
    """A rig with one fault, or none, alone or beside frictionloss; its strength goes from faint to plain."""
    if fault in OF_DRIVE and experiment == "release" or fault in LEVELS and experiment == "step":
        raise ValueError(f"{fault} shows nothing in {experiment}")
    lot = _Lot(seed)
    inertia, omega = lot.log(0.2, 5.0), 2.0 * math.pi * lot.even(1.5, 6.0)
    stiffness, damping = inertia * omega**2, 2.0 * lot.log(0.02, 0.25) * inertia * omega
    reach, gain = lot.even(0.004, 0.02), lot.log(0.4, 2.5)
    armature = inertia * lot.even(0.0, 0.5)
    command = stiffness * reach / gain
    commands = _commands(lot, experiment, command, omega)
    largest = float(np.max(np.abs(commands)))
    faults = tuple(dict.fromkeys([*([fault] if fault else []), *(["frictionloss"] if beside else [])]))
    noise, count = _encoder(lot, reach)
    return Rig(
        seed=seed, faults=faults, mass=inertia - armature, armature=armature, damping=damping, stiffness=stiffness,
        gain=gain,
        frictionloss=stiffness * reach * lot.log(0.006, 0.08) if "frictionloss" in faults else 0.0,
        lag=lot.log(0.02, 0.3) / omega if "lag" in faults else 0.0,
        saturation=largest * lot.even(0.5, 0.9) if "saturation" in faults else math.inf,
        dead_zone=largest * lot.log(0.02, 0.2) if "dead_zone" in faults else 0.0,
        limit=_limit(lot, reach, omega) if "limit" in faults else None,
        experiment=experiment,
        start=reach * lot.even(1.2, 1.8) if experiment == "release" else 0.0,
        commands=tuple(commands.tolist()),
        rate=EXPERIMENTS[experiment], noise=noise, count=count,
    )  # fmt: skip


def _limit(lot: _Lot, reach: float, omega: float) -> Limit:
    """A limit on one side or on both, at the same distance or not; as MuJoCo has them by default, or a mere spring."""
    place, sides = reach * lot.even(0.6, 1.1), lot.one("above", "below", "same", "other")
    far = 100.0 * reach
    other = {"above": far, "below": far, "same": place, "other": place * lot.even(0.75, 1.25)}[sides]
    low, high = (-place, other) if sides == "below" else (-other, place)
    frequency, ratio = omega * lot.log(1.2, 4.5), lot.log(0.02, 0.4)
    if lot.one("default", "spring") == "default":
        impedance, width = (0.9, 0.95), 0.001
    else:
        impedance, width = (lot.log(0.001, 0.05),) * 2, 0.001
    return Limit(low, high, frequency**2, 2.0 * ratio * frequency, impedance, width)


def _commands(lot: _Lot, experiment: str, size: float, omega: float) -> np.ndarray:
    """Commands, one a sample."""
    rate = EXPERIMENTS[experiment]
    if experiment == "release":
        return np.zeros(round(4.0 * rate))
    if experiment == "step":
        return np.full(round(3.0 * rate), size)
    if experiment == "sweep":
        time, low, high, span = np.arange(round(10.0 * rate)) / rate, lot.even(0.1, 0.3), lot.even(2.0, 3.0), 10.0
        growth = math.log(high / low) / span
        return np.asarray(lot.even(0.25, 0.5) * size * np.sin(omega * low * np.expm1(growth * time) / growth))
    levels = lot.order([1.0, -1.0, lot.even(0.2, 0.5), -lot.even(0.2, 0.5), lot.even(0.5, 0.9), -lot.even(0.5, 0.9)])
    hold = round(lot.even(0.4, 0.7) * rate)
    between = [value for level in levels for value in (level, 0.0)]
    return size * np.repeat(between, hold)


def _encoder(lot: _Lot, reach: float) -> tuple[float, float]:
    """Noise and encoder step [m]: one of them, or both; 300 to 3000 noise levels within the reach."""
    level, kind = reach / lot.log(300.0, 3000.0), lot.one("noise", "counts", "both")
    if kind == "noise":
        return level, 0.0
    if kind == "counts":
        return 0.0, level * math.sqrt(12.0)
    return level, level * lot.even(0.3, 2.0)
