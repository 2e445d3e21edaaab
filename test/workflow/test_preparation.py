"""Records as models are fitted to them: the sign of the force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.workflow import pipeline
from msd_ident.workflow.preparation import prepare

PLANT = Plant(1.0, 6.2, 3947.8)


def random_binary(seed: int) -> Record:
    """A linear rig under a random binary force of 4 N, at 2 kHz for 3 s."""
    rng = np.random.default_rng(seed)
    force = 4.0 * np.repeat(np.where(rng.random(86) < 0.5, -1.0, 1.0), 70)
    still = from_samples(np.arange(force.size) / 2000.0, force, np.zeros(force.size))
    return replace(still, position=simulate(PLANT, still).position + rng.normal(0.0, 1e-5, force.size))


def inverted_step() -> Record:
    """Rest, and then a step that is held, read by an encoder that counts the other way."""
    record = random_binary(96)
    step = replace(record, force=np.where(np.arange(record.samples) < 1000, 0.0, 4.0))
    return replace(step, position=-simulate(PLANT, step).position)


@pytest.mark.parametrize("seed", [5, 96])
def test_a_step_from_a_short_standstill_does_not_turn_the_force(seed: int) -> None:
    """One of 86 levels showed a response of the wrong sign: the force was turned, and the record refused."""
    record = random_binary(seed)
    assert not prepare([record]).turned
    found = pipeline.diagnose([record])
    assert found.verdict == "adequate"
    assert found.extended.quantities["mass"].value == pytest.approx(PLANT.mass, rel=2e-3)


def test_a_free_decay_beside_it_does_not_hide_an_encoder_that_counts_the_other_way() -> None:
    moved = inverted_step()
    free = replace(moved, force=np.zeros(moved.samples))
    decay = replace(free, position=simulate(PLANT, free, 0.02, 0.0).position)
    assert prepare([moved, decay]).turned


def test_an_encoder_that_counts_the_other_way_is_still_seen() -> None:
    found = prepare([inverted_step()])
    assert found.turned
    assert any("A positive force moves the encoder downwards" in sentence for sentence in found.warnings)


def test_the_same_record_twice_makes_no_interval_narrower() -> None:
    one = replace(random_binary(5), name="a.csv")
    again = replace(one, time=one.time + 40.0, force_time=one.force_time + 40.0, name="b.csv")
    found = prepare([one, again, random_binary(96)])
    assert [record.name for record in found.given] == ["a.csv", "record"]
    assert found.warnings[0].startswith("b.csv is left out: its positions and its force are those of a.csv, sample by")
    alone, both = (pipeline.identify(records).refined for records in ([one], [one, again]))
    assert both.parameters["mass"].std == alone.parameters["mass"].std


def two_tones(stiffness: float) -> Record:
    """A rig under two sines of 4 N, at 200 Hz for 10 s, from its steady motion."""
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 12.0, 0.005)
    force = 4.0 * (np.sin(2.0 * np.pi * 0.8 * time) + np.sin(2.0 * np.pi * 2.1 * time))
    still = from_samples(time, force, np.zeros(time.size))
    moved = simulate(Plant(1.0, 6.2, stiffness), still).position + rng.normal(0.0, 1e-5, time.size)
    return replace(still, position=moved).cut(2.0, 12.0)


@pytest.mark.parametrize("stiffness", [0.0, 10.0, 400.0])
def test_an_inverted_encoder_is_seen_where_no_response_shows_it(stiffness: float) -> None:
    """A voice coil with an inverted sensor (public record), driven by a sine, had a mass 7 times too large."""
    record = two_tones(stiffness)
    inverted = replace(record, position=-record.position)
    assert not prepare([record]).turned and prepare([inverted]).turned
    found = pipeline.identify([inverted])
    assert found.refined.model["mass"] == pytest.approx(1.0, rel=0.01)
    assert any("A positive force moves the encoder downwards" in sentence for sentence in found.warnings)


@pytest.mark.parametrize("spring", [0.0, 50.0])
def test_a_controller_whose_force_is_recorded_is_no_inverted_encoder(spring: float) -> None:
    """Its force pulls against the motion too, and in the inverted record it pushes along."""
    rng, step, each = np.random.default_rng(3), 1e-3, 5
    x = v = push = 0.0
    force, position = [], []
    for i in range(20_000):
        if i % each == 0:
            seen = x + 1e-6 * rng.normal()
            push = 400.0 * (0.02 * np.sign(np.sin(np.pi * i * step / 2.0)) - seen) - 30.0 * v
            force.append(push)
            position.append(seen)
        v += step * (push - 4.0 * v - spring * x)
        x += step * v
    record = from_samples(step * each * np.arange(len(force)), np.array(force), np.array(position))
    assert not prepare([record]).turned
    assert prepare([replace(record, position=-record.position)]).turned


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("drive", ["pulses", "random"])
def test_an_inverted_encoder_of_an_axis_without_a_spring_is_seen(drive: str, friction: float) -> None:
    """Five public records of such axes were refused, or had open values, with an inverted encoder."""
    time, rng = np.arange(0.0, 8.0, 0.005), np.random.default_rng(4)
    force = 3.0 * (((time > 1.0) & (time < 1.6)) * 1.0 - ((time > 4.0) & (time < 4.4)) * 1.0)
    if drive == "random":
        force = 3.0 * np.repeat(rng.choice([-1.0, 1.0], 40), 40)
    still = from_samples(time, force, np.zeros(time.size))
    moved = simulate(Plant(1.0, 0.8, 0.0) + CoulombFriction(friction), still).position
    record = replace(still, position=moved + rng.normal(0.0, 1e-5, time.size))
    inverted = replace(record, position=-record.position)
    assert not prepare([record]).turned and prepare([inverted]).turned
    assert pipeline.identify([inverted]).refined.model["mass"] == pytest.approx(1.0, rel=0.02)


def test_a_refusal_of_a_record_with_few_samples_a_swing_may_say_so() -> None:
    """A tuning fork of 439 Hz, read at 1 kHz: "a hand may have moved the cart" alone stood in the refusal."""
    time = 1e-3 * np.arange(4000)
    record = from_samples(time, np.zeros(4000), 1e-3 * np.exp(-time) * np.cos(2.0 * np.pi * 438.7 * time + 0.3))
    (said,) = prepare([record]).doubtful_data
    assert "samples; expected 12 or more: sample at" in said
