"""Experiments by name: what is done to a rig, as a commanded force and a way to begin."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from msd_sim.errors import RigError

FloatArray = npt.NDArray[np.float64]

#: Step amplitude 0.15 at 69.5 N per unit (eq. 8).
PAPER_FORCE = 10.425


@dataclass(frozen=True)
class Experiment:
    """Commanded force [N] from its stamps [s] on, duration [s], and where the cart begins [m, m/s]."""

    force_time: FloatArray
    force: FloatArray
    duration: float
    position: float = 0.0
    velocity: float = 0.0


def _levels(levels: list[tuple[float, float]], end: float, start: float) -> Experiment:
    """Forces (instant, value) held until the next; nothing happens before ``start``."""
    time = [0.0] * (start > 0.0) + [start + at for at, _ in levels]
    force = [0.0] * (start > 0.0) + [value for _, value in levels]
    return Experiment(np.array(time), np.array(force), start + end)


def paper(force: float = PAPER_FORCE, hold: float = 3.0, start: float = 0.0) -> Experiment:
    """The paper's experiment: ``force`` [N] for ``hold`` [s], then 0 for as long; ``start`` [s] of rest before."""
    return _levels([(0.0, force), (hold, 0.0)], 2.0 * hold, start)


def step(force: float = PAPER_FORCE, hold: float = 3.0, start: float = 0.0) -> Experiment:
    """One step to ``force`` [N], held for ``hold`` [s] to the end."""
    return _levels([(0.0, force)], hold, start)


def steps(force: float = PAPER_FORCE, fraction: float = 0.3, hold: float = 3.0, start: float = 0.0) -> Experiment:
    """Steps up and back to 0, in both directions, to ``force`` [N] and to a ``fraction`` of it; ``hold`` [s] each."""
    values = [v for size in (force, fraction * force) for v in (size, 0.0, -size, 0.0)]
    return _levels([(i * hold, v) for i, v in enumerate(values)], len(values) * hold, start)


def release(position: float = 0.02, duration: float = 4.0) -> Experiment:
    """Free decay: let go at ``position`` [m] without force."""
    return Experiment(np.array([0.0]), np.array([0.0]), duration, position)


def rest(duration: float = 2.0) -> Experiment:
    """No force: a zero reading."""
    return Experiment(np.array([0.0]), np.array([0.0]), duration)


def sweep(
    force: float = 3.0, low: float = 0.15, high: float = 2.5, duration: float = 20.0, rate: float = 1000.0,
    natural_frequency: float = 27.0,
) -> Experiment:  # fmt: skip
    """Sine of amplitude ``force`` [N] from ``low`` to ``high`` times the natural frequency [rad/s]."""
    if not 0.0 < low < high:
        raise RigError(f"sweep runs from {low:g} to {high:g} times the natural frequency; expected 0 < low < high")
    time = _ticks(duration, rate)
    growth = math.log(high / low) / duration
    phase = natural_frequency * low * (np.exp(growth * time) - 1.0) / growth
    return Experiment(time, force * np.sin(phase), duration)


def ramp(force: float = PAPER_FORCE, duration: float = 40.0, rate: float = 1000.0, dwell: float = 0.0) -> Experiment:
    """Slow ramp 0, +force, 0, -force, 0 [N] over ``duration`` [s], with ``dwell`` [s] at each extreme."""
    if not 0.0 <= 2.0 * dwell < duration:
        raise RigError(f"ramp dwells twice {dwell:g} s in {duration:g} s; expected less than the duration")
    time = _ticks(duration, rate)
    leg = (duration - 2.0 * dwell) / 4.0
    corners = np.cumsum([0.0, leg, dwell, 2.0 * leg, dwell, leg])
    return Experiment(time, np.interp(time, corners, force * np.array([0.0, 1.0, 1.0, -1.0, -1.0, 0.0])), duration)


def random_steps(
    force: float = PAPER_FORCE, shortest: float = 0.02, duration: float = 10.0, profile_seed: int = 0
) -> Experiment:
    """Random levels within +-force [N], each held for ``shortest`` to ten times as long [s]."""
    rng = np.random.default_rng(int(profile_seed))
    time = np.cumsum(rng.uniform(shortest, 10.0 * shortest, math.ceil(duration / shortest)))
    time = np.concatenate([[0.0], time[time < duration]])
    return Experiment(time, rng.uniform(-force, force, time.size), duration)


def _ticks(duration: float, rate: float) -> FloatArray:
    return np.asarray(np.arange(round(duration * rate)) / rate, dtype=np.float64)


EXPERIMENTS: dict[str, Callable[..., Experiment]] = {
    function.__name__: function for function in (paper, step, steps, release, rest, sweep, ramp, random_steps)
}

#: Options that the simulation fills in from the rig when the caller does not give them.
FROM_RIG = ("rate", "natural_frequency")


def build(name: str, options: Mapping[str, Any], rig: Mapping[str, float]) -> Experiment:
    """The experiment of that name with these options; ``rig`` has the values for ``FROM_RIG``.

    Raises:
        RigError: no such experiment or option, or a value out of range.
    """
    if name not in EXPERIMENTS:
        raise RigError(f"no experiment {name!r}; expected one of {', '.join(EXPERIMENTS)}")
    function = EXPERIMENTS[name]
    known = inspect.signature(function).parameters
    for option, value in options.items():
        if option not in known:
            raise RigError(f"experiment {name} has no option {option!r}; expected one of {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise RigError(f"experiment {name}: {option} is {value!r}; expected a finite number")
        if value <= 0.0 and option in ("duration", "hold", "rate", "shortest", "natural_frequency"):
            raise RigError(f"experiment {name}: {option} is {value:g}; expected more than 0")
    return function(**{k: rig[k] for k in FROM_RIG if k in known and rig[k] > 0.0} | dict(options))
