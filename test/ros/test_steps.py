"""Force steps: when the response has settled."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from msd_ident.ros.identifier.step_detection import Settling, StepWatcher, has_settled  # noqa: E402

RULE = Settling(seconds=0.5, band=0.02)
STEP_NS = 1_000_000_000


def response(seconds: float, rate: float = 1000.0, noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A swing of 4.3 Hz that decays within 2 s, begun at 1 s."""
    time = np.arange(0.0, 1.0 + seconds, 1.0 / rate)
    since = np.maximum(time - 1.0, 0.0)
    position = np.where(time < 1.0, 0.0, 0.015 * (1.0 - np.exp(-2.1 * since) * np.cos(27.0 * since)))
    position = position + noise * np.random.default_rng(1).standard_normal(time.size)
    return np.round(time * 1e9).astype(np.int64), position


@pytest.mark.parametrize("rate", [100.0, 1000.0])
@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_a_swing_settles_when_it_has_decayed_and_not_before(rate: float, noise: float) -> None:
    settled = [has_settled(*response(seconds, rate, noise), STEP_NS, RULE) for seconds in np.arange(0.1, 4.0, 0.1)]
    first = np.arange(0.1, 4.0, 0.1)[settled.index(True)]
    # The envelope over the last half second is within 2 % of the range from ln(100)/2.1 + 0.5 s on at the latest.
    assert 1.0 < first < 2.7
    assert all(settled[settled.index(True) :])


def test_a_gap_in_the_samples_is_no_rest() -> None:
    ns, position = response(3.0)
    keep = (ns < 3_500_000_000) | (ns > 3_700_000_000)
    assert has_settled(ns, position, STEP_NS, RULE)
    assert not has_settled(ns[keep], position[keep], STEP_NS, RULE)


def test_no_samples_have_not_settled() -> None:
    assert not has_settled(np.zeros(0, dtype=np.int64), np.zeros(0), STEP_NS, RULE)


def test_a_step_is_reported_once() -> None:
    watcher = StepWatcher()
    watcher.force(0, 0.0)
    assert watcher.pending == ()
    watcher.force(STEP_NS, 10.0)
    watcher.force(STEP_NS + 5, 10.0)
    assert watcher.pending == (STEP_NS,)
    assert not watcher.take_settled(*response(0.3), RULE)
    assert watcher.take_settled(*response(3.0), RULE)
    assert not watcher.take_settled(*response(3.0), RULE)


def test_steps_that_lie_ahead_wait_for_their_time() -> None:
    watcher = StepWatcher()
    for ns, value in ((0, 0.0), (STEP_NS, 10.0), (2 * STEP_NS, 5.0), (9 * STEP_NS, 0.0)):
        watcher.force(ns, value)
    assert not watcher.take_settled(*response(1.2), RULE), "the second step began 0.2 s ago"
    assert watcher.pending == (2 * STEP_NS, 9 * STEP_NS)
    assert watcher.take_settled(*response(4.0), RULE)
    assert watcher.pending == (9 * STEP_NS,)
    watcher.forget()
    assert watcher.pending == ()


def test_a_threshold_tells_a_noisy_force_from_a_step() -> None:
    watcher = StepWatcher(threshold=0.5)
    for ns, value in enumerate((0.0, 0.3, -0.4, 0.2, 10.1, 9.8, 10.3)):
        watcher.force(ns, value)
    assert watcher.pending == (4,)
