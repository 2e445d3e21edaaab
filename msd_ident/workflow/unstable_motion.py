"""Motions that no simulation follows from the first sample on, cut into stretches that one follows.

A joint that a controller holds over its axis falls without it: a deviation grows as e^(rate·t), and with it the effect
of every force that was not recorded, however small. Of a whole record a fit then finds whatever laws happen to follow
it. Over a short stretch with a start of its own the deviation stays small, as in multiple shooting (Bock and Plitt
1984, IFAC World Congress).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from msd_ident.data.motion import observe
from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Record
from msd_ident.estimate import FitResult, Initial, fit
from msd_ident.estimate.effort import A_SWING
from msd_ident.estimate.formulation import formulate, regressed
from msd_ident.estimate.levels import BEYOND_DOUBT, MOST_OF, NATURAL_RANGE, TENTH
from msd_ident.estimate.regression_init import starting_state
from msd_ident.model import Model, Simulator
from msd_ident.model.base_model import DryFriction
from msd_ident.model.effects import LIBRARY, typical
from msd_ident.tuning import fixed
from msd_ident.workflow.preparation import Prepared
from msd_ident.workflow.spring_decision import by_tone
from msd_ident.workflow.starting_plant import typical_plant

_NUDGE = fixed(1e-7, "accuracy", "deviation, in parts of the motion, whose growth is followed: far above rounding")
#: Units of velocity, in that of the motion's, in which a growth is looked at.
_UNITS = tuple(10.0 ** np.arange(-1.0, 3.5, 0.5))
#: Samples that tell a velocity.
_FEW = int(A_SWING) // 2
_MOST = fixed(24, "resources", "stretches that are fitted: each has a start, so the work grows by their square")
_PIECES = fixed(200, "resources", "pieces of a record, of which each pair of start and end is looked at")


@dataclass(frozen=True)
class Cut:
    """Records as simulations follow them.

    Attributes:
        whole: the records that were looked at. Their angles count from where the joint hangs: a stretch is too short to
            tell where that is.
        parts: of each its stretches, ``_MOST`` in all; a record along which no motion is unstable alone.
        model: whose motion is unstable there.
        zeros: readings at which the joint hangs in each record [rad].
        counts: stretches into which each record was cut.
    """

    whole: tuple[Record, ...]
    parts: tuple[tuple[Record, ...], ...]
    model: Model
    zeros: tuple[float, ...]
    counts: tuple[int, ...]

    @property
    def records(self) -> tuple[Record, ...]:
        """All stretches."""
        return tuple(part for parts in self.parts for part in parts)

    @cached_property
    def weighed(self) -> FitResult:
        """The model fitted to the stretches, from where it stands."""
        return self._fitted(self.model)

    @cached_property
    def needless(self) -> bool:
        """Whether nothing needs the weight. Fitted to the stretches, it is too light for an unstable motion; or a model
        without it leaves less than twice the error on the stretches, and less than a quarter of the motion on the whole
        records.

        A regression finds a weight on an axis that stands upright, too, where that does what noise or a hidden mass do.
        """
        if not any(_turns(self.weighed.model, record, _pieces(record)) for record in self.whole):
            return True
        light = self.model.without(*(effect.name for effect in self.model.effects if effect.angular))
        # A spring as large as the weight, which a regression may pair with it, is no start for a model without it.
        whole = fit(light, self.whole, search="wide", initial=[_started(record) for record in self.whole])
        moved = [record.position - np.mean(record.position) for record in self.whole]
        if not whole.see < MOST_OF**2 * float(np.std(np.concatenate(moved))):
            return False
        return self.weighed.see >= MOST_OF * min(self._fitted(one).see for one in (light, whole.model))

    def _fitted(self, model: Model) -> FitResult:
        return fit(model, self.records, search="near", initial=[_started(part) for part in self.records])

    @property
    def said(self) -> str:
        """A sentence on each record that was cut, and why."""
        return " ".join(
            f"The motion of {record.name} is unstable: what moves the joint a little moves it more than "
            f"{NATURAL_RANGE:.0f} times as far later on, so no simulation follows the whole record. "
            f"{'One stretch of it is used,' if count == 1 else f'It was cut into {count} stretches, each'} with its "
            "own start"
            f"{f', of which {len(parts)} are used' if len(parts) < count else ''}. Angles count from where the joint "
            f"hangs, {zero:.3g} {record.position_unit} by the encoder."
            for record, parts, count, zero in zip(self.whole, self.parts, self.counts, self.zeros, strict=True)
            if parts[0] is not record
        )


def by_regression(records: Sequence[Record]) -> Cut | None:
    """The stretches of a joint that carries a weight, by a regression; None where no motion is unstable, or where
    inertia, friction and that weight follow it to the noise.

    No simulation follows an unstable record, so a search of the whole may miss the weight. A regression of the force on
    the motion needs none. Of its starts, the one that foretells the next readings best tells how a deviation grows.

    Args:
        records: prepared ones of one rig.
    """
    joint = _joint(records[0])
    if joint is None:
        return None
    tone = by_tone(records)
    held = ("stiffness",) if tone is not None and not tone.sprung else ()
    if held:
        joint = joint.with_values({"stiffness": 0.0})
    starts = [
        (joint.with_values(start.values), tuple(zero for _, _, zero in start.initial))
        for start in regressed(formulate(joint, tuple(records), held, "free"))
    ]
    if not starts:
        return None
    pieces = [_pieces(record) for record in records]
    cut = _cut(*min(starts, key=lambda one: _missed(one[0], one[1], pieces)), records)
    return cut if cut.said and not (cut.needless or followed(cut.weighed, cut)) else None


def _joint(record: Record) -> Model | None:
    """A joint of a record's size that carries a weight; None where the law cannot act."""
    weights = [effect for effect in LIBRARY if effect.angular and effect.fits(record)]
    if not weights:
        return None
    plant = typical_plant(record)
    for weight in weights:
        plant = plant + weight.guess(record, plant)[0]
    return plant + DryFriction(TENTH**2 * typical.force(record, plant))


