"""Coverage study: do the 95 % intervals of m, b, k and Fc contain the truth in 92 to 98 % of random rigs?

Each rig has random mass, frequency, damping, friction, force, encoder step, noise (a tenth of an encoder step to ten),
stick position, zero and sampling; ``msd_sim`` makes the record, and the fit starts 30 % off. The model is the true one.

    python bench/study_coverage.py [--rigs 200] [--seed 0] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import Record
from msd_ident.estimate import fit
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.quantity import Z95
from msd_sim.api import simulate

NAMES = ("mass", "damping", "stiffness", "coulomb_force")


@dataclass(frozen=True)
class Trial:
    """One rig: deviations from the truth in standard deviations (m, b, k, Fc), SEE over noise floor."""

    seed: int
    deviations: tuple[float, ...]
    see_over_floor: float
    noise_over_step: float


def trial(seed: int) -> Trial:
    """Make a random rig, measure it, fit it."""
    rng = np.random.default_rng(seed)
    mass, omega, zeta = 10.0 ** rng.uniform(-1.0, 1.0), rng.uniform(8.0, 40.0), 10.0 ** rng.uniform(-1.7, -0.5)
    stiffness, force = mass * omega**2, 10.0 ** rng.uniform(0.0, 1.5)
    reach, friction = force / stiffness, force * 10.0 ** rng.uniform(-2.3, -1.0)
    step = reach * 10.0 ** rng.uniform(-3.5, -2.3)
    noise = step * 10.0 ** rng.uniform(-1.0, 1.0)
    period, pushed = float(rng.choice([1e-3, 2e-3])), float(rng.choice([0.0, 0.2]))
    truth = Plant(mass, 2.0 * zeta * mass * omega, stiffness) + CoulombFriction(friction)
    made = simulate(
        {"mass": mass, "damping": truth["damping"], "stiffness": stiffness, "rate": 1.0 / period,
         "effects": {"coulomb_friction": {"coulomb_force": friction}},
         "experiment": {"name": "paper", "force": force, "hold": 1500 * period, "start": pushed},
         "initial_position": rng.uniform(-1.0, 1.0) * friction / stiffness, "seed": int(rng.integers(2**31)),
         "encoder": {"counts_per_metre": 1.0 / step, "noise": noise}}
    )  # fmt: skip
    zero = step * round(rng.uniform(-1.0, 1.0) * reach / step)
    record = Record(made.time, made.position + zero, made.force_time, made.force)
    result = fit(truth.with_values(truth.values * (1.0 + 0.3 * rng.choice([-1.0, 1.0], 4))), record)
    deviations = [(result.quantities[name].value - truth[name]) / result.quantities[name].std for name in NAMES]
    return Trial(seed, tuple(float(z) for z in deviations), result.see / result.noise_floor, noise / step)


def main() -> int:
    """Run the study and print the table; exit code 1 when an interval covers too seldom or too often."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0, help="first seed")
    parser.add_argument("--json", help="write all trials to this file")
    given = parser.parse_args()
    trials = [trial(seed) for seed in range(given.seed, given.seed + given.rigs)]
    deviations = np.array([one.deviations for one in trials])
    covered = np.mean(np.abs(deviations) < Z95, axis=0)
    print(f"{given.rigs} rigs, seeds {given.seed} to {given.seed + given.rigs - 1}")
    print(f"{'parameter':15s} {'covered %':>9s} {'rms dev.':>9s} {'worst':>7s}")
    for name, share, column in zip(NAMES, covered, deviations.T, strict=True):
        print(f"{name:15s} {100.0 * share:9.1f} {np.sqrt(np.mean(column**2)):9.2f} {np.max(np.abs(column)):7.1f}")
    print(f"SEE over noise floor: median {np.median([one.see_over_floor for one in trials]):.2f}")
    if given.json:
        with open(given.json, "w", encoding="utf-8") as file:
            json.dump([vars(one) for one in trials], file, indent=1)
    return 0 if np.all((covered >= 0.92) & (covered <= 0.98)) else 1


if __name__ == "__main__":
    sys.exit(main())
