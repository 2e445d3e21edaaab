"""A record with more force values, or with fewer samples: a band-limited force interpolated, or every n-th sample.

A force that was filtered before it was sampled changes no faster than its samples tell, and is determined by them at
every instant (Shannon 1949). It is interpolated to a multiple of its rate, and read as linear in between. Straight
lines cut the tops: of a frequency f they leave 1 − (πf/r)²/3 at the rate r. The values are raised by as much
beforehand, so that the impulse over each interval is right to fourth order.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import DataError

#: Force values per measured one. On the Silverbox benchmark (8 samples a swing) 4 leave 0.342 mV, 8 leave 0.341 mV.
FACTOR = 4
#: Kaiser window of the interpolation filter: its shape sets what is left of the images (-80 dB).
_KAISER_BETA = 8.0
#: Fewest samples that an interpolation filter makes sense of.
_FEWEST = 20
#: Intervals between force stamps may differ by this part of their median.
_EVEN = 0.25


def is_even(time: FloatArray) -> bool:
    """Whether stamps (n,) [s] are evenly spaced but for jitter, as an interpolation filter needs them."""
    intervals = np.diff(time)
    period = float(np.median(intervals))
    return bool(time.size >= _FEWEST and np.max(np.abs(intervals - period)) <= _EVEN * period)


def band_limited(record: Record, factor: int = FACTOR) -> Record:
    """The record with its force interpolated as a band-limited signal.

    Args:
        record: with an evenly sampled force.
        factor: values of the force for each measured one.

    Raises:
        DataError: the force has too few samples, or uneven ones.
    """
    if not is_even(record.force_time):
        raise DataError(
            f"the force has {record.force.size} samples that are not evenly spaced; expected at least {_FEWEST} even "
            "ones for a band-limited force: use --hold linear, or --start and --end for a part without gaps"
        )
    from scipy.signal import resample_poly  # imported here: it takes a quarter of a second

    count = (record.force.size - 1) * factor + 1
    force = resample_poly(record.force, factor, 1, window=("kaiser", _KAISER_BETA), padtype="line")
    places = np.arange(count) / factor
    force = _raised(force[:count])
    time = np.interp(places, np.arange(record.force.size), record.force_time)
    return replace(
        record,
        force_time=time,
        force=force,
        hold="linear",
        hold_known=True,
        upsampled=factor * record.upsampled,
    )


def centred(record: Record) -> Record:
    """The record with each force value held from half a sample before its stamp to half a sample after it.

    A simulation that steps velocity first and position with the new velocity (semi-implicit Euler, one step a sample)
    makes such motions, and a sensor that averages about its stamp.

    Args:
        record: the record. Where force values lie further apart than samples, half a sample is that of the positions.
    """
    time, period = record.force_time, float(np.median(np.diff(record.time)))
    gaps = np.minimum(np.diff(time, prepend=-np.inf), period)
    return replace(record, force_time=time - 0.5 * gaps, hold="zero", hold_known=True, lead=0.5 * period)


def led(record: Record, lead: float) -> Record:
    """The record with a force that acts earlier than its stamps say.

    Args:
        record: the record.
        lead: how much [s].
    """
    return replace(record, force_time=record.force_time - lead, hold_known=True, lead=lead)


def _raised(force: FloatArray) -> FloatArray:
    """Values (n,) whose straight lines have the mean of the smooth force: less a twelfth of the second difference."""
    bend = np.zeros(force.size)
    bend[1:-1] = np.diff(force, 2)
    return np.asarray(force - bend / 12.0)


def thinned(record: Record, every: int, fewest: int) -> Record:
    """Every n-th sample of a record, and the mean force in between where it may change with every sample.

    Args:
        record: the measurement.
        every: n.
        fewest: samples that must remain; a record of which fewer would is returned as it is.
    """
    count = record.samples // every if every > 1 else 0
    if count < fewest:
        return record
    stop = count * every
    time, position = record.time[:stop:every], record.position[:stop:every]
    if record.force_time.size < count // 4:
        return replace(record, time=time, position=position)
    if not record.shared_clock or record.hold != "zero":
        return record
    force = record.force[:stop].reshape(count, every).mean(axis=1)
    return replace(record, time=time, position=position, force_time=time, force=force)
