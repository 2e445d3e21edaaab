"""How the cart moves, as far as the samples show it without a model: span, turning points, onset, standstills."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from msd_ident.data.noise import noise_of
from msd_ident.data.record import FloatArray, Record


@dataclass(frozen=True)
class Standstill:
    """A stretch of equal readings that the cart entered at speed.

    Attributes:
        first: index of the first of the equal readings.
        size: how many there are.
        value: the reading.
    """

    first: int
    size: int
    value: float


@dataclass(frozen=True)
class Motion:
    """What can be seen of the motion.

    Attributes:
        span: highest minus lowest position.
        rest_span: span that noise and rounding may have without any motion.
        step: encoder step, 0 when there is none.
        floor: standard deviation of the measurement noise.
        force_span: highest minus lowest force while the position was recorded.
        half_period: median time between turning points [s], 0 when there are fewer than four.
        onset: when the cart leaves its first place [s]; NaN when it does not begin at rest and without force.
        early: time by which the motion begins before the force first changes [s]; NaN when that cannot be said,
            as when the record does not begin at rest and without force.
        late: time by which it begins after a force step [s]; NaN likewise.
        standstills: stretches of equal readings, entered at speed.
    """

    span: float
    rest_span: float
    step: float
    floor: float
    force_span: float
    half_period: float
    onset: float
    early: float
    late: float
    standstills: tuple[Standstill, ...]

    @property
    def still(self) -> bool:
        """Whether the readings scatter no more than noise and rounding make those of a cart at rest."""
        return self.span <= self.rest_span

    @property
    def mass(self) -> float:
        """Mass that the force would move about as far and as fast [kg in SI]; NaN when nothing oscillates.

        A rough value: right within a factor of 2 after a force step, too high for slow pushing, too low at resonance.
        """
        if not self.half_period or not self.force_span or not self.span:
            return math.nan
        return self.force_span / (self.span * (math.pi / self.half_period) ** 2)


def observe(record: Record) -> Motion:
    """Motion of a record."""
    noise = noise_of(record)
    floor, step = noise.floor, noise.step
    position = record.position
    span = float(np.ptp(position))
    turns = turning_points(position, max(12 * floor, 3.5 * step, 0.02 * span))
    half_period = float(np.median(np.diff(record.time[turns]))) if turns.size >= 4 else 0.0
    onset, early, late = _onset(record, max(6 * floor, 2.5 * step, 0.02 * span), floor, step)
    return Motion(
        span=span,
        rest_span=2 * floor * (1 + math.sqrt(2 * math.log(record.samples))) + 2 * step,
        step=step,
        floor=floor,
        force_span=_force_span(record),
        half_period=half_period,
        onset=onset,
        early=early,
        late=late,
        standstills=_standstills(position, step),
    )


def turning_points(position: FloatArray, swing: float) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Indices at which the position turns around.

    Args:
        position: (n,).
        swing: least distance between neighbouring turning points, in the position's unit.
    """
    change = np.flatnonzero(np.diff(position))
    rising = np.diff(position)[change] > 0
    extremes = change[1:][rising[1:] != rising[:-1]]
    candidates = [0, *extremes.tolist(), position.size - 1]
    values = position[candidates].tolist()
    found: list[int] = []
    low = high = 0
    direction = 0
    for i, value in enumerate(values):
        low = i if value < values[low] else low
        high = i if value > values[high] else high
        if direction >= 0 and value <= values[high] - swing:
            found.append(candidates[high])
            direction, low = -1, i
        elif direction <= 0 and value >= values[low] + swing:
            found.append(candidates[low])
            direction, high = 1, i
    return np.array(found[1:] if direction else [], dtype=np.intp)


def _force_span(record: Record) -> float:
    """Span of the force from the first to the last position sample, the 0 before its first stamp included."""
    inside = (record.force_time >= record.time[0]) & (record.force_time <= record.time[-1])
    before = record.force_at([np.nextafter(record.time[0], -np.inf), record.time[-1]])
    return float(np.ptp(np.concatenate([before, record.force[inside]])))


def _onset(record: Record, threshold: float, floor: float, step: float) -> tuple[float, float, float]:
    """When the motion begins, and by which time before the force changes and after a force step; NaN where unknown."""
    moved = np.flatnonzero(np.abs(record.position - np.median(record.position[:5])) > threshold)
    span = _force_span(record)
    at_start = float(record.force_at(record.time[:1])[0])
    # A force that acts from the first sample on may have set the cart in motion by itself.
    if not moved.size or moved[0] < 10 or abs(at_start) > 0.005 * span or span == 0:
        return math.nan, math.nan, math.nan
    begin = record.position[: moved[0] // 2]
    if np.std(begin) > 2 * floor + step:
        return math.nan, math.nan, math.nan
    onset = float(record.time[moved[0]])
    change = np.abs(record.force - at_start)
    inside = record.force_time > record.time[0]
    first = record.force_time[inside & (change > 0.005 * span)]
    early = float(first[0]) - onset if first.size else math.nan
    stepped = record.force_time[inside & (change > 0.6 * span)]
    # Only a step, from little to much at once, says when the cart must move; a ramp may have to overcome friction.
    sudden = stepped.size and first.size and stepped[0] - first[0] < 2 * record.period
    return onset, early, (onset - float(stepped[0]) if sudden else math.nan)


def _standstills(position: FloatArray, step: float) -> tuple[Standstill, ...]:
    """Stretches of at least five equal readings that were entered without slowing down first.

    The last difference before the stretch may be cut short by it, so the two before are compared: a cart that
    friction stops loses speed from sample to sample (1 : 3 : 5 for a constant force).
    """
    difference = np.abs(np.diff(position))
    moves = np.flatnonzero(difference)
    if moves.size < 20:
        return ()
    fast = max(5 * step, 0.2 * float(np.percentile(difference[moves], 95)))
    last = np.concatenate([moves, [position.size - 1]])
    size = np.diff(last)  # readings from one change to the next
    found = []
    for i in np.flatnonzero(size >= 5).tolist():
        before = moves[i]
        if before < 3:
            continue
        near, far = difference[before - 1], difference[before - 2]
        if near >= fast and near >= 0.85 * far:
            found.append(Standstill(int(before) + 1, int(size[i]), float(position[before + 1])))
    return tuple(found)
