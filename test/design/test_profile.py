"""Profiles: the force that they mean."""

from __future__ import annotations

import numpy as np
import pytest
from designrigs import ALL


def test_force_over_time() -> None:
    assert ALL.force_at(np.array([0.2, 0.6, 1.4, 2.75, 6.4])).tolist() == pytest.approx([0.0, 2.0, 2.0, -1.0, 0.0])
    assert ALL.force_at(np.array([2.0]))[0] == pytest.approx(0.5, abs=0.01)  # the middle of the ramp
    time, force = ALL.commands
    assert force[-1] == 0.0 and time[-1] == ALL.duration == 6.5
    sweep = force[(time >= 3.0) & (time < 5.0)]
    assert sweep.max() == pytest.approx(1.7, abs=0.01) and sweep.min() == pytest.approx(-1.3, abs=0.02)
    train = ALL.force_at(np.linspace(5.001, 5.999, 100))
    assert set(train.tolist()) == {-1.0, 1.0}
