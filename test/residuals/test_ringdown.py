"""ζ(A) and ωn(A) tell dry friction from drag and a bent spring at a glance."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.features import extract
from msd_ident.model import Effect, Plant, simulate
from msd_ident.model.effects import spoken
from msd_ident.model.effects.asymmetric_spring import AsymmetricSpring
from msd_ident.model.effects.bilinear_spring import BilinearSpring
from msd_ident.model.effects.bouc_wen import BoucWen
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.curved_stiffness_drift import CurvedStiffnessDrift
from msd_ident.model.effects.damped_stop import DampedStop
from msd_ident.model.effects.fading_damping import FadingDamping
from msd_ident.model.effects.gravity import Gravity
from msd_ident.model.effects.growing_damping import GrowingDamping
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.load_dependent_friction import LoadDependentFriction
from msd_ident.model.effects.one_sided_stop import OneSidedStop
from msd_ident.model.effects.power_drag import PowerDrag
from msd_ident.model.effects.power_spring import PowerSpring
from msd_ident.model.effects.settling_stiffness import SettlingStiffness
from msd_ident.model.effects.stiffness_drift import StiffnessDrift
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.stribeck_shape import StribeckShape
from msd_ident.residuals.ringdown import RingDown, ring_down
from msd_ident.workflow import pipeline
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
    assert "rises" in result.sentences[0] and result.observations[0].law == "dry friction"
    viscous = 0.8 / (2.0 * np.sqrt(MASS * STIFFNESS))
    expected = viscous + 2.0 * coulomb / (np.pi * STIFFNESS * result.amplitude)
    large = result.amplitude > 0.2 * AMPLITUDE
    assert large.sum() > 5
    assert result.damping_ratio[large] == pytest.approx(expected[large], rel=0.06)


def test_drag_lowers_it_by_the_known_law() -> None:
    drag = 4.0
    result = found({"quadratic_drag": {"drag_coefficient": drag}})
    assert "falls" in result.sentences[0] and "drag" in result.observations[0].law
    viscous = 0.8 / (2.0 * np.sqrt(MASS * STIFFNESS))
    expected = viscous + 4.0 * drag * result.amplitude / (3.0 * np.pi * MASS)
    assert result.damping_ratio == pytest.approx(expected, rel=0.06)


def test_swings_whose_frequency_is_not_known_show_no_trend_of_it() -> None:
    """A reading that jumps with the force leaves turning points that no curve goes through."""
    record = released({"coulomb_friction": {"coulomb_force": 0.2}})
    features = extract(record)
    unknown = replace(
        features,
        responses=tuple(
            replace(one, swings=tuple(replace(swing, natural_frequency_std=math.inf) for swing in one.swings))
            for one in features.responses
        ),
    )
    told = ring_down([unknown])
    assert told is not None and not any("frequency" in sentence for sentence in told.sentences)


def test_a_hardening_spring_is_told_by_its_frequency_alone() -> None:
    result = found({"cubic_spring": {"cubic_stiffness": 1e5}})
    assert len(result.sentences) == 1
    assert "natural frequency falls" in result.sentences[0] and "hardening" in result.observations[0].law


CALLED, NOT = (
    "as expected from {}.",
    "a hardening spring would cause this, but the diagnosis does not name it.",
)


@pytest.mark.parametrize(
    ("named", "tied", "reading"),
    [
        ({"cubic_spring": 1e5}, (), CALLED.format("cubic spring")),
        ({"coulomb_friction": 0.1, "backlash": 1e-3}, (), CALLED.format("backlash")),
        ({"bilinear_spring": 20.0}, (), CALLED.format("bilinear spring")),
        ({"bilinear_spring": -20.0}, (), NOT),
        ({"cubic_spring": -1e5}, (), NOT),
        ({"coulomb_friction": 0.1}, (), NOT),
        ({}, (), NOT),
        (
            {"coulomb_friction": 0.1},
            ("end_stop",),
            "end stop would cause this, which is one of the causes that this data cannot tell apart.",
        ),
    ],
)
def test_what_is_read_in_it_never_contradicts_the_diagnosis(
    named: dict[str, float], tied: tuple[str, ...], reading: str
) -> None:
    plain = found({"cubic_spring": {"cubic_stiffness": 1e5}})
    told = plain.read_with(named, tied)
    assert told.sentences[0].endswith(reading)
    assert told.sentences[0].startswith(plain.sentences[0].rstrip("."))
    assert "hardening" not in plain.sentences[0]


@pytest.mark.usefixtures("without_copies")
def test_a_diagnosis_reads_it_with_its_own_causes() -> None:
    """The frequency of a rubbing cart on a linear spring, says nothing of a bent one."""
    result = pipeline.diagnose([released({"coulomb_friction": {"coulomb_force": 0.15}})])
    assert [one.name for one in result.causes] == ["coulomb_friction"] and result.ring_down is not None
    said = result.ring_down.sentences
    assert said[0].endswith("as expected from Coulomb friction.")
    assert len(said) == 2 and "frequency" in said[1] and said[1].endswith("; the simulated motion shows the same.")


def test_a_trend_of_the_simulation_too_is_no_further_law() -> None:
    """Losses that are not viscous shift the frequency that is read off each swing; a bent spring shifts it further."""
    rubbing = {"coulomb_friction": {"coulomb_force": 0.15}}
    bent = found({**rubbing, "cubic_spring": {"cubic_stiffness": -2e5}})
    law = "a softening spring"
    assert law in {one.law for one in found(rubbing).observations}
    assert [one.simulated for one in found(rubbing).beside(found(rubbing)).observations if one.law == law] == [True]
    assert [one.simulated for one in bent.beside(found(rubbing)).observations if one.law == law] == [False]
    assert [one.simulated for one in bent.beside(bent).observations if one.law == law] == [True]
    assert bent.beside(None) == bent


#: Laws that change the damping or the frequency with the amplitude, and those that do so over a decay by being in time.
BY_AMPLITUDE = {
    "a softening spring": {
        Gravity(400.0): {"stiffness": 0.0, "amplitude": 1.0}, PowerSpring(-1.0, AMPLITUDE, 3.0): {},
        BilinearSpring(0.01, -100.0): {},
        AsymmetricSpring(4e3): {}, SettlingStiffness(0.1, 1.0): {}, StiffnessDrift(0.02): {},
        CurvedStiffnessDrift(0.02, 0.0, 0.0): {}, BoucWen(100.0, 200.0, 200.0): {}, Hysteresis(0.3, 5e-3): {},
        Cogging(0.5, 0.06, 0.0): {},
    },
    "a hardening spring": {
        PowerSpring(1.0, AMPLITUDE, 3.0): {}, BilinearSpring(0.01, 100.0): {}, OneSidedStop(0.005, 500.0): {},
        DampedStop(0.005, 500.0, 1.0): {}, BufferedStop(0.0, 0.005, 500.0, 1.0): {}, StiffnessDrift(-0.02): {},
        Cogging(0.5, 0.06, math.pi): {},
    },
    "dry friction": {
        FadingDamping(2.0, 0.1, 2.0): {}, LoadDependentFriction(0.1, 0.05): {}, StribeckShape(0.1, 0.2, 0.05, 1.0): {},
        StribeckFriction(0.1, 0.2, 0.05): {}, BoucWen(400.0, 4000.0, 4000.0): {},
    },
    "drag that grows with the square of the speed": {
        PowerDrag(0.5, 0.3, 2.5): {}, GrowingDamping(200.0, 200.0): {}, BoucWen(100.0, 50.0, 50.0): {},
        DampedStop(0.005, 500.0, 2.0): {}, BufferedStop(0.0, 0.005, 200.0, 10.0): {},
    },
}  # fmt: skip


@pytest.mark.parametrize(
    ("law", "effect", "plant"),
    [(law, effect, plant) for law, effects in BY_AMPLITUDE.items() for effect, plant in effects.items()],
    ids=lambda value: value.name if isinstance(value, Effect) else None,
)
def test_a_law_that_makes_a_ring_down_says_so(law: str, effect: Effect, plant: dict[str, float]) -> None:
    """It is simulated, what is seen is read, and the reading must not deny the cause that is named."""
    amplitude = plant.get("amplitude", AMPLITUDE)
    model = replace(Plant(MASS, 0.8, plant.get("stiffness", STIFFNESS)), effects=(effect,))
    time = np.linspace(0.0, 6.0, 6001)
    still = Record(time=time, position=np.full(time.size, amplitude), force_time=[0.0], force=[0.0])
    noise = np.random.default_rng(3).normal(scale=2e-6, size=time.size)
    record = replace(still, position=simulate(model, still, amplitude).position + noise)
    result = ring_down([extract(record)])
    assert result is not None
    strength = getattr(effect, effect.neutral[0][0])
    (seen,) = (one for one in result.observations if one.law == law)
    assert seen.told({effect.name: strength}).endswith(f", as expected from {spoken(effect.name)}.")


def test_a_linear_plant_says_nothing() -> None:
    assert found({}).sentences == ()


def test_too_few_swings_are_none() -> None:
    time = np.linspace(0.0, 1.0, 500)
    still = Record(time=time, position=np.where(time < 0.5, 0.0, 1e-3), force_time=[0.0], force=[0.0])
    assert ring_down([extract(still)]) is None
