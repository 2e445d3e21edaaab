"""fit: the demo rig recovered, several records at once, wrong stick positions, wild samples, and honest failures."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
from effect_examples import EXAMPLES
from fitrigs import COUNTS_PER_METRE, DEMO, demo_record, measured, wrong
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import Record, from_samples
from msd_ident.errors import UsageError
from msd_ident.estimate import FitResult, Initial, fit
from msd_ident.estimate.formulation import formulate
from msd_ident.model import Model, Plant
from msd_ident.model.effects import by_name
from msd_ident.model.effects.actuator_lag import ActuatorLag
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.force_offset import ForceOffset

STUCK_ASIDE = 0.9 * DEMO["coulomb_force"] / DEMO["stiffness"]


def _off(result: FitResult, truth: Model, name: str) -> float:
    return abs(result.quantities[name].value / truth[name] - 1.0)


def _assert_demo(result: FitResult) -> None:
    """The demands of the joint refit: m and k within 0.1 %, b and Fc (so µ) within 1 %, SEE near the floor."""
    assert result.converged
    assert _off(result, DEMO, "mass") < 0.001
    assert _off(result, DEMO, "stiffness") < 0.001
    assert _off(result, DEMO, "damping") < 0.01
    assert _off(result, DEMO, "coulomb_force") < 0.01
    assert result.see < 1.5 * result.noise_floor


def test_demo_rig() -> None:
    _assert_demo(fit(wrong(DEMO), demo_record()))


@pytest.mark.parametrize("seed", range(4))
def test_demo_rig_with_noise_and_any_wrong_start(seed: int) -> None:
    record = demo_record(encoder={"counts_per_metre": COUNTS_PER_METRE, "noise": 1e-5}, seed=seed)
    factors = tuple(1.0 + 0.3 * np.random.default_rng(seed).choice([-1.0, 1.0], 4))
    _assert_demo(fit(wrong(DEMO, factors), record))


@pytest.mark.parametrize("aside", [-STUCK_ASIDE, STUCK_ASIDE])
def test_a_stick_position_and_a_zero_spoil_nothing(aside: float) -> None:
    experiment = {"name": "paper", "start": 0.3}
    record = measured(
        DEMO, experiment, zero=0.0371, rate=1000.0, encoder={"counts_per_metre": COUNTS_PER_METRE},
        initial_position=aside,
    )  # fmt: skip
    result = fit(wrong(DEMO), record)
    _assert_demo(result)
    assert result.initial[0].position == pytest.approx(aside, abs=5e-6)
    assert result.initial[0].zero == pytest.approx(0.0371, abs=5e-6)
    assert result.initial[0].velocity == 0.0


def test_agrees_with_scipy_on_the_same_residuals() -> None:
    record = demo_record(encoder={"noise": 2e-5}, seed=2)
    result = fit(wrong(DEMO), record)
    problem = formulate(DEMO, (record,))

    def residual(vector: np.ndarray) -> np.ndarray:
        return problem.residual(vector, 0)

    begin = problem.vector({name: DEMO[name] for name in DEMO.names}, [Initial()])
    theirs = scipy.optimize.least_squares(residual, begin, x_scale=np.maximum(np.abs(begin), 1e-4), diff_step=1e-5)
    ours = [result.quantities[name].value for name in DEMO.names]
    spread = [result.quantities[name].std for name in DEMO.names]
    assert np.all(np.abs(theirs.x[:4] - ours) < 0.05 * np.array(spread))


def test_records_share_parameters_and_keep_their_own_start() -> None:
    encoder = {"counts_per_metre": COUNTS_PER_METRE, "noise": 1e-5}
    first = measured(DEMO, {"name": "paper"}, zero=0.01, rate=500.0, encoder=encoder, seed=1)
    second = measured(DEMO, {"name": "release", "position": 0.02}, zero=-0.02, rate=500.0, encoder=encoder, seed=2)
    alone, both = fit(wrong(DEMO), first), fit(wrong(DEMO), [first, second])
    _assert_demo(both)
    assert both.initial[0].zero == pytest.approx(0.01, abs=2e-5)
    assert both.initial[1].zero == pytest.approx(-0.02, abs=2e-5)
    assert both.initial[1].position == pytest.approx(0.02, abs=2e-5)
    assert both.quantities["coulomb_force"].std < alone.quantities["coulomb_force"].std


def test_fixed_parameters_by_name_and_by_value() -> None:
    record = demo_record()
    by_name = fit(wrong(DEMO).with_values({"mass": DEMO["mass"]}), record, fixed=["mass"])
    by_value = fit(wrong(DEMO), record, fixed={"mass": DEMO["mass"]})
    for result in (by_name, by_value):
        assert result.quantities["mass"].value == DEMO["mass"]
        assert result.quantities["mass"].std == 0.0
        assert "mass" not in result.free
    assert by_name.quantities["stiffness"].value == pytest.approx(by_value.quantities["stiffness"].value, rel=1e-6)


def test_a_limit_that_is_not_there_is_not_fitted() -> None:
    result = fit(DEMO + ForceGainNonlinearity(0.0, math.inf), demo_record(), fixed=["gain_slope"])
    assert result.quantities["force_limit"].value == math.inf
    assert "force_limit" not in result.free


def test_known_zero_makes_the_offset_visible() -> None:
    truth = DEMO + ForceOffset(1.5)
    record = measured(truth, {"name": "paper"}, rate=1000.0, encoder={"noise": 1e-5}, initial_position=-1.5 / 694.1)
    result = fit(wrong(truth), record, zero="known")
    assert result.quantities["offset_force"].value == pytest.approx(1.5, rel=0.01)
    assert result.initial[0].zero == 0.0


def test_wild_samples_do_not_pull_with_soft_loss() -> None:
    record = demo_record(encoder={"noise": 1e-5}, seed=4)
    rng = np.random.default_rng(4)
    position = record.position.copy()
    wild = rng.choice(record.samples, 60, replace=False)
    position[wild] += rng.uniform(0.002, 0.01, wild.size)
    spoiled = replace(record, position=position)
    robust, plain = fit(wrong(DEMO), spoiled, loss="soft_l1"), fit(wrong(DEMO), spoiled)
    assert _off(robust, DEMO, "stiffness") < 0.2 * _off(plain, DEMO, "stiffness")
    assert _off(robust, DEMO, "mass") < 0.001
    clean = fit(wrong(DEMO), record)
    for name in DEMO.names:
        quantity = robust.quantities[name]
        assert abs(quantity.value - DEMO[name]) < 4.0 * quantity.std
        assert quantity.std < 2.0 * clean.quantities[name].std, name


def test_near_search_starts_where_it_is_told() -> None:
    record = demo_record(encoder={"noise": 1e-5}, seed=5)
    base = fit(wrong(DEMO), record)
    longer = fit(base.model + ActuatorLag(1e-3), record, search="near", initial=base.initial)
    assert longer.converged
    assert longer.see <= base.see * 1.0001
    assert abs(longer.quantities["lag_time"].value) < 4.0 * longer.quantities["lag_time"].std


@settings(max_examples=12)
@given(st.floats(0.3, 3.0), st.floats(-2.0, 2.0), st.floats(-0.5, 0.5))
def test_units_of_length_do_not_matter(metres: float, zero: float, time: float) -> None:
    """The same rig measured in another unit of length, from another zero: stiffness and mass scale, ratios stay."""
    record = demo_record(rate=250.0, encoder={"noise": 2e-5}, seed=1)
    scaled = replace(record, position=metres * record.position + zero)
    one, other = fit(wrong(DEMO), record), fit(wrong(DEMO), scaled)
    for name in ("mass", "damping", "stiffness"):
        assert other.quantities[name].value * metres == pytest.approx(one.quantities[name].value, rel=1e-4)
    assert other.quantities["coulomb_force"].value == pytest.approx(one.quantities["coulomb_force"].value, rel=1e-3)


def test_a_still_record_ends_in_words_not_in_an_error() -> None:
    time = np.arange(400) * 1e-3
    still = from_samples(time, np.zeros(400), np.full(400, 0.1))
    result = fit(wrong(DEMO), still)
    assert all(math.isnan(result.quantities[name].std) for name in ("mass", "damping", "stiffness"))
    assert result.open_directions
    assert result.message


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_a_still_record_beside_another_stops_no_effect(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cart that did not move has no size that a guess could be a share of.

    Each start and guess is made, but none is followed for more than two steps: no model explains these records.
    """
    for steps in ("LOOK", "SHORT", "THOROUGH", "LONG"):
        monkeypatch.setattr(f"msd_ident.estimate.multistart.{steps}", 2)
    whole = Plant(DEMO["mass"], DEMO["damping"], DEMO["stiffness"]) + by_name(name)(**EXAMPLES[name])
    time = np.arange(60) * 7e-3
    still = from_samples(time, np.zeros(60), np.full(60, 0.1))
    sine = from_samples(time, 5.0 * np.sin(9.0 * time), 0.01 * np.sin(9.0 * time) + 1e-3 * np.sin(70.0 * time))
    assert fit(whole, [sine, still]).message


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.long) if name == "cogging_harmonic" else name for name in sorted(EXAMPLES)],
)
def test_a_still_record_alone_stops_no_effect(name: str) -> None:
    """``long`` is the one that takes seconds: a cart that is simulated over thousands of ripples."""
    whole = Plant(DEMO["mass"], DEMO["damping"], DEMO["stiffness"]) + by_name(name)(**EXAMPLES[name])
    time = np.arange(30) * 4e-3
    assert fit(whole, from_samples(time, np.zeros(30), np.full(30, 0.1))).message


