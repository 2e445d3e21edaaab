"""Probabilities of causes: they add up over sets and are no surer than a cause stands out."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations

import likelihoods
import numpy as np
import pytest
from setrigs import BASE, fitted, odds, ranked, steps

from msd_ident.model import Effect
from msd_ident.model.effects.asymmetric_spring import AsymmetricSpring
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.bilinear_spring import BilinearSpring
from msd_ident.model.effects.bouc_wen import BoucWen
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.cogging_harmonic import CoggingHarmonic
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.eccentricity_harmonic import EccentricityHarmonic
from msd_ident.model.effects.fading_damping import FadingDamping
from msd_ident.model.effects.force_dead_zone import ForceDeadZone
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.modulated_disturbance import ModulatedDisturbance
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.position_dependent_friction import PositionDependentFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.second_mode import SecondMode
from msd_ident.model.effects.sensor_drift import SensorDrift
from msd_ident.model.effects.sensor_eccentricity import SensorEccentricity
from msd_ident.model.effects.smooth_friction_turn import SmoothFrictionTurn
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.two_tone_disturbance import TwoToneDisturbance
from msd_ident.selection import doubts, ties
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.certainty import CERTAIN, CERTAIN_ODDS, certain
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.ranking import Ranking


@pytest.fixture
def experiment() -> Experiment:
    return steps()


def test_a_small_cause_that_leaves_nothing_but_noise_is_named_and_never_certain(experiment: Experiment) -> None:
    """A fiftieth of what friction explains: laws that are exact to the noise show no error that it could be."""
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 1000.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * 20.0**2),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 840.0),
        }
    )
    assert found.best.causes == {"coulomb_friction", "quadratic_drag"}
    assert found.of_cause("quadratic_drag") == pytest.approx(0.9)
    assert not found.of_cause("quadratic_drag") > CERTAIN


@pytest.mark.parametrize(("without", "times"), [(1.5, 5.0), (1.9, 9.0), (7.3, 63.0)])
def test_a_further_cause_is_as_sure_as_it_stands_out_of_what_the_noise_can_hide(
    experiment: Experiment, without: float, times: float
) -> None:
    """``without`` is the variance without the drag; what explains five times a tenth of the noise's is not certain."""
    both = BASE + CoulombFriction(0.1) + QuadraticDrag(1.0)
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 64.0**2),
            "alone": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * without),
            "both": fitted(experiment, both, 840.0),
        }
    )
    assert found.best.causes == {"coulomb_friction", "quadratic_drag"}
    likely = replace(found, rich=True).of_cause("quadratic_drag") / found.of_set(found.best.causes)
    assert likely == pytest.approx(times / (1.0 + times))
    poor = found.of_cause("quadratic_drag") / found.of_set(found.best.causes)
    assert poor == pytest.approx(min(times / (1.0 + times), CERTAIN)), "a poor experiment makes none certain"


def test_a_rich_experiment_does_not_make_a_flexible_law_surer(experiment: Experiment) -> None:
    """A law with less than the usual prior odds bends to much that is another law's."""
    first, second = CoulombFriction(0.1), BilinearSpring(1e-3, 50.0)
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 64.0**2),
            "alone": fitted(experiment, BASE + first, 840.0 * 8.0**2),
            "both": fitted(experiment, BASE + first + second, 840.0),
        }
    )
    for rich in (False, True):
        assert replace(found, rich=rich).of_cause(second.name) == pytest.approx(4.5 / 5.5)


@pytest.mark.parametrize(("alone", "times"), [(8.0, 8.56), (7.0, 10.06), (16.0, 3.0)])
def test_a_spring_is_as_sure_as_it_explains_more_than_the_error_of_its_form(
    experiment: Experiment, alone: float, times: float
) -> None:
    """Both leave three noise floors, the first leaves ``alone``: what the second takes of it may be its error."""
    first, second = BilinearSpring(1e-3, 50.0), CubicSpring(1e5)
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 64.0**2),
            "alone": fitted(experiment, BASE + first, 840.0 * alone**2),
            "both": fitted(experiment, BASE + first + second, 840.0 * 3.0**2),
        }
    )
    assert found.best.causes == {first.name, second.name}
    assert found.of_cause(first.name) == pytest.approx(times / (1.0 + times), abs=2e-3)


