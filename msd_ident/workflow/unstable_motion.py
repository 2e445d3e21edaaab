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
from msd_ident.estimate.regression_init import starting_state
from msd_ident.model import Model, Simulator
from msd_ident.tuning import fixed

_NUDGE = fixed(1e-7, "accuracy", "deviation, in parts of the motion, whose growth is followed: far above rounding")
#: Units of velocity, in that of the motion's, in which a growth is looked at.
_UNITS = tuple(10.0 ** np.arange(-1.0, 3.5, 0.5))
_PIECES = fixed(200, "resources", "pieces of a record, of which each pair of start and end is looked at")


@dataclass(frozen=True)
class Stretches:
    """Records that a simulation follows.

    Attributes:
        records: the stretches, and the records that needed no cut.
        said: a sentence on what was cut, and why.
    """

    records: tuple[Record, ...]
    said: str


def stretches(fitted: FitResult, records: Sequence[Record]) -> Stretches | None:
    """The records, those cut along which the motion is unstable; None where it is nowhere.

    A stretch ends where a deviation of the size of noise would grow beyond doubt; those in which nothing moves are left
    out. Only a model with a weight that hangs on a joint is looked at: no other law of the library pushes away from a
    place for long.

    Args:
        fitted: the model of the rig.
        records: what it was fitted to.
    """
    if not any(effect.angular for effect in fitted.model.effects):
        return None
    found: list[Record] = []
    said: list[str] = []
    for record, start in zip(records, fitted.initial, strict=True):
        pieces = _pieces(record)
        turns = transitions(fitted.model, pieces, start.zero)
        if not growth(turns) > NATURAL_RANGE:
            found.append(record)
            continue
        parts = [part for part in _parts(record, pieces, _ends(turns)) if not observe(part).still]
        found += parts
        said.append(
            f"The motion of {record.name} is unstable: what moves the joint a little moves it more than "
            f"{NATURAL_RANGE:.0f} times as far later on, so no simulation follows the whole record. It was cut into "
            f"{len(parts)} stretches, each with its own start."
        )
    return Stretches(tuple(found), " ".join(said)) if said and found else None


def transitions(model: Model, pieces: Sequence[Record], zero: float) -> list[FloatArray]:
    """How each piece of a record changes a small deviation from the measured motion, (2, 2): position and velocity at
    its end for those at its start, in parts of the motion's.

    Args:
        model: of the rig.
        pieces: one after the other, each of which begins with the last sample of the one before.
        zero: reading of the relaxed spring [m].
    """
    position = np.concatenate([piece.position for piece in pieces])
    velocity = [starting_state(piece, int(A_SWING) // 2)[1] for piece in pieces]
    length, speed = float(np.std(position)), float(np.std(velocity))
    if not (length > 0.0 and speed > 0.0):
        return []
    found = []
    for piece, fast in zip(pieces, velocity, strict=True):
        simulator, place = Simulator(model, piece), float(piece.position[0]) - zero
        end = _end(simulator, place, fast)
        moved = (_end(simulator, place + _NUDGE * length, fast), _end(simulator, place, fast + _NUDGE * speed))
        columns = [(one - end) / (_NUDGE * np.array([length, speed])) for one in moved]
        found.append(np.nan_to_num(np.column_stack(columns), posinf=0.0, neginf=0.0))
    return found


def _end(simulator: Simulator, position: float, velocity: float) -> FloatArray:
    """Position and velocity (2,) at the last sample."""
    path = simulator.trajectory(simulator.model.values, position, velocity)
    return np.array([path.position[-1], path.velocity[-1]])


def growth(turns: Sequence[FloatArray]) -> float:
    """The most that a deviation grows from the start of one piece to the end of another.

    In the unit of velocity in which it is least: a swing that turns a deviation of the position into one of the
    velocity is no growth. Counting stops beyond ``NATURAL_RANGE``. Joints that hang reach 64 (measured ones that swing
    up), those that are held upright for some seconds pass it.

    Args:
        turns: (2, 2) of each piece, see ``transitions``.
    """
    return min(_growth(np.array(turns), unit) for unit in _UNITS) if len(turns) else 1.0


def _growth(turns: FloatArray, unit: float) -> float:
    """``growth`` with the velocity in so many times its unit; (n, 2, 2)."""
    scaled = turns * np.array([[1.0, unit], [1.0 / unit, 1.0]])
    whole = np.empty((0, 2, 2))
    most = 1.0
    for turn in scaled:
        whole = turn @ np.concatenate((whole, np.eye(2)[None]))
        most = max(most, float(np.max(np.abs(whole))))
        if not most <= NATURAL_RANGE:
            break
    return most


def _ends(turns: Sequence[FloatArray]) -> list[int]:
    """Numbers of the pieces with which stretches end, the last one included."""
    ends, whole = [], np.eye(2)
    for i, turn in enumerate(turns):
        whole = turn @ whole
        if i + 1 < len(turns) and float(np.linalg.norm(turns[i + 1] @ whole, 2)) > BEYOND_DOUBT:
            ends.append(i)
            whole = np.eye(2)
    return [*ends, len(turns) - 1]


def _pieces(record: Record) -> list[Record]:
    """Short equal parts of a record, each of which begins with the last sample of the one before. Without that sample
    each is long enough for a record: where a step is too short by rounding, it is the first.
    """
    count = int(np.clip(record.samples // max(A_SWING, MINIMUM_SAMPLES), 1, _PIECES))
    edges = np.linspace(0, record.samples - 1, count + 1).astype(int)
    return [
        record.window(float(record.time[first]), float(record.time[last]))
        for first, last in zip(edges, edges[1:], strict=False)
    ]


def _parts(record: Record, pieces: Sequence[Record], ends: Sequence[int]) -> list[Record]:
    """The stretches, on the record's clock and with its hold; no sample is in two of them."""
    found, begin = [], float(record.time[0])
    for end in ends:
        last = float(pieces[end].time[-1])
        part = record.window(begin, last)
        found.append(replace(part, name=f"{record.name} from {part.time[0]:.3g} s", hold_known=True))
        after = int(np.searchsorted(record.time, last, side="right"))
        begin = float(record.time[min(after, record.samples - 1)])
    return found
