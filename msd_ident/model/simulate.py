"""Simulator: the positions that an encoder would read, from a model and a record's force."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from msd_ident.errors import UsageError
from msd_ident.model.model import Model
from msd_ident.record import Record

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Trajectory:
    """A simulated motion at the record's sample times.

    Attributes:
        time: (n,) [s].
        position: (n,) [m] as the sensor reads it.
        velocity: (n,) [m/s] of the mass itself.
        force: (n,) commanded force [N].
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    force: FloatArray


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """The compiled entries, from the cache on disk or by compiling them now; says so on stderr."""
    return _load(_to_stderr)


def _load(say: Callable[[str], None]) -> Any:
    from msd_ident.model.kernel import cache, run

    return cache.load(run.PLAN, run.RUN, run.RUN_MANY, say)


def warm_up(say: Callable[[str], None] = _to_stderr) -> None:
    """Make sure that the solver is compiled; ``say`` is told, in one line, if that takes a while."""
    if _kernel.cache_info().currsize == 0:
        _load(say)
    time = np.linspace(0.0, 1.0, 20)
    record = Record(time=time, position=time, force_time=time, force=time)
    simulator = Simulator(Model(mass=1.0, damping=1.0, stiffness=1.0), record)
    simulator.positions(simulator.model.values, 0.0, 0.0)
    simulator.positions_many(simulator.model.values[None, :], np.zeros(1), np.zeros(1))


class Simulator:
    """A model's structure and a record's force, ready to be simulated many times.

    Calls are thread-safe and release the GIL. ``values`` are in the order of ``model.names``; values of the
    model itself are not used.
    """

    def __init__(self, model: Model, record: Record) -> None:
        self.model = model
        self.record = record
        entries = _kernel()
        from msd_ident.model.kernel import laws

        self._run, self._run_many = entries.run, entries.run_many
        self._bits = laws.bits(*model.effect_names)
        self._place: IntArray = np.array([laws.INDEX[name] for name in model.names], dtype=np.int64)
        self._size = len(laws.INDEX)
        given = (record.time, record.force_time, record.force, record.hold == "linear")
        self._plan = given + tuple(entries.plan(*given))
        self._no_velocity: FloatArray = np.empty(0)

    def _vector(self, values: npt.ArrayLike) -> FloatArray:
        vector = np.zeros(self._size)
        vector[self._place] = values
        return vector

    def positions(
        self, values: npt.ArrayLike, initial_position: float = 0.0, initial_velocity: float = 0.0
    ) -> FloatArray:
        """Readings (n,) [m] at the record's samples; NaN from where the motion leaves all bounds.

        Args:
            values: (p,) parameter values in the order of ``model.names``.
            initial_position, initial_velocity: state [m], [m/s] at the first sample.
        """
        out = np.empty(self.record.samples)
        self._run(
            self._bits, self._vector(values), self._plan, float(initial_position), float(initial_velocity), out,
            self._no_velocity,
        )  # fmt: skip
        return out

    def positions_many(
        self, values: npt.ArrayLike, initial_position: npt.ArrayLike, initial_velocity: npt.ArrayLike
    ) -> FloatArray:
        """The same for several vectors in one call: values (r, p), initial states (r,) each; gives (r, n)."""
        rows = np.ascontiguousarray(values, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != self._place.size:
            raise UsageError(f"values have shape {rows.shape}; expected (any, {self._place.size})")
        vectors = np.zeros((rows.shape[0], self._size))
        vectors[:, self._place] = rows
        out = np.empty((rows.shape[0], self.record.samples))
        x = np.ascontiguousarray(np.broadcast_to(np.asarray(initial_position, dtype=np.float64), rows.shape[:1]))
        v = np.ascontiguousarray(np.broadcast_to(np.asarray(initial_velocity, dtype=np.float64), rows.shape[:1]))
        self._run_many(self._bits, vectors, self._plan, x, v, out)
        return out

    def trajectory(
        self, values: npt.ArrayLike, initial_position: float = 0.0, initial_velocity: float = 0.0
    ) -> Trajectory:
        """Position and velocity for the same arguments as ``positions``."""
        position = np.empty(self.record.samples)
        velocity = np.empty(self.record.samples)
        self._run(
            self._bits, self._vector(values), self._plan, float(initial_position), float(initial_velocity),
            position, velocity,
        )  # fmt: skip
        return Trajectory(self.record.time, position, velocity, self.record.force_at(self.record.time))


def simulate(
    model: Model, record: Record, initial_position: float = 0.0, initial_velocity: float = 0.0
) -> Trajectory:
    """The model's motion under the record's force, from a state at its first sample [m], [m/s]."""
    return Simulator(model, record).trajectory(model.values, initial_position, initial_velocity)
