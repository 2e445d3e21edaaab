"""Recovery study: does the fit recover the true parameters of every effect from simulated records?

For each effect and seed, a random rig with that effect is driven through one protocol (steps to both sides at two
amplitudes, a sweep, a release) by ``msd_sim``; readings get noise of 0.1 % of the amplitude and encoder steps. The fit
starts with every parameter 30 % off. A trial succeeds when every parameter lies within three standard deviations of
the truth. The target is 98 of 100.

    python bench/study_recovery.py [--trials 100] [--seed 0] [--jobs 2] [--json FILE] [EFFECT ...]
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from msd_ident.data.record import Record
from msd_ident.estimate import FitResult, fit
from msd_ident.model import Model, Plant
from msd_ident.model.effects import by_name
from msd_sim.api import simulate

RATE = 250.0
#: Effects that are drawn: those of which the rig has the very same law. Other forms of a cause are not.
EFFECTS = (
    *("actuator_lag", "asymmetric_spring", "backlash", "cogging", "coulomb_friction", "cubic_spring", "end_stop"),
    *("force_gain_nonlinearity", "force_offset", "hysteresis", "periodic_disturbance", "position_dependent_friction"),
    *("quadratic_drag", "second_mode", "sensor_drift", "stiffness_drift", "stribeck_friction", "time_offset"),
)


@dataclass(frozen=True)
class Trial:
    """One fit: deviations from the truth in standard deviations by parameter, SEE over noise floor, CPU seconds."""

    effect: str
    seed: int
    deviations: Mapping[str, float]
    see_over_floor: float
    seconds: float
    message: str

    @property
    def recovered(self) -> bool:
        """Every parameter has an interval and lies within three standard deviations."""
        return all(math.isfinite(z) and abs(z) <= 3.0 for z in self.deviations.values())


def draw(effect: str, rng: np.random.Generator) -> tuple[dict[str, float], dict[str, float], float]:
    """Plant, the effect's parameters and the largest force [N] of a random rig on which the effect shows."""
    mass, omega, zeta = rng.uniform(0.5, 2.0), rng.uniform(15.0, 30.0), rng.uniform(0.03, 0.15)
    stiffness = mass * omega**2
    force = rng.uniform(5.0, 20.0)
    reach, speed = force / stiffness, force / stiffness * omega
    sign = rng.choice([-1.0, 1.0])
    share = rng.uniform
    ranges: dict[str, dict[str, float]] = {
        "actuator_lag": {"lag_time": share(0.1, 0.4) / omega},
        "asymmetric_spring": {"quadratic_stiffness": sign * share(0.05, 0.15) * stiffness / reach},
        "backlash": {"backlash_half_width": share(0.03, 0.12) * reach},
        "cogging": {
            "cogging_amplitude": share(0.03, 0.1) * force,
            "cogging_pitch": share(0.3, 0.8) * reach,
            "cogging_phase": share(-2.0, 2.0),
        },
        "coulomb_friction": {"coulomb_force": share(0.01, 0.08) * force},
        "cubic_spring": {"cubic_stiffness": share(0.05, 0.3) * stiffness / reach**2},
        "end_stop": {"stop_position": share(0.8, 1.1) * reach, "stop_stiffness": share(1.0, 5.0) * stiffness},
        "force_gain_nonlinearity": {"gain_slope": sign * share(0.05, 0.2) / force},
        "force_offset": {"offset_force": sign * share(0.02, 0.1) * force},
        "hysteresis": {"hysteresis_force": share(0.05, 0.15) * force, "hysteresis_length": share(0.1, 0.4) * reach},
        "periodic_disturbance": {
            "disturbance_amplitude": share(0.03, 0.1) * force,
            "disturbance_frequency": share(0.3, 2.5) * omega,
            "disturbance_phase": share(-2.0, 2.0),
        },
        "position_dependent_friction": {
            "coulomb_force": share(0.02, 0.08) * force,
            "position_friction_slope": sign * share(0.2, 0.5) / reach,
        },
        "quadratic_drag": {"drag_coefficient": share(0.05, 0.3) * force / speed**2},
        "second_mode": {
            "second_mass": share(0.1, 0.4) * mass,
            "second_stiffness": share(2.0, 6.0) * stiffness * 0.25,
            "second_damping": share(0.02, 0.1) * mass * omega,
        },
        "sensor_drift": {"sensor_drift_rate": sign * share(0.003, 0.02) * reach},
        "stiffness_drift": {"stiffness_drift_rate": sign * share(0.003, 0.02)},
        "stribeck_friction": {
            "coulomb_force": (kinetic := share(0.02, 0.06) * force),
            "static_force": share(1.3, 2.0) * kinetic,
            "stribeck_velocity": share(0.03, 0.15) * speed,
        },
        "time_offset": {"time_offset": sign * share(0.3, 5.0) / RATE},
    }
    plant = {"mass": mass, "damping": 2.0 * zeta * mass * omega, "stiffness": stiffness}
    return plant, ranges[effect], force


