"""Random rigs of the four simulators with one interface: the true parameters, and how a record is written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from bench.blind.truth import EARLY_FORCE
from bench.mujoco_rigs import rig as mujoco_rig
from bench.mujoco_rigs import simulate as mujoco_simulate
from bench.several_faults import rig as several_rig
from bench.several_faults import simulate as several_simulate
from msd_sim import api, foreign, lottery
from msd_sim.effects import ALL
from msd_sim.foreign import simulate as foreign_simulate

#: Our own rig with laws of the library or their forms, with laws that it does not have, MuJoCo's, and rigs with several
#: faults.
Author = Literal["own", "foreign", "mujoco", "several"]
Values = Mapping[str, float]

#: Faults of MuJoCo's rigs: the cause, the library's law next to it, and its values in units of command.
_FAULTS: Mapping[str, Callable[[mujoco_rig.Rig], tuple[str, str, dict[str, float]]]] = {
    "frictionloss": lambda r: ("coulomb_friction", "coulomb_friction", {"coulomb_force": r.frictionloss / r.gain}),
    "limit": lambda r: ("end_stop", *_stop(r)),
    "lag": lambda r: ("actuator_lag", "actuator_lag", {"lag_time": r.lag}),
    "saturation": lambda r: (
        "force_gain_nonlinearity", "force_gain_nonlinearity", {"gain_slope": 0.0, "force_limit": r.saturation},
    ),
    "dead_zone": lambda r: ("force_gain_nonlinearity", "force_dead_zone", {"dead_zone": r.dead_zone}),
}  # fmt: skip


#: Noise levels by which the readings change with the form of a law of dry friction, below which it has none to be seen.
_FORMLESS = 1.0


@dataclass(frozen=True)
class Sealed:
    """A rig that is opened when the diagnosis is done.

    Attributes:
        truth: names of all causes that act, or of the foreign law.
        plant: mass, damping, stiffness [SI, per unit of command].
        strength: values of the hidden effect; of several, how much the readings change without each (``changes``).
        experiment: what is done.
        write: makes the record's file and returns the standard deviation of its readings [m].
        laws: cause -> the library's law next to it and its values; of foreign laws there is none.
        at_rest: whether the plant is that of small motions about the place of rest.
    """

    truth: frozenset[str]
    plant: Values
    strength: Values
    experiment: str
    write: Callable[[Path], float]
    laws: Mapping[str, tuple[str, Values]] = field(default_factory=dict)
    at_rest: bool = False


def own(draw: lottery.Draw) -> Sealed:
    """Of our own rig's lottery."""
    effects = draw.spec["effects"]
    called = {"time_offset": EARLY_FORCE} if _leads(draw) else {}
    return Sealed(
        truth=frozenset(called.get(name, name) for name in draw.truth),
        plant={name: draw.spec[name] for name in ("mass", "damping", "stiffness")},
        strength=dict(effects.get(draw.hidden, {})),
        experiment=draw.experiment,
        write=lambda path: write(draw, path),
        laws={called.get(name, name): (name, ALL[name].values(given)) for name, given in effects.items()},
    )


def _leads(draw: lottery.Draw) -> bool:
    """Whether the force acts before its stamps by up to half a sample, which a table of commands leaves open."""
    offset = draw.spec["effects"].get("time_offset", {}).get("time_offset", 0.0)
    return -0.5 / float(draw.spec["rate"]) <= offset < 0.0


def foreign_rig(seed: int, name: str, experiment: str, other: str | None = None) -> Sealed:
    """Of one law that the library does not have, or two."""
    law = foreign.LAWS[name] if other is None else foreign.both(foreign.LAWS[name], foreign.LAWS[other])
    rig = foreign_simulate.draw(seed, law, experiment)
    return Sealed(
        truth=frozenset({name} if other is None else {name, other}),
        plant={"mass": rig.mass, "damping": rig.damping, "stiffness": rig.stiffness},
        strength=dict(rig.values),
        experiment=experiment,
        write=lambda path: _write_foreign(rig, path),
    )


def mujoco(seed: int, fault: str | None, beside: bool, experiment: str) -> Sealed:
    """Of the second author."""
    rig = mujoco_rig.draw(seed, fault, beside, experiment)
    found = [_FAULTS[name](rig) for name in rig.faults]
    laws = {cause: (law, values) for cause, law, values in found}
    strength = _FAULTS[fault](rig)[2] if fault else {}
    return Sealed(
        frozenset(laws), rig.plant, strength, experiment, lambda path: _write_mujoco(rig, path), laws
    )  # fmt: skip


def several(seed: int, experiment: str) -> Sealed:
    """With three to five faults at once."""
    rig = several_simulate.drawn(seed, experiment)
    changes = {_cause(rig, name): change for name, change in several_simulate.changes(rig).items()}
    return Sealed(
        frozenset(changes), rig.at_rest, changes, experiment, lambda path: _write_several(rig, path), at_rest=True
    )  # fmt: skip


def _cause(rig: several_rig.Rig, fault: str) -> str:
    """The cause that a fault is: dry friction that nobody can tell from a constant force is Coulomb friction, and so is
    its form that repeats along the travel.
    """
    constant = several_rig.CONSTANT.get(fault)
    if fault == "friction_ripple":
        return "coulomb_friction"
    if constant and several_simulate.change(rig, rig.with_values(fault, constant)) < _FORMLESS:
        return "coulomb_friction"
    return fault


def _stop(rig: mujoco_rig.Rig) -> tuple[str, dict[str, float]]:
    """The library's law next to a limit: on one side where only one end can be reached."""
    limit = rig.limit
    assert limit is not None
    stiffness = limit.stiffness * rig.mass / rig.gain
    if min(limit.high, -limit.low) * 10.0 > max(limit.high, -limit.low):
        return "end_stop", {"stop_position": min(limit.high, -limit.low), "stop_stiffness": stiffness}
    place = limit.high if limit.high < -limit.low else limit.low
    return "one_sided_stop", {"one_stop_position": place, "one_stop_stiffness": stiffness}


def _write_mujoco(rig: mujoco_rig.Rig, path: Path) -> float:
    mujoco_simulate.write(rig, path)
    return rig.noise_level


def _write_several(rig: several_rig.Rig, path: Path) -> float:
    several_simulate.write(rig, path)
    return rig.noise_level


def _write_foreign(rig: foreign_simulate.ForeignRig, path: Path) -> float:
    moved = foreign_simulate.simulate(rig)
    _table(path, rig.time, rig.commanded(), moved.reading)
    grows = rig.encoder.speed_noise > 0.0
    return float(np.std(moved.reading - moved.position)) if grows else rig.noise


def write(draw: lottery.Draw, path: Path) -> float:
    """Run our own rig and write its record as CSV, as a lab would.

    Returns:
        Standard deviation of the readings about the truth [m], rounding included.
    """
    made = api.simulate(draw.spec)
    # A step on a tick acts from this very sample on, whichever way the last digit of its stamp was rounded.
    place = np.searchsorted(made.force_time, made.time + 1e-9, side="right") - 1
    _table(path, made.time, np.where(place < 0, 0.0, made.force[np.maximum(place, 0)]), made.position)
    if draw.spec["encoder"].get("speed_noise", 0.0) == 0.0:
        return draw.noise
    exact = api.simulate({**draw.spec, "encoder": {}})
    return float(np.std(made.position - exact.position))


def _table(path: Path, *columns: np.ndarray) -> None:
    """Time, force and position as CSV."""
    header = "time_s,force_n,position_m"
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=header, comments="", fmt="%.12g")
