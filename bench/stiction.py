"""Strong breakaway friction, fitted from guesses alone and through observers: ``python -m bench.stiction``.

The truth counts as found where less than 1.2 noise floors are left. Every rig that is drawn counts in both columns.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from msd_ident.data.record import Record
from msd_ident.estimate.effort import SAMPLES
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Plant
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.observer import followed
from msd_sim import api

#: Rate [Hz], force of the steps [N] and the time for which each is held [s].
EXPERIMENTS = ((1000.0, 3.0, 0.75), (1000.0, 7.5, 0.75), (250.0, 7.5, 0.75), (500.0, 7.5, 2.5))
_PEAK = frozenset({"stribeck_friction"})
_START = Plant(0.6, 1.0, 830.0)


def drawn(rng: np.random.Generator, rate: float, force: float, hold: float) -> Experiment:
    """The record of a rig whose breakaway friction is 2 to 5 times the sliding one and gone at 4 to 30 mm/s."""
    sliding, peak, velocity = rng.uniform(0.1, 0.6), rng.uniform(2.0, 5.0), rng.uniform(0.004, 0.03)
    law = {"coulomb_force": sliding, "static_force": peak * sliding, "stribeck_velocity": velocity}
    made = api.simulate(
        {
            "mass": rng.uniform(0.5, 0.7), "damping": rng.uniform(0.5, 2.0), "stiffness": rng.uniform(700.0, 1000.0),
            "friction_coefficient": 0.0, "rate": rate, "effects": {"stribeck_friction": law},
            "encoder": {"counts_per_metre": 0.0, "noise": 1.1e-5}, "seed": int(rng.integers(2**31)),
            "experiment": {"name": "steps", "force": force, "hold": hold},
        }
    )  # fmt: skip
    record = Record(made.time, made.position, made.force_time, made.force)
    return Experiment(prepare([record]), _START, frozenset()).thinned(SAMPLES)


def found(experiment: Experiment, fitted: Hypothesis) -> bool:
    """Whether a fit leaves hardly more than noise."""
    return fitted.chi < 1.2**2 * experiment.evidence


def counted(rng: np.random.Generator, rigs: int, steps: tuple[float, float, float]) -> tuple[int, int]:
    """Rigs whose truth is found from the guesses of the law alone, and through observers."""
    alone = through = 0
    for _ in range(rigs):
        experiment = drawn(rng, *steps)
        still = [Initial(0.0, 0.0, float(experiment.records[0].position[0]))]
        base = refine(experiment, frozenset(), _START, still)
        begun: list[Model] = [base.model + law for law in StribeckFriction.guess(experiment.records[0], base.model)]
        alone += any(found(experiment, refine(experiment, _PEAK, model, base.initial)) for model in begun)
        through += found(experiment, followed(experiment, _PEAK, begun, base.initial))
    return alone, through


def main(given: Sequence[str] | None = None) -> None:
    """Print a table with one line for each experiment."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--rigs", type=int, default=15, help="for each experiment")
    asked.add_argument("--seed", type=int, default=5)
    options = asked.parse_args(given)
    rng = np.random.default_rng(options.seed)
    print("| rate | force, held for | rigs | truth found from 6 guesses | through observers |\n|---|---|---|---|---|")
    for steps in EXPERIMENTS:
        rate, force, hold = steps
        alone, through = counted(rng, options.rigs, steps)
        print(f"| {rate:.0f} Hz | {force:g} N, {hold:g} s | {options.rigs} | {alone} | {through} |", flush=True)


if __name__ == "__main__":
    main()
