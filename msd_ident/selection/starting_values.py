"""Starting values of a cause in addition to a fitted model: from the library, and from the residual of that model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.problem import Initial
from msd_ident.model import Effect, Model, Plant, Simulator
from msd_ident.model.effects import by_name
from msd_ident.model.effects.cogging import PITCHES, Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.load_dependent_friction import LoadDependentFriction
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.position_dependent_friction import PositionDependentFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.stribeck_shape import StribeckShape
from msd_ident.residuals.disturbance import missing_force

_LINES = 4
_RATES = 60
_TRIED = 160
_PLACES = 1500


def guesses(
    name: str, plant: Model, record: Record, residual: FloatArray, noise: float, largest: float, *, first: bool = True
) -> tuple[Effect, ...]:
    """Starting values of an effect.

    Args:
        name: of the effect.
        plant: mass, damping and stiffness of the fitted model.
        record: the liveliest record, positions from the relaxed spring.
        residual: (n,) model − data [m] of the fitted model there.
        noise: standard deviation of a reading [m].
        largest: magnitude of the force in any record [N].
        first: whether the fitted model has no effect yet; later the residual alone tells where a harmonic law starts.
    """
    harmonic = {"periodic_disturbance": lambda: lines(record, plant, residual),
                "cogging": lambda: ripples(record, plant, residual, noise)}  # fmt: skip
    if name in harmonic:
        found = harmonic[name]()
        return found if found and not first else found + by_name(name).guess(record, plant)[:1]
    found = by_name(name).guess(record, plant)
    if name == "force_gain_nonlinearity":  # its other form, saturation, which no slope leads to
        found += tuple(ForceGainNonlinearity(0.0, share * largest) for share in (0.95, 0.75) if largest > 0.0)
    return found


def from_coulomb(name: str, plant: Model, record: Record, force: float) -> tuple[Effect, ...]:
    """A law that holds Coulomb's as a limit, started next to a fitted Coulomb friction of ``force`` [N]."""
    if name == "position_dependent_friction":
        return (PositionDependentFriction(force, 0.0),)
    if name == "load_dependent_friction":
        return LoadDependentFriction.from_simple(CoulombFriction(force), record, plant)
    if name == "stribeck_shape":
        return tuple(
            StribeckShape.within_bounds(*one.values, 1.0)
            for one in from_coulomb("stribeck_friction", plant, record, force)
        )
    if name == "stribeck_friction":
        scales = {guess.stribeck_velocity for guess in StribeckFriction.guess(record, plant)}
        return tuple(StribeckFriction(force, 1.3 * force, scale) for scale in sorted(scales))
    lengths = {guess.hysteresis_length for guess in Hysteresis.guess(record, plant)}
    return tuple(Hysteresis(force, length) for length in sorted(lengths))


def ripples(record: Record, plant: Model, residual: FloatArray, noise: float) -> tuple[Effect, ...]:
    """Cogging at the pitches that explain most of the force which the fitted model lacks.

    That force is smoothed from the residual, and taken clean of what mass, spring, damper, friction and offset could
    still take up. One regression on sine and cosine for each pitch.
    """
    error = replace(record, position=-residual, force=np.zeros(record.force.size))
    lacking = missing_force(error, (plant.mass, plant.damping, plant.stiffness), noise).force
    keep = slice(None, None, max(1, record.samples // _PLACES))
    x, force = record.position[keep], lacking[keep]
    velocity = np.gradient(record.position, record.time)[keep]
    common = np.column_stack([np.ones(x.size), x, velocity, np.sign(velocity)])
    frame = np.linalg.qr(common / np.maximum(np.linalg.norm(common, axis=0), 1e-300))[0]
    force = force - frame @ (frame.T @ force)
    span = float(np.ptp(x))
    pitches = np.geomspace(PITCHES[0] * span, PITCHES[1] * span, _TRIED)
    angle = np.outer(2.0 * np.pi / pitches, x)
    pair = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    pair -= (pair @ frame) @ frame.T
    gram = np.einsum("pix,pjx->pij", pair, pair) + 1e-9 * x.size * np.eye(2)
    right = pair @ force
    solution = np.linalg.solve(gram, right[:, :, None])[:, :, 0]
    gain = np.einsum("pi,pi->p", solution, right)
    padded = np.concatenate(([-np.inf], gain, [-np.inf]))
    peaks = np.flatnonzero((gain >= padded[:-2]) & (gain >= padded[2:]))
    best = peaks[np.argsort(gain[peaks])[::-1]][:_LINES]
    return tuple(
        Cogging(max(float(np.hypot(*solution[i])), 1e-12), float(pitches[i]), float(np.arctan2(*solution[i][::-1])))
        for i in best
    )


def lines(record: Record, plant: Model, residual: FloatArray) -> tuple[Effect, ...]:
    """Disturbances at the strongest lines of a residual, as large as the plant's impedance says.

    What a model without the disturbance leaves is the plant's response to it: A·sin(ωt + φ) / (k − mω² + ibω).
    """
    period = record.duration / (record.samples - 1)
    time = record.time[0] + period * np.arange(record.samples)
    left = np.interp(time, record.time, residual)
    left = left - left.mean()
    omega = 2.0 * np.pi * np.fft.rfftfreq(8 * left.size, period)
    power = np.abs(np.fft.rfft(left * np.hanning(left.size), 8 * left.size))
    power[(omega < 4.0 * np.pi / record.duration) | (omega > 0.5 * np.pi / period)] = 0.0
    found: list[Effect] = []
    for _ in range(_LINES):
        w = float(omega[int(np.argmax(power))])
        if w == 0.0:
            break
        basis = np.column_stack([np.cos(w * time), np.sin(w * time)])
        c, s = np.linalg.lstsq(basis, left, rcond=None)[0]
        force = complex(c, -s) * complex(plant.stiffness - plant.mass * w * w, plant.damping * w)
        # Re(force·exp(iωt)) = A·sin(ωt + φ)
        found.append(PeriodicDisturbance(max(abs(force), 1e-12), w, float(np.angle(force)) + 0.5 * np.pi))
        power[np.abs(omega - w) < 4.0 * np.pi / record.duration] = 0.0
    return tuple(found)


def plain_axes(records: Sequence[Record]) -> list[tuple[Model, tuple[Initial, ...]]]:
    """Best mass and damping of a plain axis on a fine scale of b/m, each with the initial states that go with it.

    For a given b/m the motion is linear in 1/m, position and velocity at the start, so each trial is one linear
    regression: no valley is missed (variable projection, Golub and Pereyra 1973).
    """
    duration = max(record.duration for record in records)
    found = []
    for rate in np.geomspace(0.02 / duration, 500.0 / duration, _RATES):
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
