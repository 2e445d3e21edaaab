"""Motions that no simulation follows from the first sample on, cut into stretches that one follows.

A joint that a controller holds over its axis falls without it: a deviation grows as e^(rate·t), and with it the effect
of every force that was not recorded, however small. Of a whole record a fit then finds whatever laws happen to follow
it. Over a short stretch with a start of its own the deviation stays small, as in multiple shooting (Bock and Plitt
1984, IFAC World Congress).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.motion import observe
from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Record
from msd_ident.estimate import FitResult
from msd_ident.estimate.effort import A_SWING
from msd_ident.estimate.levels import BEYOND_DOUBT, NATURAL_RANGE
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.regression_init import starting_state
from msd_ident.model import Model, Simulator
from msd_ident.tuning import fixed

_NUDGE = fixed(1e-7, "accuracy", "deviation, in amplitudes, whose growth is followed: far above rounding")


@dataclass(frozen=True)
class Stretches:
    """Records that a simulation follows.

    Attributes:
        records: the stretches, and the records that needed no cut.
        said: a sentence on what was cut, and why.
    """

    records: tuple[Record, ...]
    said: str


def growth(model: Model, record: Record, start: Initial) -> float:
    """How many times as large a deviation becomes along a record as it has been before.

    Args:
        model: of the rig.
        record: gives force and stamps.
        start: state and zero at the first sample.
    """
    simulator = Simulator(model, record)
    path = simulator.trajectory(model.values, start.position, start.velocity)
    length, speed = float(np.std(path.position)), float(np.std(path.velocity))
    if not (length > 0.0 and speed > 0.0):  # a cart that sticks, or a motion that leaves all bounds
        return 1.0
    found = [1.0]
    for step in ((_NUDGE * length, 0.0), (0.0, _NUDGE * speed)):
        other = simulator.trajectory(model.values, start.position + step[0], start.velocity + step[1])
        away = np.hypot((other.position - path.position) / length, (other.velocity - path.velocity) / speed)
        # Friction and stops end a deviation; what is left of it is rounding, and no start of a growth.
        least = np.minimum.accumulate(np.maximum(away, 1e-3 * _NUDGE))
        found.append(float(np.max(away / least)))
    return max(found)


def stretches(fitted: FitResult, records: Sequence[Record]) -> Stretches | None:
    """The records, cut where the motion of a fitted model is unstable; None where it is nowhere.

    Rigs with a stable motion reach a growth of 160 (stops, and a start from rest); joints that stand over their axis
    for some seconds 6000 and more.

    Args:
        fitted: the model, with the start of each record.
        records: what it was fitted to.
    """
    found: list[Record] = []
    cut: list[str] = []
    for record, start in zip(records, fitted.initial, strict=True):
        grown = growth(fitted.model, record, start)
        if not grown > NATURAL_RANGE:
            found.append(record)
            continue
        parts = _followed(fitted.model, record, start.zero)
        found += parts
        cut.append(
            f"The motion of {record.name} is unstable: what moves the joint a little moves it more than "
            f"{NATURAL_RANGE:.0f} times as far later on, so no simulation follows the whole record. It was cut into "
            f"{len(parts)} stretches of {parts[0].duration:.2g} s, each with its own start."
        )
    return Stretches(tuple(found), " ".join(cut)) if cut else None


def _followed(model: Model, record: Record, zero: float) -> list[Record]:
    """The longest equal parts along which no deviation of the size of noise grows beyond doubt; those in which the
    joint moves.
    """
    count = 2
    while True:
        parts = [part for part in _parts(record, count) if not observe(part).still]
        short = record.samples // (2 * count) < max(A_SWING, MINIMUM_SAMPLES)
        if short or all(growth(model, part, _start(part, zero)) <= BEYOND_DOUBT for part in parts):
            return parts
        count *= 2


def _parts(record: Record, count: int) -> list[Record]:
    """Parts of equal numbers of samples, on the record's clock and with its hold."""
    pieces: list[FloatArray] = np.array_split(record.time, count)
    parts = [record.window(float(piece[0]), float(piece[-1])) for piece in pieces]
    return [replace(part, name=f"{record.name} from {part.time[0]:.3g} s", hold_known=True) for part in parts]


def _start(part: Record, zero: float) -> Initial:
    position, velocity = starting_state(part, int(A_SWING) // 2)
    return Initial(position - zero, velocity, zero)
