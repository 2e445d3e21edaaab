"""Starting values of a force that repeats along the travel, by linear regression: no simulation, no local minimum.

Where a cart sticks at the ripples, the error of a simulation has a minimum for every ripple in which the cart may come
to rest. The equation of motion at the measured positions is linear in the force of the ripples. In the weak form of
``regression_init``, what the plant, dry friction, drag and a bent spring leave is regressed on the sine and the cosine
of 2πx/p, for each pitch p of an even scale of 1/p.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import KEPT, SAMPLES
from msd_ident.estimate.levels import KNOTS
from msd_ident.estimate.peaks import highest
from msd_ident.estimate.weak_form import WIDTHS, Means, uniform
from msd_ident.model.effects import typical
from msd_ident.tuning import fixed

#: Amplitude [N], pitch [m] and phase [rad] of a ripple.
Ripple = tuple[float, float, float]

_FINE = fixed(9, "accuracy", "trials around a pitch that the scan found, within one step of it on either side")


@dataclass(frozen=True)
class Found:
    """A ripple in a record.

    Attributes:
        ripple: its amplitude [N], pitch [m] and phase [rad] at position 0; where no force acts, the amplitude is that
            of a cart of 1 kg.
        worth: what it explains over what it leaves, times the degrees of freedom (Fisher's F but for a factor).
        share: part of the force that it explains, of what the plant, friction, drag and a bent spring leave.
        pushed: whether a force acted.
    """

    ripple: Ripple
    worth: float
    share: float
    pushed: bool


def ripples(record: Record, mass: float) -> list[Ripple]:
    """The ripples that explain most of the force in a record, the best first; at most ``KEPT``.

    Args:
        record: the measurement.
        mass: of the cart [kg]; it gives the amplitude in newtons where no force acts.

    Returns:
        For each its amplitude [N], pitch [m] and phase [rad] at position 0; none if the record is too short.
    """
    return [((1.0 if one.pushed else mass) * one.ripple[0], *one.ripple[1:]) for one in found_in(record)]


def found_in(record: Record) -> list[Found]:
    """The best ripples of a record over all widths of the bump, the best first; at most ``KEPT``.

    A record with more than ``SAMPLES`` samples is thinned.
    """
    return record.kept("ripples", partial(_scanned, record), small=True)


def _scanned(record: Record) -> list[Found]:
    every = max(1, record.samples // SAMPLES)
    few = replace(record, time=record.time[::every], position=record.position[::every])
    level = float(few.position[0])
    grid = uniform(few, level)
    pushed = bool(np.ptp(grid.force) > 0.0)
    span = max(float(np.ptp(grid.position)), 1e-9)
    bends = np.linspace(grid.position.min(), grid.position.max(), 2 * KNOTS - 1)[1:-1]
    spring = np.maximum(grid.position - bends[:, None], 0.0)
    waves = 1.0 / typical.pitches(span)
    pairs = _signals(waves, grid.position)
    fine = np.linspace(-1.0, 1.0, _FINE) * (waves[1] - waves[0])
    finer: dict[int, FloatArray] = {}
    found: list[Found] = []
    for half in WIDTHS:
        if 2 * half + 1 > few.samples // 3:
            break
        means = Means(grid, half)
        left = _left(means, spring, pushed)
        if left is None:
            continue
        for peak in highest(_gain(means, left, pairs)[0]):
            near = waves[peak] + fine
            if peak not in finer:
                finer[peak] = _signals(near, grid.position)
            gain, s, c = _gain(means, left, finer[peak])
            i = int(np.argmax(gain))
            share = float(gain[i]) / max(float(left.force @ left.force), 1e-300)
            phase = math.atan2(c[i], s[i]) - 2.0 * math.pi * near[i] * level
            ripple = math.hypot(s[i], c[i]), 1.0 / float(near[i]), phase
            spare = left.force.size - left.basis.shape[1] - 2
            found.append(Found(ripple, spare * share / max(1.0 - share, 1e-12), share, pushed))
    return _distinct(sorted(found, key=lambda one: -one.worth), span)


def _signals(waves: FloatArray, position: FloatArray) -> FloatArray:
    """Sines, then cosines (2w, n), of w wave numbers [1/m]."""
    angles = 2.0 * np.pi * np.outer(waves, position)
    return np.concatenate([np.sin(angles), np.cos(angles)])


@dataclass(frozen=True)
class _Left:
    """Force (r,) [N] that smooth laws leave at each place of the bump, and an orthonormal basis (r, p) of them."""

    force: FloatArray
    basis: FloatArray


def _left(means: Means, spring: FloatArray, pushed: bool) -> _Left | None:
    """None if there are too few places of the bump."""
    frame, force = np.column_stack([means.motion(), means.smoothed(spring)]), means.force
    if not pushed:
        frame, force = frame[:, 1:], -frame[:, 0]  # nothing sets the scale but the mass, whose column stands first
    if force.size < 2 * (frame.shape[1] + 2):
        return None
    basis = np.linalg.qr(frame / np.maximum(np.linalg.norm(frame, axis=0), 1e-300))[0]
    return _Left(force - basis @ (basis.T @ force), basis)


def _gain(means: Means, left: _Left, signals: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What each sine with its cosine explains (w,) [N²], and the forces (w,) [N] of both."""
    pairs = means.smoothed(signals)
    pairs -= left.basis @ (left.basis.T @ pairs)
    sines, cosines = np.split(pairs, 2, axis=1)
    ss, cc, sc = (np.sum(a * b, axis=0) for a, b in ((sines, sines), (cosines, cosines), (sines, cosines)))
    rs, rc = sines.T @ left.force, cosines.T @ left.force
    size = np.maximum(ss * cc - sc**2, 1e-12 * (ss + cc) ** 2 + 1e-300)
    s, c = (cc * rs - sc * rc) / size, (ss * rc - sc * rs) / size
    return s * rs + c * rc, s, c


def _distinct(found: list[Found], span: float) -> list[Found]:
    """The first of the ripples that differ by less than one over the travel; at most ``KEPT``."""
    kept: list[Found] = []
    for one in found:
        if all(abs(1.0 / one.ripple[1] - 1.0 / other.ripple[1]) * span > 1.0 for other in kept):
            kept.append(one)
    return kept[:KEPT]
