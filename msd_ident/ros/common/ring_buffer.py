"""A bounded store of stamped values, the oldest go out. Without ROS."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray
from msd_ident.errors import UsageError

StampArray = npt.NDArray[np.int64]


class Ring:
    """Stamped values in order of arrival; when full, the oldest go out. Not safe for threads by itself."""

    def __init__(self, capacity: int) -> None:
        if capacity < 1:
            raise UsageError(f"a buffer of {capacity} samples; expected at least 1")
        self._ns = np.zeros(capacity, dtype=np.int64)
        self._values = np.zeros(capacity)
        self._next = 0
        self.size = 0
        self.newest_ns = 0

    @property
    def capacity(self) -> int:
        """Samples that fit."""
        return int(self._ns.size)

    def append(self, ns: int, value: float) -> None:
        """Take one sample."""
        self.newest_ns = max(ns, self.newest_ns) if self.size else ns
        self._ns[self._next] = ns
        self._values[self._next] = value
        self._next = (self._next + 1) % self.capacity
        self.size = min(self.size + 1, self.capacity)

    def extend(self, ns: StampArray, values: FloatArray) -> None:
        """Take samples in the order given; of more than fit, the last ones."""
        if not ns.size:
            return
        self.newest_ns = max(int(ns.max()), self.newest_ns) if self.size else int(ns.max())
        ns, values = ns[-self.capacity :], values[-self.capacity :]
        at = (self._next + np.arange(ns.size)) % self.capacity
        self._ns[at], self._values[at] = ns, values
        self._next = int(at[-1] + 1) % self.capacity
        self.size = min(self.size + int(ns.size), self.capacity)

    def samples(self, last: int | None = None) -> tuple[StampArray, FloatArray]:
        """Copies of stamps and values, oldest first; of the ``last`` ones only when given."""
        count = self.size if last is None else min(last, self.size)
        at = (self._next - count + np.arange(count)) % self.capacity
        return self._ns[at], self._values[at]

    def clear(self) -> None:
        """Forget all samples."""
        self._next = self.size = self.newest_ns = 0

    def keep_before(self, ns: int) -> None:
        """Forget the samples at or after a stamp."""
        stamps, values = self.samples()
        old = stamps < ns
        self.clear()
        self.extend(stamps[old], values[old])
