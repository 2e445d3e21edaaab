"""Whether the force of an experiment excites more than one kind of motion.

A single step, a slow ramp and a release move the cart in one way, in which many causes look alike. What sets a cart
swinging is a change of the force within a part of a swing: steps in both directions and sweeps have many of them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.levels import TENTH
from msd_ident.tuning import fixed, tuned

FEWEST = tuned(
    4,
    unit="changes",
    why="quick changes of the force that an experiment needs: two pushes there and back",
    chosen="by hand",
)
_QUICK = fixed(0.25, "mathematics", "part of a swing from rest to its extreme: a change within it sets a cart swinging")
_LOOKS = fixed(4, "accuracy", "instants at which the force is looked at in each quick time")


def poor(records: Sequence[Record], swing: float) -> bool:
    """Whether the force changes quickly fewer than ``FEWEST`` times, or in one direction alone.

    Args:
        records: one experiment, whose changes count together.
        swing: period of the plant's oscillation [s].
    """
    sizes = np.concatenate([changes(record, swing) for record in records])
    return bool(sizes.size < FEWEST or np.all(sizes > 0.0) or np.all(sizes < 0.0))


def changes(record: Record, swing: float) -> FloatArray:
    """Quick changes of a record's force: rises > 0 and falls < 0, in its unit.

    Args:
        record: the measurement.
        swing: period of the plant's oscillation [s]. A change is quick if it is larger than a tenth of the force's
            range within a fixed part of this period.
    """
    quick = _QUICK * swing
    count = min(int(np.ceil(record.duration / quick * _LOOKS)) + 1, 4 * record.samples)
    time = np.linspace(record.time[0], record.time[-1], count)
    force = record.force_at(np.append([np.nextafter(record.time[0], -np.inf)] * _LOOKS, time))
    change = force[_LOOKS:] - force[:-_LOOKS] if force.size > _LOOKS else np.zeros(1)
    limit = TENTH * float(np.ptp(force))
    signs = np.where(np.abs(change) > limit, np.sign(change), 0.0)
    begins = np.flatnonzero((signs != 0.0) & (np.concatenate(([0.0], signs[:-1])) != signs))
    return np.asarray(change[begins])
