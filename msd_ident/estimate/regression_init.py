"""Starting values by linear regression: no simulation, no local minimum.

The equation of motion is linear in most parameters once x, v and a are known. Multiplied by a smooth bump φ and
integrated by parts over the bump, it needs no noisy second derivative (Shinbrot 1957; "weak form"):

    m ∫φ''x − b ∫φ'x + k ∫φx + Fc ∫φ sign(v) + c ∫φ = ∫φF

One equation for each place of the bump; least squares gives the parameters. Every column is smoothed by the same bump,
so the smoothing itself leaves no bias. The bump's width trades noise against detail; several are tried, and the caller
keeps the one whose simulation fits best.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.weak_form import LINEAR, TURNED, WIDTHS, Means, Rows, quarter, uniform
from msd_ident.model.base_model import OFFSET_FORCE, PLANT
from msd_ident.model.parameters import PARAMETERS

#: Those that take energy out of the motion, or push back: set to 0 where they come out negative.
_NOT_NEGATIVE = ("damping", *(name for name in LINEAR if name not in PLANT and PARAMETERS[name].lower == 0.0))


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


def _regress(rows: list[Rows], regression: Regression, held: list[bool]) -> dict[str, float] | None:
    """Least squares over all rows; values by name, and ``constant i`` for that of a record i that is not held.

    Where no zero is known, a sine from a zero has two factors in each record i: ``name i``, and a quarter turn on.
    """
    given = regression.given
    names = [name for name in LINEAR if name in given and name in regression.free]
    turned = [name for name in names if name in TURNED and regression.zero_free and not any(held)]
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
    own += [(f"{one} {i}", i, one) for name in turned for one in (name, quarter(name)) for i in range(len(rows))]
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
    restored = any(label.startswith(name) for label in labels for name in TURNED)
    negative = [name for name in (*_NOT_NEGATIVE, *["stiffness"] * restored) if values.get(name, 0.0) < 0.0]
    if negative:
        keep = [i for i, name in enumerate(labels) if name not in negative]
        rest = _solve(matrix[:, keep], right, [labels[i] for i in keep], given) if keep else {}
        return None if rest is None else {**rest, **dict.fromkeys(negative, 0.0)}
    if values.get("mass", 1.0) <= 0.0 or values.get("stiffness", 1.0) <= 0.0:
        return None
    return {**{name: given[name] for name in ("stiffness",) if name in given}, **values}


def _sizes(values: Mapping[str, float], name: str, count: int) -> list[float]:
    """Size of a sine in each record, from its two factors."""
    return [math.hypot(values[f"{name} {i}"], values[f"{quarter(name)} {i}"]) for i in range(count)]


def _zeros(values: Mapping[str, float], count: int) -> list[float]:
    """Zero of each record: of the spring, or of a sine whose slope is steeper than it."""
    stiffness = values.get("stiffness", 0.0)
    zeros = [-values.get(f"constant {i}", 0.0) / stiffness if stiffness > 0.0 else 0.0 for i in range(count)]
    for name in TURNED:
        if f"{name} 0" in values and values[name] > stiffness:  # G·sin(x − z) = G·cos(z)·sin(x) − G·sin(z)·cos(x)
            zeros = [math.atan2(-values[f"{quarter(name)} {i}"], values[f"{name} {i}"]) for i in range(count)]
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
