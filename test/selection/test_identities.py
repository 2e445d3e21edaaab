"""What no data of this kind can tell apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from fitrigs import measured

from msd_ident.data.record import Record
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.relaxing_spring import RelaxingSpring
from msd_ident.model.effects.two_tone_disturbance import TwoToneDisturbance
from msd_ident.selection.identities import sentences
from msd_ident.workflow import pipeline

SPRUNG, PLAIN = Plant(1.0, 2.0, 400.0), Plant(1.0, 2.0, 0.0)
RUBS, LEANS, BENDS = CoulombFriction(0.2), ForceOffset(0.5), CubicSpring(1e5)
ASYMMETRIC, SHIFTED = "force_offset beside coulomb_friction is equivalent to asymmetric", "With a linear spring"
ASIDE = "force_offset beside end_stop is equivalent to stops, or bends of the spring, whose middle is off the place of"
RESHAPED = "force_offset beside cubic_spring is equivalent to a spring of another shape"


@pytest.mark.parametrize(
    ("model", "begins"),
    [
        (SPRUNG + RUBS, []),
        (SPRUNG + LEANS, [SHIFTED]),
        (SPRUNG + LEANS + BENDS, [RESHAPED]),
        (SPRUNG + LEANS + EndStop(8e-3, 3e3), [ASIDE]),
        (SPRUNG + LEANS + BENDS + Cogging(0.1, 0.01), []),
        (PLAIN + LEANS, []),
        (PLAIN + LEANS + RUBS, [ASYMMETRIC]),
        (SPRUNG + LEANS + RUBS, [ASYMMETRIC, SHIFTED]),
        (SPRUNG + LEANS + RUBS + BENDS, [ASYMMETRIC, RESHAPED]),
    ],
    ids=lambda part: "+".join(("sprung" if part.stiffness else "plain", *part.effect_names))
    if isinstance(part, Model) else "",
)  # fmt: skip
def test_an_offset_is_a_zero_or_asymmetric_friction(model: Model, begins: list[str]) -> None:
    said = sentences(model, forced=True, gain_known=True)
    assert len(said) == len(begins)
    assert all(sentence.startswith(begin) for sentence, begin in zip(said, begins, strict=True))
    others = [type(effect) for effect in model.effects if effect.name != LEANS.name]
    assert LEANS.is_shape_beside(others) == bool({RESHAPED, ASIDE}.intersection(begins))


def test_stops_off_the_middle_are_an_offset_beside_stops() -> None:
    """The identity itself: with F0 = k·xc the same motion about a zero shifted by xc."""
    aside = SPRUNG + BufferedStop(2e-3, 8e-3, 3e3, 5.0)
    (said,) = sentences(aside, forced=True, gain_known=True)
    assert said.startswith("End stops whose middle is off the relaxed spring are the same as stops about it beside")
    (said,) = sentences(aside + LEANS, forced=True, gain_known=True)
    assert said.startswith("force_offset beside buffered_stop is equivalent to stops, or bends of the spring, whose")
    for alone in (
        SPRUNG + BufferedStop(0.0, 8e-3, 3e3, 5.0),
        PLAIN + BufferedStop(2e-3, 8e-3, 3e3, 5.0),
    ):
        assert sentences(alone, forced=True, gain_known=True) == ()
    time = np.arange(2000) / 1000.0
    pushes = Record(time, 0.0 * time, time, 6.0 * np.sign(np.sin(9.0 * time)))
    about = SPRUNG + BufferedStop(0.0, 8e-3, 3e3, 5.0) + ForceOffset(2e-3 * SPRUNG.stiffness)
    moved = simulate(about, pushes, initial_position=-2e-3).position + 2e-3
    assert np.allclose(simulate(aside, pushes).position, moved, atol=1e-9)
    assert np.max(np.abs(moved)) > 9e-3, "it reaches a stop"


def test_without_a_known_force_only_ratios_are_known() -> None:
    (free,) = sentences(SPRUNG, forced=False, gain_known=False)
    assert free.startswith("No force acts in this data") and "only as ratios" in free
    (gain,) = sentences(SPRUNG, forced=True, gain_known=False)
    assert gain.startswith("The force's gain is unknown") and "share one unknown factor" in gain
    assert sentences(SPRUNG, forced=True, gain_known=True) == ()


TONE = PeriodicDisturbance(0.4, 31.0, 0.7)


@pytest.mark.parametrize(
    ("model", "how"),
    [
        (SPRUNG + TONE, "exactly"),
        (SPRUNG + TONE + LEANS + RelaxingSpring(80.0, 0.5), "exactly"),
        (SPRUNG + TONE + RUBS, "nearly"),
        (SPRUNG + TONE + BENDS, "nearly"),
        (PLAIN + TwoToneDisturbance(0.4, 31.0, 0.7, 0.2, 50.0, 0.0), "exactly"),
    ],
)
def test_a_tone_of_a_force_is_one_of_the_reading(model: Model, how: str) -> None:
    said = [one for one in sentences(model, forced=True, gain_known=True) if one.startswith("A tone of the reading")]
    assert len(said) == 1 and f"does {how} what a tone of the force does" in said[0]


def test_the_tone_of_the_reading_itself() -> None:
    """With the amplitude of the identity, and from the state that the reading shows, the same motion."""
    time = np.arange(2000) / 1000.0
    pushes = Record(time, 0.0 * time, time, 6.0 * np.sign(np.sin(9.0 * time)))
    m, b, k = SPRUNG.values
    w, phase = TONE.disturbance_frequency, TONE.disturbance_phase
    answer = -TONE.disturbance_amplitude / (k - m * w**2 + 1j * b * w)
    tone = np.imag(answer * np.exp(1j * (w * time + phase)))
    assert abs(answer) == pytest.approx(TONE.disturbance_amplitude / np.hypot(k - m * w**2, b * w))
    begins = Initial(float(tone[0]), float(np.imag(1j * w * answer * np.exp(1j * phase))))
    forced = simulate(SPRUNG + TONE, pushes, initial_position=begins.position, initial_velocity=begins.velocity)
    assert np.allclose(forced.position, simulate(SPRUNG, pushes).position + tone, atol=1e-9)


def test_the_verdict_names_both_readings_of_a_tone(asking_about: Callable[..., None]) -> None:
    """A sensor that hums: the rig has no such force."""
    asking_about("periodic_disturbance", "coulomb_friction", "second_mode")
    record = measured(SPRUNG, {"name": "steps", "force": 8.0, "hold": 0.5}, rate=500.0)
    hum = 2e-4 * np.sin(2.0 * np.pi * 50.0 * record.time + 0.3)
    found = pipeline.diagnose([replace(record, position=record.position + hum)])
    assert [cause.name for cause in found.causes] == ["periodic_disturbance"]
    assert "The periodic disturbance may also be a tone in the sensor's reading" in found.summary
    assert any(said.startswith("A tone of the reading") for said in found.warnings)
