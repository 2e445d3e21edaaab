"""Sets of causes, fitted, left where they stand or with a given chi², for the tests of ``selection``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
from fitrigs import measured

from msd_ident.data.record import Record
from msd_ident.estimate.broyden import State
from msd_ident.model import Effect, Model, Plant
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ordering import rank
from msd_ident.selection.ranking import Ranking
from msd_sim.api import simulate

BASE = Plant(1.0, 2.0, 400.0)


@cache
def steps(rate: float = 1000.0) -> Experiment:
    """Steps on a rig with nothing but m, b and k, read so often a second."""
    rig = {"mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0}
    made = simulate({**rig, "experiment": "steps", "rate": rate})
    return Experiment(prepare([Record(made.time, made.position, made.force_time, made.force)]), BASE, frozenset())


@cache
def pushed(*effects: Effect) -> Experiment:
    """Short steps on the same rig with these effects: 1000 samples, with noise of 10 µm."""
    encoder = {"counts_per_metre": 0.0, "noise": 1e-5}
    model = replace(BASE, effects=effects)
    record = measured(model, {"name": "steps", "force": 8.0, "hold": 0.5}, rate=250.0, encoder=encoder, seed=1)
    return Experiment(prepare([record]), BASE, frozenset())


@cache
def rubbing() -> Experiment:
    """Steps on the same rig with dry friction: µ is 0.03."""
    made = simulate(
        {
            "mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.03, "experiment": "steps",
            "encoder.counts_per_metre": 0.0, "encoder.noise": 1e-5,
        }
    )  # fmt: skip
    record = Record(made.time, made.position, made.force_time, made.force)
    return Experiment(prepare([record]), BASE, frozenset())


def stood(experiment: Experiment, model: Model) -> Hypothesis:
    """A set that was left where it stands."""
    problem, weighting, point = formulated(experiment, model, experiment.problem(model).initial)
    state = weighting.exact(point, weighting.steps(None))
    return Hypothesis(frozenset(model.effect_names), model, problem, state, experiment.readings)


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
        State.at(
            problem.vector(dict(zip(model.names, model.values.tolist(), strict=True)), problem.initial),
            residual,
            rows,
            exact=True,
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
