"""The search over several starts leaves valleys that a single descent ends in."""

from __future__ import annotations

from functools import cache

import numpy as np
from fitrigs import DEMO, measured

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.least_squares import Solution, minimise
from msd_ident.estimate.multistart import Valleys, limits, robust, valleys
from msd_ident.estimate.noise_floors import noise_floor
from msd_ident.estimate.problem import Initial, Problem

NOISE = 2e-5


@cache
def record() -> Record:
    encoder = {"counts_per_metre": 0.0, "noise": NOISE}
    return measured(DEMO, {"name": "paper", "hold": 1.5, "start": 0.2}, rate=400.0, encoder=encoder, seed=5)


@cache
def posed() -> tuple[Problem, Valleys]:
    problem = formulate(DEMO, (record(),))
    return problem, valleys(problem, noise_floor((record(),)))


def start(**factors: float) -> FloatArray:
    """The true vector with some parameters multiplied."""
    values = {name: DEMO[name] * factors.get(name, 1.0) for name in DEMO.names}
    return posed()[0].vector(values, [Initial()])


def test_a_valley_that_one_descent_ends_in_is_left() -> None:
    """Where the cart comes to stick, the error over the friction has many."""
    problem, search = posed()
    begin = start(stiffness=3.5)
    alone = minimise(search.plain, begin, limits(problem))
    assert not search.at_floor(alone)
    found = search.deepest([begin], [[begin]], lambda best: [], lambda best: [])
    assert found.cost < 0.5 * alone.cost
    np.testing.assert_allclose(problem.values(found.point), DEMO.values, rtol=0.1)


def test_what_a_caller_offers_beside_the_start_is_tried() -> None:
    problem, search = posed()
    asked: list[FloatArray] = []

    def guesses(best: FloatArray) -> list[FloatArray]:
        asked.append(best)
        return [start()]

    hopeless = start(mass=30.0, stiffness=0.03)
    found = search.deepest([hopeless], [[hopeless]], guesses, lambda best: [])
    assert len(asked) == 1 and search.at_floor(found)
    asked.clear()
    assert search.at_floor(search.deepest([start()], [[start()]], guesses, lambda best: [])) and not asked


def test_the_floor_is_noise_and_no_slow_pattern_of_its_size() -> None:
    problem, search = posed()
    best = minimise(search.plain, start(), limits(problem))
    assert search.at_floor(best)
    place = problem.names.index("mass")
    step = np.zeros(problem.size)
    step[place] = 1.0
    slope = problem.linearised(best.point, 0, 1e-6 * np.maximum(np.abs(best.point), problem.scale))[1][place]
    aside = best.point + step * 0.5 * NOISE / np.sqrt(np.mean(slope**2))  # the pattern adds an eighth to the noise
    moved = Solution(aside, search.plain.cost(aside), 1, True, "")
    assert best.cost < moved.cost < 1.5 * best.cost
    assert not search.at_floor(moved)
    assert not valleys(problem, float("nan")).at_floor(best), "nobody knows where the floor is"


def test_a_wide_loss_is_that_of_plain_squares() -> None:
    problem, search = posed()
    best = minimise(search.plain, start(), limits(problem))
    wide, narrow = (robust(problem, best, softness) for softness in (1e3, NOISE))
    np.testing.assert_allclose(wide.point, best.point, rtol=1e-4, atol=1e-9)
    assert not np.allclose(narrow.point, best.point, rtol=1e-6, atol=0.0)
