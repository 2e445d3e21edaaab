"""The scope: the model beside a rig that shares no code with it, resets, gaps, clocks, bounded memory."""

from __future__ import annotations

import numpy as np
import pytest

import msd_sim.api
from msd_ident.errors import UsageError
from msd_ident.live import Beside, Scope, model_of
from msd_ident.live.scope import Frame
from msd_ident.model import Model

START = 1_700_000_000_000_000_000
ECP = {"mass": 0.9407, "damping": 3.927, "stiffness": 694.1, "coulomb_force": 0.0133 * 0.9407 * 9.81}
NOISE = 1e-5


class Rig:
    """A recorded experiment that is played into a scope in handfuls, as a graph does."""

    def __init__(self, scope: Scope, **given: object) -> None:
        made = msd_sim.api.simulate({"rig": "ecp", "experiment": "steps", "rate": 1000.0, "seed": 3, **given})
        self.scope = scope
        self.ns = START + np.rint(made.time * 1e9).astype(np.int64)
        self.position = np.asarray(made.position)
        self.force_ns = START + np.rint(made.force_time * 1e9).astype(np.int64)
        self.force = np.asarray(made.force)

    def play(self, begin: float, end: float, handful: float = 0.04) -> None:
        for at in np.arange(begin, end, handful):
            low, high = START + round(at * 1e9), START + round(min(at + handful, end) * 1e9)
            force, position = (self.force_ns >= low) & (self.force_ns < high), (self.ns >= low) & (self.ns < high)
            self.scope.add_forces(self.force_ns[force], self.force[force])
            self.scope.add_positions(self.ns[position], self.position[position])
            self.scope.advance()


def truth(**changes: float) -> Beside:
    return Beside(model_of({**ECP, **changes}), "the truth", noise=NOISE)


@pytest.fixture(scope="module")
def played() -> Frame:
    """The frame after twelve seconds beside the true model, which came after three."""
    scope = Scope()
    rig = Rig(scope)
    rig.play(0.0, 3.0)
    scope.run_beside(truth())
    rig.play(3.0, 12.0)
    return scope.frame(10.0, 800)


def test_the_true_model_stays_within_the_encoder_over_many_handfuls(played: Frame) -> None:
    assert played.residual_rms < 2.0 * NOISE
    assert np.ptp(played.position[1]) > 0.02
    assert np.abs(played.residual[1]).max() < 10.0 * NOISE
    assert played.noise == NOISE
    assert played.rate == pytest.approx(1000.0)
    assert played.end == pytest.approx(12.0, abs=0.01)
    assert played.start == pytest.approx(played.end - 10.0)


def test_the_model_goes_over_what_came_before_it(played: Frame) -> None:
    time, values = played.model
    assert time[0] < 2.05
    assert np.all(np.isfinite(values))


def test_a_wrong_model_is_seen() -> None:
    scope = Scope()
    rig = Rig(scope)
    scope.run_beside(truth(stiffness=750.0))
    rig.play(0.0, 6.0)
    assert scope.frame(5.0, 800).residual_rms > 50.0 * NOISE


def test_a_force_turned_round_moves_the_model_the_right_way() -> None:
    scope = Scope()
    rig = Rig(scope)
    rig.position = -rig.position
    scope.run_beside(Beside(model_of(ECP), "turned", NOISE, turned=True))
    rig.play(0.0, 4.0)
    assert scope.frame(4.0, 800).residual_rms < 2.0 * NOISE


def test_after_a_reset_the_model_begins_anew() -> None:
    scope = Scope()
    rig = Rig(scope)
    scope.run_beside(truth())
    moving = (int(rig.force_ns[np.flatnonzero(rig.force)[0]]) - START) / 1e9 + 0.1
    rig.play(0.0, moving)
    assert np.ptp(scope.frame(0.2, 800).position[1]) > 1e-3, "reset in the midst of the motion"
    scope.restart()
    rig.ns += round(moving * 1e9)  # from rest again
    rig.force_ns += round(moving * 1e9)
    rig.play(moving, moving + 3.0)
    assert scope.frame(2.9, 800).residual_rms < 3.0 * NOISE


