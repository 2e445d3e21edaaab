"""Sizes of a motion that starting values are made from."""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.record import Record
from msd_ident.model.plant import FloatArray, Model

#: Pitches of a ripple that can be told, in parts of the travel: one that is seen less than two and a half times is a
#: bent spring.
PITCHES = (0.02, 0.4)
#: Step of a scan over pitches, in ripples over the travel: a ripple that is half a step off stays in phase.
STEP = 0.25


def amplitude(record: Record) -> float:
    """Half the range of the positions [m]; never zero."""
    return max(0.5 * float(np.ptp(record.position)), 1e-9)


def speed(record: Record) -> float:
    """A robust largest speed [m/s]: the fastest twentieth of the time in which the cart moves, however long it rests.

    The speed is taken over the shortest stretch whose motion outgrows noise.
    """
    level = 40.0 / 6.0 * float(np.mean(np.diff(record.position, 2) ** 2))  # a change that is no noise, squared
    stretch, longest = 1, max(record.samples // 50, 1)
    while True:
        rise = np.abs(record.position[stretch:] - record.position[:-stretch])
        if float(np.mean(rise**2)) > level or 2 * stretch > longest:
            break
        stretch *= 2
    run = record.time[stretch:] - record.time[:-stretch]
    moves = rise**2 > level
    speeds = (rise / run)[moves] if moves.any() else rise / run
    return max(float(np.quantile(speeds, 0.95)), 1e-9)


def force(record: Record, plant: Model) -> float:
    """The largest force at work [N]: commanded, or the spring's in a free motion; never zero."""
    commanded = float(np.max(np.abs(record.force)))
    spring = plant["stiffness"] * amplitude(record)
    return max(commanded, spring, 1e-9)


def natural_frequency(record: Record, plant: Model) -> float:
    """Natural frequency [rad/s] of the plant, or of one swing a record where there is no spring."""
    spring = plant["stiffness"] / plant["mass"]
    return max(float(np.sqrt(max(spring, 0.0))), 2.0 * np.pi / record.duration)


def rms_pitch(pitch: float, once: float, twice: float) -> float:
    """Root of the mean square of a pitch [m] and of half of it, weighted with the power of the sines of each.

    Args:
        pitch: of the first sine [m].
        once, twice: amplitudes of the sine, and of the one of half its pitch.
    """
    power = once**2 + twice**2
    return pitch * math.sqrt((once**2 + 0.25 * twice**2) / power) if power > 0.0 else pitch


def pitches(span: float, longest: float = PITCHES[1]) -> FloatArray:
    """Pitches [m] over a travel [m], on an even scale of 1/p, the shortest first.

    Args:
        span: the travel.
        longest: in parts of it; those that can be told if not given.
    """
    shortest = PITCHES[0]
    return np.asarray(span / np.arange(1.0 / longest, 1.0 / shortest + 0.5 * STEP, STEP)[::-1])


def unexplained_force(record: Record, plant: Model) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time (n,) [s], smoothed position (n,) [m] and F - m x'' - b x' - k x (n,) [N] on an even grid.

    The force that the plant leaves over, mean and slow parts included; velocity and acceleration come from a local
    cubic over about a fortieth of a swing, at least 7 samples.
    """
    from msd_ident.data.local_polynomial import local_polynomial  # imported here: it imports parts of scipy

    period = record.period
    count = int(record.duration / period) + 1
    time = record.time[0] + period * np.arange(count)
    position = np.interp(time, record.time, record.position)
    swing = 2.0 * np.pi / natural_frequency(record, plant)
    window = int(min(max(7, swing / 40.0 / period), count - 1)) // 2 * 2 + 1
    window = min(window, (count - 1) // 2 * 2 + 1)
    x, v, a = (local_polynomial(position, window, 3, order, period) for order in range(3))
    inertia = plant["mass"] * a + plant["damping"] * v + plant["stiffness"] * x
    return (
        time - record.origin,
        np.asarray(x, dtype=np.float64),
        np.asarray(record.force_at(time) - inertia, dtype=np.float64),
    )


def lines(record: Record, plant: Model, count: int) -> list[tuple[float, float, float]]:
    """(amplitude [N], frequency [rad/s], phase [rad]) of the strongest lines of ``unexplained_force`` against +x.

    Phase at the record's origin, of a sine. The commanded force's own lines stay in where the plant is wrong, so the
    strongest line need not be the right one: several are given.
    """
    time, _, left = unexplained_force(record, plant)
    against = left - np.mean(left)
    size = 4 * time.size
    spectrum = np.abs(np.fft.rfft(against * np.hanning(time.size), size))
    omega = 2.0 * np.pi * np.fft.rfftfreq(size, record.period)
    slowest = 4.0 * np.pi / record.duration
    spectrum[omega < slowest] = 0.0
    found = []
    for _ in range(count):
        best = int(np.argmax(spectrum))
        w = float(omega[best])
        basis = np.column_stack([np.sin(w * time), np.cos(w * time)])
        (s, c), *_ = np.linalg.lstsq(basis, against, rcond=None)
        found.append((max(float(np.hypot(s, c)), 1e-9), w, float(np.arctan2(c, s))))
        spectrum[np.abs(omega - w) < slowest] = 0.0
    return found


def ripples(record: Record, plant: Model, count: int) -> list[tuple[float, float, float]]:
    """(amplitude [N], pitch [m], phase [rad]) of the ripples along x that best fit ``unexplained_force``.

    A harmonic in x with a constant and x itself beside it, tried at 120 pitches from a fiftieth to twice the range.
    """
    _, x, left = unexplained_force(record, plant)
    span = max(float(np.ptp(x)), 1e-9)
    return waves(x, left, np.geomspace(0.02 * span, 2.0 * span, 120), count)


def waves(x: FloatArray, of: FloatArray, pitches: FloatArray, count: int) -> list[tuple[float, float, float]]:
    """(amplitude, pitch [m], phase [rad]) of the harmonics in x that best fit a signal, each a local best.

    Args:
        x: (n,) positions [m].
        of: (n,) the signal; a constant and x itself may be in it too.
        pitches: those that are tried [m], in their order.
        count: the most that are given.
    """
    keep = slice(None, None, max(1, x.size // 1500))
    x, against = x[keep], of[keep]
    frame = np.linalg.qr(np.column_stack([np.ones_like(x), x / max(float(np.ptp(x)), 1e-300)]))[0]
    against = against - frame @ (frame.T @ against)
    angles = np.outer(2.0 * np.pi / pitches, x)
    sine, cosine = np.sin(angles), np.cos(angles)
    sine, cosine = (wave - (wave @ frame) @ frame.T for wave in (sine, cosine))
    ss, cc, sc = (np.einsum("pn,pn->p", a, b) for a, b in ((sine, sine), (cosine, cosine), (sine, cosine)))
    rs, rc = sine @ against, cosine @ against
    size = np.maximum(ss * cc - sc**2, 1e-12 * (ss + cc) ** 2 + 1e-300)
    sines, cosines = (cc * rs - sc * rc) / size, (ss * rc - sc * rs) / size
    gain = np.concatenate(([-np.inf], sines * rs + cosines * rc, [-np.inf]))
    best = np.flatnonzero((gain[1:-1] >= gain[:-2]) & (gain[1:-1] >= gain[2:]))
    best = best[np.argsort(-gain[1:-1][best], kind="stable")][:count]
    return [
        (max(float(np.hypot(sines[i], cosines[i])), 1e-9), float(pitches[i]), float(np.arctan2(cosines[i], sines[i])))
        for i in best
    ]
