"""Simulator: the positions that an encoder would read, from a model and a record's force."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from msd_ident import cancellation
from msd_ident.data.record import Record
from msd_ident.errors import UsageError
from msd_ident.model.plant import Model

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


_NOTHING: FloatArray = np.empty(0)
#: What ``run.compare`` leaves readings as they are with. As in a record, the positions cannot be written to: for arrays
#: that can, numba would compile the solver once more.
_NOT_COMPARED = (np.empty(0), _NOTHING, 0.0)
_NOT_COMPARED[0].setflags(write=False)


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """The compiled entries, from the cache on disk or compiled now; says so on stderr."""
    return _load(_to_stderr)


def _load(say: Callable[[str], None]) -> Any:
    from msd_ident.model.kernel import cache

    entries = cache.load(say)
    if not cache.compiled(entries):
        # Code that was compiled in this process may round in another way than the same code from the cache, and stays
        # in use where that is loaded later.
        cache.compile_apart()
        entries = cache.load(_nobody)
    _run_once(entries)
    return entries


def compile_here() -> None:
    """Compile the solver in this process, into the cache."""
    from msd_ident.model.kernel import cache

    _run_once(cache.load(_nobody))


def _nobody(line: str) -> None:
    del line


def _run_once(entries: Any) -> None:
    """A first run, which loads the entries' code or compiles it.

    The collector of garbage rests meanwhile: it would look through the compiler's millions of objects again and again,
    a tenth of the time, and find little.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        time = np.linspace(0.0, 1.0, 20)
        plan = _plan(Record(time=time, position=time, force_time=time, force=time), entries)
        out = np.empty((1, time.size))
        entries.run(0, np.ones((1, 6)), np.arange(3, dtype=np.int64), plan, _NOT_COMPARED, out, out[:, :0])
    finally:
        if collecting:
            gc.enable()


def warm_up(say: Callable[[str], None] = _to_stderr) -> None:
    """Make sure that the solver is compiled and loaded; ``say`` is told, in one line, if that takes a while."""
    if not _kernel.cache_info().currsize and say is not _to_stderr:
        _load(say)
    _kernel()


def _plan(record: Record, entries: Any) -> tuple[Any, ...]:
    def made() -> tuple[Any, ...]:
        seen = record.from_origin()
        given = (seen.time, seen.force_time, seen.force, seen.hold == "linear")
        return given + tuple(entries.plan(*given))

    return record.kept("plan", made)


class Simulator:
    """A model's structure and a record's force, ready to be simulated many times.

    Calls are thread-safe and release the GIL. ``values`` are in the order of ``model.names``; values of the
    model itself are not used. Each call asks first whether the work should stop (``msd_ident.cancellation``).
    """

    def __init__(self, model: Model, record: Record) -> None:
        self.model = model
        self.record = record
        entries = _kernel()
        from msd_ident.model.kernel import laws

        self._run = entries.run
        self._bits = laws.bits(*model.effect_names)
        self._place: IntArray = np.array([laws.INDEX[name] for name in model.names], dtype=np.int64)
        self._plan = _plan(record, entries)

    def _rows(self, values: FloatArray, position: npt.ArrayLike, velocity: npt.ArrayLike) -> FloatArray:
        rows = np.zeros((values.shape[0], self._place.size + 3))
        rows[:, :-3] = values
        rows[:, -3], rows[:, -2] = position, velocity
        return rows

    def positions(
        self, values: npt.ArrayLike, initial_position: float = 0.0, initial_velocity: float = 0.0
    ) -> FloatArray:
        """Readings (n,) [m] at the record's samples; NaN from where the motion leaves all bounds.

        Args:
            values: (p,) parameter values in the order of ``model.names``.
            initial_position, initial_velocity: state [m], [m/s] at the first sample.
        """
        return self.positions_many(np.asarray(values)[None, :], initial_position, initial_velocity).reshape(-1)

    def positions_many(
        self, values: npt.ArrayLike, initial_position: npt.ArrayLike, initial_velocity: npt.ArrayLike
    ) -> FloatArray:
        """The same for several vectors in one call: values (r, p), initial states (r,) each; gives (r, n)."""
        given = np.asarray(values, dtype=np.float64)
        if given.ndim != 2 or given.shape[1] != self._place.size:
            raise UsageError(f"values have shape {given.shape}; expected (any, {self._place.size})")
        return self._simulated(self._rows(given, initial_position, initial_velocity), _NOT_COMPARED)

    def residuals(self, rows: FloatArray, worst: float, root: FloatArray = _NOTHING) -> FloatArray:
        """Simulated readings less those of the record, for several vectors in one call.

        Args:
            rows: (r, p + 3) parameter values, then position [m], velocity [m/s] and zero [m] at the first sample. They
                must be contiguous.
            worst: largest size of an error [m]; that of a simulation which diverges.
            root: (n,) factor on each error; none at all means 1 each.

        Returns:
            (r, n).
        """
        return self._simulated(rows, (self.record.position, root, worst))

    def _simulated(self, rows: FloatArray, measured: tuple[FloatArray, FloatArray, float]) -> FloatArray:
        cancellation.raise_if_cancelled()
        out: FloatArray = np.empty((rows.shape[0], self.record.samples))
        self._run(self._bits, rows, self._place, self._plan, measured, out, out[:, :0])
        return out

    def trajectory(
        self, values: npt.ArrayLike, initial_position: float = 0.0, initial_velocity: float = 0.0
    ) -> Trajectory:
        """Position and velocity for the same arguments as ``positions``."""
        cancellation.raise_if_cancelled()
        row = self._rows(np.asarray(values, dtype=np.float64)[None, :], initial_position, initial_velocity)
        x, v = np.empty((1, self.record.samples)), np.empty((1, self.record.samples))
        self._run(self._bits, row, self._place, self._plan, _NOT_COMPARED, x, v)
        return Trajectory(self.record.time, x[0], v[0], self.record.force_at(self.record.time))


def simulate(model: Model, record: Record, initial_position: float = 0.0, initial_velocity: float = 0.0) -> Trajectory:
    """The model's motion under the record's force.

    Args:
        model: plant and effects.
        record: gives force and stamps; its positions are not used.
        initial_position: at the first sample, from the relaxed spring [m].
        initial_velocity: at the first sample [m/s].
    """
    return Simulator(model, record).trajectory(model.values, initial_position, initial_velocity)
