"""The figures of a blind study."""

from __future__ import annotations

import math

import pytest

from bench.blind import score
from bench.blind.cases import Case, Outcome


def outcome(named: tuple[tuple[str, float], ...], beside: tuple[tuple[str, float], ...] = ()) -> Outcome:
    """A diagnosis of a rig with backlash that stated these probabilities."""
    return Outcome(
        case=Case(1, "backlash", False), truth=("backlash",), odd=False, strength={}, verdict="explained",
        named=tuple((name, p, ()) for name, p in named), base_floors=9.0, extended_floors=1.0, without_floors=9.0,
        heldout_floors=1.0, removed=1.0, seconds=1.0, beside=beside,
    )  # fmt: skip


def test_stated_probabilities_are_compared_with_what_acts() -> None:
    """Of ten stated with 0.7 six act; a thin bin is shown with its range, and counts for nothing."""
    right, wrong = outcome((("backlash", 0.7),)), outcome((("cogging", 0.7),))
    thin = outcome((("backlash", 0.99),), beside=(("cogging", 0.3), ("hysteresis", 0.001)))
    bins = score.reliability([*[right] * 6, *[wrong] * 4, thin])
    assert [(b.low, b.count, b.right) for b in bins] == [(0.2, 1, 0), (0.6, 10, 6), (0.95, 1, 1)]
    assert bins[1].observed == 0.6 and bins[1].range == pytest.approx((0.313, 0.832), abs=0.001)
    assert score.miscalibration([*[right] * 6, *[wrong] * 4, thin]) == pytest.approx(0.1)
    assert math.isnan(score.miscalibration([thin]))