@pytest.mark.parametrize(("left", "sure"), [(30.0, CERTAIN), (17.0, CERTAIN), (14.0, 1.0), (1.04, 1.0)])
def test_a_law_that_leaves_much_of_what_it_explains_is_not_certain(
    experiment: Experiment, left: float, sure: float
) -> None:
    """Of 100 noise floors, drag leaves ``left``: with another law in its place, nothing would be left."""
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
            "drag": fitted(experiment, BASE + QuadraticDrag(1.0), 840.0 * left**2),
        }
    )
    assert found.best.causes == {"quadratic_drag"}
    assert found.of_cause("quadratic_drag") == pytest.approx(sure, abs=0.03)
    (said,) = doubts.sentences(found) or ("",)
    assert ("% of what quadratic drag explains: the rig follows another law" in said) is (sure < 1)
    assert said.startswith("What is left is 31 % of") is (left == 30.0)


@pytest.mark.parametrize(("left", "odds"), [(30.0, 9.0), (40.0, 9.0), (60.0, 3.16), (75.0, 3.0)])
def test_of_a_law_that_leaves_much_even_friction_is_only_as_sure_as_it_stands_out_of_that(
    experiment: Experiment, left: float, odds: float
) -> None:
    """It acts on nearly every rig, but no cause is certain there, and it is less sure where the rest, which may move
    like it, is more than it explains.
    """
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * left**2),
        }
    )
    assert found.of_cause("coulomb_friction") == pytest.approx(odds / (1.0 + odds), abs=0.03)


@pytest.mark.parametrize(("clear", "odds"), [(4.0, 4.0), (1.5, 3.0), (0.9, 1.0), (0.1, 1.0)])
def test_a_cause_that_explains_less_than_is_left_is_no_likelier_than_not(
    experiment: Experiment, clear: float, odds: float
) -> None:
    """Of ten such causes on rigs of other laws four acted; they were stated with 0.67 on average."""
    drag = frozenset({"quadratic_drag"})
    sets = {
        "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
        "drag": fitted(experiment, BASE + QuadraticDrag(1.0), 840.0 * 20.0**2),
    }
    found = ranked(sets).with_caveats(drag, clear={"quadratic_drag": clear}, leaves=0.0)
    assert found.best.causes == drag and found.of_set(drag) > 0.99
    assert found.of_cause("quadratic_drag") == pytest.approx(odds / (1.0 + odds), abs=0.01)


@pytest.mark.parametrize(("left", "odds"), [(1.02, 720.0), (10.0, 7.15), (14.0, 3.0)])
def test_a_cause_is_no_surer_than_it_stands_out_of_what_the_set_leaves(
    experiment: Experiment, left: float, odds: float
) -> None:
    """Friction leaves 28 of 100 noise floors, drag beside it ``left``, which may move like the drag."""
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * 28.5**2),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 840.0 * left**2),
        }
    )
    assert found.best.causes == {"coulomb_friction", "quadratic_drag"}
    assert found.of_cause("quadratic_drag") == pytest.approx(odds / (1.0 + odds), abs=0.01)
    said = any("of what is left without quadratic drag" in one for one in doubts.sentences(found))
    assert said is (odds < CERTAIN_ODDS)


def test_another_set_can_lead_with_its_own_evidence(experiment: Experiment) -> None:
    """Where few independent samples let the base lead a tie, and the likelier set predicts better beyond doubt."""
    found = ranked(
        {
            "base": fitted(experiment, BASE, 1000.0),
            "coulomb": fitted(experiment, BASE + CoulombFriction(0.1), 980.0),
            "drag": fitted(experiment, BASE + QuadraticDrag(1.0), 999.0),
        }
    )
    assert not found.best.causes
    friction = next(one for one in found.sets if one.causes == {"coulomb_friction"})
    led = found.led_by(friction)
    assert led.best is friction
    assert odds(led) == odds(found)


