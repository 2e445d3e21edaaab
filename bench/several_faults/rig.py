"""A random rig with three to five faults, its experiment and its encoder."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.signal import butter, lfilter

#: Experiments; a force that is random, or goes up in frequency, shows other faults than steps do.
EXPERIMENTS = ("steps", "sweep", "random")
#: Steps of a record, periods of the plant that it lasts, and most samples.
_STEPS, _PERIODS, _MOST = 12, 16.0, 7000


class Law(NamedTuple):
    """Parameters of the equation of motion (``simulate``); SI units, 0: a fault that is not there.

    ``drag`` [N s^2/m^2], ``cubic`` [N/m^3], ``square`` [N/m^2]; ``gap``: half of the play; ``creep`` [m/s]: speed up to
    which dry friction creeps; ``peak``: breakaway force over sliding force; ``bump``: part by which friction changes
    once in each ``pitch`` [m]; ``wear`` [1/m]: by which it grows along the travel; ``one_way`` [N s/m]: damping that
    changes its sign with the direction; ``aging`` [1/s]: relative change of the stiffness; ``second_*``: a mass on a
    spring and a damper of its own.
    """

    mass: float
    damping: float
    stiffness: float
    friction: float = 0.0
    peak: float = 1.0
    creep: float = 1.0
    bump: float = 0.0
    wear: float = 0.0
    offset: float = 0.0
    ripple: float = 0.0
    pitch: float = 1.0
    ripple_phase: float = 0.0
    cubic: float = 0.0
    square: float = 0.0
    drag: float = 0.0
    gap: float = 0.0
    stop: float = math.inf
    stop_stiffness: float = 0.0
    one_way: float = 0.0
    aging: float = 0.0
    tone: float = 0.0
    tone_frequency: float = 0.0
    second_mass: float = 0.0
    second_stiffness: float = 0.0
    second_damping: float = 0.0


@dataclass(frozen=True)
class Rig:
    """Everything about a rig and what is done to it; SI units.

    Attributes:
        seed: what it was drawn from.
        plant: mass, damping and stiffness.
        faults: the causes that act, each with its values. Those that are no parameters of the ``Law`` are of the drive
            (``delay`` and ``lag`` [s]; ``gain_slope``: its gain is 1 + gain_slope·abs(u)/size) and of the sensor
            (``bend``, ``bow``: y = x + bend·x² + bow·x³; ``drift`` [m/s]).
        experiment: one of ``EXPERIMENTS``.
        commands: one a sample [N], held until the next.
        size: largest force [N].
        rate: samples a second.
        noise, count: standard deviation of the readings, encoder step [m].
    """

    seed: int
    plant: Mapping[str, float]
    faults: Mapping[str, Mapping[str, float]]
    experiment: str
    commands: np.ndarray
    size: float
    rate: float
    noise: float
    count: float

    @property
    def law(self) -> Law:
        """The parameters of the motion."""
        return Law(**self.plant, **{name: value for name, value in self._values.items() if name in Law._fields})

    def value(self, name: str) -> float:
        """A value of the drive or of the sensor; 0 where no fault has it."""
        return self._values.get(name, 0.0)

    @property
    def at_rest(self) -> dict[str, float]:
        """Mass, damping and stiffness for small motions about the place where springs and a constant force balance,
        for each metre that the sensor reads there.

        A record does not tell a constant force on a bent spring from another zero of it, nor one beside a bent sensor
        from another scale; with a play the zero is seen.
        """
        law = self.law
        if law.gap > 0.0:
            return dict(self.plant)
        far = -2.0 * law.offset / law.stiffness
        spring = np.polynomial.Polynomial([law.offset, law.stiffness, law.square, law.cubic])
        place = float(brentq(spring, *sorted((0.0, far)))) if far else 0.0
        scale = 1.0 + 2.0 * self.value("bend") * place + 3.0 * self.value("bow") * place**2
        found = {**self.plant, "stiffness": float(spring.deriv()(place))}
        return {name: value / scale for name, value in found.items()}

    @property
    def _values(self) -> dict[str, float]:
        return {name: value for one in self.faults.values() for name, value in one.items()}

    @property
    def noise_level(self) -> float:
        """Standard deviation of a reading [m], rounding included."""
        return math.hypot(self.noise, self.count / math.sqrt(12.0))

    def without(self, fault: str) -> Rig:
        """The same rig without one of its faults."""
        return replace(self, faults={name: values for name, values in self.faults.items() if name != fault})

    def with_values(self, fault: str, values: Mapping[str, float]) -> Rig:
        """The same rig with other values of one of its faults."""
        return replace(self, faults={**self.faults, fault: {**self.faults[fault], **values}})


class _Lot:
    """Random numbers of one rig, and the sizes that strengths are drawn in: force, travel, speed, time."""

    def __init__(self, seed: int, turn: int) -> None:
        self.rng = np.random.default_rng([seed, 47, turn] if turn else [seed, 47])
        self.mass, self.omega = self.log(0.3, 3.0), self.log(8.0, 35.0)
        self.stiffness = self.mass * self.omega**2
        self.damping = 2.0 * self.even(0.03, 0.25) * self.mass * self.omega
        self.rate = float(self.rng.choice((500.0, 1000.0)))
        self.samples = int(min(_PERIODS * 2.0 * math.pi / self.omega * self.rate, _MOST))
        self.duration = self.samples / self.rate
        self.travel = 0.012
        self.force = 1.7 * self.stiffness * self.travel

    def even(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def log(self, low: float, high: float) -> float:
        return math.exp(self.even(math.log(low), math.log(high)))

    def signed(self, low: float, high: float) -> float:
        return self.even(low, high) * float(self.rng.choice((-1.0, 1.0)))


#: Each fault: what it changes, in the sizes of the rig.
FAULTS: Mapping[str, Callable[[_Lot], dict[str, float]]] = {
    "coulomb_friction": lambda lot: _friction(lot),
    "stribeck_friction": lambda lot: {**_friction(lot), "peak": lot.even(1.3, 2.2)},
    "position_dependent_friction": lambda lot: {**_friction(lot), "wear": lot.signed(0.2, 0.8) / lot.travel},
    "friction_ripple": lambda lot: {
        **_friction(lot), "bump": lot.even(0.2, 0.8), "pitch": lot.travel * lot.log(0.15, 0.5)
    },
    "force_offset": lambda lot: {"offset": lot.force * lot.even(-0.2, 0.2)},
    "cogging": lambda lot: {
        "ripple": lot.force * lot.log(0.01, 0.06),
        "pitch": lot.travel * lot.log(0.15, 0.5), "ripple_phase": lot.even(-3.0, 3.0),
    },
    "cubic_spring": lambda lot: {"cubic": lot.stiffness * lot.log(0.03, 0.3) / lot.travel**2},
    "asymmetric_spring": lambda lot: {"square": lot.stiffness * lot.signed(0.03, 0.2) / lot.travel},
    "quadratic_drag": lambda lot: {"drag": lot.damping * lot.log(0.1, 1.0) / (lot.travel * lot.omega)},
    "backlash": lambda lot: {"gap": lot.travel * lot.log(0.01, 0.08)},
    "end_stop": lambda lot: {"stop": lot.travel * lot.even(0.5, 0.9), "stop_stiffness": lot.stiffness * lot.log(1, 20)},
    "direction_dependent_damping": lambda lot: {"one_way": lot.damping * lot.signed(0.05, 0.4)},
    "stiffness_drift": lambda lot: {"aging": lot.signed(0.01, 0.08) / lot.duration},
    "periodic_disturbance": lambda lot: {
        "tone": lot.force * lot.log(0.01, 0.05), "tone_frequency": lot.omega * lot.even(0.4, 2.5)
    },
    "second_mode": lambda lot: _second(lot, lot.mass * lot.log(0.05, 0.4), lot.omega * lot.even(2.0, 5.0)),
    "time_offset": lambda lot: {"delay": lot.even(0.5, 4.0) / lot.rate},
    "actuator_lag": lambda lot: {"lag": lot.even(0.02, 0.15) / lot.omega},
    "force_gain_nonlinearity": lambda lot: {"gain_slope": lot.signed(0.03, 0.12)},
    "sensor_nonlinearity": lambda lot: {
        "bend": lot.even(-0.02, 0.02) / lot.travel, "bow": lot.even(-0.03, 0.03) / lot.travel**2
    },
    "sensor_drift": lambda lot: {"drift": 0.6 * lot.travel * lot.signed(0.005, 0.05) / lot.duration},
}  # fmt: skip
#: Laws of dry friction: a rig has one of them.
_DRY = ("coulomb_friction", "stribeck_friction", "position_dependent_friction", "friction_ripple")
#: Value of each of them with which it is a constant force.
CONSTANT = {
    "stribeck_friction": {"peak": 1.0},
    "position_dependent_friction": {"wear": 0.0},
    "friction_ripple": {"bump": 0.0},
}


def _friction(lot: _Lot) -> dict[str, float]:
    return {"friction": lot.force * lot.log(0.01, 0.1), "creep": 5e-4 * lot.travel * lot.omega}


def _second(lot: _Lot, mass: float, omega: float) -> dict[str, float]:
    return {"second_mass": mass, "second_stiffness": mass * omega**2, "second_damping": 0.08 * mass * omega}


def draw(seed: int, experiment: str, turn: int = 0) -> Rig:
    """A rig with three to five faults, each of them from faint to plain; another one each ``turn``."""
    lot = _Lot(seed, turn)
    names = [str(name) for name in lot.rng.permutation(sorted(FAULTS))]
    dry = [name for name in names if name in _DRY]
    faults = [name for name in names if name not in dry[1:]][: int(lot.rng.integers(3, 6))]
    level = 0.6 * lot.travel * lot.log(10.0**-3.7, 10.0**-2.7)
    return Rig(
        seed=seed,
        plant={"mass": lot.mass, "damping": lot.damping, "stiffness": lot.stiffness},
        faults={name: FAULTS[name](lot) for name in sorted(faults)},
        experiment=experiment,
        commands=_commands(lot, experiment),
        size=lot.force,
        rate=lot.rate,
        noise=level,
        count=level * lot.even(0.5, 3.0),
    )


def _commands(lot: _Lot, experiment: str) -> np.ndarray:
    """Commands, one a sample [N]."""
    time = np.arange(lot.samples) / lot.rate
    if experiment == "steps":
        levels = np.append(0.0, lot.rng.uniform(-1.0, 1.0, _STEPS - 1))
        return np.asarray(lot.force * levels[np.minimum(_STEPS * np.arange(lot.samples) // lot.samples, _STEPS - 1)])
    cutoff = 3.0 * lot.omega / (2.0 * math.pi)
    if experiment == "sweep":
        low = 0.2 * lot.omega / (2.0 * math.pi)
        turns = low * time + (cutoff - low) * time**2 / (2.0 * lot.duration)
        return np.asarray(0.5 * lot.force * np.sin(2.0 * math.pi * turns))
    shaken = lfilter(*butter(2, min(2.0 * cutoff / lot.rate, 0.9)), lot.rng.normal(size=lot.samples))
    return np.asarray(0.5 * lot.force * shaken / np.std(shaken))
