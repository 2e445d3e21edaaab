"""Levels: those that follow from others do so, and those of accuracy lie where rounding ends."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from fitrigs import DEMO, measured

from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.levels import CONFIDENCE, NULL, STUCK, TWO_SIDED
from msd_ident.estimate.problem import Initial
from msd_ident.quantity import MAD


def test_an_interval_holds_its_share_of_normal_errors() -> None:
    assert math.erf(TWO_SIDED / math.sqrt(2.0)) == pytest.approx(CONFIDENCE, abs=1e-12)


def test_the_median_deviation_tells_the_standard_deviation() -> None:
    errors = 3.0 * np.random.default_rng(1).standard_normal(100_001)
    assert MAD * np.median(np.abs(errors)) == pytest.approx(3.0, rel=0.02)


def test_a_search_gives_up_where_rounding_swallows_what_a_step_gains() -> None:
    gain = 1.0 / STUCK**2
    assert gain == pytest.approx(sys.float_info.epsilon)
    assert 1.0 + 0.4 * gain == 1.0 < 1.0 + 2.0 * gain


def test_finite_differences_leave_less_than_null_along_a_null_direction() -> None:
    """Without a force, mass, damping, stiffness and friction have a common factor that no reading tells."""
    record = measured(DEMO, {"name": "release", "position": 0.02, "duration": 2.0}, rate=500.0)
    problem = formulate(DEMO, (record,))
    point = problem.vector(dict(zip(DEMO.names, DEMO.values, strict=True)), [Initial(0.02)])
    _, jacobian = problem.central(point, 0, 10.0 * problem.first_steps())
    size = np.linalg.norm(jacobian, axis=1)
    values = np.linalg.eigvalsh((jacobian / size[:, None]) @ (jacobian / size[:, None]).T)
    assert abs(values[0]) < NULL < 1e-2 * values[1]