def test_a_law_that_the_data_does_not_tell_from_the_leading_one_takes_its_place(experiment: Experiment) -> None:
    """With the limits of its certainty; both share the probability, and the old one stays a rival."""
    rubs, slope = CoulombFriction(0.1), ForceGainNonlinearity(0.01, math.inf)
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 400.0**2),
            "rubs": fitted(experiment, BASE + rubs, 840.0 * 28.5**2),
            "both": fitted(experiment, BASE + rubs + slope, 840.0 * 10.0**2),
        }
    )
    old = found.best
    found = found.with_caveats(old.causes, further={slope.name: 0.1}, clear={slope.name: 2.0})
    law = fitted(experiment, BASE + rubs + ForceDeadZone(0.1), 840.0 * 10.0**2)
    for before in (found, replace(found, sets=(*found.sets, law), evidence=(*found.evidence, -9.0),
                                  probability=(*(0.9 * p for p in found.probability), 0.1))):  # fmt: skip
        after = before.with_law(law)
        assert after.best is law and after.sets[1] is old and sum(after.probability) == pytest.approx(1.0)
        assert [one.causes for one in after.sets].count(law.causes) == 1
        assert after.of_cause("force_dead_zone") == pytest.approx(after.of_cause(slope.name))
        assert after.of_cause("force_dead_zone") <= 0.75 + 1e-9, "as sure as the law before it, no more"
        assert after.leader_caveats.further == {"force_dead_zone": 0.1}
    worse = found.with_caveats(law.causes, leaves=0.16).with_caveats(old.causes, exact=True).with_law(law)
    assert worse.leader_caveats.leaves == 0.16 and not worse.leader_caveats.exact, "what was known of its set holds on"
    same = fitted(experiment, BASE + rubs + ForceGainNonlinearity(0.0, 5.0), 840.0 * 10.0**2)
    limited = found.with_law(same)
    assert limited.best is same and len(limited.sets) == len(found.sets)


def test_a_motion_of_which_the_record_holds_less_than_a_period_is_not_certain(experiment: Experiment) -> None:
    """A reading that settles looks like a slow disturbance, or like a second mass on a weak spring."""
    duration = max(record.duration for record in experiment.records)
    for period, sure in ((2.0 * duration, CERTAIN), (0.5 * duration, 1.0)):
        omega = 2.0 * math.pi / period
        for effect in (PeriodicDisturbance(0.1, omega, 0.0), SecondMode(0.1, 0.1 * omega**2, 0.0)):
            assert effect.longest_period() == pytest.approx(period)
            found = ranked(
                {
                    "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
                    "slow": fitted(experiment, BASE + effect, 840.0),
                }
            )
            assert found.best.causes == {effect.name}
            assert found.of_cause(effect.name) == pytest.approx(sure, abs=0.01)
            said = any("shorter than a period of" in one for one in doubts.sentences(found))
            assert said is (sure < 1.0)
    assert QuadraticDrag(1.0).longest_period() == 0.0
    tones = TwoToneDisturbance(1.0, 2.0 * math.pi, 0.0, 1.0, 0.1 * math.pi, 0.0)
    assert tones.longest_period() == pytest.approx(20.0)
    assert replace(tones, second_tone_amplitude=0.0).longest_period() == pytest.approx(1.0)
    bands = ModulatedDisturbance(1.0, 6.0, 0.0, 5.0, 0.5, 0.0, 0.0, 0.0)
    assert bands.longest_period() == pytest.approx(2.0 * math.pi)


def test_sets_that_hold_a_cause_are_together_no_likelier_than_the_cause() -> None:
    """Two springs had 50 % each, beside further explanations with both of them of 50 and 4 %."""
    both = ("cubic_spring", "relaxing_spring")
    found = likelihoods.ranking({both: 0.5, (*both, "coulomb_friction"): 0.4, ("coulomb_friction",): 0.1}, both)
    for limited in (found, replace(found, unchecked=True), replace(found, foretold=True)):
        for name in ("cubic_spring", "relaxing_spring", "coulomb_friction"):
            held = sum(limited.stated(one.causes) for one in limited.sets if name in one.causes)
            assert held <= limited.of_cause(name) + 1e-12, name
    exact = replace(found, caveats={one.causes: Caveats(one.causes, exact=True) for one in found.sets}, rich=True)
    assert exact.stated(frozenset(both)) == pytest.approx(0.5), "where nothing lowers a cause"


