"""What one force step, or one release, shows: rest values, turning points, standard form."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from msd_ident.data.noise import Noise
from msd_ident.data.onsets import Onset
from msd_ident.data.record import FloatArray, Record
from msd_ident.features import equations, oscillation
from msd_ident.features.form import StandardForm, gain_unit
from msd_ident.features.rest_and_turns import (
    FEWEST,
    SHORTEST,
    TAIL,
    Extreme,
    extremes,
    is_quiet,
    rest_value,
    settled_value,
)
from msd_ident.features.shape import Shape, fit_shape
from msd_ident.quantity import Quantity

#: Part of its whole way after a step by which a cart that answers it has moved.
_AWAY = 0.05


@dataclass(frozen=True)
class Response:
    """One step response or free decay.

    Attributes:
        onset: when it begins [s], on the record's clock.
        amplitude: change of the force, 0 for a free decay.
        amplitude_std: its standard deviation, 0 for a command.
        initial: reading before the step.
        steady_state: reading at rest, xss.
        turns: all turning points that stand clear of the noise.
        peaks: the paper's two-peak values; ``None`` with fewer than two peaks on one side.
        swings: ζ(A) and ωn(A) around each turning point but the first and the last.
        shape: the fitted response where peaks were too few.
        form: ωn, ζ, K by all that the response shows; ``None`` when it shows none.
    """

    onset: float
    amplitude: float
    amplitude_std: float
    initial: Quantity
    steady_state: Quantity
    turns: tuple[Extreme, ...]
    peaks: oscillation.TwoPeaks | None
    swings: tuple[oscillation.Swing, ...]
    shape: Shape | None
    form: StandardForm | None


def step_response(record: Record, onset: Onset, noise: Noise, earlier: Response | None = None) -> Response | None:
    """Features of the motion after one force step.

    Args:
        record: the measurement.
        onset: the step.
        noise: of the record.
        earlier: response to the step before; its rest value is where this response starts. None for the first step,
            before which the cart must rest.

    Returns:
        None if the response shows too little.
    """
    inside = slice(
        int(np.searchsorted(record.time, onset.time)), int(np.searchsorted(record.time, onset.after.end, side="right"))
    )
    if inside.stop - inside.start < SHORTEST:
        return None
    time, position = record.time[inside], record.position[inside]
    still = _at_rest(record, onset, noise, float(np.ptp(position)))
    initial = _initial(record, onset, noise) if earlier is None else earlier.steady_state
    if earlier is None and not (still and _moves_soon(record, onset, time, position)):
        return None
    turns = _after_start(extremes(time, position, noise.floor), time)
    turns = () if _swings_more_later(turns, time, position) else turns
    settled = settled_value(position, noise)
    found = oscillation.all_peaks(turns, settled, noise.unit)
    if found is None:
        begin = initial if earlier is None else rest_value(_last_before(record, onset), noise)
        shape = fit_shape(time - onset.time, position, begin, onset.time_std, noise.floor) if still else None
        if shape is None or not _believable(shape, time, float(np.ptp(position))):
            return None
        frequency, ratio, rest = shape.natural_frequency, shape.damping_ratio, _end_of(shape, settled, time)
    else:
        shape = None
        frequency, ratio, rest = found.natural_frequency, found.damping_ratio, settled or found.middle
    force = Quantity(onset.amplitude, onset.amplitude_std, record.force_unit)
    gain = _gain(initial, rest, force, gain_unit(record.position_unit, record.force_unit))
    return Response(
        onset=onset.time,
        amplitude=onset.amplitude,
        amplitude_std=onset.amplitude_std,
        initial=initial,
        steady_state=rest,
        turns=turns,
        peaks=oscillation.two_peaks(turns, rest),
        swings=oscillation.swings(turns),
        shape=shape,
        form=StandardForm(frequency, ratio, gain),
    )


def _swings_more_later(turns: Sequence[Extreme], time: FloatArray, position: FloatArray) -> bool:
    """Whether the cart goes further after the last turning point of a decay than between any two of it: those are
    noise on a slower motion, or another one.
    """
    used = oscillation.significant(turns)
    widest = max((abs(two.value - one.value) for one, two in pairwise(used)), default=math.inf)
    return widest < math.inf and float(np.ptp(position[time >= used[-1].time])) > widest


def with_dead_width(responses: tuple[Response, ...]) -> tuple[Response, ...]:
    """Responses with the uncertainty of rest values, and so of K, increased for dry friction (``dead_width``)."""
    width = max((oscillation.dead_width(response.turns) for response in responses), default=0.0) / math.sqrt(3.0)
    return tuple(_widened(response, width) for response in responses) if width > 0.0 else responses


def _widened(response: Response, width: float) -> Response:
    initial, rest = (
        Quantity(value.value, math.hypot(value.std, width), value.unit)
        for value in (response.initial, response.steady_state)
    )
    form = response.form
    if form is not None and form.static_gain is not None:
        force = Quantity(response.amplitude, response.amplitude_std, "")
        gain = _gain(initial, rest, force, form.static_gain.unit)
        form = StandardForm(form.natural_frequency, form.damping_ratio, gain)
    return replace(response, initial=initial, steady_state=rest, form=form)


def _at_rest(record: Record, onset: Onset, noise: Noise, swing: float) -> bool:
    """Whether the cart was at rest when the force stepped."""
    before = _last_before(record, onset)
    if before.size < FEWEST:
        return _starts_still(record, noise, swing)
    return is_quiet(before, noise) or float(np.ptp(before)) <= 0.003 * swing


def _moves_soon(record: Record, onset: Onset, time: FloatArray, position: FloatArray) -> bool:
    """Whether the cart moves sooner after a step than the level before had lasted.

    Else it may answer the step to that level: the end of a short push is not what moves a cart that comes late.
    """
    if onset.before.start <= record.time[0]:
        return True
    away = np.abs(position - position[0]) > _AWAY * float(np.ptp(position))
    return float(time[np.argmax(away)]) - onset.time < onset.before.end - onset.before.start


def _last_before(record: Record, onset: Onset) -> FloatArray:
    """The last readings before the step, without those under an earlier force; the last of all where a gap of the
    readings left none.
    """
    first, stop = np.searchsorted(record.time, [onset.before.start, onset.time])
    level = record.position[max(min(first, stop - 1), 0) : stop]
    return level[-max(5, int(TAIL * level.size)) :]


def _initial(record: Record, onset: Onset, noise: Noise) -> Quantity:
    """Reading before the first step: of all readings before it if they are quiet, else of the last ones."""
    before = record.position[record.time < onset.time]
    if not before.size:
        before = record.position[:1]
    if not is_quiet(before, noise):
        before = _last_before(record, onset) if before.size >= FEWEST else before
    return rest_value(before, noise)


def _starts_still(record: Record, noise: Noise, swing: float) -> bool:
    """Whether a record that begins with the step begins at rest.

    Up to where the cart is a twentieth of the swing away, it hardly moves in the first half of the time: it sticks.
    Or a cubic through these samples: from rest the way grows with the square of the time, so the slope at the start has
    hardly a part in it.
    """
    reach = max(0.05 * swing, 10.0 * noise.floor)
    away = np.flatnonzero(np.abs(record.position - record.position[0]) > reach)
    count = max(8, int(away[0]) + 1) if away.size else record.samples
    # A cart that moves evenly is half-way there, which so many samples and an encoder so fine must show.
    sticks = float(np.ptp(record.position[: count // 2])) <= max(0.1 * reach, 1.01 * noise.step)
    if sticks and count >= 2 * SHORTEST and reach > 4.0 * noise.step:
        return True
    u = np.arange(count) / (count - 1.0)
    slope = float(np.polynomial.polynomial.polyfit(u, record.position[:count], 3)[1])
    return abs(slope) <= 0.4 * float(np.ptp(record.position[:count]))


def _after_start(turns: tuple[Extreme, ...], time: FloatArray) -> tuple[Extreme, ...]:
    """Turning points without one that is only the beginning of the response."""
    edge = 2.0 * float(np.median(np.diff(time)))
    return tuple(turn for turn in turns if turn.time > time[0] + edge)


def _slowest(shape: Shape) -> float:
    """Rate [1/s] at which the last of the motion dies."""
    ratio = shape.damping_ratio.value
    return shape.natural_frequency.value * (1.0 / (ratio + math.sqrt(ratio**2 - 1.0)) if ratio > 1.0 else ratio)


def _believable(shape: Shape, time: FloatArray, swing: float) -> bool:
    """Whether the fitted response follows the data, ends within sight of it, and is no faster than samples show.

    A swing of ωn beyond half the sampling rate is of no plant: the search ran away, as where a step ends at once.

    Args:
        shape: the fitted response.
        time: (n,) [s] of the readings.
        swing: greatest reading minus least [m].
    """
    shown = shape.natural_frequency.value * float(np.median(np.diff(time))) < math.pi
    return shown and shape.see < 0.05 * swing and _slowest(shape) * float(time[-1] - time[0]) > 0.7


def _end_of(shape: Shape, settled: Quantity | None, time: FloatArray) -> Quantity:
    """Rest value as read, where the motion had died by then; as fitted where the cart still crept."""
    height = abs(shape.steady_state.value - shape.initial.value)
    left = height * math.exp(-_slowest(shape) * (1.0 - TAIL) * float(time[-1] - time[0]))
    return settled if settled is not None and left < 0.3 * settled.std else shape.steady_state


def _gain(initial: Quantity, rest: Quantity, force: Quantity, unit: str) -> Quantity:
    """Eq. 9, from the changes of rest value and force."""
    gain = equations.static_gain(rest.value - initial.value, force.value)
    std = math.hypot(rest.std, initial.std, gain * force.std) / abs(force.value)
    return Quantity(gain, std, unit)
