"""Prediction of readings for a profile by an explanation, with their derivatives by its parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from msd_ident import seeds
from msd_ident.data import quality
from msd_ident.data.record import FloatArray, Record
from msd_ident.design.profile import Profile
from msd_ident.estimate.effort import A_SWING, FEWEST_READINGS, SAMPLES, SLACK
from msd_ident.estimate.problem import Initial
from msd_ident.model import Simulator
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.selection.ranking import LEADERS
from msd_ident.tuning import fixed, tuned

NUISANCES = fixed(
    2,
    "mathematics",
    "rows of every Jacobian besides the parameters': the start position, and the reading of the relaxed spring",
)
DRAWS = tuned(
    48,
    unit="draws",
    why="parameter vectors that are drawn from what the data leaves of each contender",
    chosen="by hand",
)
_FAR = tuned(0.3, unit="1", why="part of a parameter beyond which no straight line holds", chosen="by hand")


@dataclass(frozen=True)
class Sensing:
    """Measurement of the rig's encoder.

    Attributes:
        noise: standard deviation of a reading, rounding included [m].
        step: of the encoder, 0 where none is seen [m].
        period: between samples [s].
        variance: of what the explanations leave along the features of a motion, in units of the noise's: 1 where that
            is noise. No law of a rig is exact, and a new record will hold its error too.
    """

    noise: float
    step: float
    period: float
    variance: float = 1.0

    @cached_property
    def dither(self) -> float:
        """Noise ahead of the encoder's rounding [m]."""
        return math.sqrt(max(self.noise**2 - self.step**2 / 12.0, 0.0))

    def weight(self, speed: FloatArray) -> FloatArray:
        """Weight (n,) of each sample as evidence, at these speeds [m/s].

        A run of equal readings counts once (``residuals.noise_model``). A run is as long as it takes to move on by one
        count, or until noise changes the reading.
        """
        if self.step <= 0.0:
            return np.ones(speed.size)
        moved = np.hypot(speed * self.period, 1.6 * self.dither)
        return np.minimum(moved / self.step, 1.0)


def sensing(records: Sequence[Record], noise: float) -> Sensing:
    """Encoder step and sample period of the records, with a known noise.

    Args:
        records: the largest encoder step and the shortest period among them count.
        noise: standard deviation of a reading [m].
    """
    step = max(quality.encoder_step(record) for record in records)
    return Sensing(noise, step, min(record.period for record in records))


@dataclass(frozen=True)
class Grid:
    """Instants at which predictions of one profile are compared, on the clock of its first command.

    Attributes:
        record: with the profile's force; its positions mean nothing.
        each: number of real samples for each instant.
    """

    record: Record
    each: float


def instants(profile: Profile, period: float, seen: Sensing) -> int:
    """Number of instants at which a profile is predicted.

    Args:
        profile: its sweeps need fine steps too.
        period: of the plant [s].
        seen: its sample period is the finest step.
    """
    swing = min((1.0 / s.high_hz for s in profile.segments if s.high_hz > 0.0), default=math.inf)
    step = max(min(period, swing) / A_SWING, seen.period)
    return int(np.clip(profile.duration / step, FEWEST_READINGS, 4 * SAMPLES)) + 1


def grid(profile: Profile, period: float, seen: Sensing) -> Grid:
    """Evenly spaced instants over a profile.

    Args:
        profile: gives duration and force.
        period: of the plant [s].
        seen: its sample period is the finest step.
    """
    count = instants(profile, period, seen)
    time = np.linspace(0.0, profile.duration, count)
    at, force = profile.commands
    record = Record(time=time, position=np.zeros(count), force_time=at, force=force, name=profile.name)
    return Grid(record, profile.duration / (count - 1) / seen.period)


@dataclass(frozen=True)
class Prediction:
    """Readings of an explanation on a grid.

    Attributes:
        position: (n,) [m].
        speed: (n,) magnitude [m/s].
        jacobian: (p + 2, n) derivatives of the readings by each free parameter, the start position and the zero.
    """

    position: FloatArray
    speed: FloatArray
    jacobian: FloatArray


