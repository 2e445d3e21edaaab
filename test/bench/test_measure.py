"""How the benchmark tells cost against length, by a clock of the test's own."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from bench import measure


def departure(monkeypatch: pytest.MonkeyPatch, cost: Callable[[int, int], float]) -> float:
    """What ``linearity`` tells of work that takes ``cost(samples, round)`` seconds."""
    now = [0.0]

    def prepare(samples: int, turn: int) -> Callable[[], object]:
        def work() -> None:
            now[0] += cost(samples, turn)

        return work

    monkeypatch.setattr(measure, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    return measure.linearity("work", prepare, rounds=9).value


def test_work_that_grows_with_its_record_is_linear_whatever_it_begins_with(monkeypatch: pytest.MonkeyPatch) -> None:
    assert departure(monkeypatch, lambda samples, _: 5e-3 + 1e-6 * samples) == pytest.approx(0.0, abs=1e-6)


def test_a_machine_that_changes_its_pace_does_not_change_the_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even in the middle of a round: the medians of each length over all rounds would be of two paces."""

    def pace(samples: int, turn: int) -> float:
        return 2.0 if turn >= 6 or (turn == 5 and samples == measure.LENGTHS[-1]) else 1.0

    paced = departure(monkeypatch, lambda samples, turn: pace(samples, turn) * (5e-3 + 1e-6 * samples))
    assert paced == pytest.approx(0.0, abs=1e-6)


def test_work_that_grows_faster_than_its_record_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    assert departure(monkeypatch, lambda samples, _: 1e-6 * samples**1.1) > 20.0
    dearer = departure(monkeypatch, lambda samples, _: 1e-6 * samples + 0.3e-6 * max(samples - 100_000, 0))
    assert dearer == pytest.approx(30.0, abs=1e-6)
