"""The data that all sets of causes share: how it is thinned, what can act in it, and how chi² is compared."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from setrigs import BASE, pushed, rubbing

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate.effort import A_SWING, FEWEST_READINGS
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.residuals.noise_model import NOISE_ERROR, of_record, prepare
from msd_ident.selection.experiment import SOUGHT, Experiment, formulated, switched_off, weigh


def test_what_is_hopeless_is_counted_from_the_noise() -> None:
    """Beside a set that leaves noise alone, a few shapes of error more are hopeless, and not 4 times chi² alone."""
    experiment = rubbing()
    noise = experiment.evidence
    assert experiment.worse(noise, 4.0) == noise + 3.0 * SOUGHT
    assert experiment.worse((1.0 + NOISE_ERROR) * noise, 4.0) < 1.5 * noise
    assert experiment.worse(100.0 * noise, 4.0) > 390.0 * noise


@given(st.integers(10, 3000))
def test_a_thinned_record_keeps_enough_samples_and_enough_of_each_swing(keep: int) -> None:
    whole = pushed()
    (few,) = whole.thinned(keep).records
    swings = whole.records[0].duration / (2.0 * math.pi * whole.typical.time)
    wanted = max(keep, FEWEST_READINGS, int(A_SWING * swings))
    samples = whole.records[0].samples
    assert min(wanted, samples) <= few.samples <= min(2 * wanted, samples)
    assert set(few.position) <= set(whole.records[0].position), "samples are left out, and none is changed"


def test_of_many_swings_the_shortest_stretch_is_searched_that_is_like_the_whole() -> None:
    """The largest blows come in turn from either side, 2500 samples apart: 1500 samples hold one of them at most."""
    time = np.arange(9000) / 200.0
    phases = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 40)
    force = np.sum([np.sin(2.1 * (n + 10) * time + phase) for n, phase in enumerate(phases)], axis=0)
    blows = sum(
        side * 30.0 * np.exp(-((time - at) ** 2) / 1e-3) for at, side in ((5, 1), (17.5, -1), (30, 1), (42.5, -1))
    )
    record = Record(time, 0.01 * (force + blows), time, force + blows)
    whole = replace(pushed(), readings=(of_record(record, 1e-6),))
    (few,) = whole.thinned(1500).records
    assert few.samples == 3000
    assert np.ptp(few.position) > 0.8 * np.ptp(record.position)


def test_causes_that_cannot_act_are_not_in_the_library() -> None:
    whole = pushed()
    (part,) = whole.readings
    assert "gravity" not in whole.library and {"backlash", "force_dead_zone"} <= set(whole.library)
    springless = replace(whole, fixed=frozenset({"stiffness"}))
    lost = set(whole.library) - set(springless.library)
    assert lost and lost == {effect.name for effect in LIBRARY if effect.needs_spring} & set(whole.library)
    free = replace(whole, readings=(replace(part, record=replace(part.record, force=0.0 * part.record.force)),))
    assert {by_name(name).acts_on for name in free.library} == {"force", "sensor"}
    turning = replace(whole, readings=(replace(part, record=replace(part.record, position_unit="rad")),))
    assert "gravity" in turning.library
    assert replace(whole, asked=frozenset({"cogging", "gravity"})).library == ("cogging",)


def test_forms_of_a_cause_are_each_others_forms() -> None:
    whole = pushed()
    for name in whole.library:
        assert name not in whole.forms(name)
        assert all(name in whole.forms(other) for other in whole.forms(name)), name
    alone = {name for name in whole.library if not by_name(name).form_of and not by_name(name).mistaken_for}
    assert alone <= set(whole.tried_alone)


def test_what_may_be_mistaken_for_a_cause_is_tried_where_any_law_of_that_explains_something() -> None:
    whole = pushed()
    causes = {by_name(name).cause() for name in whole.library}
    late = [name for name in whole.library if by_name(name).mistaken_for]
    assert late and not set(late) & set(whole.tried_alone)
    for name in late:
        taken_for = set(by_name(name).mistaken_for)
        assert taken_for <= causes, "they are causes, not forms"
        assert set(whole.forms(name)) >= {other for other in whole.library if by_name(other).cause() in taken_for}


def test_what_is_mistaken_for_the_same_cause_is_tried_in_each_others_place() -> None:
    whole = pushed()
    for name in whole.library:
        twins = {one for one in whole.library if set(by_name(one).mistaken_for) & set(by_name(name).mistaken_for)}
        assert twins - {name} <= set(whole.forms(name)), name
    assert "scale_drift" in whole.forms("gain_drift")


@given(st.integers(0, 2**31))
def test_what_a_mask_leaves_out_and_what_it_keeps_is_all(seed: int) -> None:
    whole = pushed(CoulombFriction(0.3))
    problem, weighting, point = formulated(whole, BASE, (Initial(),))
    mask = np.random.default_rng(seed).integers(0, 2, whole.records[0].samples).astype(float)
    kept, left = (weigh(problem, whole.readings, [part]).residual(point) for part in (mask, 1.0 - mask))
    every = weighting.residual(point)
    np.testing.assert_allclose(kept + left, every)
    assert np.isclose(kept @ kept + left @ left, every @ every)


def test_a_problem_begins_inside_its_bounds_and_holds_what_it_is_told() -> None:
    whole: Experiment = pushed()
    model = BASE.with_values({"mass": 1e9}) + ForceGainNonlinearity(0.01, math.inf)
    assert switched_off(model) == {"force_limit"}
    problem, _, point = formulated(whole, model, (Initial(1e-3),), frozenset({"damping"}))
    assert set(problem.names[: len(problem.free)]) == {"mass", "stiffness", "gain_slope"}
    assert np.all(problem.lower <= point) and np.all(point <= problem.upper)
    values = dict(zip(model.names, problem.values(point), strict=True))
    assert values["damping"] == 2.0 and values["stiffness"] == 400.0 and values["gain_slope"] == 0.01
    assert values["force_limit"] == math.inf


def test_of_two_laws_with_one_parameter_each_has_its_own_range() -> None:
    """An oval wheel repeats twice a turn, so that a turn of it may be twice as long as one that is seen to repeat once.
    The range of the last law of the library counted for both.
    """
    experiment, span = pushed(), np.ptp(pushed().records[0].position)

    def longest(name: str, parameter: str) -> float:
        effect = by_name(name)
        values = [0.5 * span if p.name == parameter else 0.0 if p.lower < 0.0 else 1e-3 for p in effect.parameters]
        problem = experiment.problem(BASE + effect.within_bounds(*values))
        return float(problem.upper[problem.names.index(parameter)])

    assert math.isclose(longest("sensor_eccentricity", "eccentricity_pitch"), span / 1.5)
    assert math.isclose(longest("eccentricity_harmonic", "eccentricity_pitch"), 2.0 * span / 1.5)
    lower = experiment.problem(BASE + by_name("curved_stiffness_drift")(0.0, 0.0, 0.0))
    place = lower.names.index("stiffness_drift_rate")
    assert math.isclose(lower.lower[place], -lower.upper[place]), "its other terms hold the stiffness above zero"


@pytest.mark.parametrize(("turns", "placed"), [(3.0, True), (75.0, False)])
def test_a_shaft_that_turns_on_and_on_has_no_law_of_one_place(turns: float, placed: bool) -> None:
    """Cubic springs and stops were tied with the friction of a motor that turned 75 times."""
    time = np.arange(0.0, 4.0, 4e-3)
    force, angle = np.sin(5.0 * time), np.pi * turns * (1.0 - np.cos(np.pi * time / 4.0))
    made = replace(from_samples(time, force, angle), position_unit="rad", force_unit="V")
    library = Experiment(prepare([made]), Plant(1.0, 0.1, 0.0), frozenset({"stiffness"})).library
    assert ("cubic_spring" in library) is ("end_stop" in library) is ("position_dependent_gain" in library) is placed
    assert {"cogging", "cogging_harmonic", "coulomb_friction", "friction_ripple", "quadratic_drag", "gravity"} <= set(
        library
    )