def test_what_is_not_certain_in_the_leading_set_is_made_certain_by_no_other(experiment: Experiment) -> None:
    """An offset beside a bent spring was certain with 0.9000005: limits of 9 to 1, and a millionth of another set."""
    duration = max(record.duration for record in experiment.records)
    slow = PeriodicDisturbance(0.1, math.pi / duration, 0.0)
    fast = PeriodicDisturbance(0.1, 40.0 * math.pi / duration, 0.0)
    leader = fitted(experiment, BASE + slow, 840.0)
    other = fitted(experiment, BASE + fast + CubicSpring(1e5), 839.0)
    found = ranked({"nothing": fitted(experiment, BASE, 840.0 * 100.0**2), "slow": leader})
    both = replace(
        found, sets=(leader, other), evidence=(0.0, 0.0), probability=(0.5, 0.5),
        caveats={one.causes: replace(found.caveats_of(one.causes), exact=True) for one in (leader, other)},
    )  # fmt: skip
    assert both.of_cause_by_sets(slow.name) > 0.94 and both.of_cause(slow.name) == pytest.approx(CERTAIN)
    assert not certain(both.of_cause(slow.name))


@pytest.mark.parametrize(("periods", "floors", "sure"), [(2.7, 10.0, False), (2.7, 1.0, True), (12.0, 10.0, True)])
def test_a_tone_of_few_periods_is_not_certain_where_more_than_noise_is_left(
    experiment: Experiment, periods: float, floors: float, sure: bool
) -> None:
    """Of a push of half a second, a tone of 2.7 periods was named with 0.97: nothing on that rig turns."""
    duration = max(record.duration for record in experiment.records)
    tone = PeriodicDisturbance(0.1, 2.0 * math.pi * periods / duration, 0.0)
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 1000.0**2),
            "tone": fitted(experiment, BASE + tone, 840.0 * floors**2),
        }
    )
    assert found.best.causes == {tone.name} and certain(found.of_cause(tone.name)) is sure
    said = any("fewer than 10 periods of periodic disturbance" in one for one in doubts.sentences(found))
    assert said is not sure


def test_beside_a_drift_what_is_slower_than_the_record_is_even_with_another_drift(experiment: Experiment) -> None:
    """A sensor that settles and drifts was named as a drift beside a disturbance of two record lengths, with 0.90."""
    duration, drift = max(record.duration for record in experiment.records), SensorDrift(1e-4)
    for period, sure in ((2.0 * duration, 0.5), (0.2 * duration, 1.0)):
        for effect in (PeriodicDisturbance(0.1, 2.0 * math.pi / period, 0.0), SecondMode(0.1, 3.95 / period**2, 0.0)):
            found = ranked(
                {
                    "nothing": fitted(experiment, BASE, 840.0 * 1e3**2),
                    "drift": fitted(experiment, BASE + drift, 840.0 * 500.0**2),
                    "both": fitted(experiment, BASE + drift + effect, 840.0),
                }
            )
            assert found.best.causes == {"sensor_drift", effect.name}
            assert found.of_cause(effect.name) == pytest.approx(sure, abs=0.01)
            assert found.of_cause("sensor_drift") == pytest.approx(1.0, abs=0.01)