def cut_into(prepared: Prepared, cut: Cut) -> Prepared:
    """The same with the stretches in place of the records; what is known of those holds on. A stretch begins and ends
    where it was cut, so no feature is read from it.
    """
    return replace(
        prepared,
        records=cut.records,
        features=(),
        form=None,
        warnings=(cut.said, *prepared.warnings),
        rest_before=(None,) * len(cut.records),
        unheld=(),
    )


def beside_their_starts(records: Sequence[Record]) -> tuple[Record, ...]:
    """Stretches less the straight line through each: a start of its own explains that without any force."""
    found = []
    for record in records:
        time = record.time - record.time[0]
        line = np.polyval(np.polyfit(time, record.position, 1), time)
        found.append(replace(record, position=record.position - line))
    return tuple(found)


def followed(fitted: FitResult, cut: Cut) -> bool:
    """Whether a model of stretches with a weight, fitted to their records as a whole, leaves no more than noise: its
    laws are the rig's.
    """
    whole = fit(fitted.model, cut.whole, search="near", initial=[_started(record) for record in cut.whole])
    return whole.see**2 <= 2.0 * whole.noise_floor**2


def _started(record: Record, zero: float = 0.0) -> Initial:
    """The state at the first sample, from the first readings."""
    position, velocity = starting_state(record, _FEW)
    return Initial(position - zero, velocity, zero)


def by_model(fitted: FitResult, records: Sequence[Record]) -> Cut | None:
    """The stretches of records along which the motion of a fitted model is unstable; None where it is nowhere.

    Only a model with a weight that hangs on a joint is looked at: no other law of the library pushes away from a place
    for long.

    Args:
        fitted: the model of the rig.
        records: what it was fitted to.
    """
    if not any(effect.angular for effect in fitted.model.effects):
        return None
    cut = _cut(fitted.model, tuple(start.zero for start in fitted.initial), records)
    return cut if cut.said and not cut.needless else None


def _cut(model: Model, zeros: tuple[float, ...], records: Sequence[Record]) -> Cut:
    pairs = zip(records, zeros, strict=True)
    whole = tuple(replace(record, position=record.position - zero) for record, zero in pairs)
    parts = [_stretches(model, record) for record in whole]
    fewer = max(_MOST // len(parts), 1)
    used = (part if len(part) <= fewer else tuple(part[i] for i in _spread(len(part), fewer)) for part in parts)
    return Cut(whole, tuple(used), model, zeros, tuple(map(len, parts)))


def _spread(count: int, fewer: int) -> list[int]:
    """``fewer`` of so many indices, evenly spread."""
    return [round(place) for place in np.linspace(0, count - 1, fewer)]


def _stretches(model: Model, record: Record) -> tuple[Record, ...]:
    """The stretches of a record that counts from the model's zero; the record alone where its motion is not unstable.

    A stretch ends where a deviation of the size of noise would grow beyond doubt; those in which nothing moves are left
    out.
    """
    pieces = _pieces(record)
    turns = _turns(model, record, pieces)
    if not turns:
        return (record,)
    parts = _parts(record, pieces, _ends(turns))
    return tuple(part for part in parts if not observe(part).still) or (record,)


def _turns(model: Model, record: Record, pieces: Sequence[Record]) -> list[FloatArray]:
    """The ``transitions`` along a record that counts from the model's zero; none where no deviation grows much.

    A weight that never gets higher than its axis pulls back everywhere, even if the errors of many pieces add up to a
    growth.
    """
    if np.min(np.cos(record.position)) >= 0.0:
        return []
    found = transitions(model, pieces)
    return found if growth(found) > NATURAL_RANGE else []


def transitions(model: Model, pieces: Sequence[Record]) -> list[FloatArray]:
    """How each piece of a record changes a small deviation from the measured motion, (2, 2): position and velocity at
    its end for those at its start, in parts of the motion's.

    Args:
        model: of the rig.
        pieces: one after the other, each of which begins with the last sample of the one before. They count from the
            model's zero.
    """
    position = np.concatenate([piece.position for piece in pieces])
    velocity = [starting_state(piece, _FEW)[1] for piece in pieces]
    length, speed = float(np.std(position)), float(np.std(velocity))
    if not (length > 0.0 and speed > 0.0):
        return []
    found = []
    for piece, fast in zip(pieces, velocity, strict=True):
        simulator, place = Simulator(model, piece), float(piece.position[0])
        end = _end(simulator, place, fast)
        moved = (_end(simulator, place + _NUDGE * length, fast), _end(simulator, place, fast + _NUDGE * speed))
        columns = [(one - end) / (_NUDGE * np.array([length, speed])) for one in moved]
        found.append(np.nan_to_num(np.column_stack(columns), posinf=0.0, neginf=0.0))
    return found


def _missed(model: Model, zeros: Sequence[float], pieces: Sequence[Sequence[Record]]) -> float:
    """How far simulations of the pieces of records end from where the next ones begin, root of the sum of squares."""
    missed = []
    for of_one, zero in zip(pieces, zeros, strict=True):
        starts = [_started(piece, zero) for piece in of_one]
        for piece, start, after in zip(of_one, starts, starts[1:], strict=False):
            missed.append(_end(Simulator(model, piece), start.position, start.velocity)[0] - after.position)
    return float(np.linalg.norm(missed)) if np.all(np.isfinite(missed)) else math.inf


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
