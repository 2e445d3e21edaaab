"""Records of a single tone, in which mass and stiffness are one number.

Along x = A sin(ωt) inertia and spring give the force (k − m ω²)·x: a record shows that sum, and a heavier mass on a
stiffer spring gives the same one (Ljung 1999, System Identification, section 13.2: an input that is a sine determines
two parameters). What tells them apart is the rest of the motion. Where a model leaves more than noise, that is its own
error: of a motor whose mass is known from 40 other tones a fit to one of them gave 6 and 31 times as much, with
intervals of a fifth.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from msd_ident.data.quality.excitation import single_tone
from msd_ident.data.record import FloatArray, Record


def common_tone(records: Sequence[Record]) -> float:
    """Angular frequency [rad/s] of the tone that all records share; 0 where one has another, or more than one."""
    tones = [single_tone(record) for record in records]
    apart = max(1.0 / record.duration for record in records)
    if not all(tones) or max(tones) - min(tones) > apart:
        return 0.0
    return 2.0 * math.pi * float(np.mean(tones))


def stiffness_at(records: Sequence[Record], omega: float) -> float:
    """k − m ω² [N/m]: the part of the force in phase with the motion, over the motion, at a frequency ω [rad/s]."""
    products, squares = 0.0, 0.0
    for record in records:
        force, motion = (_amplitude(record.time, signal, omega) for signal in (_force(record), record.position))
        products += record.duration * (force * motion.conjugate()).real
        squares += record.duration * abs(motion) ** 2
    return products / squares if squares > 0.0 else 0.0


def _force(record: Record) -> FloatArray:
    """The force (n,) at the samples; of a held one the mean of what acts before and after a step."""
    period = record.duration / (record.samples - 1)
    return 0.5 * (record.force_at(record.time - 1e-3 * period) + record.force_at(record.time + 1e-3 * period))


def _amplitude(time: FloatArray, signal: FloatArray, omega: float) -> complex:
    """Complex amplitude of a tone, beside a straight line, by least squares."""
    phase = omega * (time - time[0])
    columns = np.column_stack([np.cos(phase), -np.sin(phase), np.ones(time.size), phase])
    cosine, sine = np.linalg.lstsq(columns, signal, rcond=None)[0][:2]
    return complex(cosine, sine)