@dataclass(frozen=True, eq=False)
class Predictor:
    """An explanation that predicts readings.

    The cart begins at rest: where it began in the record that started at rest nearest to the relaxed spring.

    Attributes:
        contender: the explanation.
        nudge: finite-difference step of the start position [m].
    """

    contender: CandidateModel
    nudge: float

    @cached_property
    def places(self) -> list[int]:
        """Indices of the free parameters among the model's."""
        return [self.contender.model.names.index(name) for name in self.contender.free]

    @cached_property
    def start(self) -> Initial:
        """State at the start: of the measured starts at rest, the one nearest to the relaxed spring."""
        calm = [one for one in self.contender.initial if one.velocity == 0.0] or [Initial()]
        return min(calm, key=lambda one: abs(one.position))

    @cached_property
    def precision(self) -> FloatArray:
        """Information (p, p) about the free parameters: that of the data, and a prior of natural size."""
        return np.asarray(self.contender.information + np.diag(self.contender.scale**-2.0))

    @cached_property
    def covariance(self) -> FloatArray:
        """(p, p) of the free parameters, given the data."""
        size = np.sqrt(np.diag(self.precision))
        scaled = self.precision / np.outer(size, size)
        return np.asarray(np.linalg.pinv(scaled, rcond=1e-12, hermitian=True) / np.outer(size, size))

    @cached_property
    def draws(self) -> FloatArray:
        """Fixed deviations (DRAWS, p) of the free parameters, drawn from their covariance.

        None changes a parameter by more than ``_FAR`` of its value, because the prediction is linear in the deviation.
        """
        normal = np.random.default_rng(seeds.PREDICTION).standard_normal((DRAWS, self.point.size))
        size = np.sqrt(np.maximum(np.diag(self.covariance), 1e-300))
        values, vectors = np.linalg.eigh(self.covariance / np.outer(size, size))
        drawn = normal @ (vectors * np.sqrt(np.maximum(values, 0.0))).T * size
        room = _FAR * np.where(self.point == 0.0, self.contender.scale, np.abs(self.point))
        return np.asarray(drawn / np.maximum(np.max(np.abs(drawn) / room, axis=1, keepdims=True), 1.0))

    @cached_property
    def point(self) -> FloatArray:
        """(p,) fitted values of the free parameters."""
        return np.asarray(self.contender.model.values[self.places])

    @cached_property
    def steps(self) -> FloatArray:
        """Finite-difference steps (p,) that change the measured data by about its noise."""
        scale = self.contender.scale
        sure = 1.0 / np.sqrt(np.maximum(np.diag(self.precision), 1e-300))
        steps = np.clip(sure, 1e-6 * scale, 1e-3 * scale)
        upper = np.array([self.contender.model.parameters[i].upper for i in self.places])
        return np.asarray(np.where(self.point + steps > upper, -steps, steps))

    def readings(
        self, on: Record, points: FloatArray, start: FloatArray, velocity: float = 0.0, slack: float = 1.0
    ) -> FloatArray:
        """Simulated readings (q, n) [m] for several points.

        Args:
            on: record with stamps and force.
            points: (q, p) values of the free parameters.
            start: (q, 2) start position from the relaxed spring, and zero [m].
            velocity: at the start [m/s], the same for all.
            slack: of the simulation, see ``Simulator``.
        """
        model = self.contender.model
        values = np.repeat(model.values[None, :], len(points), axis=0)
        values[:, self.places] = points
        rows = Simulator(model, on, slack).positions_many(values, start[:, 0], np.full(len(points), velocity))
        return np.asarray(np.nan_to_num(rows + start[:, 1:], nan=1e6, posinf=1e6, neginf=-1e6))

    def positions(self, on: Record) -> FloatArray:
        """Readings (n,) [m] at the fitted values."""
        start = np.array([[self.start.position, self.start.zero]])
        return np.asarray(self.readings(on, self.point[None, :], start, slack=SLACK)[0])

    def drawn(self, on: Record, count: int = LEADERS) -> FloatArray:
        """Readings (1 + count, n) [m] at the fitted values, and at the first draws within their bounds.

        Args:
            on: record with stamps and force.
            count: of draws, ``DRAWS`` at most.
        """
        owned = [self.contender.model.parameters[i] for i in self.places]
        points = np.clip(self.point + self.draws[:count], [one.lower for one in owned], [one.upper for one in owned])
        start = np.array([[self.start.position, self.start.zero]])
        every = np.repeat(start, 1 + count, axis=0)
        return self.readings(on, np.vstack([self.point, points]), every, slack=SLACK)

    def linearised(
        self, on: Record, point: FloatArray, start: FloatArray, velocity: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """Readings and their Jacobian by forward differences.

        Args:
            on: record with stamps and force.
            point: (p,) values of the free parameters.
            start: (2,) start position from the relaxed spring, and zero [m].
            velocity: at the start [m/s].

        Returns:
            Readings (n,) [m] and Jacobian (p + 2, n); its last two rows belong to start position and zero.
        """
        count = point.size
        points = np.repeat(point[None, :], count + 2, axis=0)
        points[1 + np.arange(count), np.arange(count)] += self.steps
        starts = np.repeat(start[None, :], count + 2, axis=0)
        starts[-1, 0] += self.nudge
        rows = self.readings(on, points, starts, velocity)
        jacobian = np.ones((count + NUISANCES, rows.shape[1]))
        jacobian[:count] = (rows[1:-1] - rows[0]) / self.steps[:, None]
        jacobian[count] = (rows[-1] - rows[0]) / self.nudge
        return np.asarray(rows[0]), jacobian

    def predict(self, on: Record) -> Prediction:
        """Readings and Jacobian at the fitted values."""
        start = np.array([self.start.position, self.start.zero])
        position, jacobian = self.linearised(on, self.point, start)
        speed = np.abs(np.gradient(position, on.time))
        return Prediction(position, speed, jacobian)
