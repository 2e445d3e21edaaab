"""The intervals of ωn, ζ and K cover the truth as often as they say, on rigs drawn from seeds."""

from __future__ import annotations

import numpy as np
import pytest
from steprigs import drawn

from msd_ident.features import extract


@pytest.mark.parametrize("seeds", [20, pytest.param(60, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    ("lowest", "highest", "tolerance"),
    [(0.005, 0.05, 0.02), (0.05, 0.35, 0.02), (0.35, 1.2, 0.03), (1.2, 5.0, 0.3)],
    ids=["hardly damped", "damped", "barely swinging", "overdamped"],
)
def test_intervals_cover_the_truth_in_every_regime_of_damping(
    lowest: float, highest: float, tolerance: float, seeds: int
) -> None:
    off, relative = [], []
    for seed in range(seeds):
        rig, measured = drawn(seed, lowest, highest)
        form = extract(measured).standard_form
        assert form is not None and form.static_gain is not None, f"seed {seed}: no standard form"
        pairs = ((form.natural_frequency, rig.frequency), (form.damping_ratio, rig.ratio), (form.static_gain, rig.gain))
        off.append([abs(found.value - truth) / found.std for found, truth in pairs])
        relative.append([abs(found.value / truth - 1.0) for found, truth in pairs])
    covered = np.mean(np.array(off) < 1.96, axis=0)
    assert np.all(covered >= 0.88), f"95 % intervals of ωn, ζ, K cover {covered}"
    assert np.max(off) < 6.0
    assert np.all(np.quantile(relative, 0.9, axis=0) < tolerance)
