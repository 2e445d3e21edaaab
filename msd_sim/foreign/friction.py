"""Dry friction in other forms: none of them has a jump at rest."""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_sim.foreign.law import ForeignLaw, Values
from msd_sim.strengths import Sizes

#: Elements of ``maxwell_slip``: share of the force, and deflection at which it slips in units of the first one's.
_ELEMENTS = ((0.4, 1.0), (0.3, 2.0), (0.2, 4.0), (0.1, 8.0))


def _peak(s: Sizes) -> dict[str, float]:
    force = s.force * s.log(0.01, 0.08)
    return {"kinetic": force, "static": force * s.even(1.2, 2.2), "falling": s.speed * s.log(0.03, 0.3)}


def _lugre(s: Sizes) -> dict[str, float]:
    values = _peak(s)
    bristle = values["static"] / (s.reach * s.log(0.002, 0.02))
    return values | {"bristle": bristle, "loss": 1.4 * math.sqrt(bristle * s.mass), "slow": 0.02 * s.speed}


def _bristle(p: Values, v: float) -> float:
    return p["bristle"] / (1.0 + abs(v) / p["falling"])


def _lugre_rates(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> tuple[float, ...]:
    limit = p["kinetic"] + (p["static"] - p["kinetic"]) * math.exp(-((v / p["falling"]) ** 2))
    return (v - _bristle(p, v) * abs(v) * z[0] / limit,)


def _lugre_force(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    loss = p["loss"] * math.exp(-((v / p["slow"]) ** 2))
    return _bristle(p, v) * z[0] + loss * _lugre_rates(p, t, x, v, z, u)[0]


def _slip_rates(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> tuple[float, ...]:
    """Each element follows until it is at its limit, and turns back at once."""
    rates = []
    for deflection, (_, limit) in zip(z, _ELEMENTS, strict=True):
        part = abs(deflection) / (limit * p["deflection"])
        rates.append(v * (1.0 - min(part, 1.0) ** 6) if deflection * v > 0.0 else v)
    return tuple(rates)


def _slip_force(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    parts = (share * deflection / limit for deflection, (share, limit) in zip(z, _ELEMENTS, strict=True))
    return p["kinetic"] * sum(parts) / p["deflection"]


def _arctan(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    size = p["kinetic"] + (p["static"] - p["kinetic"]) / (1.0 + abs(v) / p["falling"])
    return size * 2.0 / math.pi * math.atan(v / p["creep"])


def _tanh_sum(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    peak = math.tanh(v / p["creep"]) - math.tanh(v / p["falling"])
    return (p["static"] - p["kinetic"]) * peak + p["kinetic"] * math.tanh(v / p["creep"])


def _logarithmic(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    size = p["kinetic"] * (1.0 - p["weakening"] * math.log1p(abs(v) / p["slow"]))
    return max(size, 0.0) * math.tanh(v / p["creep"])


def _exponential_turn(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return math.copysign(p["kinetic"] * math.expm1(-abs(v) / p["creep"]), v)


def _creeping_peak(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    size = p["kinetic"] + (p["static"] - p["kinetic"]) / (1.0 + (v / p["falling"]) ** 2)
    return size * v / math.hypot(v, p["creep"])


LAWS = (
    ForeignLaw(
        "lugre",
        "LuGre, bristles that soften with speed: sigma(v) z + sigma1 exp(-(v/vd)^2) z', z' = v - sigma(v)|v| z / g(v)",
        _lugre, _lugre_force, _lugre_rates, 1,
    ),
    ForeignLaw(
        "maxwell_slip", "four springs in parallel, each of which slips at its own force (Iwan)",
        lambda s: {"kinetic": s.force * s.log(0.01, 0.1), "deflection": s.reach * s.log(0.003, 0.03)},
        _slip_force, _slip_rates, len(_ELEMENTS),
    ),
    ForeignLaw(
        "arctan_stribeck", "(Fc + (Fs - Fc) / (1 + |v|/vs)) (2/pi) arctan(v/ve): creeps at rest",
        lambda s: _peak(s) | {"creep": s.speed * s.log(1e-4, 1e-3)}, _arctan,
    ),
    ForeignLaw(
        "tanh_sum_friction", "(Fs - Fc)(tanh(v/ve) - tanh(v/vs)) + Fc tanh(v/ve) (Makkar)",
        lambda s: _peak(s) | {"creep": s.speed * s.log(1e-4, 1e-3)}, _tanh_sum,
    ),
    ForeignLaw(
        "logarithmic_friction", "Fc (1 - a ln(1 + |v|/v0)) tanh(v/ve): falls with every decade of speed",
        lambda s: {
            "kinetic": s.force * s.log(0.01, 0.08), "weakening": s.even(0.03, 0.12), "slow": 0.01 * s.speed,
            "creep": s.speed * s.log(1e-4, 1e-3),
        },
        _logarithmic,
    ),
    ForeignLaw(
        "exponential_turn", "Fc (1 - exp(-|v|/ve)) sgn v: creeps below a speed that is seen",
        lambda s: {"kinetic": s.force * s.log(0.02, 0.15), "creep": s.speed * s.log(0.005, 0.1)}, _exponential_turn,
    ),
    ForeignLaw(
        "creeping_peak", "(Fc + (Fs - Fc)/(1 + (v/vs)^2)) v/sqrt(v^2 + ve^2): a peak, and creep that is seen",
        lambda s: _peak(s) | {"creep": s.speed * s.log(0.003, 0.03)}, _creeping_peak,
    ),
)  # fmt: skip
