"""Clocks of force and position that are apart, and a force that is only known for a part of the record."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import Record

_UNKNOWN = "force_unknown"
#: Samples of a force that is sent all the time; part of their intervals that are at most twice the usual one, where it
#: is sent evenly; and usual intervals that are a hole in it.
_MANY, _EVENLY, _HOLE = 100, 0.95, 20.0


def force_unknown(findings: Iterable[Finding]) -> bool:
    """Whether the cart of a record with these findings moves before the force is known."""
    return any(finding.code == _UNKNOWN for finding in findings)


def clocks(record: Record, motion: Motion) -> Iterator[Finding]:
    """Findings on motion before its cause or long after it, and on a force known for a part of the record only."""
    soon, begins = max(2 * record.period, 0.002), record.force_time[0] - record.time[0]
    if record.force_time[0] - motion.onset > soon:
        yield warning(
            _UNKNOWN,
            "the cart moves before the first sample of the force, which comes at "
            f"{begins:.3f} s: what moved it is not known, so no cause is certain; "
            "record the force from before the motion on",
        )
    elif motion.early > soon and 0.0 <= motion.onset - record.force_time[0] <= max(soon, 0.5 * motion.half_period):
        yield warning(
            _UNKNOWN,
            f"the cart moves when the first sample of the force comes, at {begins:.3f} s with {record.force[0]:.4g} "
            f"{record.force_unit}: a force that held it before is not known, so no cause is certain; record the force "
            "from before the motion on, or begin with --start at that time",
        )
    elif motion.early > soon:
        yield warning(
            "clocks_apart",
            f"the cart moves {motion.early:.3f} s before the force first changes: the clocks of force and encoder "
            "are apart, or something else pushed",
        )
    elif motion.half_period and motion.late > max(0.5 * motion.half_period, 5 * record.period):
        yield warning(
            "clocks_apart",
            f"the cart moves only {motion.late:.3f} s after a force step, a quarter of an oscillation or more: the "
            "clocks of force and encoder are apart, or the force acts late",
        )
    if record.force.size < _MANY:
        return
    yield from _holes(record)
    late, early = record.force_time[0] - record.time[0], record.time[-1] - record.force_time[-1]
    spacing = 10 * float(np.median(np.diff(record.force_time))) + 10 * record.period
    for lack, where in ((late, "begins after"), (early, "ends before")):
        if lack > max(0.05 * record.duration, spacing):
            yield warning(
                "partial_overlap",
                f"the force {where} the position by {lack:.3f} s of {record.duration:.3f} s: use the part where both "
                "are recorded",
            )


def _holes(record: Record) -> Iterator[Finding]:
    """A finding where a force that is sent evenly is missing for a while, and the position is not."""
    intervals = np.diff(record.force_time)
    usual = float(np.median(intervals))
    if record.shared_clock or np.mean(intervals <= 2.0 * usual) < _EVENLY:
        return
    longest = int(np.argmax(intervals))
    if intervals[longest] > _HOLE * max(usual, record.period):
        first, last = record.force_time[longest : longest + 2] - record.time[0]
        yield warning(
            "force_missing",
            f"no sample of the force comes from {first:.3f} to {last:.3f} s, where {1.0 / usual:.3g} a second come "
            f"else: it is taken as {record.force[longest]:.4g} {record.force_unit} there; look for lost messages, and "
            "use the part before or after it (--start, --end)",
        )
