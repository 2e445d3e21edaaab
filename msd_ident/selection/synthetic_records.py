"""Copies of an experiment, simulated under an explanation.

A copy has the force, the stamps and the encoder step of the record. The motion is that of a fitted model whose
parameters are drawn from their posterior. If the leading explanation leaves no more than white noise, white noise of
the record's own level is added. Otherwise its residual, noise and missing force together, is added with the same
spectrum and random phases, which removes its correlation with the motion (Theiler et al. 1992, Physica D 58:
phase-randomised surrogates).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.broyden import Weighting
from msd_ident.estimate.damped_step import damped_step
from msd_ident.estimate.effort import SHORT
from msd_ident.estimate.problem import Initial, Problem
from msd_ident.model import Effect
from msd_ident.model.effects import by_name
from msd_ident.residuals.adequacy import judge
from msd_ident.residuals.noise_model import Readings
from msd_ident.selection.evidence import NoiseScale, prior_widths
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.tuning import fixed

_UNIFORM = fixed(1.0 / 12.0, "mathematics", "variance of a rounding error, in steps squared")


@dataclass(frozen=True)
class Imagined:
    """A set of causes with given values.

    Attributes:
        causes: names of the set.
        problem: its problem.
        point: (p,) vector of the problem.
    """

    causes: Causes
    problem: Problem
    point: FloatArray

    def residuals(self) -> tuple[FloatArray, ...]:
        """Model − data of each record [m]."""
        return tuple(self.problem.residual(self.point, r) for r in range(len(self.problem.records)))


def drawn(fitted: Hypothesis, scale: NoiseScale, rng: np.random.Generator) -> Imagined:
    """A fitted set with parameters drawn from their posterior (Laplace's approximation, clipped to the bounds).

    Args:
        fitted: the set.
        scale: gives the variance of the model's error.
        rng: draws the parameters.
    """
    size, variance = prior_widths(fitted), scale.spread(fitted.chi)
    information = fitted.information * np.outer(size, size) / variance + np.eye(size.size)
    values, frame = np.linalg.eigh(information)
    move = frame @ (rng.standard_normal(size.size) / np.sqrt(np.maximum(values, 1.0)))
    point = np.clip(fitted.point + size * move, fitted.problem.lower, fitted.problem.upper)
    return Imagined(fitted.causes, fitted.problem, point)


def of_any_strength(experiment: Experiment, leader: Hypothesis, causes: Causes, rng: np.random.Generator) -> Imagined:
    """A set whose new laws have strengths drawn by lot; all other parameters are adjusted to the record.

    Args:
        experiment: the measured records, or a part of their samples.
        leader: the leading set; effects that both have start from its values.
        causes: names of the set.
        rng: draws the strengths.
    """
    part, initial = experiment.readings[0], leader.initial[0]
    seen = replace(part.record, position=part.record.position - initial.zero)
    values = dict(zip(leader.model.names, leader.model.values.tolist(), strict=True))
    kept = tuple(effect for effect in leader.model.effects if effect.name in causes)
    plant, new = replace(leader.model, effects=()), list[Effect]()
    for name in sorted(causes - leader.causes):
        law = by_name(name)
        shared = {p.name: values[p.name] for p in law.parameters if p.name in values}
        guess = law.guess(seen, plant)[0]
        drawn = replace(guess, **shared).by_lot(rng, seen, plant)  # type: ignore[type-var]
        new.append(replace(drawn, **shared))  # type: ignore[type-var]
    own = frozenset(p.name for effect in new for p in effect.parameters)
    forces = frozenset(name for effect in new for name in _forces(effect))
    scaled = forces if own & set(values) else frozenset()
    found = []
    for share in _shares(new, values) if scaled else (1.0,):
        model = replace(leader.model, effects=(*kept, *(_weaker(effect, share) for effect in new)))
        problem, weighting, point = formulated(experiment, model, leader.initial, own - scaled)
        chi, point = _brought(weighting, point, [problem.names.index(name) for name in sorted(scaled)])
        found.append((chi, Imagined(causes, problem, point)))
    return min(found, key=lambda one: one[0])[1]


def _shares(new: Sequence[Effect], values: Mapping[str, float]) -> tuple[float, ...]:
    """Parts of the leading law's force at which others of its family begin.

    A quick motion shows the least force of a law, a slow one the largest.
    """
    pairs = [pair for effect in new for pair in _forces(effect).items()]
    least = max((value for name, value in pairs if name in values), default=0.0)
    largest = max((value for _, value in pairs), default=0.0)
    return (1.0, least / largest) if least > 0.0 else (1.0,)


def _weaker(effect: Effect, share: float) -> Effect:
    """The same law with all its forces times ``share``."""
    forces = {name: share * force for name, force in _forces(effect).items()}
    return replace(effect, **forces)  # type: ignore[type-var]


def _forces(effect: Effect) -> dict[str, float]:
    """Its forces [N], but for limits at infinity."""
    found = {p.name: float(getattr(effect, p.name)) for p in effect.parameters if p.unit == "N"}
    return {name: force for name, force in found.items() if math.isfinite(force)}


def _brought(weighting: Weighting, point: FloatArray, together: Sequence[int]) -> tuple[float, FloatArray]:
    """Chi² and point (p,) after a few Levenberg–Marquardt steps in which some entries keep their ratios."""
    problem, state, damping = weighting.problem, weighting.exact(point, weighting.steps(None)), 1e-3
    alone = [entry for entry in range(point.size) if entry not in together]
    for _ in range(SHORT):
        basis = np.eye(point.size)[alone]
        if together:
            basis = np.vstack([basis, np.where(np.isin(np.arange(point.size), together), state.point, 0.0)])
        rows = basis @ state.jacobian
        normal, gradient, free = rows @ rows.T, rows @ state.residual, np.full(len(rows), np.inf)
        move = damped_step(normal, gradient, damping, -free, free)[0]
        trial = np.clip(state.point + move @ basis, problem.lower, problem.upper)
        residual = weighting.residual(trial)
        if float(residual @ residual) < state.chi:
            state, damping = weighting.exact(trial, weighting.steps(state), residual), 0.1 * damping
        else:
            damping *= 10.0
    return state.chi, state.point


def whole(experiment: Experiment, found: Imagined) -> Imagined:
    """The same set on all samples of the experiment.

    Args:
        experiment: all samples.
        found: the set, drawn on a part of them.
    """
    model = found.problem.model.with_values(found.problem.values(found.point))
    initial: Sequence[Initial] = found.problem.initials(found.point)
    problem, _, point = formulated(experiment, model, initial)
    return Imagined(found.causes, problem, point)


@dataclass(frozen=True)
class Disturbed:
    """The measured records and what disturbs their copies.

    Attributes:
        readings: the records.
        left: (n,) residual of the leading explanation for each record [m], noise and missing force; None where it is no
            more than white noise.
    """

    readings: tuple[Readings, ...]
    left: tuple[FloatArray, ...] | None

    @classmethod
    def by(cls, lead: Hypothesis, readings: tuple[Readings, ...]) -> Disturbed:
        """The disturbance of copies, from what the leading explanation leaves.

        Args:
            lead: the leading set. Its residual is used unless it is no more than white noise.
            readings: the records with their weights.
        """
        residuals = lead.residuals()
        return cls(readings, None if judge(residuals, readings).consistent else residuals)

    def copy(self, imagined: Imagined, rng: np.random.Generator) -> tuple[Record, ...]:
        """Simulated records with noise, rounded as the encoder does.

        Args:
            imagined: the set whose motion is simulated.
            rng: draws the noise, or the phases of the residual.
        """
        made = []
        for index, (part, off) in enumerate(zip(self.readings, imagined.residuals(), strict=True)):
            if self.left is None:
                white = math.sqrt(max(part.noise**2 - _UNIFORM * part.step**2, 0.0))
                noise = white * rng.standard_normal(off.size)
            else:
                noise = shuffled(_unrounded(self.left[index], part.step), rng)
            made.append(replace(part.record, position=_read(part, part.record.position + off + noise)))
        return tuple(made)


def _read(part: Readings, position: FloatArray) -> FloatArray:
    """What the record's encoder says of a position [m]."""
    if part.step == 0.0:
        return position
    first = float(part.record.position[0])
    return np.asarray(first + part.step * np.rint((position - first) / part.step))


def _unrounded(error: FloatArray, step: float) -> FloatArray:
    """A residual with rounding's part of its variance taken off: a copy is rounded again."""
    variance = float(np.mean(error**2))
    share = max(variance - _UNIFORM * step**2, 0.0) / variance if variance > 0.0 else 0.0
    return np.asarray(error * math.sqrt(share))


def shuffled(error: FloatArray, rng: np.random.Generator) -> FloatArray:
    """A phase-randomised surrogate of a signal: the same amplitude spectrum, random phases (Theiler et al. 1992).

    Args:
        error: (n,) signal.
        rng: draws the phases.
    """
    lines = np.fft.rfft(error)
    phases = rng.uniform(0.0, 2.0 * np.pi, lines.size)
    turned = lines * np.exp(1j * phases)
    turned[0] = np.abs(lines[0]) * (1.0 if phases[0] < np.pi else -1.0)
    if error.size % 2 == 0:  # the last line is real too
        turned[-1] = np.abs(lines[-1]) * (1.0 if phases[-1] < np.pi else -1.0)
    return np.asarray(np.fft.irfft(turned, error.size))
