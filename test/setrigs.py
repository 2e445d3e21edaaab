"""Sets of causes with a given chi², for tests of evidence and ranking."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache

import numpy as np

from msd_ident.data.record import Record
from msd_ident.estimate.broyden import State
from msd_ident.model import Model, Plant
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import Ranking, rank
from msd_sim.api import simulate

BASE = Plant(1.0, 2.0, 400.0)


@cache
def steps() -> Experiment:
    """Steps on a rig with nothing but m, b and k."""
    made = simulate(
        {"mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0, "experiment": "steps"}
    )
    return Experiment(prepare([Record(made.time, made.position, made.force_time, made.force)]), BASE, frozenset())


def fitted(experiment: Experiment, model: Model, chi: float, known: float = 1e3) -> Hypothesis:
    """A set with a given chi², spread evenly over all frequencies, every parameter known to its natural size over
    ``known``.
    """
    problem = experiment.problem(model)
    rows = np.zeros((problem.size, experiment.readings[0].record.samples))
    rows[:, : problem.size] = known * np.diag(1.0 / problem.scale)
    whole = np.random.default_rng(1).normal(size=experiment.readings[0].record.samples)
    residual = whole * math.sqrt(chi / float(whole @ whole))
    return Hypothesis(
        frozenset(model.effect_names),
        model,
        problem,
        State(
            problem.vector(dict(zip(model.names, model.values.tolist(), strict=True)), problem.initial),
            residual,
            rows,
            True,
        ),
        experiment.readings,
    )


def ranked(sets: Mapping[str, Hypothesis], noise: float = 840.0) -> Ranking:
    """All sets, where noise alone leaves so much chi²."""
    return rank({one.causes: one for one in sets.values()}, NoiseScale(noise))


def odds(ranking: Ranking) -> dict[frozenset[str], tuple[float, float]]:
    """Evidence and probability by set."""
    return {
        one.causes: (value, p)
        for one, value, p in zip(ranking.sets, ranking.evidence, ranking.probability, strict=True)
    }
