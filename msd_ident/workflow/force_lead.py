"""A force that acts before its stamps, by up to half a sample: a matter of the recording, and no cause.

A simulation that steps the velocity first and the position with the new velocity (semi-implicit Euler: Gazebo, Bullet,
DART, Drake's discrete plant, MuJoCo) makes the motion of a force that acts half an integration step earlier. Half a
sample is that of one step a sample; of several steps a sample it is less. A sensor that averages about its stamp does
the same. A longer lead, or a delay, is something else: stamps of another clock, a reading taken after the step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_ident.data.record import Record
from msd_ident.data.resampling import centred, led
from msd_ident.estimate import FitResult, fit
from msd_ident.estimate.effort import SHORT
from msd_ident.estimate.levels import NEGLIGIBLE, TENTH
from msd_ident.model.effects import structural
from msd_ident.model.effects.law import DELAY
from msd_ident.quantity import Z95
from msd_ident.tuning import tuned
from msd_ident.workflow.force_hold import may_lead
from msd_ident.workflow.law_error import widened

#: Of a lead that no diagnosis named.
_CLEAR = tuned(4.0, unit="1", why="standard deviations from which a lead of the force counts", chosen="by hand")


def half_sample(records: Sequence[Record]) -> float:
    """Half the shortest sampling period [s] of records."""
    return 0.5 * min(record.period for record in records)


def found(fitted: FitResult, records: Sequence[Record]) -> float:
    """By how much the force acts before its stamps [s], up to half a sample; 0 where it does not.

    It is half a sample where the data does not tell it from that, and all records have the same rate.

    Args:
        fitted: the diagnosed model. If it has no delay, it is fitted once more with one.
        records: that it was fitted to, with ``hold_known`` as it was told. A force that goes on between its samples is
            none of a simulation.
    """
    delay, late = structural(DELAY), [record for record in records if _may_be_late(record)]
    if delay is None or not late:
        return 0.0
    named = fitted.model.has(delay.name)
    if not named:
        kept = frozenset(fitted.model.names) - frozenset(fitted.free)
        timed = fitted.model + delay.within_bounds(0.0)
        near = fit(timed, records, fixed=kept, search="near", initial=fitted.initial, steps=SHORT)
        fitted = widened(near)  # beside the error of a law, a lead may stand for a part of it
    seen, half = fitted.quantities[delay.parameters[0].name], half_sample(late)
    lead, std = -seen.value, seen.std
    if not (math.isfinite(std) and lead > NEGLIGIBLE * half and lead > (Z95 if named else _CLEAR) * std):
        return 0.0
    alike = max(record.period for record in late) < (1.0 + TENTH) * 2.0 * half
    if alike and abs(lead - half) < Z95 * std:
        return half
    return lead if lead < half + Z95 * std else 0.0


def shifted(record: Record, lead: float) -> Record:
    """The record with a force that acts so much earlier [s], if its stamps may be late and it is held."""
    if not _may_be_late(record):
        return record
    return centred(record) if math.isclose(lead, half_sample([record])) else led(record, lead)


def _may_be_late(record: Record) -> bool:
    return may_lead(record) and record.hold == "zero"


def sentence(lead: float, records: Sequence[Record]) -> str:
    """What was assumed, and why."""
    half = half_sample(records)
    part = "half a sample" if lead >= half or math.isclose(lead, half) else "less than half a sample"
    return (
        f"The force is assumed to act {lead * 1e3:.3g} ms before its stamps, {part}: simulations with semi-implicit "
        f"Euler steps do so, of {2e3 * lead:.3g} ms here. It is no cause. If the stamps are right, use --hold zero"
        + ("; if they are half a sample late, --hold centred ends the question." if part == "half a sample" else ".")
    )
