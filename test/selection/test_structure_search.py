"""The search for the set of causes: what is simpler gets a second look from where the leader stands."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from setrigs import BASE, fitted, pushed, rubbing, steps, stood

from msd_ident.data.record import Record, from_samples
from msd_ident.diagnosis import Task, diagnose_records
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Plant
from msd_ident.model import simulate as trajectory_of
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.bilinear_spring import BilinearSpring
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.drive_damping import DriveDamping
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.friction_drift import FrictionDrift
from msd_ident.model.effects.friction_ripple import FrictionRipple
from msd_ident.model.effects.position_dependent_friction import PositionDependentFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.settling_friction import SettlingFriction
from msd_ident.model.effects.stiffness_drift import StiffnessDrift
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.time_offset import TimeOffset
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection import structure_search
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.ranking import Ranking
from msd_ident.selection.structure_search import Search
from msd_sim.api import simulate


def test_what_is_simpler_is_begun_where_the_leader_stands() -> None:
    experiment = rubbing()
    base = stood(experiment, BASE)
    wrong = stood(experiment, BASE + CoulombFriction(0.15))
    richer = BASE + PositionDependentFriction(0.29, 0.0)
    best = refine(experiment, frozenset(richer.effect_names), richer, base.initial)
    search = Search(experiment, lambda fitted: True, lambda stage, part, cause: None)
    assert best.chi < 0.1 * wrong.chi
    found = search.compared([base, wrong, best])
    assert found.best.causes == {"coulomb_friction"}
    assert np.isclose(found.best.model["coulomb_force"], 0.03 * 9.81, rtol=0.01)


def test_the_leading_set_is_judged_beside_all_sets_that_lack_one_of_its_causes() -> None:
    """A stop of another kind (MuJoCo's) had a second mode with > 0.999: the stop alone was fitted to a part only."""
    laws = (CoulombFriction(1.0), TimeOffset(0.01))
    experiment = pushed(*laws)
    base, pair = stood(experiment, BASE), refine(
        experiment, frozenset({"coulomb_friction", "time_offset"}), BASE + laws[0] + laws[1],
        stood(experiment, BASE).initial,
    )  # fmt: skip
    search = Search(experiment, lambda fitted: False, lambda stage, part, cause: None)
    search._know([base, pair])
    assert search.ranking().leader_caveats.clear["time_offset"] > 1e3, "beside the base model alone"
    starts = {one: (one, BASE + law, base.initial) for law in laws if (one := frozenset({law.name}))}
    found = search.beside_its_parts({**starts, pair.causes: (pair.causes, pair.model, pair.initial)})
    assert found.best.causes == pair.causes and set(starts) <= set(search.sets)
    assert search.beside_its_parts({}).best.causes == pair.causes, "nothing is known of others"


def test_a_play_that_stops_imitate_is_begun_where_the_stops_stand() -> None:
    """Far from its valley the play does not find it; stops beside a weaker spring have the same force beyond them."""
    made = simulate(
        {
            "mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0, "experiment": "steps",
            "encoder.counts_per_metre": 0.0, "encoder.noise": 1e-5,
            "effects": {"backlash": {"backlash_half_width": 1e-3}},
        }
    )  # fmt: skip
    record = Record(made.time, made.position, made.force_time, made.force)
    experiment = Experiment(prepare([record]), BASE, frozenset())
    base = stood(experiment, BASE)
    stops = refine(experiment, frozenset({"end_stop"}), Plant(1.0, 2.0, 0.0) + EndStop(1.2e-3, 380.0), base.initial)
    search = Search(experiment, lambda fitted: True, lambda stage, part, cause: None)
    found = search.compared([base, stops])
    assert found.best.causes == {"backlash"}
    assert np.isclose(found.best.model["backlash_half_width"], 1e-3, rtol=0.01)


def test_a_motion_that_no_law_carries_is_not_searched_for_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is refused whatever they find: a hand moved the cart, or the force is another quantity."""
    data = steps(100.0)
    for part_left, largest in ((0.4, 2), (0.6, 1)):
        asked: list[frozenset[str]] = []

        def fit_new(
            search: Search, new: Sequence[frozenset[str]], *_: float, asked: list[frozenset[str]] = asked
        ) -> None:
            asked += new

        monkeypatch.setattr(Search, "_fit_new", fit_new)
        search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
        base = fitted(data, BASE, part_left * data.motion)
        search.run(base, [fitted(data, BASE + CoulombFriction(0.1), 0.99 * base.chi)])
        assert max(map(len, asked)) == largest


def test_causes_beside_friction_come_before_single_ones_where_friction_explains_something(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Those that may start beside a single cause too are fitted once more from there, if no pair leaves only noise."""
    data, bent = steps(100.0), BASE + CubicSpring(1e6)
    spring = frozenset(bent.effect_names)
    for friction_left, first, times in ((0.5, 2, 2), (0.95, 1, 1)):
        asked: list[frozenset[str]] = []

        def fit_new(
            search: Search, new: Sequence[frozenset[str]], *_: float, asked: list[frozenset[str]] = asked
        ) -> None:
            asked += new
            if spring in new:
                search.sets[spring] = fitted(data, bent, 0.3 * data.motion)

        monkeypatch.setattr(Search, "_fit_new", fit_new)
        monkeypatch.setattr(Search, "_follow_readings", lambda search: None)  # the sets are not what they say
        monkeypatch.setattr(Search, "_fit_regressed", lambda search: False)
        search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
        base = fitted(data, BASE, 0.4 * data.motion)
        search.run(base, [fitted(data, BASE + CoulombFriction(0.1), friction_left * base.chi)])
        assert len(asked[0]) == first
        assert asked.count(spring | {"coulomb_friction"}) == times
        assert asked.count(frozenset({"quadratic_drag", "coulomb_friction"})) == 1


def test_a_set_that_leaves_far_less_than_the_leading_one_has_its_neighbours_tried_too() -> None:
    data = steps()
    play, bent = BASE + Backlash(1e-3), BASE + CubicSpring(1e6)
    leader, floor = fitted(data, play, 1000.0), fitted(data, play + CoulombFriction(0.1), 10.0)
    for causes, left, fronts in (
        (bent, 400.0, 2), (bent, 600.0, 1), (bent + CoulombFriction(0.1), 200.0, 2),
        (bent + CoulombFriction(0.1), 300.0, 1), (bent + CoulombFriction(0.1) + QuadraticDrag(1.0), 120.0, 2),
    ):  # fmt: skip
        rival = fitted(data, causes, left)
        search = Search(data, lambda fitted: fitted.chi < 100.0, lambda stage, part, cause: None)
        search.sets = {one.causes: one for one in (fitted(data, BASE, 9000.0), leader, rival)}
        assert search._fronts(leader) == [leader, rival][:fronts], "half for each cause more"
        search.sets[floor.causes] = floor
        assert search._fronts(floor) == [floor], "at the floor nothing else is tried"


def test_a_law_that_holds_coulomb_friction_is_begun_from_the_same_set_with_it() -> None:
    """Beside stops alone the law would take up what their damping makes up for, and end without its peak."""
    data = steps()
    stops = BASE + EndStop(1e-3, 1e4)
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 9e3), fitted(data, stops, 5e3))}
    names = ("coulomb_friction", "stribeck_friction", "quadratic_drag")
    rubs, peak, drag = (frozenset({"end_stop", name}) for name in names)
    begun: list[tuple[frozenset[str], bool]] = []

    def fit(new: Sequence[frozenset[str]], start: float, end: float) -> None:
        begun.extend((causes, rubs in search.sets) for causes in new)
        search.sets[rubs] = fitted(data, stops + CoulombFriction(0.1), 100.0)

    search._fit_new = fit  # type: ignore[method-assign]
    assert search._fit([peak, drag, rubs], 0.0, 1.0)
    assert begun == [(drag, False), (rubs, False), (peak, True)]
    assert [one.causes for one in search.neighbours.parents(peak, search.sets)] == [rubs]
    assert not search._fit([peak], 0.0, 1.0)


