"""Harmonic terms are found by a scan, from a model that has nothing of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fitrigs import DEMO, measured

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import KEPT
from msd_ident.estimate.formulation import formulate, own_vectors
from msd_ident.estimate.frequency_scan import harmonic_vectors, term_is_ordered
from msd_ident.estimate.problem import Problem
from msd_ident.model import Effect
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance

HUM, RIPPLE = PeriodicDisturbance(0.5, 41.0, 0.7), Cogging(0.6, 6e-3, -1.1)


def disturbed(effect: Effect) -> Record:
    experiment = {"name": "paper", "hold": 1.5}
    return measured(DEMO + effect, experiment, rate=400.0, encoder={"counts_per_metre": 0.0, "noise": 1e-5}, seed=2)


def posed(effect: Effect, *held: str) -> tuple[Problem, FloatArray]:
    """The problem, and its vector at the plant's values with a term of no size at a wrong frequency."""
    model = DEMO + type(effect)(0.0, 2.0 * effect.values[1], 0.0)
    problem = formulate(model, (disturbed(effect),), held)
    return problem, own_vectors(problem, model, [])[0]


@pytest.mark.parametrize("effect", [HUM, RIPPLE], ids=["over time", "over place"])
def test_frequency_amplitude_and_phase_are_found(effect: Effect) -> None:
    problem, best = posed(effect)
    vectors = harmonic_vectors(problem, best)
    assert 0 < len(vectors) <= KEPT
    size, rate, phase = (problem.names.index(p.name) for p in effect.parameters)
    near = min(vectors, key=lambda vector: abs(math.log(vector[rate] / effect.values[1])))
    assert near[rate] == pytest.approx(effect.values[1], rel=0.03)
    assert near[size] == pytest.approx(effect.values[0], rel=0.4)
    assert np.cos(near[phase] - effect.values[2]) > 0.5
    squares = [float(np.sum(problem.residual(vector, 0) ** 2)) for vector in (best, near)]
    assert squares[1] < 0.3 * squares[0]


def test_a_term_whose_frequency_is_held_is_not_scanned() -> None:
    assert harmonic_vectors(*posed(HUM, "disturbance_frequency")) == []


def test_only_rising_trials_have_neighbours() -> None:
    assert term_is_ordered(np.array([1.0, 2.0, 4.0])) and not term_is_ordered(np.array([4.0, 1.0, 2.0]))
