"""Free decay without force: the release, from which on no hand acts on the cart, and what the free motion shows.

A hand that pulls adds energy, one that holds carries the spring's force, and a free decay does neither. The law of the
decay (acceleration against position, velocity and its sign) is regressed from the later swings; what the acceleration
departs from it is the force of the hand per mass. The release is the end of the last stretch of such a force up to the
greatest energy. What the rig itself does in the same way later, e.g. at an end stop, is no hand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from msd_ident.data.noise import Noise
from msd_ident.data.record import FloatArray, Record
from msd_ident.features import oscillation
from msd_ident.features.form import StandardForm
from msd_ident.features.let_go import let_go
from msd_ident.features.response import Response
from msd_ident.features.rest_and_turns import Extreme, extremes, settled_value
from msd_ident.quantity import MAD, Quantity

#: A half-swing may differ by this part from the others.
_HALF_OFF = 0.12
#: The largest excursion must be this many noise floors.
_CLEAR = 20.0
#: A hand carries at least this part of the force that the spring has at the greatest energy. Decays of measured rigs
#: depart from their own law by 0.02 to 0.06 of it, hands by 0.3 to 1.
_HAND = 0.2
#: … and this many times what the decay itself departs from its law, by its 90 % quantile.
_BEYOND = 3.0
#: Windows of the local polynomial, in periods: the shortest that leaves a scatter below ``_CALM`` of the first swing.
_WINDOWS = (0.1, 0.15, 0.25)
_CALM = 0.03
#: A hand holds or pulls for at least this part of a period; a reading that is off makes shorter departures.
_LASTS = 0.25
#: Degree of that polynomial, fewest samples a period, and fewest samples that a law is regressed from.
_DEGREE, _COARSE, _FEWEST = 4, 10.0, 12
#: Turning points that the law is regressed up to, and up to which the greatest energy is looked for.
_TURNS, _EARLY = 13, 4


def free_decay(record: Record, noise: Noise) -> Response | None:
    """Features of a release without force.

    The part before the free motion (a hand that pulls, holds and lets go) is left out.

    Args:
        record: without a force that varies.
        noise: of the record.

    Returns:
        None if nothing swings.
    """
    turns = _swinging(_shrinking(extremes(record.time, record.position, noise.floor)))
    settled = settled_value(record.position, noise)
    first = _release(record, turns)
    if first == 0 and (freed := let_go(record, noise)) is not None:
        first = int(np.searchsorted(record.time, freed))  # with too few readings no law tells a hand that holds
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


@dataclass(frozen=True)
class _Free:
    """The law of the decay, and what departs from it.

    Attributes:
        first: sample that the first entry stands for.
        period: of the oscillation, in samples.
        energy: (n,) squared amplitude [position unit²] that the state would swing with.
        away: (n,) distance from the spring's zero [position unit].
        departure: (n,) force beyond the law, as the shift of the spring's zero that it makes [position unit].
        swing: amplitude at the first sure turning point [position unit].
        scatter: robust standard deviation of ``departure`` in the decay [position unit].
        usual: 90 % quantile of its size there [position unit].
    """

    first: int
    period: float
    energy: FloatArray
    away: FloatArray
    departure: FloatArray
    swing: float
    scatter: float
    usual: float


def _release(record: Record, turns: tuple[Extreme, ...]) -> int | None:
    """Sample from which the motion is free; ``None`` where too few samples or swings tell.

    Args:
        record: without force.
        turns: turning points of the decay, of which a hand may have made the first few.
    """
    if len(turns) < 3:
        return None
    half_period = float(np.median(np.diff([turn.time for turn in turns])))
    if half_period < 0.5 * _COARSE * record.period:
        return None
    last = min(turns[min(len(turns), _TURNS) - 1].time + half_period, float(record.time[-1]))
    even = np.arange(record.time[0], last, record.period)
    position = np.interp(even, record.time, record.position)
    free = None
    for window in _WINDOWS:
        half = max(2, round(window * half_period / record.period))
        free = _free(even, position, half, turns)
        if free is None:
            return None
        if free.scatter < _CALM * free.swing:
            break
    assert free is not None
    sure, until = (int(np.searchsorted(even, turn.time)) for turn in (turns[0], turns[min(len(turns) - 1, _EARLY)]))
    return int(np.searchsorted(record.time, even[_let_go(free, sure, until)] - 0.5 * record.period))


def _let_go(free: _Free, sure: int, until: int) -> int:
    """Sample of the even stamps at which the hand's force ends, 0 where none acts.

    Args:
        free: the decay and what departs from it.
        sure: sample of the first turning point; at a quarter of a period before it a hand may still begin to pull.
        until: sample up to which the greatest energy is looked for, and a hand that gave it.
    """
    most = int(np.argmax(free.energy[: max(until - free.first, 1)]))
    limit = max(_HAND * math.sqrt(free.energy[most]), _BEYOND * free.usual)
    side = np.where(np.abs(free.departure) > limit, np.sign(free.departure), 0.0)
    latest = max(most, sure - free.first - int(free.period / 4.0))
    ends = [end for begin, end in _stretches(side) if begin <= latest and _is_hand(free, begin, end, most)]
    if not ends:
        return 0
    after = max(ends)
    calm = np.flatnonzero(np.abs(free.departure[after:]) <= max(3.0 * free.scatter, free.usual))
    return free.first + after + (int(calm[0]) if calm.size else 0)


def _stretches(side: FloatArray) -> list[tuple[int, int]]:
    """First sample and end of each stretch of one sign (n,), zeros between them left out."""
    edges = [0, *(np.flatnonzero(np.diff(side)) + 1).tolist(), side.size]
    return [(begin, end) for begin, end in pairwise(edges) if side[begin]]


def _is_hand(free: _Free, begin: int, end: int, most: int) -> bool:
    """Whether a stretch of departure is a hand's: it gives energy to a cart that had little, or holds one that has it.

    Friction that the law does not know takes the energy away instead, and a reading that is off is soon over. A stretch
    that the record begins with may have begun long before: there its length and its first energy tell nothing, but that
    the cart is carried outward and gains energy. A spring that is stiffer than the law gives energy on the way inward.
    """
    carried = free.away[end - 1] - free.away[begin] > _BEYOND * free.scatter
    if begin == 0 and carried and free.energy[end - 1] > free.energy[begin]:
        return True
    given = free.energy[begin] < 0.5 * free.energy[most]
    held = end - begin >= _LASTS * free.period and free.energy[end - 1] > 0.5 * free.energy[begin]
    return bool(given or held)


def _free(time: FloatArray, position: FloatArray, half: int, turns: tuple[Extreme, ...]) -> _Free | None:
    """The law of the decay from its second turning point on, from evenly sampled readings."""
    if position.size < 2 * half + _FEWEST:
        return None
    x, v, a = _local(position, half, float(time[1] - time[0]))
    sure = time[half : time.size - half] > turns[1].time
    columns = np.column_stack((x, v, np.ones(x.size), np.sign(v)))
    law = _regressed(columns[sure], a[sure])
    if law is None or law[0] >= 0.0:
        return None
    square = -float(law[0])
    middle = float(law[2]) / square
    departure = (a - columns @ law) / square
    later = np.abs(departure[sure])
    return _Free(
        first=half,
        period=2.0 * math.pi / math.sqrt(square) / float(time[1] - time[0]),
        energy=(x - middle) ** 2 + v**2 / square,
        away=np.abs(x - middle),
        departure=departure,
        swing=abs(turns[1].value - middle),
        scatter=MAD * float(np.median(later)),
        usual=float(np.quantile(later, 0.9)),
    )


def _local(position: FloatArray, half: int, period: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, velocity and acceleration (n − 2·half,) by a polynomial through 2·half + 1 readings around each."""
    steps = np.arange(-half, half + 1) / half
    rows = np.linalg.pinv(np.vander(steps, min(_DEGREE, 2 * half) + 1, increasing=True))[:3]
    value, slope, bend = (np.convolve(position, row[::-1], mode="valid") for row in rows)
    return value, slope / (half * period), 2.0 * bend / (half * period) ** 2


def _regressed(columns: FloatArray, values: FloatArray) -> FloatArray | None:
    """Least squares without outliers: what departs by more than three robust deviations is left out, three times."""
    kept = np.ones(values.size, dtype=bool)
    law: FloatArray = np.zeros(columns.shape[1])
    for _ in range(4):
        if np.count_nonzero(kept) < _FEWEST:
            return None
        law = np.asarray(np.linalg.lstsq(columns[kept], values[kept], rcond=None)[0], dtype=np.float64)
        error = np.abs(values - columns @ law)
        kept = error <= 3.0 * MAD * max(float(np.median(error)), math.ulp(1.0))
    return law
