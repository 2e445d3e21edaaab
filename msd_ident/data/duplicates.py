"""Records that are one measurement under several names: together they would count its noise as averaged out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from msd_ident.data.record import FloatArray, Record

#: Part of the range of the values by which one differs from its duplicate, at most: what nine written digits lose.
_ROUNDING = 1e-8
#: Part of a sample period by which a stamp differs from its duplicate, at most.
_OF_A_PERIOD = 1e-3


def without_duplicates(records: Sequence[Record]) -> tuple[tuple[Record, ...], tuple[str, ...]]:
    """The records without those that are an earlier one again, and a sentence for each that is left out.

    A duplicate has the same positions and the same force at the same times from its beginning; its clock may read
    otherwise.
    """
    kept: list[Record] = []
    said = []
    for record in records:
        first = next((one for one in kept if _same(one, record)), None)
        if first is None:
            kept.append(record)
        else:
            said.append(
                f"{record.name} is left out: its positions and its force are those of {first.name}, sample by sample, "
                "and one measurement counts once."
            )
    return tuple(kept), tuple(said)


def _same(one: Record, other: Record) -> bool:
    if one.samples != other.samples or one.force.size != other.force.size or one.hold != other.hold:
        return False
    slack = _OF_A_PERIOD * one.period
    return (
        _near(one.position, other.position, _ROUNDING * float(np.ptp(one.position)))
        and _near(one.force, other.force, _ROUNDING * float(np.ptp(one.force)))
        and _near(one.time - one.time[0], other.time - other.time[0], slack)
        and _near(one.force_time - one.time[0], other.force_time - other.time[0], slack)
    )


def _near(one: FloatArray, other: FloatArray, slack: float) -> bool:
    return bool(np.max(np.abs(one - other), initial=0.0) <= slack)
