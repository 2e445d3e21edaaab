"""What one force step, or one release, shows: rest values, turning points, standard form."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from msd_ident import quality
from msd_ident.features import equations, oscillation
from msd_ident.features.form import StandardForm, gain_unit
from msd_ident.features.onsets import Onset
from msd_ident.features.shape import Shape, fit_shape
from msd_ident.features.swings import Extreme, extremes
from msd_ident.quantity import Quantity
from msd_ident.record import FloatArray, Record

#: Part of a response, at its end, that its rest value is read from.
_TAIL = 0.15
#: Fewest samples of a response.
SHORTEST = 12


@dataclass(frozen=True)
class Response:
    """One step response or free decay.

    Attributes:
        onset: when it begins [s], on the record's clock.
        amplitude: change of the force, 0 for a free decay.
        initial: reading before the step.
        steady_state: reading at rest, xss.
        turns: all turning points.
        peaks: the paper's two-peak values; ``None`` with fewer than two peaks on one side.
        swings: ζ(A) and ωn(A) a half-swing.
        shape: the fitted response where peaks were too few.
        form: ωn, ζ, K by all that the response shows; ``None`` when it shows none.
    """

    onset: float
    amplitude: float
    initial: Quantity
    steady_state: Quantity
    turns: tuple[Extreme, ...]
    peaks: oscillation.TwoPeaks | None
    swings: tuple[oscillation.Swing, ...]
    shape: Shape | None
    form: StandardForm | None


def step_response(record: Record, onset: Onset, earlier: Response | None = None) -> Response | None:
    """Features of the motion after one force step; ``None`` when too little of it was recorded.

    ``earlier`` is the response before it, whose rest value counts where the cart had not come to rest yet.
    """
    inside = (record.time >= onset.time) & (record.time <= onset.end)
    if np.count_nonzero(inside) < SHORTEST:
        return None
    floor = quality.noise_floor(record)
    time, position = record.time[inside], record.position[inside]
    initial, at_rest = _before(record, onset.time, floor, float(np.ptp(position)))
    if not at_rest:
        if earlier is None:
            return None
        initial = earlier.steady_state
    turns = extremes(time, position, floor)
    rest = _rest(position, turns, floor, record.position_unit)
    if rest is None:
        return None
    found = oscillation.all_peaks(_after_start(turns, time), rest.value, rest.std)
    peaks = oscillation.two_peaks(turns, rest.value, rest.std)
    shape = None
    if found is None:
        if not at_rest:
            return None
        shape = fit_shape(time - onset.time, position, floor, record.position_unit)
        if shape is None or not _believable(shape, float(time[-1] - time[0]), position):
            return None
        found, rest = (shape.natural_frequency, shape.damping_ratio), shape.steady_state
    gain = _gain(initial, rest, onset.amplitude, gain_unit(record.position_unit, record.force_unit))
    return Response(
        onset=onset.time,
        amplitude=onset.amplitude,
        initial=initial,
        steady_state=rest,
        turns=turns,
        peaks=peaks,
        swings=oscillation.swings(turns, rest.value, rest.std),
        shape=shape,
        form=StandardForm(found[0], found[1], gain),
    )


def with_dead_width(responses: tuple[Response, ...]) -> tuple[Response, ...]:
    """The same with the uncertainty of rest values, and so of K, widened by where dry friction may hold the cart."""
    width = max((oscillation.dead_width(response.swings) for response in responses), default=0.0) / math.sqrt(3.0)
    return tuple(_widened(response, width) for response in responses) if width > 0.0 else responses


def _widened(response: Response, width: float) -> Response:
    initial, rest = (
        Quantity(value.value, math.hypot(value.std, width), value.unit)
        for value in (response.initial, response.steady_state)
    )
    form = response.form
    if form is not None and form.static_gain is not None:
        gain = _gain(initial, rest, response.amplitude, form.static_gain.unit)
        form = StandardForm(form.natural_frequency, form.damping_ratio, gain)
    return replace(response, initial=initial, steady_state=rest, form=form)


def free_decay(record: Record) -> Response | None:
    """Features of a release without force: from the last time that the cart is near its largest excursion on.

    What comes before (a hand that pulls and holds) is left out. ``None`` when nothing swings after it.
    """
    floor = quality.noise_floor(record)
    tail = record.position[-max(SHORTEST, int(_TAIL * record.samples)) :]
    rest = float(np.median(tail))
    away = np.abs(record.position - rest)
    far = np.flatnonzero(away >= 0.97 * away.max())
    first = int(far[0])
    if far.size > 1:
        # The hand may hold for long: the motion is free from the last sample of the first stay out there.
        jumps = np.flatnonzero(np.diff(far) > max(3, record.samples // 50))
        first = int(far[jumps[0]]) if jumps.size else int(far[-1])
    time, position = record.time[first:], record.position[first:]
    if time.size < SHORTEST or away.max() < 20.0 * floor:
        return None
    turns = extremes(time, position, floor)
    settled = _rest(position, turns, floor, record.position_unit)
    if settled is None:
        return None
    found = oscillation.all_peaks(turns, settled.value, settled.std)
    if found is None:
        return None
    return Response(
        onset=float(time[0]),
        amplitude=0.0,
        initial=Quantity(float(position[0]), floor, record.position_unit),
        steady_state=settled,
        turns=turns,
        peaks=oscillation.two_peaks(turns, settled.value, settled.std),
        swings=oscillation.swings(turns, settled.value, settled.std),
        shape=None,
        form=StandardForm(found[0], found[1], None),
    )


def _before(record: Record, onset: float, floor: float, swing: float) -> tuple[Quantity, bool]:
    """Reading before the step, the median of what lies just before it, and whether the cart was at rest there."""
    count = max(5, int(0.02 * record.samples) + 1)
    tail = record.position[record.time <= onset][-count:]
    if tail.size > 2:
        still = float(np.ptp(tail)) <= max(8.0 * floor, 0.02 * swing)
    else:
        still = _starts_still(record, floor, swing)
    tail = tail if tail.size else record.position[:1]
    return Quantity(float(np.median(tail)), floor / math.sqrt(tail.size), record.position_unit), still


def _starts_still(record: Record, floor: float, swing: float) -> bool:
    """Whether a record that begins with the step begins at rest.

    A cubic through the first samples, until the cart is a twentieth of the swing away: from rest the way grows with
    the square of the time, so the slope at the start has hardly a part in it.
    """
    away = np.flatnonzero(np.abs(record.position - record.position[0]) > max(0.05 * swing, 10.0 * floor))
    count = max(8, int(away[0]) + 1) if away.size else record.samples
    u = np.arange(count) / (count - 1.0)
    slope = float(np.polynomial.polynomial.polyfit(u, record.position[:count], 3)[1])
    return abs(slope) <= 0.4 * float(np.ptp(record.position[:count]))


def _after_start(turns: tuple[Extreme, ...], time: FloatArray) -> tuple[Extreme, ...]:
    """Turning points without one that is only the beginning of the response."""
    edge = 2.0 * float(np.median(np.diff(time)))
    return tuple(turn for turn in turns if turn.time > time[0] + edge)


def _rest(position: FloatArray, turns: tuple[Extreme, ...], floor: float, unit: str) -> Quantity | None:
    """Rest value: of the settled tail, or else the middle of the last turning points."""
    tail = position[-max(SHORTEST, int(_TAIL * position.size)) :]
    swing = max(float(np.ptp(position)), 1e-300)
    if float(np.ptp(tail)) <= max(8.0 * floor, 0.02 * swing):
        return Quantity(float(np.mean(tail)), max(floor / math.sqrt(10.0), float(np.std(tail)) / 10.0), unit)
    if len(turns) >= 3:
        one, two, three = (turn.value for turn in turns[-3:])
        return Quantity(0.25 * (one + 2.0 * two + three), floor + 0.02 * abs(one - three), unit)
    return Quantity(float(np.mean(tail)), float(np.ptp(tail)), unit)


def _believable(shape: Shape, duration: float, position: FloatArray) -> bool:
    """Whether the fitted response follows the data and ends within sight of it."""
    swing = float(np.ptp(position))
    slowest = shape.natural_frequency.value * (
        shape.damping_ratio.value - math.sqrt(max(shape.damping_ratio.value**2 - 1.0, 0.0))
    )
    return shape.see < 0.05 * swing and slowest * duration > 0.7


def _gain(initial: Quantity, rest: Quantity, amplitude: float, unit: str) -> Quantity:
    """Eq. 9, from the change of the rest value."""
    change = rest.value - initial.value
    return Quantity(equations.static_gain(change, amplitude), math.hypot(rest.std, initial.std) / abs(amplitude), unit)
