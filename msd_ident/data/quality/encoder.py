"""What the encoder does to the motion: it sticks, clips, counts coarsely, or gives too few readings."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from msd_ident.data.motion import Motion, Standstill
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import Record
from msd_ident.data.streams import OTHER_VALUES

#: Fewest samples an oscillation that is not a warning.
_FEW_SAMPLES = 12
#: Readings before a standstill at which the force is looked at: those that show that the cart came at speed.
_AROUND = 3
#: Part of the force below which it went away.
_GONE = 0.5
#: Part of the range of positions within which a standstill is at its end.
_NEAR_END = 0.01


def frozen_encoder(record: Record, motion: Motion) -> Iterator[Finding]:
    """Findings on readings that stand still although the cart arrives at speed; friction would stop it gently."""
    unit = record.position_unit
    if _samples_an_oscillation(record, motion) < _FEW_SAMPLES:
        return
    low, high = float(np.min(record.position)), float(np.max(record.position))
    near = _NEAR_END * (high - low)  # a stop gives way by a little
    stills = [still for still in motion.standstills if not _switched_off(record, still)]
    ends = [still.value - low <= near or high - still.value <= near for still in stills]
    clipped = [still for still, end in zip(stills, ends, strict=True) if end]
    stuck = [still for still, end in zip(stills, ends, strict=True) if not end and still.size >= 8]
    if clipped:
        longest = max(clipped, key=lambda still: still.size)
        times = "once" if len(clipped) == 1 else f"{len(clipped)} times"
        yield warning(
            "clipped_position",
            f"the position stops dead at {longest.value:.4g} {unit}, the end of its range, {times}, the longest for "
            f"{longest.size * record.period:.3g} s from {record.time[longest.first]:.3f} s on: the encoder is clipped "
            "or the cart hits an end stop",
        )
    if stuck:
        longest = max(stuck, key=lambda still: still.size)
        yield warning(
            "stuck_position",
            f"the position stands still at {longest.value:.4g} {unit} for {longest.size * record.period:.3g} s from "
            f"{record.time[longest.first]:.3f} s on, in the middle of a motion: the encoder is stuck or not read, or "
            "something holds the cart",
        )


def _switched_off(record: Record, still: Standstill) -> bool:
    """Whether what drove the cart went away as the standstill began: behind a gear a motor stops dead then."""
    before, arrived, end = still.first - _AROUND, still.first + 1, still.first + still.size
    ahead = math.copysign(1.0, still.value - float(record.position[before]))
    pushed = float(np.min(ahead * record.force_at(record.time[before : still.first - 1])))
    pushes = float(np.max(ahead * record.force_at(record.time[arrived:end])))
    return pushed > 0.0 and pushes < _GONE * pushed


def resolution(record: Record, motion: Motion) -> Iterator[Finding]:
    """Encoder steps [m or rad] too coarse for the motion: fewer than 20 over its whole span."""
    if motion.still:
        return
    steps = motion.span / motion.step if motion.step else np.inf
    if steps < 20:
        yield warning(
            "coarse_encoder",
            f"the whole motion is only {steps:.0f} encoder steps of {motion.step:.3g} {record.position_unit}: "
            "push harder or use a finer encoder",
        )
    elif motion.span < 30 * motion.floor:
        yield warning(
            "noisy_position",
            f"the whole motion is only {motion.span / motion.floor:.0f} times the measurement noise of "
            f"{motion.floor:.3g} {record.position_unit}: push harder or measure better",
        )


def rate(record: Record, motion: Motion) -> Iterator[Finding]:
    """Too few samples in an oscillation, whose period is twice the motion's half period [s]."""
    samples = _samples_an_oscillation(record, motion)
    if samples < _FEW_SAMPLES:
        period, shown = 2 * motion.half_period, math.floor(10.0 * samples) / 10.0
        advice = f"sample at {_rounded_up(_FEW_SAMPLES / period):.3g} Hz or faster"
        if any(OTHER_VALUES in note for note in record.notes):
            advice = "the others were dropped, because they share their stamps: give each sample one of its own"
        yield warning(
            "low_rate",
            f"one oscillation of {period:.3g} s has only {shown:.1f} samples; expected {_FEW_SAMPLES} or more: "
            f"{advice}",
        )


def _rounded_up(rate: float) -> float:
    """To three digits, so that the rate that is asked for is enough."""
    unit = 10.0 ** (math.floor(math.log10(rate)) - 2)
    return math.ceil(round(rate / unit, 6)) * unit


def _samples_an_oscillation(record: Record, motion: Motion) -> float:
    """Samples an oscillation, without what rounding leaves of whole ones."""
    return round(2 * motion.half_period / record.period, 6) if motion.half_period else np.inf
