"""Time that was lost although the stamps do not show it."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data import quality
from msd_ident.data.record import FloatArray, Record, from_samples

TIME = 1e-3 * np.arange(10_000)


def swinging(kept: FloatArray, shift: FloatArray | float = 0.0, *, stamped: bool = False) -> Record:
    """A decay of which some samples are kept, with even stamps or their own."""
    noise = np.random.default_rng(7).normal(0.0, 2e-3, TIME.size)
    position = (1.3 * np.exp(-0.05 * TIME) * np.cos(10.5 * TIME) + noise + shift)[kept]
    time = TIME[kept] if stamped else TIME[: position.size]
    return from_samples(time, np.zeros(time.size), position)


def said(record: Record) -> list[str]:
    return [one.sentence for one in quality.check(record) if one.code == "lost_time"]


@pytest.mark.parametrize("lost", [6, 15])
def test_samples_that_are_lost_under_even_stamps_are_told(lost: int) -> None:
    """A pendulum whose loop was late 35 times was "nothing that a cause of the library explains"."""
    kept = np.ones(TIME.size, dtype=bool)
    for begin in range(470, 9000, 530):
        kept[begin : begin + lost] = False
    (sentence,) = said(swinging(kept))
    places = int(sentence.split()[1])
    assert 10 <= places <= 17, "those at a turn, where the speed is small, are not seen"
    told = float(sentence.split("about ")[1].split()[0])
    assert told == pytest.approx(1e-3 * lost * places, rel=0.1)
    assert sentence.endswith("log the time of each sample in place of counting them")
    assert said(swinging(kept, stamped=True)) == [], "their own stamps show it"


def test_readings_that_slip_both_ways_lost_no_time() -> None:
    slips = np.cumsum(np.where(np.arange(TIME.size) % 600 == 470, 0.1, 0.0) * np.sign(np.sin(0.0123 * TIME * 1e3)))
    every = np.ones(TIME.size, dtype=bool)
    assert said(swinging(every, slips)) == []
    assert said(swinging(every)) == []


def test_readings_that_are_held_and_catch_up_lost_no_time() -> None:
    position = swinging(np.ones(TIME.size, dtype=bool)).position.copy()
    for begin in range(470, 9000, 600):
        position[begin : begin + 8] = position[begin]
    assert said(from_samples(TIME, np.zeros(TIME.size), position)) == []


def test_steps_of_a_scale_in_a_motion_that_never_turns_are_no_lost_time() -> None:
    noise = np.random.default_rng(7).normal(0.0, 1e-3, TIME.size)
    turned = 1.5 * TIME + 0.02 * np.sin(TIME) + noise + 0.05 * np.floor(TIME / 0.7)
    assert said(from_samples(TIME, np.sin(TIME), turned)) == []