def test_beside_a_drift_a_law_along_the_travel_keeps_its_odds_and_so_does_a_slow_one_beside_a_fast_tone(
    experiment: Experiment,
) -> None:
    """Only two slow curves over time come near any third one."""
    duration = max(record.duration for record in experiment.records)
    wheel = SensorEccentricity(1e-4, float(np.ptp(experiment.records[0].position)) / 1.5, 0.3)
    slow = SecondMode(0.1, 0.1 * (math.pi / duration) ** 2, 0.0)
    for one, beside in ((wheel, SensorDrift(1e-4)), (slow, PeriodicDisturbance(0.1, 60.0, 0.0))):
        found = ranked(
            {
                "nothing": fitted(experiment, BASE, 840.0 * 1e3**2),
                "other": fitted(experiment, BASE + beside, 840.0 * 500.0**2),
                "both": fitted(experiment, BASE + beside + one, 840.0),
            }
        )
        assert one.name in found.leader_caveats.slow
        assert found.of_cause(one.name) == pytest.approx(CERTAIN, abs=0.01)


@pytest.mark.parametrize("turns", [1.9, 2.1])
def test_what_is_not_seen_to_repeat_along_the_travel_is_not_certain(experiment: Experiment, turns: float) -> None:
    """A sensor bent like tanh³ was "explained" as an eccentric wheel that turned 1.64 times, with 1.000."""
    pitch = float(np.ptp(experiment.records[0].position)) / turns
    wheels = (
        SensorEccentricity(1e-4, pitch, 0.3),
        EccentricityHarmonic(1e-4, pitch, 0.3, 1e-5, 0.0),
        EccentricityHarmonic(1e-6, 2.0 * pitch, 0.3, 1e-4, 0.0),  # an oval wheel: its error repeats twice a turn
    )
    for effect in (*wheels, Cogging(0.1, pitch, 0.0), CoggingHarmonic(0.1, pitch, 0.0, 0.01, 0.0)):
        assert effect.repeats_after() == pytest.approx(pitch, rel=0.01)
        found = ranked(
            {
                "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
                "turns": fitted(experiment, BASE + effect, 840.0),
            }
        )
        assert found.of_cause(effect.name) == pytest.approx(1.0 if turns > 2.0 else CERTAIN, abs=0.01)
        said = any("does not show that it repeats" in one for one in doubts.sentences(found))
        assert said is (turns < 2.0)
    assert QuadraticDrag(1.0).repeats_after() == PeriodicDisturbance(0.1, 5.0, 0.0).repeats_after() == 0.0


@pytest.mark.parametrize(
    ("effect", "sure"),
    [
        (StribeckFriction(0.02, 0.4, 1e-4), False),
        (StribeckFriction(0.04, 0.4, 1e-4), False),
        (StribeckFriction(0.05, 0.4, 1e-4), True),
        (StribeckFriction(0.04, 0.4, 0.1), True),
        (CoulombFriction(0.4), True),
        (Hysteresis(0.4, 1e-3), True),
        (PositionDependentFriction(0.4, 1.0), True),
    ],
)
def test_friction_of_which_hardly_anything_is_seen_in_motion_is_not_certain(
    experiment: Experiment, effect: Effect, sure: bool
) -> None:
    """A drive with a dead zone of two sides was given such friction, with 1.000: it held the cart before the start."""
    found = ranked(
        {"nothing": fitted(experiment, BASE, 840.0 * 100.0**2), "held": fitted(experiment, BASE + effect, 840.0)}
    )
    assert found.best.causes == {effect.name}
    assert found.of_cause(effect.name) == pytest.approx(1.0 if sure else CERTAIN, abs=0.01)
    assert any("holds the cart where it rests" in one for one in doubts.sentences(found)) is not sure


def test_a_small_further_spring_is_not_certain_even_where_only_noise_is_left(experiment: Experiment) -> None:
    """A saturating spring was stated as three springs of the library, the small ones with 0.93 and 0.97."""
    one, two = CubicSpring(1e5), AsymmetricSpring(1e3)
    for further, sure in ((two, CERTAIN), (QuadraticDrag(1.0), 1.0)):
        found = ranked(
            {
                "nothing": fitted(experiment, BASE, 840.0 * 4000.0**2),
                "one": fitted(experiment, BASE + one, 840.0 * 28.5**2),
                "both": fitted(experiment, BASE + one + further, 840.0),
            }
        )
        found = replace(found, rich=True)
        assert found.best.causes == {one.name, further.name}
        assert found.leader_caveats.further
        assert found.of_cause(further.name) == pytest.approx(sure, abs=0.01)


