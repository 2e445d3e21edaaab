"""Ranges of the effects' parameters that a record's samples can resolve.

A pitch finer than the noise, a frequency above half the sampling rate or a stop out of reach changes nothing in the
data. A search that gets there finds nothing, and its simulations need very short solver steps. Each effect knows its
own ranges.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import Record
from msd_ident.estimate.levels import TENTH
from msd_ident.estimate.problem import Problem
from msd_ident.model import Effect, Model
from msd_ident.model.declarations import RecordScales
from msd_ident.model.effects import LIBRARY


def ranges(records: Sequence[Record], plant: Model) -> dict[str, tuple[float, float]]:
    """Ranges of the effects' parameters that the samples can resolve.

    Args:
        records: the records of one experiment.
        plant: a model whose mass and stiffness are roughly known.

    Returns:
        Lower and upper limit by parameter name, in the records' units, over all effects of the library.
    """
    return of_laws(LIBRARY, seen(records, plant))


def of_laws(effects: Iterable[type[Effect]], shown: RecordScales) -> dict[str, tuple[float, float]]:
    """Ranges of the effects' parameters by name; of two laws with one parameter the later one's counts.

    Args:
        effects: the laws.
        shown: scales of the records.
    """
    return {name: limits for effect in effects for name, limits in effect.resolvable(shown).items()}


def seen(records: Sequence[Record], plant: Model) -> RecordScales:
    """Scales of a set of records: duration, sample period, range, top speed, largest force.

    Args:
        records: the records of one experiment.
        plant: a model whose mass and stiffness are roughly known.

    Returns:
        The scales. The rate is the natural frequency of the plant, but at least that of five swings in the longest
        record. Without a force, the force is mass · span · rate².
    """
    mass, stiffness = plant.mass, plant.stiffness
    span = max(float(np.ptp(record.position)) for record in records)
    duration = max(record.duration for record in records)
    rate = max(np.sqrt(stiffness / mass), 10.0 * np.pi / duration)  # of the plant's motion, or of a few swings
    force = max(float(np.max(np.abs(record.force))) for record in records)
    return RecordScales(
        mass=mass,
        stiffness=stiffness,
        reach=max(float(np.max(np.abs(record.position))) for record in records),
        span=span,
        duration=duration,
        period=min(record.period for record in records),
        speed=max(_top_speed(record) for record in records),
        rate=rate,
        force=force or mass * span * rate**2,
        driven=force > 0.0,
        weakest=_weakest(records),
        acceleration=max(_acceleration(record) for record in records),
    )


def _weakest(records: Sequence[Record]) -> float:
    """The force [N] that is not exceeded for a ``TENTH`` of the time in which any acts; 0 without a force."""
    sizes = np.concatenate([np.abs(record.force_at(record.time)) for record in records])
    acting = sizes[sizes > 0.0]
    return float(np.quantile(acting, TENTH)) if acting.size else 0.0


def _acceleration(record: Record) -> float:
    """√2 times the root mean square of the acceleration [m/s²], from second differences over two samples."""
    step = 2 * record.period
    bends = record.position[4:] - 2.0 * record.position[2:-2] + record.position[:-4]
    return math.sqrt(2.0 * float(np.mean(bends**2))) / step**2


def _top_speed(record: Record) -> float:
    stretch = max(record.samples // 300, 1)
    rise = np.abs(record.position[stretch:] - record.position[:-stretch])
    return float(np.max(rise / (record.time[stretch:] - record.time[:-stretch])))


def within(problem: Problem, limits: dict[str, tuple[float, float]]) -> Problem:
    """The problem with its bounds narrowed.

    Args:
        problem: its bounds of parameters without a limit stay.
        limits: lower and upper limit by parameter name, as ``ranges`` gives them.
    """
    lower, upper = problem.lower.copy(), problem.upper.copy()
    for place, index in enumerate(problem.free):
        low, high = limits.get(problem.model.names[index], (-np.inf, np.inf))
        lower[place], upper[place] = max(lower[place], low), min(upper[place], high)
    return replace(problem, lower=lower, upper=upper)
