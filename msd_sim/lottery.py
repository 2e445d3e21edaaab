"""Rigs drawn by lot: plant, encoder and a hidden effect of some strength from a seed, for those who must find it.

``draw(seed, ...)`` gives the spec of a rig and experiment for ``msd_sim.api.simulate``; the strengths are relative to
the plant drawn, from barely to plainly visible.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from msd_sim.effects import ALL, KNOWN, ODD
from msd_sim.errors import RigError
from msd_sim.strengths import STRENGTHS, VARIANT_STRENGTHS, Ranges, Sizes

#: Effects that may be hidden.
NAMES = tuple(effect.name for effect in KNOWN)
#: Oddities that may be hidden.
ODDITIES = tuple(effect.name for effect in ODD)
#: Other laws of known families that may be hidden.
VARIANTS = tuple(VARIANT_STRENGTHS)
#: The variant that is not in the rig but between two commands: they are joined by straight lines.
BAND_LIMITED = "band_limited_force"
_ALL_STRENGTHS = {**STRENGTHS, **VARIANT_STRENGTHS}

Noise = Literal["white", "coloured", "speed"]
NOISES: tuple[str, ...] = get_args(Noise)

EXPERIMENTS = ("steps", "step", "release", "sweep", "ramp")


@dataclass(frozen=True)
class Draw:
    """A rig by lot.

    Attributes:
        seed: what it was drawn from.
        spec: for ``msd_sim.api.simulate``.
        hidden: name of the hidden effect, or none.
        beside: whether Coulomb friction acts beside it.
        experiment: name of the experiment.
        noise: standard deviation of a reading at rest [m], rounding included.
        other: name of a second hidden effect, or none.
    """

    seed: int
    spec: Mapping[str, Any]
    hidden: str | None
    beside: bool
    experiment: str
    noise: float
    other: str | None = None

    @property
    def truth(self) -> frozenset[str]:
        """Names of all effects of the rig, and of what lies between its commands."""
        return frozenset(self.spec["effects"]) | ({BAND_LIMITED} & {self.hidden})


def _experiment(name: str, force: float, omega: float, rate: float) -> tuple[dict[str, float | str], float]:
    """Experiment and its duration [s]; long enough for a few swings each."""
    if name == "steps":
        return {"name": "steps", "force": force, "hold": 0.75}, 6.0
    if name == "step":
        return {"name": "step", "force": force, "hold": 3.0}, 3.0
    if name == "release":
        return {"name": "release", "position": 0.0, "duration": 4.0}, 4.0
    if name == "sweep":
        return {"name": "sweep", "force": 0.3 * force, "duration": 10.0, "rate": rate, "natural_frequency": omega}, 10.0
    if name == "ramp":
        return {"name": "ramp", "force": force, "duration": 16.0, "rate": rate}, 16.0
    raise RigError(f"no experiment {name!r} in the lottery; expected one of {', '.join(EXPERIMENTS)}")


def draw(
    seed: int,
    hidden: str | None,
    beside: bool = False,
    experiment: str = "steps",
    rate: float = 1000.0,
    *,
    other: str | None = None,
    ranges: Ranges = "narrow",
    noise: Noise = "white",
) -> Draw:
    """A rig by lot with ``hidden`` (a name, or None) in it, ``beside`` Coulomb friction or alone.

    Dry friction beside dry friction is one law of dry friction again: such effects always stand alone.

    Args:
        seed: of everything that is drawn.
        hidden: the effect to be found.
        beside: whether Coulomb friction acts too.
        experiment: one of ``EXPERIMENTS``.
        rate: samples a second [Hz].
        other: a second effect to be found.
        ranges: of the strengths.
        noise: ``white``; ``coloured``: first-order autoregressive, with a memory of 1 to 20 samples; ``speed``: at top
            speed 2 to 10 times what it is at rest.

    Raises:
        RigError: no such effect, experiment or noise, or two laws of dry friction.
    """
    _check(hidden, other, noise, experiment)
    sizes, damping, how = begun(np.random.default_rng([seed, 20141]), experiment, rate, ranges)
    rng, mass, stiffness, force, reach = sizes.rng, sizes.mass, sizes.stiffness, sizes.force, sizes.reach
    hidden_ones = [name for name in (hidden, other) if name is not None]
    effects = {name: _ALL_STRENGTHS[name](sizes) for name in hidden_ones if name != BAND_LIMITED}
    beside = beside and not any(ALL[name].dry_friction for name in effects)
    if beside:
        effects["coulomb_friction"] = {"coulomb_force": force * sizes.log(0.01, 0.08)}
    encoder, level = drawn_encoder(rng, reach)
    if noise == "coloured":
        encoder, level = _coloured(encoder, level, sizes.log(1.0, 20.0, wide=(1.0, 20.0)))
    elif noise == "speed":
        encoder["speed_noise"] = level * sizes.log(2.0, 10.0, wide=(2.0, 10.0)) / sizes.speed
    spec: dict[str, Any] = {
        "mass": mass, "damping": damping, "stiffness": stiffness, "friction_coefficient": 0.0, "effects": effects,
        "encoder": encoder, "experiment": how, "rate": rate, "seed": int(rng.integers(1 << 31)),
    }  # fmt: skip
    if hidden == BAND_LIMITED:
        spec["hold"] = "linear"
    return Draw(seed, spec, hidden, beside, experiment, level, other)


def begun(
    rng: np.random.Generator, experiment: str, rate: float, ranges: Ranges = "narrow"
) -> tuple[Sizes, float, dict[str, float | str]]:
    """A plant by lot: its sizes, its damping [N s/m], and the experiment for ``msd_sim.api.simulate``."""
    mass = float(np.exp(rng.uniform(np.log(0.3), np.log(3.0))))
    omega = 2.0 * math.pi * float(rng.uniform(1.7, 6.0))
    stiffness = mass * omega**2
    damping = 2.0 * float(np.exp(rng.uniform(np.log(0.02), np.log(0.2)))) * mass * omega
    reach = float(rng.uniform(0.005, 0.02))
    how, duration = _experiment(experiment, stiffness * reach, omega, rate)
    if experiment == "release":
        how["position"] = 1.5 * reach
    return Sizes(rng, mass, stiffness, stiffness * reach, duration, ranges), damping, how


def _check(hidden: str | None, other: str | None, noise: str, experiment: str) -> None:
    for name in (hidden, other):
        if name is not None and name not in _ALL_STRENGTHS:
            raise RigError(f"no effect {name!r} in the lottery; expected one of {', '.join(_ALL_STRENGTHS)}")
    dry = [name for name in (hidden, other) if name in ALL and ALL[name].dry_friction]
    if len(dry) > 1:
        raise RigError(f"{' and '.join(dry)} are two laws of dry friction; expected one at most")
    if hidden == BAND_LIMITED and experiment not in ("sweep", "ramp"):
        raise RigError(f"{BAND_LIMITED} in {experiment}; expected sweep or ramp, where commands are close together")
    if noise not in NOISES:
        raise RigError(f"no noise {noise!r} in the lottery; expected one of {', '.join(NOISES)}")


def _coloured(encoder: dict[str, float], level: float, samples: float) -> tuple[dict[str, float], float]:
    """The same encoder with noise that forgets itself in so many samples, and its level [m]; counts alone get some."""
    coloured = encoder | {"noise": encoder["noise"] or level, "noise_correlation": samples}
    return coloured, level if encoder["noise"] else math.hypot(level, level)


def drawn_encoder(rng: np.random.Generator, reach: float) -> tuple[dict[str, float], float]:
    """Counts, or noise, or both: 300 to 10000 noise levels within the reach."""
    noise = reach / float(np.exp(rng.uniform(np.log(300.0), np.log(10000.0))))
    kind = rng.choice(("counts", "noise", "both"))
    if kind == "noise":
        return {"counts_per_metre": 0.0, "noise": noise}, noise
    if kind == "both":
        step = noise * float(rng.uniform(0.3, 2.0))
        return {"counts_per_metre": 1.0 / step, "noise": noise}, math.hypot(noise, step / math.sqrt(12.0))
    return {"counts_per_metre": 1.0 / (noise * math.sqrt(12.0)), "noise": 0.0}, noise