def test_where_the_rig_follows_another_law_sets_that_leave_hardly_less_make_no_cause_certain(
    experiment: Experiment,
) -> None:
    """The output says that no named cause is certain: the sum over sets must not say more."""
    rub = fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * 20.0**2)
    more = fitted(experiment, BASE + CoulombFriction(0.1) + SensorEccentricity(1e-4, 0.01), 840.0 * 19.0**2)
    plain = Ranking((rub, more), (0.0, -1.5), (0.8, 0.2))
    told = plain.with_caveats(rub.causes, leaves=0.3)
    assert plain.of_cause("coulomb_friction") == pytest.approx(1.0)
    assert told.of_cause("coulomb_friction") <= CERTAIN + 1e-12
    assert any("so no named cause is certain" in said for said in doubts.sentences(told))


def test_of_two_laws_that_give_the_same_motion_each_is_as_likely_as_the_other(experiment: Experiment) -> None:
    """Whether both were ranked or one of them: with the sum of what they have, no third cause comes before them."""
    play, ripple = frozenset({"backlash"}), frozenset({"cogging"})
    sets = {
        "nothing": fitted(experiment, BASE, 1e6),
        "play": fitted(experiment, BASE + Backlash(1e-3), 840.0),
        "ripple": fitted(experiment, BASE + Cogging(0.1, 0.01, 0.0), 840.0),
    }
    twin = {"backlash": "cogging"}
    both = ranked(sets).with_caveats(play, alike=twin).with_caveats(ripple, alike={"cogging": "backlash"})
    assert both.of_set(play) + both.of_set(ripple) == pytest.approx(1.0)
    assert both.of_cause("backlash") == pytest.approx(0.5) == both.of_cause("cogging")
    one = ranked({name: sets[name] for name in ("nothing", "play")}).with_caveats(play, alike=twin)
    assert one.of_cause("backlash") == pytest.approx(0.5) == one.of_cause("cogging")
    assert ties.tied(one, "backlash") == ("cogging",)


def test_that_one_of_more_causes_acts_is_no_less_likely(experiment: Experiment) -> None:
    """A set counts by its law of one of them, or by a law that gives the same motion, whichever is surer."""
    drag, peak = FadingDamping(3.0, 0.2, 1.3), StribeckFriction(0.3, 0.4, 0.01)
    both = frozenset({"fading_damping", "stribeck_friction"})
    sets = {
        "nothing": fitted(experiment, BASE, 1e6),
        "drag": fitted(experiment, BASE + drag, 4e5),
        "peak": fitted(experiment, BASE + peak, 900.0),
        "both": fitted(experiment, BASE + drag + peak, 840.0),
    }
    told = ranked(sets).with_caveats(both, alike={"fading_damping": "coulomb_friction"})
    assert {"stribeck_friction", "fading_damping"} & set(told.caveats_of(both).further)
    names = ("coulomb_friction", "stribeck_friction", "quadratic_drag", "cogging")
    groups = [group for size in range(1, 5) for group in combinations(names, size)]
    for fewer in groups:
        for more in groups:
            if set(fewer) <= set(more):
                assert told.of_any(fewer) <= told.of_any(more) + 1e-12


@pytest.mark.parametrize(("rubs", "sure"), [(CoulombFriction(0.3), True), (SmoothFrictionTurn(0.3, 0.01, 2.0), False)])
def test_drag_beside_a_friction_of_a_free_form_is_not_certain(rubs: Effect, sure: bool, experiment: Experiment) -> None:
    """Two curves over the speed come near a third: a Stribeck curve that creeps was drag with 0.94 beside friction."""
    sets = {
        "nothing": fitted(experiment, BASE, 1e6),
        "rubs": fitted(experiment, BASE + rubs, 2e3),
        "drag": fitted(experiment, BASE + QuadraticDrag(1.0), 9e5),
        "both": fitted(experiment, BASE + rubs + QuadraticDrag(1.0), 840.0),
    }
    told = replace(ranked(sets), rich=True)
    assert told.best.causes == {rubs.name, "quadratic_drag"} and told.leader_caveats.exact
    assert "quadratic_drag" in told.leader_caveats.further
    assert certain(told.of_cause("quadratic_drag")) is sure


