"""Units that are wrong by a factor of 1000."""

from __future__ import annotations

from collections.abc import Iterator

from msd_ident.data.motion import Motion
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import Record

#: Spans of the position [m] and mass [kg] beyond which a rig on a table is measured in another unit.
_FARTHEST, _NEAREST = 3.0, 1e-4
_LIGHTEST = 1e-3
#: Sampling periods [s] beyond which no encoder is read.
_SHORTEST, _LONGEST = 2e-6, 0.5


def units(record: Record, motion: Motion) -> Iterator[Finding]:
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
    yield warning(
        "wrong_unit",
        f"the position spans {motion.span:.4g} m{implied}: wrong by a factor of 1000? {advice}",
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