def test_a_ripple_that_a_regression_shows_is_tried_beside_each_other_cause_and_begun_from_it() -> None:
    """Alone it leaves almost as much as the base model: without the drag the cart stops in other ripples."""
    ripple, drag = Cogging(0.9, 3e-3, 0.4), QuadraticDrag(30.0)
    both = frozenset({"cogging", "quadratic_drag"})
    experiment = pushed(ripple, drag)
    search = Search(experiment, lambda fitted: False, lambda stage, part, cause: None)
    assert search.neighbours.rippled == {"cogging"}
    base = refine(experiment, frozenset(), BASE, experiment.problem(BASE).initial)
    alone = refine(experiment, frozenset({"quadratic_drag"}), BASE + QuadraticDrag(1.0), base.initial)
    search.sets = {one.causes: one for one in (base, alone)}
    assert base in search.neighbours.parents(both, search.sets), "a regression starts next to the base model"
    search._fit([both], 0.0, 1.0)
    assert search.sets[both].chi < 1.2 * experiment.evidence
    assert np.isclose(search.sets[both].model["cogging_pitch"], 3e-3, rtol=1e-3)
    plain = Search(pushed(drag), lambda fitted: False, lambda stage, part, cause: None)
    assert plain.neighbours.rippled == frozenset()