def test_a_pause_of_the_encoder_begins_anew_too() -> None:
    scope = Scope()
    rig = Rig(scope)
    scope.run_beside(truth())
    rig.play(0.0, 2.0)
    scope.add_forces(rig.force_ns[(rig.force_ns < START + 6e9)], rig.force[(rig.force_ns < START + 6e9)])
    rig.play(6.0, 8.0)
    assert scope.frame(1.5, 800).residual_rms < 3.0 * NOISE
    assert not scope.problem


def test_a_clock_that_was_set_back_begins_anew() -> None:
    scope = Scope()
    rig = Rig(scope)
    scope.run_beside(truth())
    rig.play(0.0, 2.0)
    scope.clear()
    assert scope.frame(5.0, 100).rate != scope.frame(5.0, 100).rate
    rig.play(0.0, 3.0)
    assert scope.frame(2.5, 800).residual_rms < 2.0 * NOISE


def test_late_and_doubled_samples_are_left_out() -> None:
    scope = Scope()
    ns = START + np.array([0, 10, 10, 5, 20, 20], dtype=np.int64) * 1_000_000
    scope.add_positions(ns, np.arange(6.0))
    scope.add_positions(ns[:3], np.arange(3.0))
    time, values = scope.frame(10.0, 100).position
    assert np.allclose(time, [0.0, 0.01, 0.02])
    assert values.tolist() == [0.0, 1.0, 4.0]


def test_memory_does_not_grow_with_time() -> None:
    scope = Scope(capacity=2000)
    before = scope.bytes
    scope.run_beside(truth())
    for second in range(200):
        ns = START + second * 10**9 + np.arange(1000, dtype=np.int64) * 10**6
        scope.add_forces(ns[:1], np.ones(1))
        scope.add_positions(ns, np.zeros(1000))
        scope.advance()
    assert scope.bytes == before
    frame = scope.frame(60.0, 800)
    assert frame.position[0][0] > 197.9
    assert frame.end == pytest.approx(199.999)


def test_no_model_no_residual() -> None:
    scope = Scope()
    rig = Rig(scope)
    scope.run_beside(truth())
    rig.play(0.0, 1.0)
    scope.run_beside(None)
    rig.play(1.0, 1.2)
    frame = scope.frame(1.0, 100)
    assert not np.isfinite(frame.residual[1]).any()
    assert not np.isfinite([frame.residual_rms, frame.model_now, frame.noise]).any()


def test_what_cannot_be_simulated_is_said_and_the_curves_go_on() -> None:
    scope = Scope()
    scope.run_beside(truth())
    ns = START + np.arange(100, dtype=np.int64) * 10**6
    scope.add_positions(ns, np.full(100, np.nan))
    scope.advance()
    assert "not finite" in scope.problem
    assert scope.frame(1.0, 100).position[0].size == 100


def test_models_are_found_by_their_parameters() -> None:
    assert model_of(ECP).effect_names == ("coulomb_friction",)
    assert model_of({**ECP, "friction_coefficient": 0.01}).effect_names == ("coulomb_friction",)
    assert model_of({"mass": 1.0, "damping": 2.0}) == Model(1.0, 2.0, 0.0)
    assert model_of({**ECP, "drag_coefficient": 4.0}).has("quadratic_drag")


def test_models_that_cannot_run_are_refused_in_words() -> None:
    with pytest.raises(UsageError, match="no mass among stiffness; expected"):
        model_of({"stiffness": 1.0})
    with pytest.raises(UsageError, match="stiffness_drift depends on the time since its record began"):
        model_of({**ECP, "stiffness_drift_rate": 0.1})
