"""Time cut into segments in which the force is one straight line, and the force on each."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.kernel.compiled import lean, making
from msd_ident.model.kernel.groups import Segments

#: Distinct segment lengths whose propagators are kept; other segments are propagated by series.
LENGTHS = 8
_ROUNDING = 1e-15


@lean
def _last_before(times, instant):
    """Index of the last of the rising times that is not after the instant; -1 if all are."""
    low, high = -1, times.size
    while high - low > 1:
        middle = (low + high) // 2
        if times[middle] <= instant:
            low = middle
        else:
            high = middle
    return low


@making
def merge(time, command):
    """Cut [time[0], time[-1]] at all samples and where the commanded force changes its course.

    Returns (start, length, kind, force_index, pick, lengths): start and length [s] of each of the N segments, the
    ``kind`` of its length (place in ``lengths``, -1 for an odd one), the force value that acts (-1: none yet), and
    for each sample the segment boundary, 0..N, that it falls on.
    """
    force_time, force, straight, shift = command
    most = time.size + force_time.size
    start, length = np.empty(most), np.empty(most)
    kind, force_index = np.empty(most, np.int8), np.empty(most, np.int64)
    pick = np.zeros(time.size, np.int64)
    lengths = np.zeros(LENGTHS)
    known = 0
    now = time[0]
    i = _last_before(force_time, now - shift + _ROUNDING * abs(now))
    count, j = 0, 1
    while j < time.size:
        while not straight and i >= 0 and i + 1 < force_time.size and force[i + 1] == force[i]:
            i += 1
        stamp = force_time[i + 1] + shift if i + 1 < force_time.size else math.inf
        end = min(time[j], stamp)
        close = 4.0 * _ROUNDING * (1.0 + abs(end))
        if end - now > close:
            h = end - now
            start[count], length[count], force_index[count] = now, h, i
            kind[count] = -1
            for n in range(known):
                if abs(h - lengths[n]) <= close:
                    kind[count] = n
                    break
            if kind[count] < 0 and known < LENGTHS:
                lengths[known] = h
                kind[count] = known
                known += 1
            count += 1
            now = end
        if stamp - end <= close:
            i += 1
        if time[j] - end <= close:
            pick[j] = count
            j += 1
    return start[:count], length[:count], kind[:count], force_index[:count], pick, lengths[:known]


@lean
def force_lines(start, force_index, command, level, slope):
    """Fill the force at the start of each segment, ``level`` [N], and its ``slope`` [N/s] (where straight)."""
    force_time, force, straight, shift = command
    last = force_time.size - 1
    for j in range(start.size):
        i = force_index[j]
        if i < 0:
            level[j] = 0.0
            if straight:
                slope[j] = 0.0
        elif not straight:
            level[j] = force[i]
        elif i == last:
            level[j] = force[i]
            slope[j] = 0.0
        else:
            slope[j] = (force[i + 1] - force[i]) / (force_time[i + 1] - force_time[i])
            level[j] = force[i] + slope[j] * (start[j] - shift - force_time[i])


@lean
def lagged_start(start, command, tau):
    """The lagged force [N] when the record starts [s], from the stamps before it.

    A first stamp before the record is a force that has acted for long (a record cut out of a longer one); otherwise
    there was none before it.
    """
    force_time, force, straight, shift = command
    lagged = force[0] if force_time[0] < start else 0.0
    for i in range(force_time.size):
        begin = force_time[i] + shift
        if begin >= start - _ROUNDING * (1.0 + abs(start)):
            break
        end, rise = start, 0.0
        if i + 1 < force_time.size:
            end = min(end, force_time[i + 1] + shift)
            if straight:
                rise = (force[i + 1] - force[i]) / (force_time[i + 1] - force_time[i])
        level = force[i] - rise * tau
        lagged = level + rise * (end - begin) + (lagged - level) * math.exp(-(end - begin) / tau)
    return lagged


@lean
def lag(segments, tau, at_start):
    """First-order lag: replace each segment's line by level + slope t + transient exp(-t/tau).

    ``at_start`` [N] is the lagged force when the first segment begins.
    """
    length, level, slope, transient = segments.length, segments.level, segments.slope, segments.transient
    steep = slope.size > 0
    force = at_start
    last_length, fade = -1.0, 0.0
    for j in range(length.size):
        h = length[j]
        if h != last_length:
            last_length, fade = h, math.exp(-h / tau)
        rise = slope[j] if steep else 0.0
        level[j] -= rise * tau
        transient[j] = force - level[j]
        force = level[j] + rise * h + transient[j] * fade


@making
def walked_where_long(segments, longest):
    """The same segments; those longer than ``longest`` [s] count as odd ones, so they are walked event by event."""
    if not np.any(segments.lengths > longest):
        return segments
    kind = segments.kind.copy()
    for j in range(kind.size):
        if segments.length[j] > longest:
            kind[j] = -1
    start, length, _, lengths, level, slope, transient, decay = segments
    return Segments(start, length, kind, lengths, level, slope, transient, decay)
