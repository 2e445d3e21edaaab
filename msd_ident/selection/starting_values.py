"""Starting values of a cause in addition to a fitted model: from the library, and from the residual of that model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import KEPT, THOROUGH
from msd_ident.estimate.peaks import highest
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.ripple_regression import ripples
from msd_ident.model import Effect, Model, Plant, Simulator
from msd_ident.model.declarations import TIME
from msd_ident.model.effects import by_name, typical
from msd_ident.residuals.disturbance import missing_force
from msd_ident.tuning import fixed, tuned

#: Amplitude [N], frequency [rad/s] or pitch [m], and phase [rad] of a harmonic term.
Term = tuple[float, float, float]

_FAINT = fixed(
    1e-12,
    "accuracy",
    "amplitude [N] of a term that is not there: above 0, so that frequency and phase still move something",
)
_PADDED = fixed(8, "accuracy", "times the length of a record to which it is padded for a finer spectrum")
_CELLS = fixed(1024, "accuracy", "cells of the travel: twenty to the shortest ripple that is looked for")
_AROUND = fixed(40, "accuracy", "lines around a line whose median it is compared with")
_SATURATED = tuned(
    (0.95, 0.75),
    unit="1",
    why="limits of the force that a search begins from, in parts of the largest force",
    chosen="by hand",
)


@dataclass(frozen=True)
class FittedRecord:
    """The record with the largest motion, and what a fitted model leaves there.

    Attributes:
        plant: mass, damping and stiffness of the fitted model.
        measured: the record.
        zero: reading of the relaxed spring [m].
        residual: (n,) model − data [m].
        noise: standard deviation of a reading [m].
        largest: magnitude of the force in any record [N].
        bare: whether the fitted model has no effect yet. Beside other effects the library's own guess of a harmonic law
            is not asked.
    """

    plant: Model
    measured: Record
    zero: float
    residual: FloatArray
    noise: float
    largest: float
    bare: bool

    @cached_property
    def record(self) -> Record:
        """The record with positions from the relaxed spring."""
        return replace(self.measured, position=self.measured.position - self.zero)

    def ripples(self) -> list[Term]:
        """Harmonic forces over position from the relaxed spring, found without the fitted model."""
        known = ripples(self.measured, self.plant.mass)
        return [(amplitude, pitch, phase + 2.0 * np.pi * self.zero / pitch) for amplitude, pitch, phase in known]


def guesses(name: str, fitted: FittedRecord) -> tuple[Effect, ...]:
    """Starting values of an effect beside a fitted model.

    Args:
        name: of the effect.
        fitted: a record and the residual that the fitted model leaves in it.
    """
    effect, plant, record = by_name(name), fitted.plant, fitted.record
    if effect.harmonic is not None and not effect.form_of:
        over_time = effect.harmonic.over == TIME
        terms = (
            lines(record, plant, fitted.residual)
            if over_time
            else fitted.ripples() + residual_ripples(record, plant, fitted.residual, fitted.noise)[:1]
        )
        found = tuple(effect.from_values(dict(zip(effect.harmonic.names, term, strict=True))) for term in terms)
        return found if found and not fitted.bare else found + effect.guess(record, plant)[:1]
    shown = effect.from_residual(record, fitted.residual)
    found = shown or effect.guess(record, plant)
    if effect.limits_force:  # its other form, saturation, which no slope leads to
        found += tuple(effect.limited(share * fitted.largest) for share in _SATURATED if fitted.largest > 0.0)
    return found


def residual_ripples(record: Record, plant: Model, residual: FloatArray, noise: float) -> list[Term]:
    """Starting values of a harmonic force over position, at the pitches that explain most of the missing force.

    The missing force is smoothed from the residual. What mass, spring, damper, friction and offset could take up is
    projected out. Then sine and cosine are regressed on it for each pitch. All sums over the samples of a function of
    the position times a sine come from one discrete Fourier transform over the travel.

    Args:
        record: positions from the relaxed spring.
        plant: mass, damping and stiffness of the fitted model.
        residual: (n,) model − data [m].
        noise: standard deviation of a reading [m].

    Returns:
        At most ``KEPT`` triples of amplitude [N], pitch [m] and phase [rad]; none where the model ran away.
    """
    error = replace(record, position=-residual, force=np.zeros(record.force.size))
    force = missing_force(error, (plant.mass, plant.damping, plant.stiffness), noise).force
    if not np.all(np.isfinite(force)):
        return []  # a motion that ran away: nothing is seen in what it leaves
    x, velocity = record.position, np.gradient(record.position, record.time)
    common = np.column_stack([np.ones(x.size), x, velocity, np.sign(velocity)])
    frame = np.linalg.qr(common / np.maximum(np.linalg.norm(common, axis=0), 1e-300))[0]
    force = force - frame @ (frame.T @ force)
    span = max(float(np.ptp(x)), 1e-300)
    pitches = typical.pitches(span)
    turns = np.rint(span / pitches / typical.STEP).astype(np.intp)
    sums = _over_travel(x, np.vstack([force, frame.T, np.ones(x.size)]), 2 * int(turns.max()))
    pair = np.stack([-sums[:, turns].imag, sums[:, turns].real])  # sums of the rows times sine and cosine
    right, shared = pair[:, 0].T, pair[:, 1:-1].transpose(2, 0, 1)
    twice = sums[-1, 2 * turns]
    own = 0.5 * np.array([[x.size - twice.real, -twice.imag], [-twice.imag, x.size + twice.real]])
    gram = own.transpose(2, 0, 1) - shared @ shared.transpose(0, 2, 1) + 1e-9 * x.size * np.eye(2)
    solution = np.linalg.solve(gram, right[:, :, None])[:, :, 0]
    gain = np.einsum("pi,pi->p", solution, right)
    best = highest(gain)
    phases = np.angle((solution @ (1.0, 1j)) * np.exp(-2j * np.pi * float(x.min()) / pitches))
    return [(max(float(np.hypot(*solution[i])), _FAINT), float(pitches[i]), float(phases[i])) for i in best]


def _over_travel(position: FloatArray, rows: FloatArray, most: int) -> npt.NDArray[np.complex128]:
    """Sums Σ r·exp(−iθ) over the samples for θ = 2π·q·(x − min x)/span at q = 0, STEP, ..., most·STEP.

    The samples are gathered in ``_CELLS`` cells of the travel first.

    Args:
        position: (n,) x [m].
        rows: (r, n) weights of the samples.
        most: number of the last q.

    Returns:
        (r, most + 1).
    """
    span = max(float(np.ptp(position)), 1e-300)
    cell = np.minimum(((position - position.min()) / span * _CELLS).astype(np.intp), _CELLS - 1)
    gathered = np.array([np.bincount(cell, row, _CELLS) for row in rows])
    spectrum = np.fft.rfft(gathered, round(_CELLS / typical.STEP))[:, : most + 1]
    middle = np.exp(-1j * np.pi * typical.STEP / _CELLS * np.arange(most + 1))  # of a cell, from its lower edge
    return np.asarray(spectrum * middle)


def lines(record: Record, plant: Model, residual: FloatArray) -> list[Term]:
    """Starting values of a harmonic force over time, at the strongest lines of a residual's spectrum.

    The residual is the plant's response to the disturbance, A·sin(ωt + φ) / (k − mω² + ibω), so the amplitude follows
    from the plant's impedance.

    Args:
        record: gives the stamps.
        plant: mass, damping and stiffness of the fitted model.
        residual: (n,) model − data [m].

    Returns:
        Triples of amplitude [N], angular frequency [rad/s] and phase [rad]: ``KEPT`` of the largest motion, and half
        as many, rounded down, that stand out most of the force around them.
    """
    period = record.duration / (record.samples - 1)
    stamps = record.time - record.origin
    time = stamps[0] + period * np.arange(record.samples)
    left = np.interp(time, stamps, residual)
    left = left - left.mean()
    omega = 2.0 * np.pi * np.fft.rfftfreq(_PADDED * left.size, period)
    power = np.abs(np.fft.rfft(left * np.hanning(left.size), _PADDED * left.size))
    # Beside friction the residual is large at low frequencies. As a force, and beside what is around it, a line stands
    # out of it.
    force = power * np.abs(plant.stiffness - plant.mass * omega**2 + 1j * plant.damping * omega)
    around = median_filter(force, size=_AROUND * _PADDED + 1)
    prominent = force / np.maximum(around, 1e-12 * float(np.max(force)) + 1e-300)
    outside = (omega < 4.0 * np.pi / record.duration) | (omega > 0.5 * np.pi / period)
    power[outside], prominent[outside] = 0.0, 0.0
    found: list[Term] = []
    for count, by in ((KEPT, power), (KEPT // 2, prominent)):
        for _ in range(count):
            strongest = int(np.argmax(by))
            if by[strongest] == 0.0:
                break
            w = float(omega[strongest])
            basis = np.column_stack([np.cos(w * time), np.sin(w * time)])
            c, s = np.linalg.lstsq(basis, left, rcond=None)[0]
            term = complex(c, -s) * complex(plant.stiffness - plant.mass * w * w, plant.damping * w)
            # Re(term·exp(iωt)) = A·sin(ωt + φ)
            found.append((max(abs(term), _FAINT), w, float(np.angle(term)) + 0.5 * np.pi))
            taken = np.abs(omega - w) < 4.0 * np.pi / record.duration
            power[taken], prominent[taken] = 0.0, 0.0
    return found


def plain_axes(records: Sequence[Record]) -> list[tuple[Model, tuple[Initial, ...]]]:
    """The best two models of an axis without a spring, with their initial states, over a fine scale of b/m.

    For a given b/m the motion is linear in 1/m and in position and velocity at the start, so each trial is one linear
    regression, and no local minimum is missed (variable projection, Golub and Pereyra 1973).
    """
    duration = max(record.duration for record in records)
    found = []
    for rate in np.geomspace(0.02 / duration, 500.0 / duration, THOROUGH):
        solved = _regressed(records, float(rate))
        if solved is not None:
            found.append(solved)
    found.sort(key=lambda item: item[0])
    return [(model, initial) for _, model, initial in found[:2]]


def _regressed(records: Sequence[Record], rate: float) -> tuple[float, Model, tuple[Initial, ...]] | None:
    unit = Plant(1.0, rate, 0.0)
    rows, right = [], []
    for i, record in enumerate(records):
        time = record.time - record.time[0]
        own = np.zeros((record.samples, 2 * len(records)))
        own[:, 2 * i], own[:, 2 * i + 1] = 1.0, -np.expm1(-rate * time) / rate
        rows.append(np.column_stack([Simulator(unit, record).positions(unit.values), own]))
        right.append(record.position)
    matrix, target = np.concatenate(rows), np.concatenate(right)
    size = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    solution = np.linalg.lstsq(matrix / size, target, rcond=1e-12)[0] / size
    if solution[0] <= 0.0:
        return None
    error = float(np.sum((matrix @ solution - target) ** 2))
    mass = 1.0 / float(solution[0])
    starts = tuple(Initial(float(solution[1 + 2 * i]), float(solution[2 + 2 * i])) for i in range(len(records)))
    return error, Plant(mass, rate * mass, 0.0), starts
