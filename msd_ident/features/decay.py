"""Free decay without force: where the free motion begins, and what it shows."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from msd_ident.data.record import Record
from msd_ident.features import oscillation
from msd_ident.features.form import StandardForm
from msd_ident.features.release import release
from msd_ident.features.response import SHORTEST, Noise, Response
from msd_ident.features.rest import is_quiet, rest_value
from msd_ident.features.swings import Extreme, extremes
from msd_ident.quantity import Quantity

#: Part of the record, at its end, that the rest value is read from.
_TAIL = 0.15
#: A half-swing may differ by this part from the others.
_HALF_OFF = 0.12
#: The largest excursion must be this many noise floors.
_CLEAR = 20.0


def free_decay(record: Record, noise: Noise) -> Response | None:
    """Features of a release without force.

    The part before the free motion (a hand that pulls, holds and lets go) is left out.

    Args:
        record: without a force that varies.
        noise: noise floor and encoder step of the record.

    Returns:
        None if nothing swings.
    """
    turns = _swinging(_shrinking(extremes(record.time, record.position, noise.floor)))
    tail = record.position[-max(SHORTEST, int(_TAIL * record.samples)) :]
    settled = rest_value(tail, noise.floor, noise.unit) if is_quiet(tail, noise.floor, noise.step) else None
    first = release(record, turns)
    turns = turns if first is None else _after(turns, float(record.time[first]))
    found = oscillation.all_peaks(turns, settled, noise.unit)
    if found is None or abs(turns[0].value - found.middle.value) < _CLEAR * noise.floor:
        return None
    rest = settled or found.middle
    if first is None:
        first = max(int(np.searchsorted(record.time, turns[0].time)) - 1, 0)
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


def _after(turns: tuple[Extreme, ...], start: float) -> tuple[Extreme, ...]:
    """Turning points from ``start`` [s] on, if three are left to tell a decrement; else all."""
    free = tuple(turn for turn in turns if turn.time >= start)
    return free if len(free) > 2 else turns


def _shrinking(turns: tuple[Extreme, ...]) -> tuple[Extreme, ...]:
    """The unbroken decay on which the cart goes the longest way: a hand moves it to and fro a few times at most."""
    runs = [tuple(oscillation.significant(turns[first:])) for first in range(len(turns))]
    return max((run for run in runs if len(run) > 2), key=_way, default=())


def _swinging(turns: tuple[Extreme, ...]) -> tuple[Extreme, ...]:
    """Without a first turning point that is only the middle of the time for which a hand held the cart."""
    if len(turns) < 4:
        return turns
    gaps = np.diff([turn.time for turn in turns])
    half = float(np.median(gaps[1:]))
    return turns[1:] if abs(gaps[0] - half) > _HALF_OFF * half else turns


def _way(turns: tuple[Extreme, ...]) -> float:
    """Way from the first turning point to the last, to and fro."""
    return sum(abs(two.value - one.value) for one, two in pairwise(turns))
