"""Free decay without force: where the free motion begins, and what it shows."""

from __future__ import annotations

import math

import numpy as np

from msd_ident.features import oscillation
from msd_ident.features.form import StandardForm
from msd_ident.features.response import SHORTEST, Noise, Response
from msd_ident.features.rest import is_quiet, rest_value
from msd_ident.features.swings import Extreme, extremes
from msd_ident.quantity import Quantity
from msd_ident.record import FloatArray, Record

#: Part of the record, at its end, that the rest value is read from.
_TAIL = 0.15
#: Part of the way to the middle, after a release, at which the speed is compared with that of a free motion.
_EARLY = 0.1
#: A hand that lets go slowly makes the cart slower there than this part of the free motion's speed.
_SLOW = 0.88
#: A half-swing may differ by this part from the others.
_HALF_OFF = 0.12
#: The largest excursion must be this many noise floors.
_CLEAR = 20.0


def free_decay(record: Record, noise: Noise) -> Response | None:
    """Features of a release without force; ``None`` when nothing swings.

    What comes before the free motion (a hand that pulls, holds and lets go) is left out.
    """
    turns = _swinging(_shrinking(extremes(record.time, record.position, noise.floor)))
    tail = record.position[-max(SHORTEST, int(_TAIL * record.samples)) :]
    settled = rest_value(tail, noise.floor, noise.unit) if is_quiet(tail, noise.floor, noise.step) else None
    found = oscillation.all_peaks(turns, settled, noise.unit)
    if found is None or abs(turns[0].value - found.middle.value) < _CLEAR * noise.floor:
        return None
    rest = settled or found.middle
    first = _release(record, turns, found, noise.floor)
    begin = float(record.position[first])
    return Response(
        onset=float(record.time[first]),
        amplitude=0.0,
        amplitude_std=0.0,
        initial=Quantity(begin, noise.floor, noise.unit),
        steady_state=rest,
        turns=turns,
        peaks=oscillation.two_peaks(turns, rest),
        swings=oscillation.swings(turns),
        shape=None,
        form=StandardForm(found.natural_frequency, found.damping_ratio, None),
    )


def _shrinking(turns: tuple[Extreme, ...]) -> tuple[Extreme, ...]:
    """From the turning point on after which the longest unbroken decay follows."""
    best: tuple[Extreme, ...] = ()
    for first in range(len(turns)):
        used = tuple(oscillation.significant(turns[first:]))
        if len(used) > 2 and (not best or _way(used) > _way(best)):
            best = used
    return best


def _swinging(turns: tuple[Extreme, ...]) -> tuple[Extreme, ...]:
    """Without a first turning point that is only the middle of the time for which a hand held the cart."""
    if len(turns) < 4:
        return turns
    gaps = np.diff([turn.time for turn in turns])
    half = float(np.median(gaps[1:]))
    return turns[1:] if abs(gaps[0] - half) > _HALF_OFF * half else turns


def _way(turns: tuple[Extreme, ...]) -> float:
    return abs(turns[1].value - turns[0].value)


def _release(record: Record, turns: tuple[Extreme, ...], found: oscillation.AllPeaks, floor: float) -> int:
    """Sample at which the free motion begins.

    That is the first turning point of the decay, or already the place it was let go from, if the cart left that
    place as fast as a free motion does.
    """
    turn = max(int(np.searchsorted(record.time, turns[0].time)) - 1, 0)
    before = record.position[: turn + 1]
    side = -turns[0].side
    height = side * (before - found.middle.value)
    start = _let_go(height, floor)
    if start is None:
        return turn
    early = start + int(np.flatnonzero(height[start:] <= (1.0 - _EARLY) * height[start])[0])
    # Energy gives the speed of a free motion; damping takes a part of it on the way, about 0.45 rad of the swing.
    undamped = found.natural_frequency.value * math.sqrt(float(height[start] ** 2 - height[early] ** 2))
    free = undamped * math.exp(-0.45 * found.damping_ratio.value)
    return start if _speed(record.time, height, early) > _SLOW * free else turn


def _let_go(height: FloatArray, floor: float) -> int | None:
    """Last sample before the first turning point that is still near the place of release; ``None`` without one."""
    far = np.flatnonzero(height > 0.0)
    if not far.size or far[0] == height.size - 1:
        return None
    # The last unbroken stay on the other side of the middle, and in it the last sample near its greatest height.
    stay = far[np.flatnonzero(np.diff(far) > 1)[-1] + 1 :] if np.any(np.diff(far) > 1) else far
    top = float(height[stay].max())
    near = stay[height[stay] >= top - max(0.02 * top, 3.0 * floor)]
    return int(near[-1])


def _speed(time: FloatArray, height: FloatArray, at: int) -> float:
    """Speed towards the middle at a sample, by a straight line through its neighbours."""
    reach = max(2, min(at, height.size - 1 - at, 5))
    window = slice(max(at - reach, 0), min(at + reach + 1, height.size))
    return -float(np.polynomial.polynomial.polyfit(time[window] - time[at], height[window], 1)[1])
