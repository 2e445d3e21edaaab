"""Records of a rig without ROS: ``simulate(spec)``, reached by others through the entry point group ``msd.rigs``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from msd_sim import config, experiments
from msd_sim.effects import ALL
from msd_sim.encoder import EncoderReader
from msd_sim.errors import RigError
from msd_sim.experiments import Experiment
from msd_sim.rig import FloatArray, Hold, Motion, Rig

#: Keys of a spec that belong to the simulation; all others are parameters of the rig (``config.parse``).
_OWN = (
    "rig", "experiment", "duration", "time", "force_time", "force", "hold", "initial_position", "initial_velocity",
)  # fmt: skip


@dataclass(frozen=True)
class Simulated:
    """A record of a rig, and what lies behind it.

    Attributes:
        time: (n,) stamps of the readings [s], from 0 unless the spec says otherwise.
        position: (n,) readings of the encoder [m].
        force_time: (p,) stamps of the commands [s].
        force: (p,) commanded force [N].
        hold: how a command goes on: ``zero`` or ``linear``.
        motion: what truly happened at the (n,) sampling instants (without the encoder's delay): position, velocity and
            force on the cart.
        truth: mass, damping, stiffness, effects: what made the record; encoder, rate, seed, experiment.
    """

    time: FloatArray
    position: FloatArray
    force_time: FloatArray
    force: FloatArray
    hold: Hold
    motion: Motion
    truth: Mapping[str, Any]


def simulate(spec: Mapping[str, Any]) -> Simulated:
    """Run an experiment on a rig. The spec (all keys optional but the rig's):

    - ``rig``: a name (``ecp``) or a YAML file, or no such key and the rig's parameters themselves beside the others
      (``mass``, ``damping``, ``stiffness``, ``friction_coefficient``, ``effects``, ``encoder``, ...); where both are
      given, the parameters replace those of the rig and ``effects`` add to its effects;
    - ``experiment``: a name (``paper``), or a mapping with ``name`` and the experiment's options;
      or ``force_time`` [s], ``force`` [N] and ``hold`` for a force of one's own;
    - ``rate`` [Hz], ``duration`` [s]; or ``time``, the sampling instants [s] (rising, any);
    - ``initial_position`` [m], ``initial_velocity`` [m/s] at the first sampling instant; ``seed``.

    Raises:
        RigError: anything in it that makes no sense, in one line.
    """
    given = dict(spec)
    own = {key: given.pop(key) for key in _OWN if key in given}
    parameters = _merged(config.load(str(own["rig"])), config.nested(given)) if "rig" in own else given
    rig_config = config.parse(parameters)
    experiment, name = _experiment(own, rig_config)
    instants = _instants(own, experiment, rig_config.rate)
    hold: Hold = own.get("hold", "zero")
    rig = Rig(rig_config.truth, experiment.position, experiment.velocity, float(instants[0]), hold)
    rig.drive(experiment.force_time, experiment.force)
    motion = rig.sample(np.maximum(instants - rig_config.encoder.delay, instants[0]))
    reader = EncoderReader(rig_config.encoder, rig_config.seed)
    position = reader.read(rig_config.truth.sensed(motion.time, motion.position), motion.velocity)
    period = float(np.median(np.diff(instants))) if instants.size > 1 else 1.0 / rig_config.rate
    stamps, kept = reader.stamps(instants, period), reader.arrives(instants.size)
    truth = rig_config.truth.as_dict() | {
        "encoder": vars(rig_config.encoder).copy(), "rate": rig_config.rate, "seed": rig_config.seed,
        "experiment": name,
    }  # fmt: skip
    return Simulated(stamps[kept], position[kept], experiment.force_time, experiment.force, hold, motion, truth)


def _merged(base: dict[str, Any], more: Mapping[str, Any]) -> dict[str, Any]:
    """A rig's parameters with others over them; effects as a mapping, those of both."""
    merged = base | {key: value for key, value in more.items() if key not in ("effects", "encoder", *ALL)}
    merged["encoder"] = {**base.get("encoder", {}), **more.get("encoder", {})}
    listed: dict[str, Any] = {}
    for tree in (base, more):
        chosen = tree.get("effects") or ()
        for name in chosen:
            values = chosen[name] if isinstance(chosen, Mapping) else tree.get(name)
            listed[name] = {**listed.get(name, {}), **(values or {})}
    own_friction = [name for name in (more.get("effects") or ()) if name in ALL and ALL[name].dry_friction]
    if own_friction:  # dry friction that the caller asks for takes the place of the rig's
        listed = {n: v for n, v in listed.items() if n in own_friction or not (n in ALL and ALL[n].dry_friction)}
    return {key: value for key, value in merged.items() if key not in ALL} | {"effects": listed}


def _experiment(own: Mapping[str, Any], rig: config.RigConfig) -> tuple[Experiment, str]:
    """The experiment that the spec asks for, and its name."""
    if ("force" in own) != ("force_time" in own):
        raise RigError("force and force_time go together; expected both or neither")
    if "force" in own and "experiment" in own:
        raise RigError("an experiment and a force; expected one of them")
    if "force" in own:
        force_time, force = (np.asarray(own[key], dtype=np.float64) for key in ("force_time", "force"))
        if force_time.ndim != 1 or force_time.size == 0 or force_time.shape != force.shape:
            raise RigError(
                f"{force_time.size} force stamps for {force.size} forces; expected as many of each, at least one"
            )
        experiment, name = Experiment(force_time, force, max(float(force_time[-1]), 0.0)), "force"
    else:
        asked = own.get("experiment", "paper")
        options = dict(asked) if isinstance(asked, Mapping) else {"name": asked}
        name = str(options.pop("name", "paper"))
        from_rig = {"rate": rig.rate, "natural_frequency": rig.truth.natural_frequency}
        experiment = experiments.build(name, options, from_rig)
    begin = (own.get("initial_position", experiment.position), own.get("initial_velocity", experiment.velocity))
    return Experiment(experiment.force_time, experiment.force, experiment.duration, *begin), name


def _instants(own: Mapping[str, Any], experiment: Experiment, rate: float) -> FloatArray:
    """Sampling instants [s]."""
    if "time" in own:
        time = np.asarray(own["time"], dtype=np.float64)
        if time.ndim != 1 or time.size == 0 or not np.isfinite(time).all() or np.any(np.diff(time) <= 0.0):
            raise RigError("time does not rise; expected finite sampling instants [s], each later than the one before")
        return time
    duration = own.get("duration", experiment.duration)
    if isinstance(duration, bool) or not isinstance(duration, int | float) or not 0.0 < duration < math.inf:
        raise RigError(f"duration is {duration!r}; expected more than 0 s")
    samples = round(duration * rate)
    if not 1 <= samples <= 50_000_000:
        raise RigError(f"{duration:g} s at {rate:g} Hz are {samples} samples; expected 1 to 50 million")
    return np.asarray(np.arange(samples) / rate, dtype=np.float64)
