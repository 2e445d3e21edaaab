"""What a missing force depends on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import FloatArray
from msd_ident.residuals.dependence import dependences, sentence
from msd_ident.residuals.disturbance import DisturbanceEstimate

SAMPLES = 4000
RNG = np.random.default_rng(7)
TIME = np.linspace(0.0, 10.0, SAMPLES)
POSITION, VELOCITY, APPLIED = RNG.uniform(-1.0, 1.0, (3, SAMPLES))
NOISE = RNG.normal(size=SAMPLES)


def missing(force: FloatArray) -> DisturbanceEstimate:
    """A missing force beside signals that have nothing to do with each other."""
    return DisturbanceEstimate(TIME, POSITION, VELOCITY, APPLIED, force, np.ones(SAMPLES), 1.0, (1.0, 1.0, 1.0))


@pytest.mark.parametrize(
    ("signal", "force"),
    [
        ("position", 1e5 * POSITION**3),
        ("velocity", np.sign(VELOCITY)),
        ("time", np.exp(-0.3 * TIME)),
        ("applied force", np.clip(APPLIED, -0.4, 0.4)),
    ],
)
def test_the_signal_that_makes_the_force_comes_first_and_alone(signal: str, force: FloatArray) -> None:
    first, *others = dependences([missing(force)])
    assert first.signal == signal and first.share > 0.95
    assert max(other.share for other in others) < 0.05
    assert sentence([missing(force)]) == (
        f"Of its variance, {100.0 * first.share:.0f} % depends on the {signal}, each signal taken alone."
    )


def test_two_signals_share_the_variance() -> None:
    found = {one.signal: one.share for one in dependences([missing(3.0 * POSITION + 4.0 * VELOCITY)])}
    assert found["position"] == pytest.approx(9.0 / 25.0, abs=0.05)
    assert found["velocity"] == pytest.approx(16.0 / 25.0, abs=0.05)


@settings(max_examples=20)
@given(st.floats(1e-6, 1e6), st.floats(-1.0, 1.0), st.integers(1, SAMPLES - 1))
def test_shares_do_not_depend_on_unit_offset_or_how_records_are_cut(unit: float, offset: float, cut: int) -> None:
    force = POSITION**2 + 0.5 * NOISE
    whole = {one.signal: one.share for one in dependences([missing(force)])}
    other = missing(unit * (force + offset))
    fields = ("time", "position", "velocity", "applied", "force", "std")
    parts = [replace(other, **{name: getattr(other, name)[part] for name in fields})
             for part in (slice(cut), slice(cut, None))]  # fmt: skip
    for one in dependences(parts):
        assert 0.0 <= one.share <= 1.0
        assert one.share == pytest.approx(whole[one.signal], abs=1e-6)


@pytest.mark.parametrize("force", [NOISE, np.full(SAMPLES, 0.3)], ids=["noise", "constant"])
def test_what_depends_on_nothing_is_not_told(force: FloatArray) -> None:
    assert max(one.share for one in dependences([missing(force)])) < 0.05
    assert sentence([missing(force)]) == ""
