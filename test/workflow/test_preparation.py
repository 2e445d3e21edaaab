"""Records as models are fitted to them: the sign of the force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Plant, simulate
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
