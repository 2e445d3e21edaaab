"""SEE and its reduction: eqs. 14 and 15."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.errors import UsageError
from msd_ident.estimate import see, see_reduction


def test_see_divides_by_n_minus_two() -> None:
    assert see(np.array([1.0, -1.0, 1.0, -1.0])) == pytest.approx(np.sqrt(4.0 / 2.0))


def test_see_pools_records_as_one() -> None:
    one, other = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0])
    assert see([one, other]) == pytest.approx(see(np.concatenate([one, other])))


def test_see_of_two_residuals_is_refused() -> None:
    with pytest.raises(UsageError, match="SEE of 2 residuals; expected at least 3"):
        see(np.zeros(2))


def test_reduction_of_the_paper() -> None:
    assert see_reduction(0.0829, 0.0606) == pytest.approx(26.9, abs=0.05)


def test_reduction_of_nothing_is_refused() -> None:
    with pytest.raises(UsageError, match="original SEE is 0.0; expected a positive number"):
        see_reduction(0.0, 0.0)
