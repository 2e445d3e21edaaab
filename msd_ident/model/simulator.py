"""Simulator: the positions that an encoder would read, from a model and a record's force."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident import cancellation
from msd_ident.data.record import Record
from msd_ident.errors import UsageError
from msd_ident.model import solver
from msd_ident.model.kernel import places
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
#: What ``run.compare`` leaves readings as they are with.
_NOT_COMPARED = (np.empty(0), _NOTHING, 0.0, math.inf)


def warm_up(say: Callable[[str], None] | None = None) -> None:
    """Make sure that the solver is compiled and loaded; ``say``, or stderr, is told in one line if that takes long."""
    solver.LIBRARY.load(say)


class Simulator:
    """A model's structure and a record's force, ready to be simulated many times.

    Calls are thread-safe and release the GIL. ``values`` are in the order of ``model.names``; values of the
    model itself are not used. Each call asks first whether the work should stop (``msd_ident.cancellation``).

    Args:
        model: plant and effects.
        record: gives force and stamps, and the readings of ``residuals``.
        slack: factor on the errors that steps of nonlinear laws may have.
    """

    def __init__(self, model: Model, record: Record, slack: float = 1.0) -> None:
        self.model = model
        self.record = record
        self.slack = slack
        self._bits = places.bits(*model.effect_names)
        self._place: IntArray = np.array([places.INDEX[name] for name in model.names], dtype=np.int64)
        self._plan = solver.plan(record)

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

    def residuals(self, rows: FloatArray, worst: float, reach: float, root: FloatArray = _NOTHING) -> FloatArray:
        """Simulated readings less those of the record, for several vectors in one call.

        Args:
            rows: (r, p + 3) parameter values, then position [m], velocity [m/s] and zero [m] at the first sample. They
                must be contiguous.
            worst: largest size of an error [m]; that of a simulation which diverges.
            reach: distance [m] from where it begins at which a motion of nonlinear laws counts as one that diverges.
            root: (n,) factor on each error; none at all means 1 each.

        Returns:
            (r, n).
        """
        return self._simulated(rows, (self.record.position, root, worst, reach))

    def _simulated(self, rows: FloatArray, measured: tuple[FloatArray, FloatArray, float, float]) -> FloatArray:
        cancellation.raise_if_cancelled()
        out: FloatArray = np.empty((rows.shape[0], self.record.samples))
        solver.run((self._bits, self._place), rows, self._plan, (*measured, self.slack), (out, out[:, :0]))
        return out

    def trajectory(
        self, values: npt.ArrayLike, initial_position: float = 0.0, initial_velocity: float = 0.0
    ) -> Trajectory:
        """Position and velocity for the same arguments as ``positions``."""
        cancellation.raise_if_cancelled()
        row = self._rows(np.asarray(values, dtype=np.float64)[None, :], initial_position, initial_velocity)
        x, v = np.empty((1, self.record.samples)), np.empty((1, self.record.samples))
        solver.run((self._bits, self._place), row, self._plan, (*_NOT_COMPARED, self.slack), (x, v))
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
