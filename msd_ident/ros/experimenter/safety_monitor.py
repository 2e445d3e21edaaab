"""Checks the limits of an experiment in progress on every reading. Without ROS."""

from __future__ import annotations

import threading
import time

from msd_ident.design import Limits

#: Readings over which a speed is taken [ns]: shorter, and the encoder's step would look like speed.
_SPEED_NS = 20_000_000


class SafetyMonitor:
    """Watches travel, speed and silence; what goes wrong first is kept.

    Args:
        limits: of the rig.
        silence: longest time without a reading [s].
        unit: of the readings.
    """

    def __init__(self, limits: Limits, silence: float, unit: str = "m") -> None:
        self._limits, self._silence, self._unit = limits, silence, unit
        self._lock = threading.Lock()
        self._start: float | None = None
        self._before: tuple[int, float] | None = None
        self._last_reading = time.monotonic()
        self.position, self.reason = 0.0, ""

    def reading(self, stamp_ns: int, position: float) -> bool:
        """Take one reading; False from the first on that is beyond a limit."""
        with self._lock:
            self._last_reading = time.monotonic()
            if self._start is None:
                self._start, self._before = position, (stamp_ns, position)
            self.position = position - self._start
            low, high = self._limits.travel
            if not low <= self.position <= high:  # NaN is beyond, too
                self._stop(
                    f"the cart left its travel: {self.position:.4g} {self._unit} from its start, the limits allow "
                    f"{low:.4g} to {high:.4g}"
                )
            self._watch_speed(stamp_ns, position)
            return not self.reason

    def _watch_speed(self, stamp_ns: int, position: float) -> None:
        assert self._before is not None
        passed = stamp_ns - self._before[0]
        if passed < _SPEED_NS:
            return
        speed = abs(position - self._before[1]) / (passed / 1e9)
        self._before = (stamp_ns, position)
        if speed > self._limits.speed:
            self._stop(f"the cart is too fast: {speed:.3g} {self._unit}/s, the limit is {self._limits.speed:.3g}")

    def silent(self) -> bool:
        """Whether no reading came for too long; that stops the experiment, too."""
        with self._lock:
            if time.monotonic() - self._last_reading <= self._silence:
                return False
            self._stop(f"the encoder fell silent: no reading for {self._silence:g} s")
            return True

    def stop(self, reason: str) -> None:
        """Stop for another reason."""
        with self._lock:
            self._stop(reason)

    def _stop(self, reason: str) -> None:
        self.reason = self.reason or reason
