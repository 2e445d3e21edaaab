"""Intervals of a diagnosed model: the error of its laws, and its rivals."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from setrigs import BASE, pushed, stood

from msd_ident.data.record import Record
from msd_ident.diagnosis import intervals
from msd_ident.estimate import FitResult
from msd_ident.estimate.least_squares import Solution
from msd_ident.estimate.levels import SHAPES
from msd_ident.estimate.summary import summarise_fit
from msd_ident.model import Plant
from msd_ident.model import simulate as model_motion
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.parameters import FORCES
from msd_ident.model.rest import slope_at_rest
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.workflow import pipeline
from msd_sim.api import simulate


@pytest.fixture
def plain() -> Hypothesis:
    return stood(pushed(), BASE)


def result(fitted: Hypothesis) -> FitResult:
    """The fit as it stands, with the covariance of its noise."""
    return summarise_fit(fitted.problem, Solution(fitted.point, 1.0, 0, True, "stood"), 1e-5)


def growth(fitted: Hypothesis, noise: float, rivals: tuple[tuple[float, Hypothesis], ...] = ()) -> dict[str, float]:
    """Factor on each standard deviation where noise leaves this chi²."""
    before = result(fitted)
    after = intervals.stated(before, fitted, rivals, NoiseScale(noise))
    assert after.model == before.model
    for name, quantity in after.quantities.items():
        assert quantity.value == before.quantities[name].value
    assert np.allclose(np.sqrt(np.diag(after.covariance)), [after.quantities[name].std for name in after.free])
    assert np.allclose(after.correlation, before.correlation)
    return {name: after.quantities[name].std / before.quantities[name].std for name in after.free}


def test_where_only_noise_is_left_the_intervals_are_those_of_the_noise(plain: Hypothesis) -> None:
    assert all(1.0 <= factor < 1.3 for factor in growth(plain, plain.chi).values())


def test_what_the_laws_leave_widens_them_as_the_evidence_counts_it(plain: Hypothesis) -> None:
    """A hundred times as much chi² in so few features, not in a thousand samples."""
    least = growth(plain, plain.chi)
    found = growth(plain, 0.01 * plain.chi)
    root = math.sqrt(1.0 + 0.99 * plain.chi / SHAPES)
    assert root > 10.0
    for name, factor in found.items():
        assert factor == pytest.approx(root * least[name], rel=0.3)


def test_contacts_that_may_begin_late_widen_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the stop's force jumps, by what hides of it in the scatter of chi²: without a jump by nothing."""
    stop = BufferedStop(0.0, 0.015, 4000.0, 60.0)
    record = pushed().readings[0].record
    moved = model_motion(BASE + stop, record).position + np.random.default_rng(1).normal(0.0, 1e-5, record.samples)
    experiment = Experiment(prepare([replace(record, position=moved)]), BASE, frozenset())
    touching = stood(experiment, BASE + stop)
    late = growth(touching, touching.chi)
    monkeypatch.setattr(BufferedStop, "jumps", False)
    known = growth(touching, touching.chi)
    assert late["damping"] > 1.2 * known["damping"]
    assert all(late[name] >= known[name] for name in known)


def test_a_rival_widens_what_it_moves_as_likely_as_it_is(plain: Hypothesis) -> None:
    stiffer = stood(pushed(), replace(BASE, stiffness=440.0) + CubicSpring(1.0))
    before = result(plain).quantities["stiffness"].std
    found = growth(plain, plain.chi, ((0.25, stiffer),))
    assert found["stiffness"] * before == pytest.approx(math.sqrt(0.25) * 40.0, rel=1e-3)
    assert found["mass"] == pytest.approx(growth(plain, plain.chi)["mass"])


def test_what_is_open_stays_open(plain: Hypothesis) -> None:
    before = result(plain)
    quantities = {**before.quantities, "damping": replace(before.quantities["damping"], std=math.nan)}
    after = intervals.stated(replace(before, quantities=quantities), plain, (), NoiseScale(0.01 * plain.chi))
    assert math.isnan(after.quantities["damping"].std) and math.isfinite(after.quantities["mass"].std)


def test_what_is_wider_than_its_range_is_open(plain: Hypothesis) -> None:
    """A loop of 0 N wide is crossed within any force: no number of volts says that."""
    problem = plain.problem
    entry = problem.names.index("damping")
    before = result(plain)
    wide = 2.0 * before.quantities["damping"].std
    for upper, known in ((problem.lower[entry] + 0.5 * wide, False), (problem.lower[entry] + 10.0 * wide, True)):
        bounds = problem.upper.copy()
        bounds[entry] = upper
        fitted = replace(plain, problem=replace(problem, upper=bounds))
        after = intervals.stated(replace(before, model=fitted.model), fitted, (), NoiseScale(plain.chi / 4.0))
        assert after.quantities["damping"].known is known
        assert after.quantities["mass"].known


