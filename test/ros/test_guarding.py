"""The guard of an experiment: travel to either side, speed and silence, without a graph."""

from __future__ import annotations

import math
import time

import pytest

from msd_ident.design import Limits
from msd_ident.ros.experimenter.safety_monitor import SafetyMonitor

LIMITS = Limits((-10.0, 10.0), (-0.02, 0.03), 20.0, speed=0.5)


def guard(silence: float = 60.0) -> SafetyMonitor:
    made = SafetyMonitor(LIMITS, silence)
    assert made.reading(0, 0.1)  # wherever it starts, that is its zero
    return made


@pytest.mark.parametrize(("aside", "free"), [(0.0299, True), (0.0301, False), (-0.0199, True), (-0.0201, False)])
def test_travel_ends_on_either_side(aside: float, free: bool) -> None:
    watch = guard()
    assert watch.reading(10**9, 0.1 + aside) is free
    assert watch.reason.startswith(f"the cart left its travel: {aside:.4g} m from its start") is not free
    assert watch.reading(2 * 10**9, 0.1) is free, "what went wrong once stays"


def test_a_reading_that_is_no_number_is_beyond_all_limits() -> None:
    watch = guard()
    assert not watch.reading(10**6, math.nan)
    assert "the limits allow -0.02 to 0.03" in watch.reason


def test_speed_to_either_side() -> None:
    for sign in (-1.0, 1.0):
        slow, fast = guard(), guard()
        assert slow.reading(30_000_000, 0.1 + sign * 0.0145)
        assert not fast.reading(30_000_000, 0.1 + sign * 0.0155)
        assert fast.reason == "the cart is too fast: 0.517 m/s, the limit is 0.5"


def test_silence_counts_from_the_last_reading() -> None:
    watch = guard(silence=0.2)
    assert not watch.silent()
    time.sleep(0.25)
    assert watch.silent() and watch.reason == "the encoder fell silent: no reading for 0.2 s"
