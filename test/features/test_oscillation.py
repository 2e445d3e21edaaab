"""What turning points tell of dry friction, and when readings count as rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from steprigs import Rig, record

from msd_ident.data.noise import Noise
from msd_ident.data.record import Record
from msd_ident.features import extract
from msd_ident.features.oscillation import dead_width, significant, swings
from msd_ident.features.rest_and_turns import Extreme, evidence, is_quiet, rest_value


def coulomb_turns(ratio: float, width: float, count: int = 9) -> list[Extreme]:
    """Turning points of a release from 1 m: each half-swing goes around a middle ``width`` off, against the motion."""
    turns, value = [Extreme(0.0, 1.0, 1e-4, 1e-4, 1)], 1.0
    for i in range(1, count):
        side = -turns[-1].side
        middle = -side * width
        value = middle - ratio * (value - middle)
        turns.append(Extreme(0.1 * i, value, 1e-4, 1e-4, side))
    return turns


@settings(max_examples=40, deadline=None)
@given(ratio=st.floats(0.8, 0.97), width=st.floats(0.003, 0.02))
def test_dead_width_is_that_of_coulombs_law(ratio: float, width: float) -> None:
    turns = significant(coulomb_turns(ratio, width))
    if len(turns) < 6:
        return
    assert dead_width(turns) == pytest.approx(width, rel=1e-6)


def test_turning_points_end_where_noise_changed_their_order() -> None:
    """So no half-swing takes no time."""
    turns = [Extreme(t, x, 1e-4, 1e-4, s) for t, x, s in ((0.021, 1.0, 1), (0.0155, 0.2, -1), (0.021, 0.9, 1))]
    assert significant(turns) == turns[:1] and swings(turns) == ()
    assert len(significant([replace(turn, time=0.01 * i) for i, turn in enumerate(turns)])) == 3


def test_linear_rig_has_no_dead_width_and_the_demo_rig_has_its_own() -> None:
    pytest.importorskip("msd_sim")
    from msd_sim.api import simulate

    linear = record(Rig(27.0, 0.08, 1.44e-3), np.arange(0.0, 7.0, 1e-3), [(0.5, 10.0), (3.5, 0.0)], noise=2e-6)
    assert [dead_width(response.turns) for response in extract(linear).responses] == [0.0, 0.0]
    data = simulate({"rig": "ecp", "experiment": "paper", "seed": 1})
    demo = Record(time=data.time, position=data.position, force_time=data.force_time, force=data.force)
    friction = 0.0133 * 0.9407 * 9.81
    for response in extract(demo).responses:
        assert dead_width(response.turns) == pytest.approx(friction / 694.1, rel=0.05)


def test_two_peaks_of_a_rubbing_rig_are_nearer_to_its_viscous_damping_than_all_peaks() -> None:
    pytest.importorskip("msd_sim")
    from msd_sim.api import simulate

    data = simulate({"rig": "ecp", "experiment": "paper", "seed": 1})
    found = extract(Record(time=data.time, position=data.position, force_time=data.force_time, force=data.force))
    two, every = found.two_peak_form, found.standard_form
    assert two is not None and every is not None
    viscous = 3.927 / (2.0 * np.sqrt(0.9407 * 694.1))
    assert viscous < two.damping_ratio.value < every.damping_ratio.value
    assert every.damping_ratio.std > 20.0 * two.damping_ratio.std, "the scatter between the swings is told"


def test_growing_or_drowned_turning_points_end_the_decay() -> None:
    turns = coulomb_turns(0.9, 0.0, 6)
    grown = [*turns[:3], Extreme(0.3, -2.0, 1e-4, 1e-4, -1), *turns[4:]]
    assert len(significant(grown)) == 3
    noise = [Extreme(turn.time, turn.value, 0.01, 1.0, turn.side) for turn in turns]
    assert len(significant(noise)) == 1


def test_a_resting_encoder_knows_one_count_however_often_it_is_read() -> None:
    step = 4.4e-6
    still = np.full(1000, 1.502e-2)
    assert evidence(still) == 1
    assert rest_value(still, Noise(step / np.sqrt(12.0), step, "m")).std == pytest.approx(step / np.sqrt(12.0))
    noisy = 1.502e-2 + 1e-5 * np.random.default_rng(1).standard_normal(1000)
    assert rest_value(noisy, Noise(1e-5, 0.0, "m")).std == pytest.approx(1e-5 / np.sqrt(1000), rel=0.1)


@pytest.mark.parametrize("seed", range(5))
def test_noise_is_quiet_and_creep_or_swing_under_it_is_not(seed: int) -> None:
    noise = 1e-5 * np.random.default_rng(seed).standard_normal(400)
    time = np.linspace(0.0, 1.0, 400)
    assert is_quiet(noise, Noise(1e-5, 0.0, "m"))
    assert not is_quiet(noise + 2e-5 * time, Noise(1e-5, 0.0, "m"))
    assert not is_quiet(noise + 3e-5 * np.cos(40.0 * time), Noise(1e-5, 0.0, "m"))
