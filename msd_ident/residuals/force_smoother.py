"""Kalman filter and Bryson–Frazier smoother of an unknown force on a linear plant, compiled.

The state is (x, v, d, c, c'): position, velocity, an unknown force d, and a smooth error c of the sensor,

    m x'' + b x' + k x + d = F,    d a random walk,    T² c'' + 2 T c' + c = white,    reading = x + c + white,

where c has the covariance of Matérn with ν = 3/2 (Hartikainen and Särkkä 2010, Kalman filtering and smoothing solutions
to temporal Gaussian process regression models).
(Kalman 1960; Bryson and Frazier 1963; Bierman 1977.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from msd_ident.compiled import Library
from msd_ident.data.record import FloatArray
from msd_ident.tuning import fixed

SETTLED = fixed(
    1e-9,
    "accuracy",
    "relative change of the covariance below which the filter's gain is settled (regular sampling only)",
)
STATES = fixed(5, "mathematics", "size of the state (x, v, d, c, c')")
#: Numbers kept of each filtered sample: a covariance, and variance and value of what its reading surprises by.
WORK = STATES * STATES + 2


class Readings(NamedTuple):
    """Steps of time (n − 1,) [s], readings (n,) [m], mean force (n − 1,) [N] between them."""

    steps: FloatArray
    position: FloatArray
    applied: FloatArray


class Law(NamedTuple):
    """The equation of the filter.

    Attributes:
        m, b, k: of the plant.
        variance: of a reading [m²].
        walk: strength of the force's random walk [N²/s].
        smooth: variance of the sensor's smooth error [m²]; 0 without one.
        memory: time constant T of that error [s].
    """

    m: float
    b: float
    k: float
    variance: float
    walk: float
    smooth: float
    memory: float


LIBRARY = Library(__name__, f"{__name__}_loops")
_ROW, _MATRIX = "f8[:]", "f8[:,:]"
_LAW = (Law, "f8", "f8", "f8", "f8", "f8", "f8", "f8")
_filtered = LIBRARY.function("filtered", (Readings, _ROW, _ROW, _ROW), _LAW, "f8", (_MATRIX, _MATRIX), _ROW)
_smoothed = LIBRARY.function("smoothed", _ROW, _LAW, _MATRIX, _MATRIX, _ROW)


def filtered(readings: Readings, law: Law, states: FloatArray, work: FloatArray) -> float:
    """Log likelihood [nats] of the readings, but for a constant.

    Fills the filtered ``states`` (n, STATES), and ``work`` (n, WORK) with their covariances, and variance and value of
    what each reading surprises by; nothing where they have no rows.
    """
    likelihood = np.empty(1)
    _filtered(readings, law, float(np.median(readings.steps)), (states, work), likelihood)
    return float(likelihood[0])


def smoothed(steps: FloatArray, law: Law, states: FloatArray, work: FloatArray, spread: FloatArray) -> None:
    """Modified Bryson–Frazier smoother: states become the smoothed ones, spread (n,) the variance of d.

    It inverts no covariance. A force that hardly walks makes them all but singular, and the smoother of Rauch, Tung
    and Striebel, which inverts them, diverges there. (Bierman 1977, Factorization Methods, ch. X.)
    """
    _smoothed(steps, law, states, work, spread)