def test_the_cause_that_leaves_least_is_paired_with_all_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Far from the noise another one may lead by its evidence, which counts features of the error."""
    data = steps(100.0)
    bilinear, drift = BASE + BilinearSpring(2e-3, 100.0), BASE + StiffnessDrift(1.0)
    alone = [fitted(data, BASE, 1e6), fitted(data, bilinear, 4e5), fitted(data, drift, 1e5)]
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in alone}
    asked: list[set[frozenset[str]]] = []
    monkeypatch.setattr(search, "_leader", lambda: alone[1])
    monkeypatch.setattr(search, "_fit", lambda wanted, start, end: asked.append(set(wanted)))
    monkeypatch.setattr(search, "_walk", lambda: None)
    search.run(alone[0])
    beside = [frozenset({leads, "backlash"}) for leads in ("bilinear_spring", "stiffness_drift")]
    assert next(batch for batch in asked if not batch.isdisjoint(beside)).issuperset(beside)


def searched(rig: dict[str, object], start: Model, asked: frozenset[str] | None = None) -> Ranking:
    """What a search finds from the base model and from Coulomb friction, with nothing added at the noise."""
    made = simulate({"friction_coefficient": 0.0, **rig})
    record = Record(made.time, made.position, made.force_time, made.force)
    data = Experiment(prepare([record]), BASE, frozenset(), asked=asked)
    base = refine(data, frozenset(), start, (Initial(),))
    rubs = start + CoulombFriction(0.05 * float(np.max(np.abs(made.force))))
    friction = refine(data, frozenset(rubs.effect_names), rubs, (Initial(),))
    search = Search(data, lambda one: one.chi < 1.1 * data.evidence, lambda stage, part, cause: None)
    return search.run(base, [friction])


def test_a_breakaway_friction_that_no_start_finds_is_found_through_observers() -> None:
    """4.4 times the sliding one and gone at 8 mm/s: without observers 37 noise floors are left."""
    rig = {
        "mass": 0.6014459563265683, "damping": 1.1256901509670305, "stiffness": 827.5189415146758, "rate": 1000.0,
        "effects": {"stribeck_friction": {"coulomb_force": 0.34751536041466075, "static_force": 1.5331866511423509,
                                          "stribeck_velocity": 0.0083185063764787}},
        "encoder": {"counts_per_metre": 0.0, "noise": 1.1e-5}, "seed": 3,
        "experiment": {"name": "steps", "force": 7.0, "hold": 0.75},
    }  # fmt: skip
    asked = frozenset({"stribeck_friction", "coulomb_friction", "hysteresis", "quadratic_drag"})
    found = searched(rig, Plant(0.6, 1.1, 830.0), asked).best
    assert found.causes == {"stribeck_friction"}
    assert np.isclose(found.model["static_force"], 1.533, rtol=0.02)


def test_a_linear_law_along_a_weak_direction_of_one_step_is_fitted() -> None:
    """One step hardly shows k2 beside k and the zero: its first step promises twice the noise, a bent spring 1.2."""
    rig = {
        "mass": 1.2997, "damping": 1.1681, "stiffness": 593.48, "rate": 1000.0, "seed": 725304986,
        "effects": {"asymmetric_spring": {"quadratic_stiffness": 1546.6}},
        "encoder": {"counts_per_metre": 47499.65, "noise": 0.0},
        "experiment": {"name": "step", "force": 3.00455, "hold": 3.0},
    }  # fmt: skip
    assert searched(rig, Plant(1.3, 1.2, 600.0)).best.causes == {"asymmetric_spring"}


def test_coulomb_friction_and_drag_are_tried_where_a_falling_friction_imitates_them() -> None:
    """Stribeck's curve with a free exponent leaves 1.02 noise floors; the drag's first step promises nothing."""
    rig = {
        "mass": 0.7437007369111666, "damping": 1.6284775163825376, "stiffness": 748.3410009932336, "rate": 1000.0,
        "effects": {"quadratic_drag": {"drag_coefficient": 3.929738115321307},
                    "coulomb_friction": {"coulomb_force": 0.2360242323706884}},
        "encoder": {"counts_per_metre": 105006.59279245726, "noise": 0.0}, "seed": 1888302521,
        "experiment": {"name": "steps", "force": 5.035164473325261, "hold": 0.75},
    }  # fmt: skip
    assert searched(rig, Plant(0.74, 1.6, 748.0)).best.causes == {"coulomb_friction", "quadratic_drag"}


def test_the_nearest_rival_of_a_law_is_not_passed_over_where_another_form_of_that_law_leads() -> None:
    """A buffered stop leaves a fifth of what play does; play with an offset leaves only noise."""
    rig = {
        "mass": 0.6949179294779242, "damping": 2.562713293231082, "stiffness": 235.3612320127352, "rate": 250.0,
        "effects": {"backlash": {"backlash_half_width": 0.00022810111007160982},
                    "force_offset": {"offset_force": 0.13490918585951842}},
        "encoder": {"counts_per_metre": 102790.5260060497, "noise": 0.0}, "seed": 1816287582,
        "experiment": {"name": "steps", "force": 3.1104998855614325, "hold": 0.75},
    }  # fmt: skip
    asked = frozenset(
        {"backlash", "force_offset", "end_stop", "buffered_stop", "coulomb_friction", "stribeck_friction", "hysteresis"}
    )
    found = searched(rig, Plant(0.69, 2.6, 235.0), asked)
    assert found.best.causes == {"backlash", "force_offset"}
    assert frozenset({"buffered_stop"}) in {one.causes for one in found.sets}


def test_dry_friction_is_divided_between_coulombs_and_a_law_that_holds_it() -> None:
    """From Dahl's law with the force of both, Coulomb friction ends at no force, and 20 noise floors are left."""
    rig = {
        "mass": 0.6725680163602066, "damping": 0.9313651282263923, "stiffness": 388.47924705129594, "rate": 250.0,
        "effects": {"hysteresis": {"hysteresis_force": 0.1066159710875257, "hysteresis_length": 0.002574087557742065},
                    "coulomb_friction": {"coulomb_force": 0.14467611618262965}},
        "encoder": {"counts_per_metre": 50793.474517908166, "noise": 0.0}, "seed": 166800745,
        "experiment": {"name": "steps", "force": 7.217533482837681, "hold": 0.75},
    }  # fmt: skip
    assert searched(rig, Plant(0.67, 0.93, 388.0)).best.causes == {"coulomb_friction", "hysteresis"}


