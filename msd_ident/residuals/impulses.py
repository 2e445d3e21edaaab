"""Pushes that are in no force signal, as a bump against the table or a collision; and readings that move alone.

A push shows as a short, strong missing force in a record that is otherwise explained. A cause that belongs to the rig
acts again and again, with every swing; a push comes once or twice. A missing force that pushes as much one way as the
other leaves the speed as it was: the readings moved, as those of an encoder do that slips.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.data.quality.cleaning import sudden
from msd_ident.data.quality.sampling import SHORT_GAP
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import FitResult
from msd_ident.estimate.effort import LONG_RECORD
from msd_ident.estimate.levels import BEYOND_DOUBT, MOST_OF, TENTH
from msd_ident.model import Model
from msd_ident.model.base_model import DRY_FRICTION, friction_force
from msd_ident.quantity import MAD
from msd_ident.residuals.disturbance import lacking_force, missing_force
from msd_ident.tuning import fixed, tuned

_MOST = tuned(2, unit="pushes", why="pushes that are named, at most: there are few of them", chosen="by hand")

_LATE = fixed(3, "interface", "samples by which a force may be off its stamps before its own impulse is told as a push")


@dataclass(frozen=True)
class Push:
    """An impulse on the cart.

    Attributes:
        time: of its peak [s].
        impulse: of the force [N·s], with the sign of the position; NaN of one that pushes to and fro.
        jump: how far the readings moved at once [m], where they did and the speed did not; else 0.
    """

    time: float
    impulse: float
    jump: float = 0.0


def pushes(
    record: Record, model: Model, noise: float, zero: float, residual: FloatArray | None = None
) -> tuple[Push, ...]:
    """Pushes in a record, and readings that move alone: short, strong missing forces of a model that explains the rest
    of it; none if there are many, and none beside a stop.

    What begins or ends with the record is none: the first and the last swing of a model that lacks a law look so, and
    what pushed the cart before is its initial state.

    Args:
        record: the measurement.
        model: with mass [kg], damping [N·s/m] and stiffness [N/m].
        noise: standard deviation of a reading [m].
        zero: reading at which the spring is relaxed [m].
        residual: of the simulated model (n,) [m], needed where it has laws besides dry friction: their own force is no
            push.
    """
    if record.samples > LONG_RECORD or not model["stiffness"] > 0.0:
        return ()
    if any(effect.stops() for effect in model.effects):  # its own force is short and strong
        return ()
    found = _unexplained(record, model, noise, zero, residual)
    period = 2.0 * math.pi * math.sqrt(model["mass"] / model["stiffness"])
    edges = np.flatnonzero(
        np.diff(np.concatenate([[False], np.abs(found.force) > found.limit, [False]]).astype(np.int8))
    )
    spans = list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
    groups: list[tuple[int, int]] = []
    for begin, end in spans:  # what rings at both sides of a peak belongs to it
        if groups and record.time[begin] - record.time[groups[-1][1] - 1] < MOST_OF * period:
            groups[-1] = (groups[-1][0], end)
        else:
            groups.append((begin, end))
    if len(groups) > _MOST or any(
        record.time[end - 1] - record.time[begin] > MOST_OF * period for begin, end in groups
    ):
        return ()
    whole = found.force.size
    seen = [span for span in groups if span[0] > 0 and span[1] < whole and _is_seen(record, *span)]
    named = [
        push
        for push, span in ((_push(record, found, *span), span) for span in seen)
        if math.isfinite(push.impulse) or push.jump or not _answers_the_force(record, *span)
    ]
    low, high = _usual_ground(record, groups, MOST_OF * period)
    return tuple(
        push
        for push in named
        if low <= np.interp(push.time, record.time, record.position) <= high
        and not _is_timing(record, push, len(groups))
    )


@dataclass(frozen=True)
class _Unexplained:
    """Force (n,) that a model lacks [N], with the sign of the position, and the size (n,) beyond which it is a push.

    ``exact``: whether it is found from the readings; else a linear plant stands for the model, and it swings after a
    push.
    """

    force: FloatArray
    limit: FloatArray
    exact: bool


def _unexplained(record: Record, model: Model, noise: float, zero: float, residual: FloatArray | None) -> _Unexplained:
    plant = (model["mass"], model["damping"], model["stiffness"])
    if residual is None or _is_plain(model):
        found = missing_force(record, plant, noise, zero)
        friction = friction_force(model) * np.sign(found.velocity)
        force = friction - found.force
        least = 2.0 * float(np.max(np.abs(friction)))
        return _Unexplained(force, BEYOND_DOUBT * np.maximum(_usual(force), found.std) + least, exact=True)
    found = lacking_force(record, residual, plant, noise)
    # A linear plant stands for the model: after a push it errs by a part of it.
    least = MOST_OF**2 * float(np.max(np.abs(found.force)))
    limit = np.maximum(BEYOND_DOUBT * np.maximum(_usual(found.force), found.std), least)
    return _Unexplained(-found.force, limit, exact=False)


def _is_plain(model: Model) -> bool:
    """Whether a model has no law besides dry friction."""
    return set(model.effect_names) <= {DRY_FRICTION}


def _usual(force: FloatArray) -> float:
    """Robust size of a force [N]."""
    return MAD * float(np.median(np.abs(force)))


def _is_seen(record: Record, begin: int, end: int) -> bool:
    """Whether the readings follow each other around it: what happened in a gap is no push."""
    return float(np.max(np.diff(record.time[max(begin - 5, 0) : end + 5]))) < SHORT_GAP * record.period


def _answers_the_force(record: Record, begin: int, end: int) -> bool:
    """Whether the force changes there as it seldom does: what pushes to and fro then is what the rig makes of this
    change, by a law that the model lacks. Of a knock at any instant, the chance to be there is less than a tenth.
    """
    change = np.abs(np.diff(record.force_at(record.time)))
    large = np.flatnonzero(change >= MOST_OF * np.max(change)) if np.any(change) else np.empty(0)
    met = np.any((large >= begin - _LATE) & (large < end + _LATE))
    return bool(met and large.size * (end - begin + 2 * _LATE) < TENTH * record.samples)


def _usual_ground(record: Record, groups: Sequence[tuple[int, int]], apart: float) -> tuple[float, float]:
    """Lowest and highest position further than ``apart`` [s] from every strong missing force: beyond it a law of the
    place may act where the cart comes but once, as a rope that goes slack. No limits where less than a swing is left.
    """
    elsewhere = np.ones(record.samples, dtype=bool)
    for begin, end in groups:
        elsewhere &= (record.time < record.time[begin] - apart) | (record.time > record.time[end - 1] + apart)
    position = record.position[elsewhere]
    if position.size * record.period < 2.0 * apart:
        return -math.inf, math.inf
    return float(position.min()), float(position.max())


def _is_timing(record: Record, push: Push, found: int) -> bool:
    """Whether a change of the force that is a few samples early or late makes such an impulse: stamps that are off do
    so at every such change, so that there are few more of these than strong missing forces (``found``).
    """
    force, width = record.force_at(record.time), 2 * _LATE + 2  # between two samples
    change = np.ptp(np.lib.stride_tricks.sliding_window_view(force, width), axis=1)
    here = float(change[np.clip(np.searchsorted(record.time, push.time) - _LATE - 1, 0, change.size - 1)])
    alike = np.count_nonzero(change >= MOST_OF * here) / (width - 1)
    return bool(alike < 2 * (found + 1) and abs(push.impulse) < here * _LATE * record.period)


def sentences(records: Sequence[Record], fitted: FitResult, noise: float) -> tuple[str, ...]:
    """A warning for each push that a fit shows.

    Args:
        records: the records of the fit.
        fitted: the fit; it gives the model and the zero of each record.
        noise: standard deviation of a reading [m].
    """
    said, mass = [], fitted.quantities["mass"]
    sized = mass.known and _is_plain(fitted.model)  # beside other laws a linear plant stands for the model
    for record, residual, initial in zip(records, fitted.residuals, fitted.initial, strict=True):
        for push in pushes(record, fitted.model, noise, initial.zero, residual):
            where = f" of {record.name}" if len(records) > 1 else ""
            if push.jump:
                said.append(
                    f"The readings move by about {push.jump:.2g} {record.position_unit} at {push.time:.3f} s{where} "
                    "while the speed stays, as no push makes them: the encoder slipped or missed counts, or its scale "
                    "is uneven there, or samples were lost that the stamps do not show. It makes the parameters wrong: "
                    "check cable and coupling, or leave this part out with --start or --end."
                )
                continue
            known = sized and math.isfinite(push.impulse)
            size = f"about {push.impulse:.3g} {record.force_unit}·s that are" if known else "an impulse that is"
            said.append(
                f"Something pushed the cart at {push.time:.3f} s{where} with {size} in no signal: a bump, a "
                "collision, or a stop or a limit of the drive that the model lacks. It makes the parameters wrong: "
                "exclude this part with --start or --end, or repeat the record."
            )
    return tuple(said)


def _push(record: Record, found: _Unexplained, begin: int, end: int) -> Push:
    width = end - begin
    part = slice(max(begin - width, 0), end + width)
    peak = float(record.time[begin + int(np.argmax(np.abs(found.force[begin:end])))])
    impulse, both_ways = (
        float(np.trapezoid(size, record.time[part])) for size in (found.force[part], np.abs(found.force[part]))
    )
    if not found.exact or abs(impulse) > MOST_OF * both_ways:
        return Push(peak, impulse)
    steps = sudden(record)  # a push to and fro takes the cart there on the way
    here = steps.size[(steps.index >= begin - _LATE) & (steps.index <= end + _LATE)]
    return Push(peak, math.nan, max(here.tolist(), key=abs, default=0.0))