def test_of_two_laws_that_give_the_same_motion_the_rarer_has_the_odds_of_its_prior(experiment: Experiment) -> None:
    """The likelier one is no more than even: no record tells them apart."""
    valve = frozenset({"force_dead_zone"})
    sets = {"nothing": fitted(experiment, BASE, 1e6), "valve": fitted(experiment, BASE + ForceDeadZone(0.1), 840.0)}
    told = ranked(sets).with_caveats(valve, alike={"force_dead_zone": "coulomb_friction"})
    rarer = ForceDeadZone.prior_odds / CoulombFriction.prior_odds
    assert rarer < 0.1
    assert told.of_cause("force_dead_zone") == pytest.approx(rarer / (1.0 + rarer))
    assert told.of_cause("coulomb_friction") == pytest.approx(0.5)
    assert told.of_any(("force_dead_zone", "coulomb_friction")) > 0.999, "that one of them acts is not in doubt"
    assert told.of_any(("force_dead_zone", "quadratic_drag")) == pytest.approx(rarer / (1.0 + rarer))


def test_one_of_two_that_share_the_probability_acts_surely(experiment: Experiment) -> None:
    """Each alone is a coin's toss; a cause beside both changes nothing, a set without either takes its part."""
    drag = QuadraticDrag(1.0)
    sets = {
        "nothing": fitted(experiment, BASE, 1e6),
        "friction": fitted(experiment, BASE + CoulombFriction(0.1) + drag, 840.0),
        "play": fitted(experiment, BASE + Backlash(0.1) + drag, 840.0),
    }
    found = replace(ranked(sets), rich=True, probability=(0.55, 0.44, 0.01))
    each = [found.of_cause(name) for name in ("coulomb_friction", "backlash")]
    assert found.of_any(("coulomb_friction", "backlash")) == pytest.approx(sum(each)) == pytest.approx(0.99)
    assert found.of_any(("coulomb_friction",)) == each[0]
    assert found.of_any(("coulomb_friction", "cogging")) == each[0]
    assert replace(found, unchecked=True).of_any(("coulomb_friction", "backlash")) <= found.limit("backlash")
    doubted = replace(found, foretold=True).with_caveats(found.best.causes, exact=False)
    assert doubted.of_any(("coulomb_friction", "backlash")) == pytest.approx(0.5)


def test_limits_of_nine_to_one_that_add_up_are_no_certainty() -> None:
    parts = (0.22876222127045265, 0.7165084742834696, 0.05472930444607771)
    assert sum(part * CERTAIN for part in parts) > CERTAIN
    assert not certain(sum(part * CERTAIN for part in parts)) and certain(0.901)


def test_the_probability_of_other_laws_counts_the_sets_that_hold_the_cause_without_this_law(
    experiment: Experiment,
) -> None:
    """Hysteresis in two laws, one of them beside drag too."""
    loop, smooth = Hysteresis(300.0, 1.0), BoucWen(300.0, 200.0, 100.0)
    models = {"loop": BASE + loop, "smooth": BASE + smooth, "both": BASE + loop + QuadraticDrag(1.0), "base": BASE}
    chis = (900.0, 845.0, 842.0, 84000.0)
    pairs = zip(models.items(), chis, strict=True)
    ranking = ranked({name: fitted(experiment, model, chi) for (name, model), chi in pairs})
    share = {one.causes: p for one, p in zip(ranking.sets, ranking.probability, strict=True)}
    of_loop = share[frozenset({"hysteresis"})] + share[frozenset({"hysteresis", "quadratic_drag"})]
    assert ranking.of_other_laws("bouc_wen") == pytest.approx(of_loop) and of_loop > 0.9
    assert ranking.of_other_laws("hysteresis") == pytest.approx(share[frozenset({"bouc_wen"})])
    assert ranking.of_other_laws("quadratic_drag") == 0.0
