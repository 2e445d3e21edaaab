"""ζ(A) and ωn(A) tell dry friction from drag and a bent spring at a glance."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.diagnose.ringdown import RingDown, ring_down
from msd_ident.features import extract
from msd_ident.record import Record
from msd_sim import api

MASS, STIFFNESS, AMPLITUDE = 1.0, 400.0, 0.02


def released(effects: dict[str, dict[str, float]], noise: float = 2e-6) -> Record:
    """A cart let go at 20 mm, seen by the rig's own encoder."""
    made = api.simulate(
        {
            "mass": MASS, "damping": 0.8, "stiffness": STIFFNESS, "friction_coefficient": 0.0, "effects": effects,
            "encoder": {"counts_per_metre": 0.0, "noise": noise}, "rate": 1000.0, "seed": 3,
            "experiment": {"name": "release", "position": AMPLITUDE, "duration": 4.0},
        }
    )  # fmt: skip
    return Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)


def found(effects: dict[str, dict[str, float]]) -> RingDown:
    """The ring-down of one release."""
    result = ring_down([extract(released(effects))])
    assert result is not None
    return result


def test_dry_friction_raises_the_ratio_of_small_swings_by_the_known_law() -> None:
    coulomb = 0.15
    result = found({"coulomb_friction": {"coulomb_force": coulomb}})
    assert "rises" in result.sentences[0] and "dry friction" in result.sentences[0]
    viscous = 0.8 / (2.0 * np.sqrt(MASS * STIFFNESS))
    expected = viscous + 2.0 * coulomb / (np.pi * STIFFNESS * result.amplitude)
    large = result.amplitude > 0.2 * AMPLITUDE
    assert large.sum() > 5
    assert result.damping_ratio[large] == pytest.approx(expected[large], rel=0.06)


def test_drag_lowers_it_by_the_known_law() -> None:
    drag = 4.0
    result = found({"quadratic_drag": {"drag_coefficient": drag}})
    assert "falls" in result.sentences[0] and "drag" in result.sentences[0]
    viscous = 0.8 / (2.0 * np.sqrt(MASS * STIFFNESS))
    expected = viscous + 4.0 * drag * result.amplitude / (3.0 * np.pi * MASS)
    assert result.damping_ratio == pytest.approx(expected, rel=0.06)


def test_a_hardening_spring_is_told_by_its_frequency_alone() -> None:
    result = found({"cubic_spring": {"cubic_stiffness": 1e5}})
    assert len(result.sentences) == 1
    assert "natural frequency falls" in result.sentences[0] and "hardening" in result.sentences[0]


def test_a_linear_plant_says_nothing() -> None:
    assert found({}).sentences == ()


def test_too_few_swings_are_none() -> None:
    time = np.linspace(0.0, 1.0, 500)
    still = Record(time=time, position=np.where(time < 0.5, 0.0, 1e-3), force_time=[0.0], force=[0.0])
    assert ring_down([extract(still)]) is None
