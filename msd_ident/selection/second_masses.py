"""Starting values for a second mass, by regressions on the residual of a fitted model.

With a heavy second mass, the fit without it is far from the right mass, spring and damper: its mass is the sum of both,
and no descent leads from there to the right ones. But for a given frequency ω and damping ratio ζ of the second mass
alone, its force on the first is m2·H·x″ with H = (2ζωs + ω²)/(s² + 2ζωs + ω²). With G = 1/(m s² + b s + k) of the
fitted model, the residual is linear in the missing terms,

    x_model - x = G·(Δm·x″ + Δb·x′ + Δk·x + m2·H·x″),

so each trial of ω and ζ is one linear regression, without a simulation (variable projection, Golub and Pereyra 1973).
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from msd_ident.data.compiled import pole_zero
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import THOROUGH
from msd_ident.estimate.levels import TENTH
from msd_ident.estimate.peaks import highest
from msd_ident.model import Model
from msd_ident.model.effects import typical
from msd_ident.model.effects.law import SECOND_MASS
from msd_ident.tuning import fixed, tuned

_FREQUENCIES = tuned(
    (0.3, 30.0),
    unit="1",
    why="frequencies of a second mass that are tried, in parts of the plant's own",
    chosen="by hand",
)
_RATIOS = tuned(
    (0.03, 0.15), unit="1", why="damping ratios of a second mass that are tried at each frequency", chosen="by hand"
)
_NYQUIST = fixed(0.9 * math.pi, "mathematics", "rad a sample period: beyond pi no motion is sampled")
_DAMPED = fixed((1e-3, 1.0), "mathematics", "damping ratios of a mass that swings by itself")
_FASTEST = fixed(
    0.5, "mathematics", "rad a sample period: up to it the trapezoidal rule shifts a frequency by 2 % or less"
)


@dataclass(frozen=True)
class SecondMass:
    """A start.

    Attributes:
        plant: mass [kg], damping [N·s/m] and stiffness [N/m] of the first.
        hung: mass [kg], stiffness [N/m] and damping [N·s/m] of the second.
    """

    plant: tuple[float, float, float]
    hung: tuple[float, float, float]


def second_masses(plant: Model, record: Record, residual: FloatArray, fixed: Collection[str]) -> list[SecondMass]:
    """The second masses that explain most of a residual, the best first.

    Args:
        plant: mass, damping and stiffness of the fitted model.
        record: positions from the relaxed spring.
        residual: (n,) model − data [m] there.
        fixed: parameters of the plant that are not fitted.
    """
    missing = _Missing.of(plant, record, residual, [name not in fixed for name in ("mass", "damping", "stiffness")])
    frequencies = _frequencies(plant, record, missing.period, THOROUGH)
    frequencies = frequencies[frequencies < _NYQUIST / missing.period]
    if not frequencies.size:
        return []
    gain = np.array([[missing.gain(frequency, ratio) for ratio in _RATIOS] for frequency in frequencies.tolist()])
    widest = (float(frequencies[0]), max(_FASTEST / missing.period, float(frequencies[-1])))
    found = []
    for peak in highest(gain.max(axis=1)):
        trial = missing.sharpest(float(frequencies[peak]), _RATIOS[int(np.argmax(gain[peak]))], widest)
        found += _start(plant, missing.free, missing.solution(*trial), *trial)
    return found


@dataclass(frozen=True)
class _Missing:
    """The regression of a residual on what a second mass would add.

    Attributes:
        free: which of mass, damping and stiffness are fitted.
        moved: (n, 3) what the plant makes of x″, x′ and x.
        others: (n, q) columns beside that of the second mass.
        frame: (n, q) orthonormal base of these.
        left: (n,) the residual [m].
        beyond: (n,) the part of it that ``frame`` does not reach.
        period: between samples [s].
    """

    free: list[bool]
    moved: FloatArray
    others: FloatArray
    frame: FloatArray
    left: FloatArray
    beyond: FloatArray
    period: float

    @classmethod
    def of(cls, plant: Model, record: Record, residual: FloatArray, free: list[bool]) -> _Missing:
        """The regression for a record, on even samples."""
        period = record.duration / (record.samples - 1)
        time = record.time[0] + period * np.arange(record.samples)
        position, left = np.interp(time, record.time, record.position), np.interp(time, record.time, residual)
        moved, common = _common(plant, position, period)
        others = np.column_stack([moved[:, free], common])
        frame = np.linalg.qr(others / np.maximum(np.linalg.norm(others, axis=0), 1e-300))[0]
        return cls(free, moved, others, frame, left, left - frame @ (frame.T @ left), period)

    def hung(self, frequency: float, ratio: float) -> FloatArray:
        """(n,) what the plant makes of the force of 1 kg that hangs on it, with its own frequency [rad/s] and damping
        ratio.
        """
        bent = 2.0 / self.period * math.tan(0.5 * frequency * self.period)  # which the trapezoidal rule bends back
        fade, square = 2.0 * ratio * bent, bent**2
        return filtered((0.0, fade, square), (1.0, fade, square), self.moved[:, 0], self.period)

    def gain(self, frequency: float, ratio: float) -> float:
        """Sum of squares that such a mass takes away; 0 where it would be less than nothing."""
        hung = self.hung(frequency, ratio)
        hung -= self.frame @ (self.frame.T @ hung)
        along, size = float(hung @ self.beyond), float(hung @ hung)
        return along**2 / max(size, 1e-300) if along > 0.0 and math.isfinite(size) else 0.0

    def sharpest(self, frequency: float, ratio: float, widest: tuple[float, float]) -> tuple[float, float]:
        """Frequency [rad/s] and damping ratio at the top of the peak of ``gain`` beside these.

        Over many swings of a faintly damped mass a start must know its frequency to a part of a swing in all of them.
        """

        def lost(at: FloatArray) -> float:
            return -self.gain(math.exp(at[0]), math.exp(at[1]))

        lower, upper = np.log([widest, _DAMPED]).T
        top = scipy.optimize.minimize(
            lost,
            np.clip(np.log([frequency, ratio]), lower, upper),
            method="Nelder-Mead",
            bounds=scipy.optimize.Bounds(lower, upper),
            options={"maxfev": THOROUGH, "xatol": TENTH**4, "fatol": 0.0},
        )
        sharp, damped = np.exp(top.x).tolist()
        return sharp, damped

    def solution(self, frequency: float, ratio: float) -> FloatArray:
        """(q + 1,) factors of the plant's free terms, of the second mass [kg], and of what is common to all."""
        columns = np.insert(self.others, sum(self.free), self.hung(frequency, ratio), axis=1)
        size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        return np.asarray(np.linalg.lstsq(columns / size, self.left, rcond=1e-12)[0] / size)


