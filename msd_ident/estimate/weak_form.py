"""The rows of a regression of the equation of motion, smoothed by a bump (the weak form of ``regression_init``).

Which parameters enter linearly, a record's signals on even instants, and their sums over the bump at places where the
cart moves.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import SAMPLES
from msd_ident.estimate.levels import MOST_OF, NEGLIGIBLE
from msd_ident.estimate.windows import breadths
from msd_ident.model.base_model import OFFSET_FORCE, PLANT
from msd_ident.model.parameters import PARAMETERS
from msd_ident.tuning import tuned

#: What a column depends on first; columns stand in this order: friction, constant forces, drag, springs. Sums round
#: differently in another.
_SIGNALS = ("direction", "", "v", "x", "driven")


def _arguments(name: str) -> tuple[str, ...]:
    """Argument names of the regressor of a parameter; its quadrature has the same."""
    return tuple(inspect.signature(_regressor(name)).parameters)


def _regressor(name: str) -> Callable[..., FloatArray]:
    found = PARAMETERS[name].regressor
    assert found is not None
    return found


def _place(name: str) -> tuple[int, str]:
    """Where a parameter's column stands among those of effects."""
    return _SIGNALS.index(next(iter(_arguments(name)), "")), name


#: Parameters that enter the equation of motion linearly through something that x and v tell.
LINEAR = (*PLANT, *sorted((p.name for p in PARAMETERS.values() if p.regressor), key=_place))
#: Those of them whose force is a sine from a zero.
TURNED = tuple(name for name in LINEAR if name not in PLANT and PARAMETERS[name].quadrature)
#: Those of them that every regression has: the integrals of x by parts, and the constant.
_MOTION = (*PLANT, OFFSET_FORCE)
WIDTHS = tuned(
    (6, 16, 42, 110, 290),
    unit="samples",
    why="half widths of the bump, from little to much smoothing",
    chosen="by hand",
)


@dataclass(frozen=True)
class Rows:
    """Regression rows of one record: a column for each linear parameter, the constant, and the force."""

    columns: dict[str, FloatArray]
    constant: FloatArray
    force: FloatArray


@dataclass(frozen=True)
class Grid:
    """Position (less a level) and force of a record on uniform instants."""

    period: float
    position: FloatArray
    force: FloatArray


def uniform(record: Record, level: float) -> Grid:
    """A record on a uniform grid; a held force counts half before and half after its step."""
    period = record.duration / (record.samples - 1)
    time = record.time[0] + period * np.arange(record.samples)
    position = np.interp(time, record.time, record.position) - level
    if record.hold == "linear":
        return Grid(period, position, record.force_at(time))
    force = 0.5 * (record.force_at(time + 1e-3 * period) + record.force_at(time - 1e-3 * period))
    return Grid(period, position, force)


def _velocity(position: FloatArray, period: float, span: int) -> FloatArray:
    """Central differences over ``span`` samples either side, shorter at the ends."""
    span = min(span, position.size - 1)
    held = np.concatenate((np.full(span, position[0]), position, np.full(span, position[-1])))
    way: FloatArray = held[2 * span :] - held[: -2 * span]
    way /= period * breadths(position.size, span)
    return way