@pytest.mark.long
def test_what_the_likeliest_set_lacks_is_tried_where_a_disturbance_leads_the_walk(
    asking_about: Callable[..., None],
) -> None:
    """A drive that brakes while it is on, dry friction and a delay, in one step and its end: a disturbance that comes
    near leads the walk, and far from the noise it ends soon.
    """
    asking_about(
        *("coulomb_friction", "drive_damping", "time_offset", "actuator_lag", "periodic_disturbance", "hysteresis"),
        *("quadratic_drag", "stribeck_friction", "backlash", "force_offset"),
    )
    time = np.arange(10000) / 887.15
    force = np.where((time >= 5.0) & (time < 10.0), 491.0, 0.0)
    made = Plant(0.58e-3, 0.8e-3, 0.272) + CoulombFriction(8.0) + DriveDamping(1.2e-3) + TimeOffset(0.005)
    motion = trajectory_of(made, from_samples(time, force, np.zeros(time.size))).position
    found = diagnose_records(Task((from_samples(time, force, np.round(motion)),)))
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "drive_damping", "time_offset"}
    assert found.extended.see < 0.5


def test_neighbours_of_the_likeliest_set_that_came_last_are_fitted_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cogging and drag beside Coulomb friction come near a friction that falls with speed beside cogging."""
    data = steps()
    pair = BASE + Cogging(1.0, 0.01, 0.0) + CoulombFriction(0.1)
    sets = [fitted(data, BASE, 9e7), fitted(data, BASE + CoulombFriction(0.1), 9e6), fitted(data, pair, 5e5)]
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in sets}
    asked: list[frozenset[str]] = []

    def fit(wanted: Sequence[frozenset[str]], start: float, end: float) -> bool:
        asked.extend(wanted)
        return False

    monkeypatch.setattr(search, "_fit", fit)
    assert search.ranking().likeliest.causes == {"cogging", "coulomb_friction"}
    search._around_likeliest()
    assert frozenset({"cogging", "stribeck_friction"}) in asked, "another law in place of one"
    assert frozenset({"cogging", "coulomb_friction", "quadratic_drag"}) in asked, "one more"


@pytest.mark.parametrize("noise_only", [True, False])
def test_another_form_of_a_leading_law_is_not_fitted_in_its_place_where_only_noise_is_left(
    noise_only: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It could not count: it has more numbers, and nothing more to explain."""
    data = steps()
    pair = fitted(data, BASE + QuadraticDrag(1.0) + CoulombFriction(0.1), 5e5)
    search = Search(data, lambda one: noise_only, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 9e7), pair)}
    asked: list[frozenset[str]] = []

    def fit(wanted: Sequence[frozenset[str]], start: float, end: float) -> bool:
        asked.extend(wanted)
        return True

    monkeypatch.setattr(search, "_fit", fit)
    search._advance(pair, 0.5)
    for form in ({"quadratic_drag", "rubbing_second_mode"}, {"coulomb_friction", "power_drag"}):
        assert (frozenset(form) in asked) == (not noise_only), form
    for cause in ("stribeck_friction", "hysteresis"):
        assert frozenset({"quadratic_drag", cause}) in asked, "another cause, whatever it holds as a limit"
    assert frozenset({"quadratic_drag"}) in asked


