"""A start beside an unstable motion is followed before it parts from the record."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pendulums import led, turned

from msd_ident.estimate.broyden import Weighting
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant
from msd_ident.model.effects.gravity import Gravity
from msd_ident.residuals import noise_model
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.growing import Start, grown

#: J [kg·m²], b [N·m·s/rad] and G [N·m].
TRUE = (0.18, 0.05, 3.7)


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    """Brought to the top and held there for two seconds."""
    record = turned(led(lambda t: math.pi * min(t, 1.0), 20.0, 0.6), 3.0, TRUE)
    return Experiment(noise_model.prepare((record,)), Plant(*TRUE[:2], 0.0), frozenset({"stiffness"}))


def start(experiment: Experiment, inertia: float) -> Start:
    """The truth but for its inertia, in parts of it."""
    model = Plant(inertia * TRUE[0], TRUE[1], 0.0) + Gravity(TRUE[2])
    _, weighting, point = formulated(experiment, model, (Initial(),))
    return weighting, point


def left(weighting: Weighting, point: np.ndarray) -> float:
    return float(np.sum(weighting.residual(point) ** 2))


def test_a_start_that_would_part_from_the_record_ends_where_a_fit_can_go_on(experiment: Experiment) -> None:
    begun = start(experiment, 1.03)
    assert left(*begun) > experiment.motion, "as far as the wrong side of the top"
    ((weighting, point),) = grown([begun], 1)
    assert left(weighting, point) < 1e-4 * experiment.motion
    assert weighting.problem.values(point)[0] == pytest.approx(TRUE[0], rel=0.02)


def test_a_start_that_follows_the_record_is_kept_and_comes_first(experiment: Experiment) -> None:
    wild, near = start(experiment, 1.5), start(experiment, 1.0 + 1e-6)
    (first,) = grown([wild, near], 1)
    assert first[0] is near[0] and np.array_equal(first[1], near[1])
    assert len(grown([wild, near], 2)) == 2


def test_a_start_that_goes_round_once_more_is_followed_only_so_far() -> None:
    """Of five turns one is little: gravity of a joint that is driven over the top again and again was lost."""
    levels = np.random.default_rng(3).choice([-8.0, -5.0, 0.0, 5.0, 8.0], 10).tolist()
    record = turned(lambda t, _, __: levels[int(t / 0.8)] if t > 0.8 else 8.0, 8.0, (0.3, 0.5, 3.0))
    data = Experiment(noise_model.prepare((record,)), Plant(0.3, 0.5, 0.0), frozenset({"stiffness"}))
    _, weighting, point = formulated(data, Plant(0.33, 0.5, 0.0) + Gravity(3.0), (Initial(),))
    assert left(weighting, point) < 0.05 * data.motion
    assert np.max(np.abs(weighting.problem.residual(point, 0))) > math.pi
    ((_, ended),) = grown([(weighting, point)], 1)
    assert left(weighting, ended) < 1e-4 * data.motion
