"""From where the solver ended to intervals and sentences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from fitrigs import DEMO, measured

from msd_ident.data.record import Record
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.least_squares import Solution
from msd_ident.estimate.objective import SquaredError
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.result import FitResult
from msd_ident.estimate.summary import summarise_fit

NOISE = 2e-5


def clean() -> Record:
    return measured(DEMO, {"name": "steps", "hold": 0.5}, rate=250.0, encoder={"counts_per_metre": 0.0})


def noisy(noise: float = NOISE, seed: int = 1) -> Record:
    record = clean()
    return replace(
        record, position=record.position + noise * np.random.default_rng(seed).standard_normal(record.samples)
    )


def summarised(records: Sequence[Record], floor: float = NOISE) -> FitResult:
    """The result at the true values, as if the solver had ended there."""
    problem = formulate(DEMO, tuple(records), zero="known")
    point = problem.vector(dict(zip(DEMO.names, DEMO.values, strict=True)), [Initial()] * len(records))
    ended = Solution(point, SquaredError(problem).cost(point), 1, True, "ended")
    return summarise_fit(problem, ended, floor)


def stds(result: FitResult) -> np.ndarray:
    return np.array([result.quantities[name].std for name in DEMO.names])


def test_intervals_grow_with_the_noise_and_shrink_with_the_records() -> None:
    one = summarised([noisy()])
    np.testing.assert_allclose(stds(summarised([noisy(3.0 * NOISE)], 3.0 * NOISE)), 3.0 * stds(one), rtol=0.02)
    four = summarised([noisy(seed=seed) for seed in range(4)])
    np.testing.assert_allclose(stds(four), 0.5 * stds(one), rtol=0.15)
    assert four.samples == 4 * one.samples and one.see == pytest.approx(NOISE, rel=0.1)


def test_values_message_and_residuals_are_those_of_the_point() -> None:
    result = summarised([noisy()])
    assert result.model == DEMO and result.message == "ended" and result.converged
    np.testing.assert_allclose(result.residuals[0], clean().position - noisy().position, atol=1e-7)
    assert summarised([replace(noisy(), position=np.full(noisy().samples, 0.1))]).open_directions


@pytest.mark.parametrize(
    ("force", "position", "words"),
    [
        ("N", "m", ()),
        ("N·m", "rad", ()),
        ("V", "m", ("The force is in V and its gain in newtons is unknown, so mass, damping, stiffness",)),
        ("V", "rad", ("The force is in V and its gain in N·m is unknown, so mass, damping, stiffness",)),
        ("N", "count", ("The position is in count and its scale in metres is unknown",)),
        ("V", "count", ("The force is in V and its gain", "The position is in count and its scale")),
        ("N", "rad", ("The force is in N and the position in rad, so mass, damping, stiffness, coulomb_force are known "
                      "only up to the lever arm between them",)),
    ],
)  # fmt: skip
def test_what_the_units_leave_open_is_told(force: str, position: str, words: tuple[str, ...]) -> None:
    result = summarised([replace(noisy(), force_unit=force, position_unit=position)])
    assert len(result.open_directions) == len(words)
    for said, begin in zip(result.open_directions, words, strict=True):
        assert said.startswith(begin)