def test_friction_beside_a_simple_law_is_fitted_together_with_the_forms_of_it() -> None:
    """A drive at its limit with dry friction was "explained" by a stop with buffers, with 0.95: its four numbers left
    only noise, so that nothing else was fitted.
    """
    data = steps()
    stop, limit, buffers = EndStop(2e-3, 500.0), ForceGainNonlinearity(0.0, 2.0), BufferedStop(0.0, 2e-3, 500.0, 5.0)
    search = Search(data, lambda fitted: "buffered_stop" in fitted.causes, lambda stage, part, cause: None)
    asked: list[set[frozenset[str]]] = []

    def fit(wanted: Iterable[frozenset[str]], start: float, end: float) -> bool:
        models = {BASE + stop: 3e4, BASE + limit: 4e4} if not asked else {BASE + buffers: 840.0}
        search.sets |= {one.causes: one for model, chi in models.items() if (one := fitted(data, model, chi))}
        asked.append(set(wanted))
        return True

    search._fit = fit  # type: ignore[method-assign]
    search._walk = search.ranking  # type: ignore[method-assign]
    search.run(fitted(data, BASE, 9e6))
    assert len(asked) == 2, "the stop with buffers leaves only noise"
    beside = {frozenset({name, "coulomb_friction"}) for name in ("end_stop", "force_gain_nonlinearity")}
    assert asked[1] >= beside | {frozenset({"buffered_stop"})}


