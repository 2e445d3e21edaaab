"""Which part of a record a search may be content with."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import Record
from msd_ident.residuals.noise_model import Readings, of_record

RATE, KEEP = 200.0, 1500


def record(force: np.ndarray, position: np.ndarray) -> Readings:
    time = np.arange(force.size) / RATE
    return of_record(Record(time=time, position=position, force_time=time, force=force), 1e-6)


def multisine(size: int = 9000) -> np.ndarray:
    time = np.arange(size) / RATE
    phases = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 40)
    return np.asarray(sum(np.sin(2.1 * (n + 10) * time + phase) for n, phase in enumerate(phases)))


def test_a_record_that_goes_on_in_the_same_way_shows_itself_in_a_stretch() -> None:
    force = multisine()
    part = record(force, 0.01 * np.roll(force, 3)).stretch(KEEP)
    assert part.record.samples == KEEP
    assert np.ptp(part.record.position) > 0.8 * 0.01 * np.ptp(force)
    first = int(round(part.record.time[0] * RATE))
    assert np.array_equal(part.record.position, 0.01 * np.roll(force, 3)[first : first + KEEP])


def test_a_decay_and_a_few_steps_and_a_fading_drive_are_kept_whole() -> None:
    time = np.arange(9000) / RATE
    decay = record(np.zeros(9000), np.exp(-0.1 * time) * np.cos(9.0 * time))
    steps = np.sign(np.sin(0.3 * time))
    fading = multisine() * np.exp(-0.1 * time)
    for whole in (decay, record(steps, steps), record(fading, fading)):
        assert whole.stretch(KEEP) is whole
