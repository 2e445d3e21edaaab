"""What the encoder does to the motion: it sticks, clips, counts coarsely, is read too seldom, or jumps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from msd_ident.motion import Motion
from msd_ident.quality.finding import Finding
from msd_ident.record import Record

#: Fewest samples an oscillation that is not a warning.
_FEW_SAMPLES = 12


def frozen_encoder(record: Record, motion: Motion) -> Iterator[Finding]:
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


def resolution(record: Record, motion: Motion) -> Iterator[Finding]:
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


def rate(record: Record, motion: Motion) -> Iterator[Finding]:
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


def outliers(record: Record, motion: Motion) -> Iterator[Finding]:
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