def measure(
    plant: Mapping[str, float], effect: str, values: Mapping[str, float], force: float, rng: np.random.Generator
) -> list[Record]:
    """The protocol: steps to both sides at two amplitudes, a sweep, a release."""
    reach = force / plant["stiffness"]
    encoder = {"noise": 0.001 * reach, "counts_per_metre": 1.0 / (0.0005 * reach)}
    experiments: list[dict[str, Any]] = [
        {"name": "steps", "force": force, "fraction": 0.3, "hold": 1.0, "start": 0.2},
        {"name": "sweep", "force": 0.3 * force, "low": 0.2, "high": 2.5, "duration": 6.0},
        {"name": "release", "position": 1.2 * reach, "duration": 3.0},
    ]
    records = []
    for experiment in experiments:
        made = simulate(
            {**plant, "effects": {effect: dict(values)}, "experiment": experiment, "rate": RATE, "encoder": encoder,
             "seed": int(rng.integers(2**31))}
        )  # fmt: skip
        records.append(
            Record(made.time, made.position, made.force_time, made.force, hold=made.hold, name=str(experiment["name"]))
        )
    return records


def wrong_start(truth: Model, rng: np.random.Generator) -> Model:
    """Every parameter 30 % off, either way."""
    factors = 1.0 + 0.3 * rng.choice([-1.0, 1.0], truth.values.size)
    values = np.where(np.isfinite(truth.values), truth.values * factors, truth.values)
    for i, name in enumerate(truth.names):
        if name == "static_force":  # breakaway stays above sliding friction
            values[i] = max(values[i], 1.05 * values[truth.names.index("coulomb_force")])
    return truth.with_values(values)


def deviation(name: str, result: FitResult, truth: float) -> float:
    """Deviation in standard deviations; angles count modulo a turn."""
    quantity = result.quantities[name]
    error = quantity.value - truth
    if name.endswith("_phase"):
        error = (error + math.pi) % (2.0 * math.pi) - math.pi
    return error / quantity.std if quantity.std > 0.0 else math.nan


def trial(effect: str, seed: int) -> Trial:
    """Make a rig, measure it, fit it."""
    rng = np.random.default_rng([seed, EFFECTS.index(effect)])
    plant, values, force = draw(effect, rng)
    records = measure(plant, effect, values, force, rng)
    full = {**values, "force_limit": math.inf}
    truth = Plant(**plant) + by_name(effect).from_values(full)
    # Offset and zero are one and the same with a linear spring: whoever wants the offset must know the zero.
    zero = "known" if effect == "force_offset" else "free"
    begin = time.process_time()
    result = fit(wrong_start(truth, rng), records, zero=zero)
    seconds = time.process_time() - begin
    deviations = {name: deviation(name, result, truth[name]) for name in result.free}
    return Trial(effect, seed, deviations, result.see / result.noise_floor, seconds, result.message)


def _tell(effect: str, trials: Sequence[Trial], verbose: bool) -> bool:
    """Print an effect's row; whether it misses the target."""
    good = sum(one.recovered for one in trials)
    worst = max((abs(z), name) for one in trials for name, z in one.deviations.items())
    see = np.median([one.see_over_floor for one in trials])
    seconds = np.median([one.seconds for one in trials])
    print(
        f"{effect:30s} {good:6d}/{len(trials):3d} {see:10.2f} {seconds:7.2f}  {worst[1]} {worst[0]:.1f} std",
        flush=True,
    )
    for one in trials if verbose else []:
        if not one.recovered:
            shown = ", ".join(f"{name} {z:.1f}" for name, z in one.deviations.items())
            print(f"    seed {one.seed}: SEE/floor {one.see_over_floor:.2f}, {shown}; {one.message}")
    return good < math.floor(0.98 * len(trials))


def main() -> int:
    """Run the study and print the table; exit code 1 when an effect misses the target."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("effects", nargs="*", default=list(EFFECTS))
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0, help="first seed")
    parser.add_argument("--jobs", type=int, default=2, help="fits at once")
    parser.add_argument("--json", help="write all trials to this file")
    parser.add_argument("--verbose", action="store_true", help="show the trials that failed")
    given = parser.parse_args()
    everything, missed = [], 0
    print(f"{'effect':30s} {'recovered':>10s} {'SEE/floor':>10s} {'s/fit':>7s}  worst parameter")
    seeds = range(given.seed, given.seed + given.trials)
    with ProcessPoolExecutor(given.jobs) as pool:
        studies = [(effect, pool.map(partial(trial, effect), seeds, chunksize=5)) for effect in given.effects]
        for effect, running in studies:
            trials = list(running)
            everything += trials
            missed += _tell(effect, trials, given.verbose)
    if given.json:
        with open(given.json, "w", encoding="utf-8") as file:
            json.dump([{**vars(one), "recovered": one.recovered} for one in everything], file, indent=1)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
