"""What a drive makes of a command, in other forms."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from msd_sim.foreign.law import FloatArray, ForeignLaw, Values

#: Time in which a drive with a limited rate follows what is within its rate [s].
_FOLLOWS = 3e-4


def _sharp(p: Values, commands: FloatArray) -> FloatArray:
    return np.asarray(commands / (1.0 + (commands / p["limit"]) ** 4) ** 0.25)


def _dead(p: Values, commands: FloatArray) -> FloatArray:
    return np.asarray(commands - p["threshold"] * np.tanh(commands / p["corner"]))


def _remembering(p: Values, commands: FloatArray) -> FloatArray:
    """The command behind a play: a core that keeps a part of its field."""
    made, last = [], 0.0
    for command in commands.tolist():
        last = min(max(last, command - p["play"]), command + p["play"])
        made.append(last)
    return np.array(made)


def _second_order(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> tuple[float, ...]:
    return z[1], p["turn"] ** 2 * (u - z[0]) - 2.0 * p["ratio"] * p["turn"] * z[1]


def _limited(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> tuple[float, ...]:
    return (min(max((u - z[0]) / _FOLLOWS, -p["rate"]), p["rate"]),)


def _behind(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return u - z[0]


def _threshold(threshold: float, sharpness: float) -> dict[str, float]:
    return {"threshold": threshold, "corner": threshold * math.exp(sharpness - 1.0)}


LAWS = (
    ForeignLaw(
        "sharp_saturation", "F / (1 + (F/Fmax)^4)^(1/4)",
        lambda s: {"limit": s.force * s.log(0.9, 2.0)}, commands=_sharp, experiments=("steps",),
    ),
    ForeignLaw(
        "smooth_dead_zone", "F - d tanh(F/w)",
        lambda s: _threshold(s.force * s.log(0.01, 0.1), s.even(0.5, 2.0)), commands=_dead, experiments=("steps",),
    ),
    ForeignLaw(
        "remembering_drive", "F behind a play of h: the drive's own hysteresis",
        lambda s: {"play": s.force * s.log(0.005, 0.05)}, commands=_remembering, experiments=("steps",),
    ),
    ForeignLaw(
        "second_order_drive", "wa^-2 f'' + 2 za/wa f' + f = F",
        lambda s: {"turn": s.omega * s.log(3.0, 20.0), "ratio": s.even(0.4, 1.0)},
        _behind, _second_order, 2, experiments=("steps",),
    ),
    ForeignLaw(
        "rate_limited_drive", "the force follows at a limited rate",
        lambda s: {"rate": s.force * s.omega / s.log(0.05, 0.8)}, _behind, _limited, 1, experiments=("steps",),
    ),
)  # fmt: skip
