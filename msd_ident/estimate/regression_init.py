"""Starting values by linear regression: no simulation, no local minimum.

The equation of motion is linear in most parameters once x, v and a are known. Multiplied by a smooth bump φ and
integrated by parts over the bump, it needs no noisy second derivative (Shinbrot 1957; "weak form"):

    m ∫φ''x − b ∫φ'x + k ∫φx + Fc ∫φ sign(v) + c ∫φ = ∫φF

One equation for each place of the bump; least squares gives the parameters. Every column is smoothed by the same bump,
so the smoothing itself leaves no bias. The bump's width trades noise against detail; several are tried, and the caller
keeps the one whose simulation fits best.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import partial

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
_TURNED = tuple(name for name in LINEAR if name not in PLANT and PARAMETERS[name].quadrature)
#: Those of them that every regression has: the integrals of x by parts, and the constant.
_MOTION = (*PLANT, OFFSET_FORCE)
#: Those that take energy out of the motion, or push back: set to 0 where they come out negative.
_NOT_NEGATIVE = ("damping", *(name for name in LINEAR if name not in PLANT and PARAMETERS[name].lower == 0.0))
WIDTHS = tuned(
    (6, 16, 42, 110, 290),
    unit="samples",
    why="half widths of the bump, from little to much smoothing",
    chosen="by hand",
)


@dataclass(frozen=True)
class Start:
    """Result of a regression.

    Attributes:
        values: parameter values by name.
        initial: for each record its position [m], velocity [m/s] and zero [m] at the first sample.
    """

    values: Mapping[str, float]
    initial: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class _Rows:
    """Regression rows of one record: a column for each linear parameter, the constant, and the force."""

    columns: dict[str, FloatArray]
    constant: FloatArray
    force: FloatArray


@dataclass(frozen=True)
class Regression:
    """What to regress.

    Attributes:
        given: value of every parameter of the model; fixed ones keep it.
        free: names of the parameters to estimate.
        zero_free: whether each record has an unknown zero, which shows as a constant force of its own.
        relaxed: per record, whether it begins at rest without force, so that its first reading is about its zero.
    """

    given: Mapping[str, float]
    free: Collection[str]
    zero_free: bool
    relaxed: tuple[bool, ...]


def candidates(records: tuple[Record, ...], regression: Regression) -> list[Start]:
    """Starting values by linear regression, one start for each width of the bump.

    Args:
        records: the records, which share the parameters.
        regression: what to estimate and what is given.

    Returns:
        At most as many starts as there are widths. A width is left out if the bump is longer than a third of the
        shortest record, or if the regression fails (too few rows, or a mass or stiffness that is not positive).
    """
    shortest = min(record.samples for record in records)
    steady = regression.zero_free and all(_steady(record) for record in records)
    # Under one constant force an unknown zero takes all of it; only rest at the start can tell the two apart.
    held = [steady and relaxed for relaxed in regression.relaxed]
    levels = [float(record.position[0]) if hold else 0.0 for record, hold in zip(records, held, strict=True)]
    grids = [
        record.kept(("grid", level), partial(uniform, record, level))
        for record, level in zip(records, levels, strict=True)
    ]
    states = [record.kept("starting state", partial(starting_state, record)) for record in records]
    names = [name for name in LINEAR if name in regression.given]
    found = []
    for half in WIDTHS:
        if 2 * half + 1 > shortest // 3:
            break
        smoothed = [
            record.kept(("means", level, half), partial(Means, grid, half))
            for record, grid, level in zip(records, grids, levels, strict=True)
        ]
        values = _regress([means.rows(names, regression.given) for means in smoothed], regression, held)
        if values is None:
            continue
        zeros = [zero + level for zero, level in zip(_zeros(values, len(records)), levels, strict=True)]
        initial = tuple((x - zero, v, zero) for (x, v), zero in zip(states, zeros, strict=True))
        shared = {name: values.get(name, value) for name, value in regression.given.items()}
        found.append(Start(shared, initial))
    return found


def _steady(record: Record) -> bool:
    """Whether one constant force acts but for the first fiftieth of the record."""
    return float(np.ptp(record.force_at(record.time[record.samples // 50 + 2 :]))) == 0.0


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
        constant, force: columns of 1 and of the force.
    """

    def __init__(self, grid: Grid, half: int) -> None:
        period, position = grid.period, grid.position
        self.grid, self._half = grid, half
        self._velocity = velocity = _velocity(position, period, max(half // 2, 2))
        slow = max(NEGLIGIBLE * float(np.max(np.abs(velocity))), 1e-300)
        self._direction = np.where(np.abs(velocity) > slow, np.sign(velocity), 0.0)
        s = np.linspace(-1.0, 1.0, 2 * half + 1)
        self._bump = bump = (1.0 - s**2) ** 3
        # Derivatives of the bump as differences: then the sums by parts hold exactly for the differences of x.
        padded = np.concatenate(([0.0], bump, [0.0]))
        slope = (padded[2:] - padded[:-2]) / (2.0 * period)
        bend = (padded[2:] - 2.0 * bump + padded[:-2]) / period**2
        self._stride = max(half // 2, -(-position.size // SAMPLES))
        # Where the cart rests, dry friction is whatever balances the rest: such places say nothing about Fc.
        self._moving = self._over(np.abs(self._direction), bump)[:, 0] > MOST_OF * float(bump.sum())
        motion = self._over(position, bend, -slope, bump)[self._moving]
        self.constant = np.full(motion.shape[0], float(bump.sum()))
        self.force = self._over(grid.force, bump)[self._moving, 0]
        self._columns: dict[tuple[str, tuple[float, ...]], FloatArray] = {
            (name, ()): motion[:, i] for i, name in enumerate(PLANT)
        }
        self._columns[OFFSET_FORCE, ()] = self.constant

    def _over(self, signal: FloatArray, *weights: FloatArray) -> FloatArray:
        windows = sliding_window_view(signal, 2 * self._half + 1)[:: self._stride]
        return np.asarray(windows @ np.stack(weights, axis=1))

    def column(self, name: str, given: Mapping[str, float], *, quarter_on: bool = False) -> FloatArray:
        """Column (r,) of the regression: the smoothed signal that a parameter's force is proportional to.

        Args:
            name: parameter that enters the equation of motion linearly.
            given: values by name; they give the inner parameters of the law, if it has any.
            quarter_on: the quadrature of the signal in its place.
        """
        inner = () if name in PLANT else tuple(argument for argument in _arguments(name) if argument not in _SIGNALS)
        law = PARAMETERS[name].quadrature if quarter_on else None
        key = _quarter(name) if law else name, tuple(given[argument] for argument in inner)
        if key not in self._columns:
            motion = {
                "direction": self._direction, "v": self._velocity, "x": self.grid.position,
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
        drag = self.smoothed(np.stack([self._direction, self._velocity * np.abs(self._velocity)]))
        return np.column_stack([*plain, drag])

    def rows(self, names: Collection[str], given: Mapping[str, float]) -> _Rows:
        """The rows of a regression.

        Args:
            names: parameters whose columns are needed beside those of the plant and the offset.
            given: values by name, for the inner parameters of the laws.
        """
        columns = {name: self.column(name, given) for name in (*_MOTION, *names)}
        columns |= {_quarter(name): self.column(name, given, quarter_on=True) for name in names if name in _TURNED}
        return _Rows(columns, self.constant, self.force)


def _regress(rows: list[_Rows], regression: Regression, held: list[bool]) -> dict[str, float] | None:
    """Least squares over all rows; values by name, and ``constant i`` for that of a record i that is not held.

    Where no zero is known, a sine from a zero has two factors in each record i: ``name i``, and a quarter turn on.
    """
    given = regression.given
    names = [name for name in LINEAR if name in given and name in regression.free]
    turned = [name for name in names if name in _TURNED and regression.zero_free and not any(held)]
    plain = bool(turned) and "stiffness" not in names and given.get("stiffness", 0.0) == 0.0
    loose = regression.zero_free and OFFSET_FORCE not in names and not plain
    constants = [i for i in range(len(rows)) if loose and not held[i]]
    right = np.concatenate([part.force for part in rows])
    if not any(_pushes(part.force, i in constants or OFFSET_FORCE in names) for i, part in enumerate(rows)):
        names = [name for name in names if name != "mass"]  # nothing sets the scale, so the mass keeps its value
    for name in LINEAR:
        if name in given and name not in names:
            right = right - given[name] * np.concatenate([part.columns[name] for part in rows])
    names = [name for name in names if name not in turned]
    matrix = [np.concatenate([part.columns[name] for part in rows]) for name in names]
    own = [(f"constant {i}", i, OFFSET_FORCE) for i in constants]
    own += [(f"{one} {i}", i, one) for name in turned for one in (name, _quarter(name)) for i in range(len(rows))]
    for _, i, column in own:
        parts = [part.columns[column] if j == i else np.zeros(part.constant.size) for j, part in enumerate(rows)]
        matrix.append(np.concatenate(parts))
    labels = names + [label for label, _, _ in own]
    if not labels or right.size < 2 * len(labels):
        return None
    values = _solve(np.stack(matrix, axis=1), right, labels, given)
    if values is None:
        return None
    return {**values, **{name: float(np.mean(_sizes(values, name, len(rows)))) for name in turned}}


def _pushes(force: FloatArray, constant: bool) -> bool:
    """Whether the force differs from nothing, or from a constant where one is free."""
    if not force.size:
        return False
    change = float(np.ptp(force)) if constant else float(np.max(np.abs(force)))
    return change > 1e-3 * float(np.max(np.abs(force)))


def _solve(
    matrix: FloatArray, right: FloatArray, labels: list[str], given: Mapping[str, float]
) -> dict[str, float] | None:
    """Least squares with unit columns; dissipative forces that come out negative are zeroed and the rest redone.

    So is the spring beside a sine from a zero, which may be all that restores; else a negative spring is no start.
    """
    size = np.linalg.norm(matrix, axis=0)
    size[size == 0.0] = 1.0
    solution = np.linalg.lstsq(matrix / size, right, rcond=1e-10)[0] / size
    values = dict(zip(labels, (float(value) for value in solution), strict=True))
    restored = any(label.startswith(name) for label in labels for name in _TURNED)
    negative = [name for name in (*_NOT_NEGATIVE, *["stiffness"] * restored) if values.get(name, 0.0) < 0.0]
    if negative:
        keep = [i for i, name in enumerate(labels) if name not in negative]
        rest = _solve(matrix[:, keep], right, [labels[i] for i in keep], given) if keep else {}
        return None if rest is None else {**rest, **dict.fromkeys(negative, 0.0)}
    if values.get("mass", 1.0) <= 0.0 or values.get("stiffness", 1.0) <= 0.0:
        return None
    return {**{name: given[name] for name in ("stiffness",) if name in given}, **values}


def _quarter(name: str) -> str:
    """What the quadrature of a parameter's regressor is called."""
    return f"{name} a quarter turn on"


def _sizes(values: Mapping[str, float], name: str, count: int) -> list[float]:
    """Size of a sine in each record, from its two factors."""
    return [math.hypot(values[f"{name} {i}"], values[f"{_quarter(name)} {i}"]) for i in range(count)]


def _zeros(values: Mapping[str, float], count: int) -> list[float]:
    """Zero of each record: of the spring, or of a sine whose slope is steeper than it."""
    stiffness = values.get("stiffness", 0.0)
    zeros = [-values.get(f"constant {i}", 0.0) / stiffness if stiffness > 0.0 else 0.0 for i in range(count)]
    for name in _TURNED:
        if f"{name} 0" in values and values[name] > stiffness:  # G·sin(x − z) = G·cos(z)·sin(x) − G·sin(z)·cos(x)
            zeros = [math.atan2(-values[f"{_quarter(name)} {i}"], values[f"{name} {i}"]) for i in range(count)]
    return zeros


def starting_state(record: Record, count: int = 15) -> tuple[float, float]:
    """Position [m] and velocity [m/s] at the first sample, from a parabola through the first samples.

    Args:
        record: the measurement.
        count: number of samples of the parabola; all if the record has fewer.
    """
    count = min(count, record.samples)
    time = record.time[:count] - record.time[0]
    _, velocity, position = np.polyfit(time / time[-1], record.position[:count], 2)
    return float(position), float(velocity) / float(time[-1])
