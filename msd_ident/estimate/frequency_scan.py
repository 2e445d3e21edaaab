"""Starts for harmonic terms: A·sin(s·y + φ) with a scanned frequency or pitch.

The error surface has a valley for every line of the spectrum, but amplitude and phase enter linearly while they are
small. So the rest of the model is fitted without the term; for each trial frequency (pitch) the simulated response to a
small sine and a small cosine is projected on what that fit leaves; and the trials that explain most become starts
("variable projection", Golub and Pereyra 1973).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.effort import KEPT, THOROUGH
from msd_ident.estimate.least_squares import SolverOptions, minimise
from msd_ident.estimate.objective import SquaredError
from msd_ident.estimate.peaks import highest
from msd_ident.estimate.problem import Problem
from msd_ident.model.declarations import PLACE, TIME
from msd_ident.model.effects import typical
from msd_ident.tuning import fixed

_COARSEST = fixed(2.0, "mathematics", "ranges of motion: a ripple of a longer pitch is less than half a wave, a bend")
_MOST_VALUES = fixed(2_000_000, "resources", "readings simulated at once, at most: 16 MB")


@dataclass(frozen=True)
class _Term:
    """Places of a harmonic term's amplitude, scanned parameter and phase in the vector."""

    amplitude: int
    scanned: int
    phase: int


def harmonic_vectors(problem: Problem, best: FloatArray) -> list[FloatArray]:
    """Starting vectors for the harmonic terms of a model, found by a scan over frequency or pitch.

    Args:
        problem: model and records.
        best: (p,) best vector so far; it gives all other entries.

    Returns:
        At most ``KEPT`` vectors (p,) for each harmonic term whose amplitude, frequency (or pitch) and phase are all
        free.
    """
    vectors = []
    for over, trials in ((TIME, _frequencies), (PLACE, _pitches)):
        for harmonic in (effect.harmonic for effect in problem.model.effects):
            if harmonic is None or harmonic.over != over or not set(harmonic.names) <= set(problem.names):
                continue
            term = _Term(*(problem.names.index(name) for name in harmonic.names))
            base = _without(problem, best, term)
            vectors += _scan(problem, base, term, trials(problem, base))
    return vectors


def _without(problem: Problem, best: FloatArray, term: _Term) -> FloatArray:
    """The best fit with the amplitude held at zero."""
    upper = problem.upper.copy()
    upper[term.amplitude] = 0.0
    start = best.copy()
    start[term.amplitude] = 0.0
    return minimise(SquaredError(problem), start, SolverOptions(problem.lower, upper, problem.scale, 40)).point


def _frequencies(problem: Problem, base: FloatArray) -> FloatArray:
    """The strongest lines [rad/s] of what the base leaves, over all records."""
    period = min(record.period for record in problem.records)
    size = 4 * max(record.samples for record in problem.records)
    power = np.zeros(size // 2 + 1)
    for r, record in enumerate(problem.records):
        uniform = np.interp(
            record.time[0] + period * np.arange(int(record.duration / period)), record.time, problem.residual(base, r)
        )
        spectrum = np.fft.rfft((uniform - uniform.mean()) * np.hanning(uniform.size), size)
        power += np.abs(spectrum) ** 2
    omega = 2.0 * np.pi * np.fft.rfftfreq(size, period)
    # A force of frequency w moves the mass by 1/w²: weigh that out, or slow lines win always.
    weighed = power * (omega**2 + omega[8] ** 2)
    peaks = np.flatnonzero((weighed[1:-1] >= weighed[:-2]) & (weighed[1:-1] > weighed[2:])) + 1
    strongest = peaks[np.argsort(weighed[peaks])[::-1][:THOROUGH]]
    return np.asarray(omega[strongest])


def _pitches(problem: Problem, base: FloatArray) -> FloatArray:
    span = 2.0 * max(typical.amplitude(record) for record in problem.records)
    return typical.pitches(span, _COARSEST)


def _scan(problem: Problem, base: FloatArray, term: _Term, trials: FloatArray) -> list[FloatArray]:
    """The trials that explain most of the base's residual, as vectors with their amplitude and phase."""
    others = np.array([e for e in range(problem.size) if e not in (term.amplitude, term.scanned, term.phase)])
    normal = SquaredError(problem).linearise(base)
    held = np.linalg.pinv(normal.matrix[np.ix_(others, others)], rcond=1e-12, hermitian=True)
    small = 1e-3 * problem.typical.force
    found = []
    for trial, (gram, cross, right) in zip(trials, _responses(problem, base, term, trials, small), strict=True):
        reduced = gram - cross[others].T @ held @ cross[others]
        target = -(right - cross[others].T @ held @ normal.gradient[others])
        solution = np.linalg.lstsq(reduced, target, rcond=1e-9)[0]
        vector = base.copy()
        vector[others] -= held @ (normal.gradient[others] + cross[others] @ solution)
        vector[term.amplitude] = max(float(np.hypot(*solution)), 1e-6 * problem.typical.force)
        vector[term.scanned] = trial
        vector[term.phase] = math.atan2(solution[1], solution[0])
        found.append((float(solution @ target), np.clip(vector, problem.lower, problem.upper)))
    gains = np.array([gain for gain, _ in found])
    best = highest(gains) if term_is_ordered(trials) else np.argsort(gains)[::-1][:KEPT]
    return [found[i][1] for i in best]


def term_is_ordered(trials: FloatArray) -> bool:
    """Whether neighbouring trials are neighbours in value, so that only local maxima are worth a start."""
    return bool(np.all(np.diff(trials) > 0.0))


def _responses(
    problem: Problem, base: FloatArray, term: _Term, trials: FloatArray, small: float
) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """For each trial CᵀC (2, 2), JᵀC (p, 2) and Cᵀr (2,), C the responses to a unit sine and cosine."""
    sums = [(np.zeros((2, 2)), np.zeros((problem.size, 2)), np.zeros(2)) for _ in trials]
    steps = problem.steps(SquaredError(problem).linearise(base).matrix)
    for r, record in enumerate(problem.records):
        residual, jacobian = problem.linearised(base, r, steps)
        entries = problem.entries(r)
        batch = max(1, _MOST_VALUES // (2 * record.samples))
        for first in range(0, trials.size, batch):
            chosen = range(first, min(first + batch, trials.size))
            points = np.repeat(base[None, :], 2 * len(chosen), axis=0)
            points[:, term.amplitude] = small
            points[:, term.scanned] = np.repeat(trials[chosen.start : chosen.stop], 2)
            points[:, term.phase] = np.tile([0.0, 0.5 * np.pi], len(chosen))
            responses = (problem.residuals(points, r) - residual) / small
            for place, trial in enumerate(chosen):
                pair = responses[2 * place : 2 * place + 2]
                gram, cross, right = sums[trial]
                gram += pair @ pair.T
                cross[entries] += jacobian @ pair.T
                right += pair @ residual
    return sums