def test_the_stiffness_at_rest_has_the_interval_of_the_curve_and_of_its_rivals() -> None:
    """k, k3 and F0 vary together, as their covariance says."""
    k3 = 3e5
    effects = CubicSpring(k3), ForceOffset(-BASE.stiffness * 0.02 - k3 * 0.02**3)
    experiment, model = pushed(*effects), replace(BASE, effects=effects)
    fitted = refine(experiment, frozenset(model.effect_names), model, experiment.problem(model).initial)
    before, scale = result(fitted), NoiseScale(fitted.chi)
    rest = intervals.at_rest(before, fitted, (), scale)["stiffness_at_rest"]
    assert rest.value == pytest.approx(BASE.stiffness + 3.0 * k3 * 0.02**2, abs=3.0 * rest.std) and rest.unit == "N/m"
    drawn = np.random.default_rng(1).multivariate_normal([before.model[p] for p in before.free], before.covariance, 400)
    slopes = [slope_at_rest(before.model.with_values(dict(zip(before.free, one, strict=True)))) for one in drawn]
    assert rest.std == pytest.approx(np.std(slopes), rel=0.2)
    rival = stood(pushed(), replace(BASE, stiffness=rest.value + 10.0))
    wider = intervals.at_rest(before, fitted, ((0.25, rival),), scale)["stiffness_at_rest"]
    assert wider.std == pytest.approx(math.hypot(rest.std, 5.0), rel=1e-3)


def test_a_spring_without_a_constant_force_has_no_second_stiffness(plain: Hypothesis) -> None:
    bent = stood(pushed(), BASE + CubicSpring(3e5))
    for fitted in (plain, bent):
        assert intervals.at_rest(result(fitted), fitted, (), NoiseScale(fitted.chi)) == {}


def test_friction_too_weak_to_be_seen_is_in_the_interval_of_the_damping(plain: Hypothesis) -> None:
    """As likely as the evidence has it, and with the variance that friction beside damping leaves to both."""
    rubbing = stood(pushed(), BASE + CoulombFriction(1e-4))
    before, known = result(plain), growth(plain, plain.chi)
    after = intervals.stated(before, plain, (), NoiseScale(plain.chi), rubbing)
    for name in before.free:
        assert after.quantities[name].value == before.quantities[name].value
        assert after.quantities[name].std >= known[name] * before.quantities[name].std * (1.0 - 1e-12), name
    assert after.quantities["damping"].std > 1.2 * known["damping"] * before.quantities["damping"].std


def test_an_adequate_model_of_a_rig_that_rubs_a_little_states_no_damping_that_it_has_not() -> None:
    """A friction of 0.003 N under 8 N, in noise of 0.1 mm: the base model takes it for damping."""
    rig = {"mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0}
    told = {
        "encoder": {"counts_per_metre": 100000.0, "noise": 1e-4},
        "experiment": {"name": "steps", "force": 8.0, "hold": 0.6},
        "effects": {"coulomb_friction": {"coulomb_force": 0.003}},
    }
    made = simulate({**rig, **told})
    found = pipeline.diagnose([Record(made.time, made.position, made.force_time, made.force)])
    assert found.verdict == "adequate"
    for name in ("mass", "damping", "stiffness"):
        quantity = found.extended.quantities[name]
        assert abs(quantity.value - rig[name]) < 3.0 * quantity.std, name
        assert quantity.std < 0.01 * rig[name], name


@pytest.mark.parametrize("seed", [1, 2])
def test_over_a_few_swings_unseen_friction_takes_no_more_than_all_damping(seed: int) -> None:
    """Damping and friction tell only their sum, and neither is below 0: 0.035 ± 0.13 N·s/m was stated, and ± 0.80."""
    time = 0.05 * np.arange(101)
    force = np.zeros(1)
    still = Record(time=time, position=0.0 * time, force_time=time[:1], force=force)
    swing = model_motion(Plant(1.0, 0.0345, 27.53), still, 0.05).position
    read = swing + np.random.default_rng(seed).normal(0.0, 3.7e-4, time.size)
    found = pipeline.diagnose([replace(still, position=read)])
    damping = found.base.quantities["damping"]
    assert found.verdict == "adequate"
    assert abs(damping.value - 0.0345) < 1.96 * damping.std < 2.2 * 0.0345


def test_what_is_a_place_in_the_force_signal_stays_known_where_no_force_is() -> None:
    """ "No parameter with a unit of force is known" stood beside a dead zone of 18.7 ± 6.4 %."""
    assert "dead_zone" not in FORCES and "mass" in FORCES
    assert "no parameter with a unit of force is, but for those of the force signal itself: push" in intervals.NO_SCALE
