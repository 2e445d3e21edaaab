"""Linear rigs drawn from a seed, their responses in closed form: truth for the features' intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import Hold, Record, from_samples

FloatArray = npt.NDArray[np.float64]


def unit_response(time: FloatArray, frequency: float, ratio: float) -> FloatArray:
    """Step response (n,) of x''/ωn² + (2ζ/ωn) x' + x = 1 from rest, by its complex roots."""
    root = np.sqrt(complex(ratio**2 - 1.0) if ratio != 1.0 else 1e-12)
    slow, fast = frequency * (-ratio + root), frequency * (-ratio - root)
    after = np.maximum(time, 0.0)
    return np.asarray((1.0 - (fast * np.exp(slow * after) - slow * np.exp(fast * after)) / (fast - slow)).real)


@dataclass(frozen=True)
class Rig:
    """ωn [rad/s], ζ, K [m/N]."""

    frequency: float
    ratio: float
    gain: float

    @property
    def period(self) -> float:
        """2π/ωn [s]."""
        return float(2.0 * np.pi / self.frequency)

    def response(self, time: FloatArray, levels: list[tuple[float, float]]) -> FloatArray:
        """Motion (n,) from rest under a force that becomes ``levels`` = [(time, force)]."""
        position, before = np.zeros(time.size), 0.0
        for start, force in levels:
            position += self.gain * (force - before) * unit_response(time - start, self.frequency, self.ratio)
            before = force
        return position


def command(time: FloatArray, levels: list[tuple[float, float]]) -> FloatArray:
    """The force (n,) that holds each of ``levels`` from its time on."""
    force = np.zeros(time.size)
    for start, value in levels:
        force[time >= start - 1e-12] = value
    return force


def record(
    rig: Rig, time: FloatArray, levels: list[tuple[float, float]], noise: float = 0.0, step: float = 0.0, seed: int = 0,
    hold: Hold = "zero",
) -> Record:  # fmt: skip
    """A measurement of the rig: white noise [m], then an encoder of this step [m]."""
    position = rig.response(time, levels) + noise * np.random.default_rng(seed).standard_normal(time.size)
    return from_samples(time, command(time, levels), np.round(position / step) * step if step else position, hold=hold)


def drawn(seed: int, lowest: float, highest: float) -> tuple[Rig, Record]:
    """A rig with ζ between ``lowest`` and ``highest``, and a step up and back: noise or encoder, long or short."""
    rng = np.random.default_rng(seed)
    between = lambda low, high: float(np.exp(rng.uniform(np.log(low), np.log(high))))  # noqa: E731
    rig = Rig(between(5.0, 60.0), between(lowest, highest), between(1e-4, 2e-2) * rng.choice([-1.0, 1.0]))
    slowest = rig.frequency / (rig.ratio + np.sqrt(max(rig.ratio**2 - 1.0, 0.0)))
    held = max(rng.uniform(3.0, 12.0) * rig.period, rng.uniform(3.0, 8.0) / slowest if rig.ratio > 0.6 else 0.0)
    spacing = rig.period / between(25.0, 300.0)
    time = np.arange(0.0, 2.0 * held + rng.uniform(0.3, 2.0) * rig.period, spacing)
    first = time[-1] - 2.0 * held
    on, off = (float(time[np.searchsorted(time, at)]) for at in (first, first + held))
    force = between(0.3, 50.0) * rng.choice([-1.0, 1.0])
    floor = abs(rig.gain * force) * between(1e-4, 1e-2)
    quantised = rng.random() < 0.5
    levels = [(on, force), (off, 0.0)]
    return rig, record(rig, time, levels, 0.0 if quantised else floor, 2.0 * floor if quantised else 0.0, seed)
