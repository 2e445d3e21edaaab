"""Windows around each sample."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.estimate.windows import breadths


@given(st.integers(1, 60), st.integers(1, 80))
def test_a_window_ends_where_the_record_ends(size: int, reach: int) -> None:
    counted = [min(i + reach, size - 1) - max(i - reach, 0) for i in range(size)]
    np.testing.assert_array_equal(breadths(size, reach), counted)
