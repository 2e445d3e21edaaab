"""Springs, stops, plays and drifts of stiffness in other forms."""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_sim.foreign.law import ForeignLaw, Values
from msd_sim.strengths import Sizes


def _hertz(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    depth = abs(x) - p["place"]
    if depth <= 0.0:
        return 0.0
    side = 1.0 if x > 0.0 else -1.0
    return side * max(p["contact"] * depth * math.sqrt(depth) * (1.0 + p["loss"] * side * v), 0.0)


def _padded(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    depth = x - p["place"]
    return p["pad"] * math.expm1(min(depth / p["length"], 50.0)) if depth > 0.0 else 0.0


def _uneven(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    if x > p["above"]:
        return p["stiff_above"] * (x - p["above"]) + p["loss"] * max(v, 0.0)
    if x < -p["below"]:
        return p["stiff_below"] * (x + p["below"]) + p["loss"] * min(v, 0.0)
    return 0.0


def _exponential(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    y = x / p["length"]
    return p["size"] * (math.expm1(y) - y)


def _sinh(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    y = x / p["length"]
    return p["size"] * (math.sinh(y) - y)


def _saturating(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return -p["stiffness"] * x * abs(x) / (p["length"] + abs(x))


def _three_slopes(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    size = p["first"] * max(abs(x) - p["bend"], 0.0) + p["second"] * max(abs(x) - p["further_bend"], 0.0)
    return math.copysign(size, x)


def _linkage(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    """Less its value and its slope at zero, which are a shift and a part of the spring."""
    angle, phase = x / p["length"], p["phase"]
    second = math.sin(2.0 * angle + phase) - math.sin(phase) - 2.0 * angle * math.cos(phase)
    return p["weight"] * (math.sin(angle) - angle + p["second"] * second)


def _soft_play(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    """The spring's force in the gap, less that of a spring without one."""
    gap, corner = p["gap"], p["corner"]
    stretch = _ramp(x - gap, corner) - _ramp(-x - gap, corner)
    return p["stiffness"] * (1.0 - p["inside"]) * (stretch - x)


def _ramp(y: float, corner: float) -> float:
    """max(y, 0) with a round corner."""
    part = y / corner
    return y if part > 30.0 else corner * math.log1p(math.exp(part))


def _wandering(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return p["stiffness"] * p["part"] * math.sin(p["turn"] * t) * x


def _uneven_strengths(s: Sizes) -> dict[str, float]:
    stiff = s.stiffness * s.log(1.0, 15.0)
    place = s.reach * s.even(0.7, 1.1)
    return {
        "above": place, "below": place * s.even(0.7, 0.95),
        "stiff_above": stiff, "stiff_below": stiff * s.even(0.4, 0.8),
        "loss": 2.0 * s.log(0.02, 0.2) * math.sqrt(stiff * s.mass),
    }  # fmt: skip


def _pad(s: Sizes) -> dict[str, float]:
    length = s.reach * s.log(0.2, 0.6)
    return {"place": s.reach * s.even(0.7, 1.1), "length": length, "pad": s.stiffness * s.log(0.3, 3.0) * length}


def _bent(s: Sizes, part: float) -> dict[str, float]:
    """A spring that bends within a length; ``part`` of the force at full reach."""
    length = s.reach * s.even(0.7, 2.0)
    y = s.reach / length
    return {"length": length, "size": part * s.force / (math.sinh(y) - y + 0.25 * y**2)}


def _play(s: Sizes) -> dict[str, float]:
    gap = s.reach * s.log(0.02, 0.15)
    return {"stiffness": s.stiffness, "gap": gap, "corner": 0.1 * gap, "inside": s.even(0.03, 0.3)}


LAWS = (
    ForeignLaw(
        "hertz_stop", "K d^1.5 (1 + c d') at a depth d beyond xs or -xs (Lankarani-Nikravesh)",
        lambda s: {
            "place": s.reach * s.even(0.7, 1.1), "contact": s.stiffness * s.log(3.0, 30.0) / math.sqrt(0.1 * s.reach),
            "loss": s.log(0.1, 0.6) / s.speed,
        },
        _hertz,
    ),
    ForeignLaw(
        "padded_stop", "Fp (exp((x - xs)/l) - 1) beyond xs, on this side only: a soft pad",
        lambda s: _pad(s), _padded,
    ),
    ForeignLaw(
        "uneven_stops", "a spring with a loss while it is pressed, at another place and stiffness on either side",
        _uneven_strengths, _uneven,
    ),
    ForeignLaw(
        "exponential_spring", "a (exp(x/l) - 1 - x/l)",
        lambda s: _bent(s, s.log(0.02, 0.1)), _exponential,
    ),
    ForeignLaw("sinh_spring", "a (sinh(x/l) - x/l)", lambda s: _bent(s, s.log(0.01, 0.06)), _sinh),
    ForeignLaw(
        "saturating_spring", "k x / (1 + |x|/l) in place of k x",
        lambda s: {"stiffness": s.stiffness, "length": s.reach * s.log(10.0, 80.0)}, _saturating,
    ),
    ForeignLaw(
        "three_slope_spring", "slopes that change at x1 and again at x2, either side",
        lambda s: {
            "first": s.stiffness * s.log(0.05, 0.3), "second": s.stiffness * s.log(0.05, 0.3),
            "bend": s.reach * s.even(0.2, 0.5), "further_bend": s.reach * s.even(0.6, 1.0),
        },
        _three_slopes,
    ),
    ForeignLaw(
        "linkage_gravity", "G (sin(x/l) + a sin(2x/l + phi)) beyond its value and slope at 0: a weight on a linkage",
        lambda s: {
            "weight": s.force * s.log(0.2, 0.8), "length": s.reach * s.even(1.5, 3.0), "second": s.even(0.02, 0.15),
            "phase": s.even(-3.0, 3.0),
        },
        _linkage,
    ),
    ForeignLaw(
        "soft_play", "a gap with round corners in which a part of the spring still pulls",
        lambda s: _play(s), _soft_play,
    ),
    ForeignLaw(
        "wandering_stiffness", "k (1 + r sin(w t)) in place of k: slower than the record is long",
        lambda s: {
            "stiffness": s.stiffness, "part": s.sign() * s.log(0.01, 0.1), "turn": s.even(2.0, 5.5) / s.duration
        },
        _wandering,
    ),
)  # fmt: skip
