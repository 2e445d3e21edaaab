"""Units that are wrong: by a factor of 1000, or degrees for radians."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from msd_ident.data.motion import Motion, turning_points
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import Record
from msd_ident.data.turns import TURN, wraps

#: Spans of the position [m] and mass [kg] beyond which a rig on a table is measured in another unit.
_FARTHEST, _NEAREST = 3.0, 1e-4
_LIGHTEST = 1e-3
#: Span of an angle [rad], four turns, beyond which hardly a spring or gravity swings anything to and fro; fewest
#: turning points that show it, and the least swing between them in parts of the span.
_WIDEST, _SWINGS, _SWING = 8.0 * math.pi, 4, 0.1
#: By unit of the position: length after which it may be wrapped, what that is, and what to do. Most counters of a turn
#: or of a chip have a power of two.
_WRAPS = {
    "m": (
        (360.0, "is it an angle in degrees that is wrapped at one turn", "If so, use --position-unit deg"),
        (TURN, "is it an angle in radians that is wrapped at one turn", "If so, use --position-unit rad"),
    ),
    "count": tuple(
        (2.0**bits, "is it a counter that overflows", "If so, unwrap it before (numpy.unwrap with this period)")
        for bits in range(8, 33)
    ),
}
#: Sampling periods [s] beyond which no encoder is read.
_SHORTEST, _LONGEST = 2e-6, 0.5


def units(record: Record, motion: Motion) -> Iterator[Finding]:
    """Millimetres taken for metres, or the other way round."""
    if record.position_unit != "m" or motion.still:
        return
    light = record.force_unit == "N" and motion.mass < _LIGHTEST
    implied = f", and with the force given the moving mass is about {motion.mass:.2g} kg" if light else ""
    if motion.span > _FARTHEST:
        advice = "if it is in millimetres, use --position-scale 0.001; if in degrees, --position-unit deg"
    elif light:
        advice = "use --position-scale 0.001 if it is in millimetres, --force-scale 1000 if the force is in kN"
    elif motion.span < _NEAREST:
        advice = "if it was scaled twice, use a --position-scale 1000 times larger"
    else:
        return
    yield warning(
        "wrong_unit",
        f"the position spans {motion.span:.4g} m{implied}: wrong by a factor of 1000? {advice}",
    )


def angle_unit(record: Record, motion: Motion) -> Iterator[Finding]:
    """Degrees taken for radians: an angle that swings over many turns while the force stays as it is.

    A shaft that a motor turns is no case of it: it goes one way, or turns around where its force changes.
    """
    if record.position_unit != "rad" or motion.still or motion.span <= _WIDEST:
        return
    turns = record.time[turning_points(record.position, _SWING * motion.span)]
    changes = record.force_time[1:][np.diff(record.force) != 0.0]
    at_one_force = np.bincount(np.searchsorted(changes, turns, side="right")) if turns.size else np.zeros(1)
    if int(np.max(at_one_force)) >= _SWINGS:
        yield warning(
            "wrong_unit",
            f"the position spans {motion.span:.4g} rad, {motion.span / (2.0 * math.pi):.0f} turns, and swings to and "
            "fro under one force: is it in degrees? If so, use --position-unit deg",
        )


def wrapped(record: Record) -> Iterator[Finding]:
    """An angle that is wrapped at one turn, or a counter that overflows, and is not known to be one."""
    for turn, what, advice in _WRAPS.get(record.position_unit, ()):
        jumps = wraps(record.time, record.position, turn)
        if jumps.size:
            yield warning(
                "wrong_unit",
                f"the position jumps by {turn:.4g} {record.position_unit} between two samples ({jumps.size} times, the "
                f"first at {record.time[jumps[0] + 1]:.3f} s) and goes on with the same speed: {what}? {advice}",
            )


def time_unit(record: Record, motion: Motion) -> Iterator[Finding]:
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
    yield warning("wrong_time_unit", f"{rate}: wrong by a factor of 1000? {advice}")