def test_noise_alone_ends_in_words_not_in_an_error() -> None:
    rng = np.random.default_rng(0)
    time = np.arange(400) * 1e-3
    result = fit(wrong(DEMO), from_samples(time, rng.normal(size=400), rng.normal(size=400)))
    assert math.isfinite(result.see)
    assert result.message


def test_few_samples() -> None:
    record = demo_record()
    few = Record(record.time[:400:20], record.position[:400:20], record.force_time, record.force)
    result = fit(wrong(DEMO), few)
    assert math.isfinite(result.see)
    assert result.message


def test_misuse_is_refused_in_words() -> None:
    record = demo_record(rate=250.0)
    with pytest.raises(UsageError, match="no records to fit; expected at least one"):
        fit(DEMO, [])
    with pytest.raises(UsageError, match="no parameter 'masss' to fix; this model has mass, damping, stiffness"):
        fit(DEMO, record, fixed=["masss"])
    with pytest.raises(UsageError, match="every parameter is fixed"):
        fit(DEMO, record, fixed=DEMO.names)
    with pytest.raises(UsageError, match="a start has mass, damping, stiffness; expected the model's"):
        fit(DEMO, record, starts=[Plant(1.0, 1.0, 1.0)])
    with pytest.raises(UsageError, match="2 initial states for 1 records"):
        fit(DEMO, record, search="near", initial=[Initial(), Initial()])
    with pytest.raises(UsageError, match="zero is 'maybe'; expected 'free' or 'known'"):
        fit(DEMO, record, zero="maybe")  # type: ignore[arg-type]


def test_a_fit_near_its_start_ends_after_the_steps_that_it_is_given() -> None:
    ended = fit(wrong(DEMO), demo_record(rate=250.0), search="near", steps=1)
    assert not ended.converged and "after 1 iterations" in ended.message


def test_a_result_cannot_be_changed() -> None:
    result = fit(DEMO, demo_record(rate=250.0))
    with pytest.raises(dataclasses.FrozenInstanceError):
        result.see = 0.0  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        result.residuals[0][0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        result.covariance[0, 0] = 1.0


def test_twice_the_same() -> None:
    record = demo_record(rate=250.0)
    one, other = fit(wrong(DEMO), record), fit(wrong(DEMO), record)
    assert one.quantities == other.quantities
    assert one.see == other.see


def test_friction_that_is_not_there() -> None:
    truth = Plant(1.0, 3.0, 600.0)
    record = measured(truth, {"name": "paper"}, rate=500.0, encoder={"noise": 2e-5}, seed=1)
    result = fit(Plant(1.3, 2.1, 780.0) + CoulombFriction(0.3), record)
    friction = result.quantities["coulomb_force"]
    assert friction.value < 4.0 * friction.std
    assert _off(result, truth, "mass") < 0.002