def light_masses(plant: Model, record: Record) -> list[tuple[float, float, float]]:
    """Mass [kg], stiffness [N/m] and damping [N·s/m] of second masses of a tenth of the first, at all frequencies that
    are tried, every other one.
    """
    mass, ratio = TENTH * plant.mass, _RATIOS[-1]
    found = _frequencies(plant, record, record.duration / (record.samples - 1), THOROUGH // 2).tolist()
    return [(mass, mass * w * w, 2.0 * ratio * mass * w) for w in found]


def swing(model: Model) -> float:
    """Period [s] in which a second mass swings against the first, 2·pi·sqrt(m·m2/(m + m2)/k2); 0 without one."""
    hung = model.structure(SECOND_MASS)
    if not hung or not hung[0] > 0.0:
        return 0.0
    reduced = model.mass * hung[0] / (model.mass + hung[0])
    return 2.0 * math.pi * math.sqrt(reduced / hung[1]) if hung[1] > 0.0 else math.inf


def _frequencies(plant: Model, record: Record, period: float, count: int) -> FloatArray:
    own, (slow, fast) = typical.natural_frequency(record, plant), _FREQUENCIES
    return np.geomspace(slow * own, max(min(fast * own, _FASTEST / period), own), count)


def _common(plant: Model, position: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    """What the plant makes of x″, x′ and x (n, 3); and of friction, of a constant force and of another beginning."""
    own = (plant.mass, plant.damping, plant.stiffness)
    way, kick = position - position[0], np.eye(1, position.size)[0]
    direction = np.sign(np.gradient(position))
    moved = [filtered(part, own, way, period) for part in np.eye(3)]
    forces = [filtered((0.0, 0.0, 1.0), own, force, period) for force in (direction, np.ones(way.size), kick)]
    return np.column_stack(moved), np.column_stack(
        [*forces, filtered((0.0, 1.0, 0.0), own, kick, period), np.ones(way.size)]
    )


def filtered(
    above: tuple[float, float, float] | FloatArray, below: tuple[float, float, float], signal: FloatArray, period: float
) -> FloatArray:
    """A signal (n,) through (a s² + b s + c)/(d s² + e s + f), by the trapezoidal rule."""
    rate = 2.0 / period
    upper, lower = (
        np.array([a * rate**2 + b * rate + c, 2.0 * (c - a * rate**2), a * rate**2 - b * rate + c])
        for a, b, c in (above, below)
    )
    return pole_zero(upper, lower, signal)


def _start(plant: Model, free: list[bool], solution: FloatArray, frequency: float, ratio: float) -> list[SecondMass]:
    """The start that a regression says; none where it leaves too little of the first mass."""
    change = np.zeros(3)
    change[free] = solution[: sum(free)]
    second = float(solution[sum(free)])
    mass, damping, stiffness = (change + (plant.mass, plant.damping, plant.stiffness)).tolist()
    if not (second > 0.0 and mass > TENTH * plant.mass):
        return []
    hung = (second, second * frequency**2, 2.0 * ratio * second * frequency)
    return [SecondMass((mass, max(damping, 0.0), max(stiffness, 0.0)), hung)]
