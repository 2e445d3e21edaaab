"""Noise floor of a set of records: what no model can beat, and what repeated experiments say about it."""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.quality import noise_floor as floor_of
from msd_ident.data.record import FloatArray, Record


def noise_floor(records: tuple[Record, ...]) -> float:
    """Pooled standard deviation [m] of the measurement noise of several records; NaN if no record shows it.

    It comes from rest phases and the encoder step. If the same experiment was run twice, the scatter between the runs
    is used where it is larger; it also contains what the rig does not repeat.
    """
    own = [(floor_of(record), record.samples) for record in records]
    told = [(floor, samples) for floor, samples in own if math.isfinite(floor) and floor > 0.0]
    if not told:
        return repeat_scatter(records)
    pooled = math.sqrt(sum(n * floor**2 for floor, n in told) / sum(n for _, n in told))
    scatter = repeat_scatter(records)
    return max(pooled, scatter) if math.isfinite(scatter) else pooled


def repeat_scatter(records: tuple[Record, ...]) -> float:
    """Standard deviation [m] between records with the same force at the same stamps; NaN without such repeats.

    Each record's mean is subtracted first, because the zero may differ from run to run.
    """
    squares, freedom = 0.0, 0
    for group in _repeats(records):
        stack = np.stack([position - position.mean() for position in group])
        squares += float(np.sum((stack - stack.mean(axis=0)) ** 2))
        freedom += (len(group) - 1) * (stack.shape[1] - 1)
    return math.sqrt(squares / freedom) if freedom else math.nan


def _repeats(records: tuple[Record, ...]) -> list[list[FloatArray]]:
    groups: list[tuple[Record, list[FloatArray]]] = []
    for record in records:
        for first, members in groups:
            if _same_experiment(first, record):
                members.append(record.position)
                break
        else:
            groups.append((record, [record.position]))
    return [members for _, members in groups if len(members) > 1]


def _same_experiment(one: Record, other: Record) -> bool:
    if one.samples != other.samples or one.hold != other.hold or not np.any(one.force):
        return False
    tick = 0.1 * one.period
    if float(np.max(np.abs(one.time - other.time))) > tick:
        return False
    return bool(np.array_equal(one.force_at(one.time + tick), other.force_at(other.time + tick)))
