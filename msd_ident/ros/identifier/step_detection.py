"""Detects force steps, and when the response to one has settled. Without ROS."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.ros.common.live_buffer import StampArray

#: Parts of the settling time whose means are compared: averages noise, sees what swings slower.
_PARTS = 10


@dataclass(frozen=True)
class Settling:
    """When a response counts as settled.

    Attributes:
        seconds: how long force and position must have been at rest.
        band: how much the position may still vary, as a part of its range since the step.
    """

    seconds: float
    band: float


def has_settled(ns: StampArray, position: FloatArray, step_ns: int, rule: Settling) -> bool:
    """Whether the position rests after a force step.

    Args:
        ns: (n,) stamps [ns].
        position: (n,) positions.
        step_ns: stamp of the step [ns]; samples before it count for the range as far as the settling time.
        rule: when it counts as settled.
    """
    if not ns.size:
        return False
    end = int(ns.max())
    length = round(rule.seconds * 1e9)
    if end - step_ns < length:
        return False
    tail = ns > end - length
    since = ns > step_ns - length
    part = ((end - ns[tail]) * _PARTS) // length
    counts = np.bincount(part, minlength=_PARTS)
    if np.any(counts == 0):
        return False
    means = np.bincount(part, weights=position[tail], minlength=_PARTS) / counts
    return bool(np.ptp(means) <= rule.band * np.ptp(position[since]))


class StepWatcher:
    """Remembers force steps until the response to the latest one was reported as settled, once.

    Args:
        threshold: smallest change of the force that counts as a step, in its unit; 0: any change.
    """

    def __init__(self, threshold: float = 0.0) -> None:
        self._threshold = threshold
        self._level: float | None = None
        self._steps: list[int] = []

    @property
    def pending(self) -> tuple[int, ...]:
        """Stamps of the steps whose response is awaited [ns]; some may lie ahead."""
        return tuple(self._steps)

    def force(self, ns: int, value: float) -> None:
        """Take a force sample; one that differs from the level before is a step. The first sample is none."""
        if self._level is None:
            self._level = value
        elif abs(value - self._level) > self._threshold:
            self._level = value
            self._steps = [*self._steps[-99:], ns]

    def take_settled(self, ns: StampArray, position: FloatArray, rule: Settling) -> bool:
        """Whether the response to the latest step that has acted is settled; true only once a step."""
        if not self._steps or not ns.size:
            return False
        now = int(ns.max())
        acted = [step for step in self._steps if step <= now]
        self._steps = acted[-1:] + [step for step in self._steps if step > now]
        if not acted or not has_settled(ns, position, acted[-1], rule):
            return False
        self._steps = self._steps[1:]
        return True

    def forget(self) -> None:
        """The clock was set back: the steps that were awaited are no more."""
        self._steps = []
