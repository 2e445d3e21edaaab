"""Numbers that depend on which law of the force's gain acts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from setrigs import BASE, fitted, steps

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Effect, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_dead_zone import ForceDeadZone
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.gain_laws import _rescaled, leading, shares
from msd_ident.workflow import pipeline
from msd_sim import api

MASS = 1.3


def stepped(sizes: tuple[float, ...], limit: float = 7.0) -> Record:
    """Steps of these sizes on a drive that gives this much [N] at most."""
    at = np.arange(len(sizes)) * 0.8
    made = api.simulate(
        {"mass": MASS, "damping": 8.0, "stiffness": 700.0, "friction_coefficient": 0.0, "seed": 4,
         "effects": {"force_gain_nonlinearity": {"gain_slope": 0.0, "force_limit": limit}},
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


def test_of_laws_that_fit_alike_one_leads_that_keeps_the_calibrated_gain() -> None:
    data, scale = steps(), NoiseScale(6000.0)
    slope, limit = ForceGainNonlinearity(0.01, math.inf), ForceGainNonlinearity(0.0, 7.0)
    best, dead, limited = (fitted(data, BASE + law, chi) for law, chi in
                           ((slope, 6000.0), (ForceDeadZone(0.5), 6002.0), (limit, 6001.0)))  # fmt: skip
    assert leading(best, [dead], scale) is dead
    assert leading(best, [dead, limited], scale) is limited, "the likelier one of those that keep it"
    assert leading(dead, [best, limited], scale) is dead, "it keeps the gain already"
    assert leading(best, [], scale) is best
    worse = fitted(data, BASE + ForceDeadZone(0.5), 9000.0)
    assert scale.of(worse) < scale.of(best) - 1.0 and leading(best, [worse], scale) is best
    other = fitted(data, BASE + ForceGainNonlinearity(0.02, math.inf), 6000.0)
    assert leading(best, [other], scale) is best


@pytest.mark.parametrize("law", [ForceDeadZone(0.1), ForceGainNonlinearity(0.0, 9.0)], ids=["dead zone", "limit"])
def test_of_two_sizes_of_force_another_law_moves_the_rig_alike_once_all_forces_are_multiplied(law: Effect) -> None:
    """A mass was 63 % off, with no word: beside a second mass that rubs no search got from the one law to the other."""
    at = np.arange(600) / 500.0
    force = np.select([at < 0.3, at < 0.6, at < 0.9], [5.0, -10.0, 10.0], -5.0)
    record = from_samples(at, force, np.zeros(at.size))
    experiment = Experiment(prepare([record]), BASE, frozenset())
    slope = ForceGainNonlinearity(0.02 if isinstance(law, ForceDeadZone) else -0.02, math.inf)
    model = BASE + CoulombFriction(0.3) + QuadraticDrag(2.0) + slope
    found = _rescaled(model, slope, law, experiment)
    assert {type(effect) for effect in found.effects} == {CoulombFriction, QuadraticDrag, type(law)}
    factor = found.mass / model.mass
    assert abs(factor - 1.0) > 0.05 and found["coulomb_force"] == pytest.approx(0.3 * factor)
    before, after = (simulate(one, record).position for one in (model, found))
    np.testing.assert_allclose(after, before, atol=1e-7 * np.ptp(before))


@pytest.mark.parametrize("law", [ForceDeadZone(9.5), ForceGainNonlinearity(0.0, 0.01)], ids=["dead zone", "limit"])
def test_a_law_that_lets_hardly_a_command_pass_takes_no_force_from_the_rig(law: Effect) -> None:
    """With a factor of 0 and no force at all, any two laws would agree."""
    at = np.arange(300) / 500.0
    record = from_samples(at, np.where(at < 0.3, 5.0, -10.0), np.zeros(at.size))
    slope = ForceGainNonlinearity(-0.02, math.inf)
    found = _rescaled(BASE + slope, slope, law, Experiment(prepare([record]), BASE, frozenset()))
    pushed = max(abs(effect.pushes(u)) for effect in found.effects for u in (5.0, -10.0))
    assert 1e-3 * BASE.mass < found.mass < 1e3 * BASE.mass and pushed > 0.0


@pytest.mark.parametrize("zone", [0.1, 0.35, 0.6, 1.5])
def test_of_two_sizes_of_force_a_dead_zone_has_the_mass(zone: float) -> None:
    sizes = (5.0, 0.0, 10.0, 0.0, -5.0, 0.0, -10.0, 0.0)
    made = stepped(tuple(math.copysign(max(abs(size) - zone, 0.0), size) for size in sizes), limit=math.inf)
    asked = Record(made.time, made.position, made.force_time, np.asarray(sizes))
    found = pipeline.diagnose([asked])
    assert [cause.name for cause in found.causes] == ["force_dead_zone"]
    assert abs(found.extended.quantities["mass"].value / MASS - 1.0) < 0.005
    assert found.causes[0].parameters["dead_zone"].value == pytest.approx(zone, rel=0.01)
    assert found.heldout.better
    low, high = found.spread["mass"]
    assert low < 1.001 * MASS and high > 1.02 * MASS, "a slope of the gain says another mass"
