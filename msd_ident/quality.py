"""What is wrong with a record before any model is fitted: findings with a severity and a sentence.

Findings are told in numbers. They are cautious: a clean record has none, since a warning that comes
with every record is read by nobody.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from msd_ident.motion import Motion, observe
from msd_ident.noise import encoder_step, noise_floor
from msd_ident.record import FloatArray, Record

__all__ = ["Finding", "check", "encoder_step", "missing_in", "missing_samples", "noise_floor"]

Severity = Literal["info", "warning", "error"]

#: Intervals within this part of the median count as the sampling period.
_REGULAR = 0.25
#: Jitter of the stamps, relative to the period, from which it is told, and from which it is a warning.
_JITTER_TOLD, _JITTER_BAD = 0.05, 0.2
#: Fewest samples an oscillation that is not a warning.
_FEW_SAMPLES = 12
#: Spans of the position [m] and mass [kg] beyond which a rig on a table is measured in another unit.
_FARTHEST, _NEAREST = 3.0, 1e-4
_LIGHTEST = 1e-3
#: Sampling periods [s] beyond which no encoder is read.
_SHORTEST, _LONGEST = 2e-6, 0.5


@dataclass(frozen=True)
class Finding:
    """One thing about the data that the user should know.

    Attributes:
        severity: ``info`` (good to know), ``warning`` (the result may suffer), ``error`` (no result makes sense).
        code: short name that stays the same, for programs and tests.
        sentence: the thing in words, with its numbers and the next step.
    """

    severity: Severity
    code: str
    sentence: str


def check(record: Record) -> tuple[Finding, ...]:
    """All findings of a record, the worst first."""
    motion = observe(record, encoder_step(record), noise_floor(record))
    checks: tuple[Callable[[Record, Motion], Iterator[Finding]], ...] = (
        _excitation,
        _sampling,
        _frozen_encoder,
        _resolution,
        _rate,
        _clocks,
        _units,
        _time_unit,
        _outliers,
    )
    findings = [finding for one in checks for finding in one(record, motion)]
    order = ("error", "warning", "info")
    return tuple(sorted(findings, key=lambda finding: order.index(finding.severity)))


def missing_samples(record: Record) -> int:
    """Position samples that the stamps say are missing: see ``missing_in``."""
    return missing_in(record.time)


def missing_in(time: FloatArray) -> int:
    """Samples missing in stamps (n,) [s]: whole periods in gaps of a train with a regular period, else 0."""
    intervals = np.diff(time)
    if intervals.size < 2:
        return 0
    _, slow = _rates(intervals)
    period = slow or float(np.median(intervals))
    if not slow and np.mean(np.abs(intervals - period) < _REGULAR * period) < 0.5:
        return 0
    gaps = intervals[intervals > 1.5 * period]
    return int(np.sum(np.rint(gaps / period) - 1))


def _excitation(record: Record, motion: Motion) -> Iterator[Finding]:
    unit = record.position_unit
    factor = _same_signal(record)
    if factor:
        yield Finding(
            "error",
            "same_signal",
            f"the force is the position times {factor:.4g} in every sample: name a force of its own",
        )
        return
    if motion.span == 0:
        yield Finding(
            "error",
            "constant_position",
            f"the position never changes ({record.position[0]:g} {unit} in all {record.samples} samples): "
            "check the encoder and the choice of the signal",
        )
        return
    if motion.still and motion.force_span == 0:
        yield Finding(
            "error",
            "no_excitation",
            f"the force never changes and the position only by {motion.span:.3g} {unit}, which is noise: "
            "apply a force step or release the cart from a displacement",
        )
    elif motion.still:
        yield Finding(
            "error",
            "no_motion",
            f"the force changes by {motion.force_span:.3g} {record.force_unit} and the position only by "
            f"{motion.span:.3g} {unit}, which is noise: push harder, or check the encoder",
        )
    elif motion.force_span == 0:
        held = f"constant at {record.force[-1]:g} {record.force_unit}" if record.force[-1] else "zero"
        yield Finding(
            "info",
            "free_decay",
            f"the force is {held} all the time: a free decay, which gives the parameters relative to each other only",
        )


def _same_signal(record: Record) -> float:
    """Factor that makes the position the force, 0.0 when they are two signals."""
    largest = int(np.argmax(np.abs(record.position)))
    if not record.shared_clock or not record.position[largest]:
        return 0.0
    factor = float(record.force[largest] / record.position[largest])
    same = np.allclose(record.force, factor * record.position, rtol=1e-9, atol=0.0)
    return factor if same and np.ptp(record.position) > 0 else 0.0


def _sampling(record: Record, motion: Motion) -> Iterator[Finding]:
    intervals = np.diff(record.time)
    fast, slow = _rates(intervals)
    if fast and slow:
        yield Finding(
            "warning",
            "two_rates",
            f"two sampling rates are mixed: {1 / fast:.4g} Hz and {1 / slow:.4g} Hz: check that one publisher alone "
            "sends the position",
        )
    period = slow or record.period
    yield from _gaps(record, intervals, period)
    regular = intervals[np.abs(intervals - period) < 0.5 * period]
    jitter = float(np.std(regular)) if regular.size > 1 and not slow else 0.0
    if jitter > _JITTER_TOLD * period:
        yield Finding(
            "warning" if jitter > _JITTER_BAD * period else "info",
            "jitter",
            f"the intervals between samples scatter by {1e3 * jitter:.3g} ms around {1e3 * period:.4g} ms "
            f"({100 * jitter / period:.0f} %): stamp the samples when they are taken",
        )


def _gaps(record: Record, intervals: FloatArray, period: float) -> Iterator[Finding]:
    missing = missing_samples(record)
    if not missing:
        return
    gaps = np.flatnonzero(intervals > 1.5 * period)
    longest = int(gaps[np.argmax(intervals[gaps])])
    share = missing / (missing + record.samples)
    where = f"the longest {intervals[longest]:.4g} s at {record.time[longest]:.3f} s"
    count = f"{gaps.size} gap, {where}" if gaps.size == 1 else f"{gaps.size} gaps, {where}"
    small = share < 1e-3 and intervals[longest] < 5.5 * period
    yield Finding(
        "info" if small else "warning",
        "missing_samples",
        f"{missing} of {missing + record.samples} samples ({100 * share:.2g} %) are missing ({count}): "
        "look for lost messages",
    )


def _frozen_encoder(record: Record, motion: Motion) -> Iterator[Finding]:
    """Readings that stand still although the cart came in at speed: friction stops it gently."""
    unit = record.position_unit
    if motion.held > 0.05 * record.samples:
        yield Finding(
            "warning",
            "held_samples",
            f"the position changes only every {motion.held_size} samples "
            f"({1e3 * record.period * motion.held_size:.3g} ms) while the cart moves: the encoder is read more slowly "
            "than it is published",
        )
        return
    if _samples_an_oscillation(record, motion) < _FEW_SAMPLES:
        return
    ends = (float(np.min(record.position)), float(np.max(record.position)))
    clipped = [still for still in motion.standstills if still.value in ends]
    stuck = [still for still in motion.standstills if still.value not in ends and still.size >= 8]
    if clipped:
        longest = max(clipped, key=lambda still: still.size)
        times = "once" if len(clipped) == 1 else f"{len(clipped)} times"
        yield Finding(
            "warning",
            "clipped_position",
            f"the position stops dead at {longest.value:.4g} {unit}, the end of its range, {times}, the longest for "
            f"{longest.size * record.period:.3g} s from {record.time[longest.first]:.3f} s on: the encoder is clipped "
            "or the cart hits an end stop",
        )
    if stuck:
        longest = max(stuck, key=lambda still: still.size)
        yield Finding(
            "warning",
            "stuck_position",
            f"the position stands still at {longest.value:.4g} {unit} for {longest.size * record.period:.3g} s from "
            f"{record.time[longest.first]:.3f} s on, in the middle of a motion: the encoder is stuck or not read",
        )


def _resolution(record: Record, motion: Motion) -> Iterator[Finding]:
    if motion.still:
        return
    steps = motion.span / motion.step if motion.step else np.inf
    if steps < 20:
        yield Finding(
            "warning",
            "coarse_encoder",
            f"the whole motion is only {steps:.0f} encoder steps of {motion.step:.3g} {record.position_unit}: "
            "push harder or use a finer encoder",
        )
    elif motion.span < 30 * motion.floor:
        yield Finding(
            "warning",
            "noisy_position",
            f"the whole motion is only {motion.span / motion.floor:.0f} times the measurement noise of "
            f"{motion.floor:.3g} {record.position_unit}: push harder or measure better",
        )


def _rate(record: Record, motion: Motion) -> Iterator[Finding]:
    samples = _samples_an_oscillation(record, motion)
    if samples < _FEW_SAMPLES:
        period = 2 * motion.half_period
        yield Finding(
            "warning",
            "low_rate",
            f"one oscillation of {period:.3g} s has only {samples:.1f} samples; expected {_FEW_SAMPLES} or more: "
            f"sample at {_FEW_SAMPLES / period:.3g} Hz or faster",
        )


def _samples_an_oscillation(record: Record, motion: Motion) -> float:
    return 2 * motion.half_period / record.period if motion.half_period else np.inf


def _clocks(record: Record, motion: Motion) -> Iterator[Finding]:
    """Motion before its cause or long after it, and a force that is only known for a part of the record."""
    if motion.early > max(2 * record.period, 0.002):
        yield Finding(
            "warning",
            "clocks_apart",
            f"the cart moves {motion.early:.3f} s before the force first changes: the clocks of force and encoder "
            "are apart, or something else pushed",
        )
    elif motion.half_period and motion.late > max(0.5 * motion.half_period, 5 * record.period):
        yield Finding(
            "warning",
            "clocks_apart",
            f"the cart moves only {motion.late:.3f} s after a force step, a quarter of an oscillation or more: the "
            "clocks of force and encoder are apart, or the force acts late",
        )
    if record.force.size < 100:
        return
    late, early = record.force_time[0] - record.time[0], record.time[-1] - record.force_time[-1]
    spacing = 10 * float(np.median(np.diff(record.force_time))) + 10 * record.period
    for lack, where in ((late, "begins after"), (early, "ends before")):
        if lack > max(0.05 * record.duration, spacing):
            yield Finding(
                "warning",
                "partial_overlap",
                f"the force {where} the position by {lack:.3f} s of {record.duration:.3f} s: use the part where both "
                "are recorded",
            )


def _units(record: Record, motion: Motion) -> Iterator[Finding]:
    """Millimetres taken for metres, or the other way round."""
    if record.position_unit != "m" or motion.still:
        return
    light = record.force_unit == "N" and motion.mass < _LIGHTEST
    implied = f", and with the force given the moving mass is about {motion.mass:.2g} kg" if light else ""
    if motion.span > _FARTHEST:
        advice = "if it is in millimetres, use --position-scale 0.001"
    elif light:
        advice = "use --position-scale 0.001 if it is in millimetres, --force-scale 1000 if the force is in kN"
    elif motion.span < _NEAREST:
        advice = "if it was scaled twice, use a --position-scale 1000 times larger"
    else:
        return
    yield Finding(
        "warning",
        "wrong_unit",
        f"the position spans {motion.span:.4g} m{implied}: wrong by a factor of 1000? {advice}",
    )


def _time_unit(record: Record, motion: Motion) -> Iterator[Finding]:
    """Milliseconds (or less) taken for seconds, or the other way round."""
    if _SHORTEST < record.period < _LONGEST:
        return
    rate = f"the samples lie {record.period:.4g} s apart, {record.duration:.4g} s in all"
    long = record.period >= _LONGEST
    advice = (
        "if the time is in milliseconds, use --time-scale 0.001 (0.000001 for µs, 0.000000001 for ns)"
        if long
        else "if the time was scaled twice, use a --time-scale 1000 times larger"
    )
    yield Finding("warning", "wrong_time_unit", f"{rate}: wrong by a factor of 1000? {advice}")


def _outliers(record: Record, motion: Motion) -> Iterator[Finding]:
    """Single readings far off both of their neighbours, which agree with each other."""
    change = np.diff(record.position)
    before, after = change[:-1], -change[1:]
    height = np.where(before * after > 0, np.minimum(np.abs(before), np.abs(after)), 0.0)[2:-2]
    size = np.abs(change)
    usual = np.max([size[:-5], size[1:-4], size[4:-1], size[5:]], axis=0)
    wild = np.flatnonzero(height > 10 * usual + max(50 * motion.floor, 0.1 * motion.span)) + 3
    highest = float(np.max(height[wild - 3], initial=0.0))
    if wild.size and wild.size < 0.02 * record.samples:
        yield Finding(
            "warning",
            "outliers",
            f"{wild.size} single readings jump away from their neighbours, by up to {highest:.4g} "
            f"{record.position_unit} (the first at {record.time[wild[0]]:.3f} s): "
            "remove them, or use --loss soft_l1",
        )


def _rates(intervals: FloatArray) -> tuple[float, float]:
    """Shorter and longer sampling interval [s] where two regular rates are mixed, else twice 0.

    Either one part of the record has another rate, or two publishers take turns. Lost samples do neither: their
    gaps stand alone, and no interval is shorter than the period.
    """
    period = float(np.median(intervals))
    other = intervals[_in_long_runs(np.abs(intervals - period) > _REGULAR * period, 10)]
    second = float(np.median(other)) if other.size else 0.0
    if other.size > 0.01 * intervals.size and np.mean(np.abs(other - second) < _REGULAR * second) > 0.8:
        return min(period, second), max(period, second)
    return _taking_turns(intervals, period)


def _taking_turns(intervals: FloatArray, period: float) -> tuple[float, float]:
    """Rates of two publishers: one of them cuts intervals of the other in two parts."""
    pairs = intervals[:-1] + intervals[1:]
    whole = float(np.median(pairs))
    uneven = np.mean(np.abs(intervals - whole / 2) > 0.05 * whole) > 0.8
    if uneven and np.mean(np.abs(pairs - whole) < 0.02 * whole) > 0.8:
        return whole, whole
    short = intervals < (1 - _REGULAR) * period
    cut = short[:-1] & short[1:] & (np.abs(pairs - period) < 0.1 * period)
    if np.count_nonzero(cut) < 0.02 * intervals.size or 2 * np.count_nonzero(cut) < 0.8 * np.count_nonzero(short):
        return 0.0, 0.0
    return period, float(np.sum(intervals)) / int(np.count_nonzero(cut))


def _in_long_runs(mask: npt.NDArray[np.bool_], length: int) -> npt.NDArray[np.bool_]:
    """Which of the true entries stand in runs of at least ``length``."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    long = np.zeros_like(mask)
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        long[begin:end] = end - begin >= length
    return long
