"""A set of causes: which may act together, what one is without another, and what imitates what."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from effect_examples import EXAMPLES
from effect_examples import model as example
from hypothesis import given
from hypothesis import strategies as st
from setrigs import BASE, fitted, pushed, stood

from msd_ident.data.record import from_samples
from msd_ident.errors import UsageError
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant, simulate
from msd_ident.model.effects import by_name
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.gravity import Gravity
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.smooth_friction import SmoothFriction
from msd_ident.model.effects.smooth_stribeck_friction import SmoothStribeckFriction
from msd_ident.residuals.noise_model import of_record
from msd_ident.selection.hypothesis import causes_that_fit, imitated, without
from msd_ident.selection.hypothesis_fit import refine

RUB = CoulombFriction(0.3)


def test_whatever_stands_beside_it_an_effect_takes_the_place_of_another_one() -> None:
    """Beside gravity a spring that softens was to become gravity, which then stood in the model twice."""
    for one, other in combinations(EXAMPLES, 2):
        if causes_that_fit(frozenset({one, other})):
            model = Plant(1.0, 2.0, 400.0) + by_name(one)(**EXAMPLES[one]) + by_name(other)(**EXAMPLES[other])
            soft = {name: -1.0 for name in ("cubic_stiffness", "power_force") if name in model.names}
            for either in (model, model.with_values(soft)):
                assert all(causes == frozenset(there.effect_names) for causes, there in imitated(either).items())
    weighed = imitated(Plant(1.0, 2.0, 5.0) + Gravity(2.0) + CubicSpring(-0.5))
    assert weighed[frozenset({"gravity"})] == Plant(1.0, 2.0, 0.0) + Gravity(7.0)


def test_what_stops_and_a_play_come_to() -> None:
    """The force beyond the stops is that of one spring with a play; beside no spring it is nothing else."""
    alone, beside = Plant(1.0, 2.0, 0.0) + EndStop(2e-3, 400.0), Plant(1.0, 2.0, 100.0) + EndStop(2e-3, 300.0)
    play = frozenset({"backlash"})
    for model, width in ((alone, 2e-3), (beside, 1.5e-3), (beside + Backlash(4e-4), 1.6e-3)):
        assert imitated(model) == {play: Plant(1.0, 2.0, 400.0) + Backlash(width)}
    assert set(imitated(alone, alike=True)) == {play}
    assert imitated(beside, alike=True) == {} == imitated(Plant(1.0, 2.0, 0.0) + EndStop(2e-3, 0.0))


@pytest.mark.parametrize(("peak", "alike"), [(0.3, True), (0.5, False)])
def test_what_a_smooth_law_with_a_peak_that_is_none_comes_to(peak: float, alike: bool) -> None:
    """It is not named as friction with a peak: a search fits the law without it too (``simpler_sets.reduced``)."""
    model = Plant(1.0, 2.0, 400.0) + SmoothStribeckFriction(0.4, peak, 0.02, 2e-4)
    smooth = {frozenset({"smooth_friction"}): Plant(1.0, 2.0, 400.0) + SmoothFriction(0.4, 2e-4)}
    assert imitated(model) == smooth
    assert imitated(model, alike=True) == (smooth if alike else {})


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("before", [0.0, 0.4])
def test_stops_about_another_place_are_a_play_beside_a_force(side: float, before: float) -> None:
    """Beyond the stops on either side both move alike, counted from the middle of the stops."""
    centre = -1e-3
    model = Plant(1.0, 2.0, 900.0) + BufferedStop(centre, 1e-3, 300.0, 0.0)
    model = model + ForceOffset(before) if before else model
    ((causes, play),) = imitated(model).items()
    assert causes == {"backlash", "force_offset"} and play["backlash_half_width"] == pytest.approx(0.25e-3)
    assert play.effect("backlash").zero_in(model) == centre
    time = np.linspace(0.0, 2.0, 400)
    record = from_samples(time, np.where(time < 1.0, 10.0, 8.0) * side, 0.0 * time)
    start = 8e-3 * side
    moved = simulate(model, record, start).position
    counted = simulate(play, record, start - centre).position + centre
    assert np.min(np.abs(moved)) > 2e-3, "the cart leaves the stops"
    np.testing.assert_allclose(moved, counted, rtol=0.0, atol=1e-8)


@given(st.sets(st.sampled_from(sorted(EXAMPLES)), max_size=4))
def test_causes_fit_together_where_a_model_can_hold_them(names: set[str]) -> None:
    if causes_that_fit(frozenset(names)):
        assert set(example(*names).effect_names) == names
        assert all(causes_that_fit(frozenset(names - {name})) for name in names)
    else:
        with pytest.raises(UsageError, match="laws; expected one at most"):
            example(*sorted(names))


def test_the_octaves_share_the_chi() -> None:
    one = fitted(pushed(RUB), BASE + RUB, 900.0)
    assert one.octaves.sum() == pytest.approx(one.chi) == pytest.approx(900.0)
    assert len(one.residuals()) == 1


def test_the_others_follow_where_an_effect_is_taken_away() -> None:
    """Without its friction a model rings longer, unless the damper takes it upon itself."""
    data = pushed(RUB)
    whole = refine(data, frozenset({"coulomb_friction"}), BASE + RUB, (Initial(),))
    left, initial = without(whole, "coulomb_friction")
    assert left.effects == () and left.damping > whole.model.damping
    dropped = stood(data, whole.model.without("coulomb_friction"))
    assert refine(data, frozenset(), left, initial).chi <= stood(data, left).chi < 0.7 * dropped.chi


def test_what_has_no_strength_goes_without_a_trace() -> None:
    data = pushed(RUB)
    left, _ = without(stood(data, BASE + CoulombFriction(0.0)), "coulomb_friction")
    np.testing.assert_allclose(left.values, BASE.values, rtol=1e-9)


def test_a_cart_that_rests_speaks_against_what_would_move_it() -> None:
    data = pushed()
    still = replace(data.records[0], position=data.readings[0].noise * np.random.default_rng(1).standard_normal(1000))
    moving = stood(data, BASE + PeriodicDisturbance(0.2, 25.0, 0.4))
    assert moving.stirred == 0.0
    assert replace(moving, rests=(of_record(still, data.readings[0].noise),)).stirred > 1e3
