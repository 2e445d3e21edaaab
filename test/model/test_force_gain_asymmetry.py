"""A drive that is stronger one way than the other, up to one that only pulls."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lsim

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Plant
from msd_ident.model.effects.force_gain_asymmetry import ForceGainAsymmetry
from msd_ident.workflow import pipeline

MASS, DAMPING, STIFFNESS = 1.8, 3.0, 220.0


def roped(sign: float) -> Record:
    """A cart that a rope pulls one way: of the recorded force, the other sign does nothing."""
    time = 0.002 * np.arange(3000)
    force = np.asarray(np.random.default_rng(2).choice([-8.0, -3.0, 0.0, 4.0, 8.0], 30))[(time / 0.2).astype(int)]
    pulled = sign * np.maximum(sign * force, 0.0)
    plant = ([1.0], [MASS, DAMPING, STIFFNESS])
    noise = np.random.default_rng(1).normal(0.0, 3e-5, time.size)
    return from_samples(time, force, np.asarray(lsim(plant, pulled, time, interp=False)[1]) + noise)


@pytest.mark.usefixtures("without_copies")
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_rope_that_pulls_only_is_explained(sign: float, asking_about: Callable[..., None]) -> None:
    """The law was bounded at 0.95: 1.6 % of the motion was left, and "g 0.950 ± 0.034"."""
    asking_about("force_gain_asymmetry", "force_gain_nonlinearity", "coulomb_friction", "asymmetric_spring")
    found = pipeline.diagnose([roped(sign)])
    assert found.verdict == "explained" and [cause.name for cause in found.causes] == ["force_gain_asymmetry"]
    assert found.extended.model["gain_asymmetry"] == pytest.approx(sign, abs=2e-3)
    for name, true in (("mass", MASS), ("damping", DAMPING), ("stiffness", STIFFNESS)):
        assert 0.5 * found.extended.model[name] == pytest.approx(true, rel=0.01), "the mean of both gains is 1"
    assert any("stiffness are 0.5 times as large" in said for said in found.warnings)


def test_hardly_any_difference_says_nothing() -> None:
    assert ForceGainAsymmetry(0.005).same_as(Plant(1.0, 1.0, 1.0)) == ""
