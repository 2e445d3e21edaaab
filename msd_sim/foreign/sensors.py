"""What the sensor makes of a position in other forms, noise that is not white, and a force between its samples."""

from __future__ import annotations

import math

import numpy as np

from msd_sim.foreign.law import FloatArray, ForeignLaw, Values, nothing
from msd_sim.strengths import Sizes

#: The law that is in the force between its samples and nowhere else.
SMOOTH_FORCE = "smooth_force"


def _settling(p: Values, t: FloatArray, x: FloatArray, v: FloatArray, rng: np.random.Generator) -> FloatArray:
    return np.asarray(x - p["size"] * np.expm1(-t / p["time"]) + p["rate"] * t)


def _walking(p: Values, t: FloatArray, x: FloatArray, v: FloatArray, rng: np.random.Generator) -> FloatArray:
    steps = rng.standard_normal(t.size) * np.sqrt(np.gradient(t) / (t[-1] - t[0]))
    return np.asarray(x + p["size"] * np.cumsum(steps))


def _missing(p: Values, t: FloatArray, x: FloatArray, v: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Of the counts on the way up, at speed, some are lost."""
    up = np.where(v > p["speed"], v, 0.0) * np.gradient(t) / p["count"]
    return np.asarray(x - p["count"] * np.cumsum(rng.random(t.size) < p["share"] * up))


def _elliptic(p: Values, t: FloatArray, x: FloatArray, v: FloatArray, rng: np.random.Generator) -> FloatArray:
    angle = 2.0 * math.pi * x / p["pitch"]
    return np.asarray(x + p["size"] * (np.sin(angle + p["phase"]) + p["second"] * np.sin(2.0 * angle)))


def _lost(s: Sizes) -> dict[str, float]:
    return {"count": s.reach * s.log(2e-4, 2e-3), "share": s.log(0.003, 0.03), "speed": 0.3 * s.speed}


def _coloured(s: Sizes, level: float) -> dict[str, float]:
    return {"noise": level, "noise_correlation": s.log(2.0, 30.0)}


def _growing(s: Sizes, level: float) -> dict[str, float]:
    return {"speed_noise": level * s.log(2.0, 10.0) / s.speed}


LAWS = (
    ForeignLaw(
        "settling_and_drifting", "the reading is x + A (1 - exp(-t/T)) + r t",
        lambda s: {
            "size": s.sign() * s.reach * s.log(0.01, 0.08), "time": s.duration * s.even(0.1, 0.4),
            "rate": s.sign() * s.reach * s.log(0.01, 0.08) / s.duration,
        },
        reading=_settling,
    ),
    ForeignLaw(
        "walking_zero", "the zero of the readings walks at random",
        lambda s: {"size": s.reach * s.log(0.003, 0.03)}, reading=_walking,
    ),
    ForeignLaw("missed_counts", "some counts of fast moves up are lost", _lost, reading=_missing),
    ForeignLaw(
        "elliptic_wheel", "the reading is x + e (sin(q + phi) + a sin 2q), q = 2 pi x / p",
        lambda s: {
            "size": s.reach * s.log(0.003, 0.03), "pitch": s.reach * s.even(1.0, 4.0), "second": s.even(0.2, 0.8),
            "phase": s.even(-3.0, 3.0),
        },
        reading=_elliptic,
    ),
    ForeignLaw("coloured_noise", "first-order autoregressive noise", nothing, encoder=_coloured),
    ForeignLaw("growing_noise", "noise that grows with speed", nothing, encoder=_growing),
    ForeignLaw(SMOOTH_FORCE, "tones of force, smooth between their samples", nothing, experiments=("tones",)),
)  # fmt: skip
