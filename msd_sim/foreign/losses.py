"""Damping in other forms."""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_sim.foreign.law import ForeignLaw, Values


def _mixed(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return p["second"] * abs(v) * v + p["third"] * v**3


def _saturating(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return p["drag"] * v / math.sqrt(1.0 + (v / p["corner"]) ** 2)


def _film(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return p["drag"] * v / (1.0 - max(min(x / p["gap"], 0.9), -5.0)) ** 3


def _torque_speed(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return abs(u) * v / p["idle"]


LAWS = (
    ForeignLaw(
        "mixed_drag", "b2 v|v| + b3 v^3",
        lambda s: {
            "second": s.force * s.log(0.01, 0.2) / s.speed**2, "third": s.force * s.log(0.01, 0.2) / s.speed**3,
        },
        _mixed,
    ),
    ForeignLaw(
        "saturating_damping", "c v / sqrt(1 + (v/v0)^2): a damper whose force hardly grows beyond v0",
        lambda s: {"drag": s.mass * s.omega * s.log(0.03, 0.3), "corner": s.speed * s.even(0.3, 1.0)}, _saturating,
    ),
    ForeignLaw(
        "film_damping", "c v / (1 - x/h)^3: a film that is squeezed",
        lambda s: {"drag": s.mass * s.omega * s.log(0.02, 0.15), "gap": s.reach * s.even(3.0, 6.0)}, _film,
    ),
    ForeignLaw(
        "torque_speed", "F (1 - v/v0) of a commanded F > 0: a motor that gets weaker with speed",
        lambda s: {"idle": s.speed * s.log(3.0, 30.0)}, _torque_speed, experiments=("steps",),
    ),
)  # fmt: skip