class Means:
    """A record's signals times a smooth bump, summed at places where the cart moves: columns (r,) of a regression.

    Attributes:
        grid: the signals on even instants.
        velocity, direction: (n,) [m/s], and its sign, 0 at rest.
        constant, force: columns of 1 and of the force.
    """

    def __init__(self, grid: Grid, half: int) -> None:
        period, position = grid.period, grid.position
        self.grid, self._half = grid, half
        self.velocity = velocity = _velocity(position, period, max(half // 2, 2))
        slow = max(NEGLIGIBLE * float(np.max(np.abs(velocity))), 1e-300)
        self.direction = np.where(np.abs(velocity) > slow, np.sign(velocity), 0.0)
        s = np.linspace(-1.0, 1.0, 2 * half + 1)
        self._bump = bump = (1.0 - s**2) ** 3
        # Derivatives of the bump as differences: then the sums by parts hold exactly for the differences of x.
        padded = np.concatenate(([0.0], bump, [0.0]))
        slope = (padded[2:] - padded[:-2]) / (2.0 * period)
        bend = (padded[2:] - 2.0 * bump + padded[:-2]) / period**2
        self._stride = max(half // 2, -(-position.size // SAMPLES))
        # Where the cart rests, dry friction is whatever balances the rest: such places say nothing about Fc.
        self._moving = self._over(np.abs(self.direction), bump)[:, 0] > MOST_OF * float(bump.sum())
        self._by_parts = (bend, -slope, bump)
        motion = self.plant_columns(position)
        self.constant = np.full(motion.shape[0], float(bump.sum()))
        self.force = self._over(grid.force, bump)[self._moving, 0]
        self._columns: dict[tuple[str, tuple[float, ...]], FloatArray] = {
            (name, ()): motion[:, i] for i, name in enumerate(PLANT)
        }
        self._columns[OFFSET_FORCE, ()] = self.constant

    def _over(self, signal: FloatArray, *weights: FloatArray) -> FloatArray:
        windows = sliding_window_view(signal, 2 * self._half + 1)[:: self._stride]
        return np.asarray(windows @ np.stack(weights, axis=1))

    def plant_columns(self, position: FloatArray) -> FloatArray:
        """Columns (r, 3) of inertia, damper and spring for a position (n,) [m] on the instants of the grid."""
        return self._over(position, *self._by_parts)[self._moving]

    def noise_gain(self, plant: tuple[float, float, float]) -> float:
        """What white noise of the position of 1 m rms makes of the sum of these columns, times mass, damping and
        stiffness: its rms.
        """
        return float(np.linalg.norm(np.stack(self._by_parts, axis=1) @ plant))

    def column(self, name: str, given: Mapping[str, float], *, quarter_on: bool = False) -> FloatArray:
        """Column (r,) of the regression: the smoothed signal that a parameter's force is proportional to.

        Args:
            name: parameter that enters the equation of motion linearly.
            given: values by name; they give the inner parameters of the law, if it has any.
            quarter_on: the quadrature of the signal in its place.
        """
        inner = () if name in PLANT else tuple(argument for argument in _arguments(name) if argument not in _SIGNALS)
        law = PARAMETERS[name].quadrature if quarter_on else None
        key = quarter(name) if law else name, tuple(given[argument] for argument in inner)
        if key not in self._columns:
            motion = {
                "direction": self.direction, "v": self.velocity, "x": self.grid.position,
                "driven": self.grid.force != 0.0,
            }  # fmt: skip
            signal = (law or _regressor(name))(**{one: motion.get(one, given.get(one)) for one in _arguments(name)})
            self._columns[key] = self._over(np.asarray(signal), self._bump)[self._moving, 0]
        return self._columns[key]

    def smoothed(self, signals: FloatArray) -> FloatArray:
        """Columns (r, s) of signals (s, n) on the instants of the grid."""
        windows = sliding_window_view(signals, 2 * self._half + 1, axis=1)[:, :: self._stride]
        return np.asarray((windows @ self._bump)[:, self._moving].T)

    def motion(self) -> FloatArray:
        """Columns (r, s) of what acts on every rig: inertia, damper, spring, constant force, dry friction and drag."""
        plain = [self._columns[name, ()] for name in _MOTION]
        drag = self.smoothed(np.stack([self.direction, self.velocity * np.abs(self.velocity)]))
        return np.column_stack([*plain, drag])

    def rows(self, names: Collection[str], given: Mapping[str, float]) -> Rows:
        """The rows of a regression.

        Args:
            names: parameters whose columns are needed beside those of the plant and the offset.
            given: values by name, for the inner parameters of the laws.
        """
        columns = {name: self.column(name, given) for name in (*_MOTION, *names)}
        columns |= {quarter(name): self.column(name, given, quarter_on=True) for name in names if name in TURNED}
        return Rows(columns, self.constant, self.force)


def quarter(name: str) -> str:
    """What the quadrature of a parameter's regressor is called."""
    return f"{name} a quarter turn on"
