"""Peaks of a scan."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis.extra.numpy import arrays

from msd_ident.data.record import FloatArray
from msd_ident.estimate.effort import KEPT
from msd_ident.estimate.peaks import highest


@given(arrays(np.float64, (12,), elements={"min_value": -1e3, "max_value": 1e3}, unique=True))
def test_the_highest_come_first_and_each_stands_above_its_neighbours(gain: FloatArray) -> None:
    places = highest(gain)
    assert places[0] == int(np.argmax(gain)) and 1 <= len(places) <= KEPT
    assert [gain[i] for i in places] == sorted((gain[i] for i in places), reverse=True)
    for i in places:
        assert all(gain[i] > gain[j] for j in (i - 1, i + 1) if 0 <= j < gain.size)