def test_other_forms_of_the_leading_laws_are_fitted_before_a_cause_is_added() -> None:
    """A stop with a damper beside Coulomb friction was explained as a stop with none beside a second mode."""
    data = steps()
    stop, buffers, rubs = EndStop(2e-3, 500.0), BufferedStop(0.0, 2e-3, 500.0, 5.0), CoulombFriction(0.1)
    search = Search(data, lambda fitted: "buffered_stop" in fitted.causes, lambda stage, part, cause: None)
    asked: list[set[frozenset[str]]] = []
    found = [BASE + stop, BASE + stop + rubs, BASE + buffers + rubs]

    def fit(wanted: Iterable[frozenset[str]], start: float, end: float) -> bool:
        one = fitted(data, found[len(asked)], (9e6, 3e4, 840.0)[len(asked)])
        search.sets[one.causes] = one
        asked.append(set(wanted))
        return True

    search._fit = fit  # type: ignore[method-assign]
    search._walk = search.ranking  # type: ignore[method-assign]
    search.run(fitted(data, BASE, 9e7))
    assert len(asked) == 3, "no pair is asked for where the other form leaves only noise"
    assert asked[2] >= {frozenset({name, "coulomb_friction"}) for name in ("buffered_stop", "damped_stop")}


@pytest.mark.parametrize("begun", [False, True])
def test_copies_that_begin_with_known_fits_take_no_round_of_pairs(begun: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four fifths of the time of a measured step went into rounds that its own search had made."""
    data = replace(steps(100.0), begun=begun)
    alone = [fitted(data, BASE, 1e6), fitted(data, BASE + StiffnessDrift(1.0), 1e5)]
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in alone}
    walked, paired = [], []
    monkeypatch.setattr(search, "_fit", lambda wanted, start, end: False)
    monkeypatch.setattr(search, "_follow_readings", lambda: None)
    monkeypatch.setattr(search, "_walk", lambda: walked.append(True))
    monkeypatch.setattr(search, "_fit_regressed", lambda: False)
    monkeypatch.setattr(structure_search, "pairs", lambda *given: paired.append(True) or [])
    search.run(alone[0])
    assert walked == [True] and paired == ([] if begun else [True])


def sets_followed(search: Search, monkeypatch: pytest.MonkeyPatch) -> list[frozenset[str]]:
    """The sets that a search fits through observers."""
    asked: list[frozenset[str]] = []

    def follow(experiment: object, causes: frozenset[str], *rest: object) -> Hypothesis:
        asked.append(causes)
        return search.sets[causes]

    monkeypatch.setattr(structure_search, "followed", follow)
    monkeypatch.setattr(structure_search.starting_points, "starts", lambda *given: [])
    search._follow_readings()
    return asked


@pytest.mark.parametrize("begun", [False, True])
def test_copies_that_begin_with_known_fits_are_not_followed_through_observers(
    begun: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = replace(steps(), begun=begun)
    search = Search(data, lambda found: False, lambda *told: None)
    search._know([fitted(data, BASE, 1e9), fitted(data, BASE + CoulombFriction(0.1), 5e8)])
    asked = sets_followed(search, monkeypatch)
    assert asked == ([] if begun else [frozenset({"coulomb_friction"})])


def test_of_laws_that_leave_as_much_the_likeliest_before_any_data_are_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A breakaway force of 4.8 times the sliding one: in wrong minima ripples and drifts of the friction left less."""
    data = steps()
    search = Search(data, lambda found: False, lambda *told: None)
    laws = (
        CoulombFriction(0.1),
        StribeckFriction(0.1, 0.5, 0.01),
        FrictionRipple(0.1, 0.05, 0.01, 0.0),
        FrictionDrift(0.1, 0.01),
        SettlingFriction(0.1, 0.1, 1.0),
    )
    search._know([fitted(data, BASE, 1e9), *(fitted(data, BASE + law, 5e8 - 1e7 * i) for i, law in enumerate(laws))])
    asked = sets_followed(search, monkeypatch)
    assert frozenset({"stribeck_friction"}) in asked
