"""Numbers that depend on which law of the force's gain acts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from setrigs import BASE, fitted, steps

from msd_ident.data.record import Record
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.gain_laws import shares
from msd_ident.workflow import pipeline
from msd_sim import api

MASS = 1.3


def stepped(sizes: tuple[float, ...]) -> Record:
    """Steps of these sizes on a drive that gives 7 N at most."""
    at = np.arange(len(sizes)) * 0.8
    made = api.simulate(
        {"mass": MASS, "damping": 8.0, "stiffness": 700.0, "friction_coefficient": 0.0, "seed": 4,
         "effects": {"force_gain_nonlinearity": {"gain_slope": 0.0, "force_limit": 7.0}},
         "encoder": {"counts_per_metre": 0.0, "noise": 5e-6}, "rate": 500.0, "duration": 0.8 * len(sizes),
         "force_time": at.tolist(), "force": list(sizes)}
    )  # fmt: skip
    return Record(made.time, made.position, made.force_time, made.force)


def test_of_two_sizes_of_force_the_mass_is_said_to_depend_on_the_law() -> None:
    found = pipeline.diagnose([stepped((5.0, 0.0, 10.0, 0.0, -5.0, 0.0, -10.0, 0.0))])
    assert [cause.name for cause in found.causes] == ["force_gain_nonlinearity"]
    low, high = found.spread["mass"]
    assert low * 0.999 < MASS < high * 1.001 and high > 1.05 * low
    mass = found.extended.quantities["mass"]
    assert mass.std > 0.25 * (high - low), "its interval holds what another law of the gain says"
    assert any("laws of one cause" in warning and "mass" in warning for warning in found.warnings)


def test_of_four_sizes_it_is_known() -> None:
    found = pipeline.diagnose([stepped((3.0, 0.0, 6.0, 0.0, -8.0, 0.0, -10.0, 0.0))])
    assert [cause.name for cause in found.causes] == ["force_gain_nonlinearity"]
    low, high = found.spread.get("mass", (MASS, MASS))
    assert high < 1.01 * low
    mass = found.extended.quantities["mass"]
    assert abs(mass.value / MASS - 1.0) < 0.005 and mass.std < 0.01 * MASS


def test_the_probability_of_the_leading_set_is_shared_by_likelihood() -> None:
    data = steps()
    slope = ForceGainNonlinearity(-0.01, math.inf)
    best, same, worse = (fitted(data, BASE + slope, chi) for chi in (6000.0, 6000.0, 9000.0))
    scale = NoiseScale(6000.0)
    assert [p for p, _ in shares([same], best, scale, 0.8)] == pytest.approx([0.4])
    (p, _), (q, _) = shares([same, worse], best, scale, 0.8)
    odds = math.exp(scale.of(worse) - scale.of(best))
    assert 0.0 < odds < 1.0 and (p, q) == pytest.approx((0.8 / (2.0 + odds), 0.8 * odds / (2.0 + odds)))
    assert shares([], best, scale, 0.8) == []
