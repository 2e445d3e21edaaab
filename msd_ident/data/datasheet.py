"""How a record was measured: rate, gaps, jitter, resolution, and how long the cart takes to answer a force step."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from msd_ident.data.motion import observe
from msd_ident.data.quality import missing_samples
from msd_ident.data.record import Record


@dataclass(frozen=True)
class DataSheet:
    """Facts about one record; nothing is judged here, ``quality`` does that.

    Attributes:
        name: of the record.
        samples, force_samples: numbers of positions and forces.
        duration_s: first to last position.
        rate_hz: one over the median interval.
        jitter_s: standard deviation of the intervals, gaps left out.
        gaps: intervals of more than one and a half periods.
        longest_gap_s: the longest interval, a gap or not.
        missing_samples: positions that the stamps say were lost.
        encoder_step: in the position unit; 0 where none is seen.
        noise_floor: in the position unit.
        step_delay_s: from the first force step to the first motion seen; negative where the cart moves first, NaN where
            the record does not say. Inertia has its part in it: it is no clock offset, but bounds one.
        position_unit, force_unit: of the record.
        force_hold: how the force goes on between its samples: ``zero``, ``linear``, ``band_limited`` or ``centred``.
        force_lead_s: time by which the force acts before its stamps.
        origin_s: instant of the record from which laws of time count it.
    """

    name: str
    samples: int
    force_samples: int
    duration_s: float
    rate_hz: float
    jitter_s: float
    gaps: int
    longest_gap_s: float
    missing_samples: int
    encoder_step: float
    noise_floor: float
    step_delay_s: float
    position_unit: str
    force_unit: str
    force_hold: str
    force_lead_s: float = 0.0
    origin_s: float = 0.0

    def to_json_dict(self) -> dict[str, Any]:
        """Plain numbers and words."""
        return asdict(self)


def data_sheet(record: Record) -> DataSheet:
    """The facts of one record."""
    intervals = np.diff(record.time)
    gaps = intervals > 1.5 * record.period
    regular = intervals[~gaps]
    motion = observe(record)
    early = motion.early > max(2.0 * record.period, 0.002)
    return DataSheet(
        name=record.name,
        samples=record.samples,
        force_samples=-(-int(record.force.size) // record.upsampled),
        duration_s=record.duration,
        rate_hz=1.0 / record.period,
        jitter_s=float(np.std(regular)) if regular.size > 1 else 0.0,
        gaps=int(np.count_nonzero(gaps)),
        longest_gap_s=float(intervals.max()),
        missing_samples=missing_samples(record),
        encoder_step=motion.step,
        noise_floor=motion.floor,
        step_delay_s=-motion.early if early else motion.late,
        position_unit=record.position_unit,
        force_unit=record.force_unit,
        force_hold=_hold(record),
        force_lead_s=record.lead,
        origin_s=record.origin,
    )


def _hold(record: Record) -> str:
    if record.upsampled > 1:
        return "band_limited"
    return "centred" if record.hold == "zero" and math.isclose(record.lead, 0.5 * record.period) else record.hold
