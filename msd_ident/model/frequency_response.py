"""Frequency response: of the linear part of a model, and as measured.

A response is measured from the differences of force and position, x(t+h) − x(t): a step becomes a pulse and a swing at
rest stays nothing, so a record that starts and ends near rest has no leakage and needs no window. Over a band of
frequencies, H = Σ X F* / Σ |F|², with the coherence |Σ X F*|² / (Σ |X|² Σ |F|²). (Bendat and Piersol 2010, ch. 6.)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray, Record
from msd_ident.model import Model

Complex = npt.NDArray[np.complex128]

#: Bands a decade, and what a band needs to be shown.
_BANDS, _COHERENT, _POWER = 24, 0.8, 1e-4
#: How far above and below its natural frequency a model is shown.
_SPAN = 30.0


@dataclass(frozen=True)
class FrequencyResponse:
    """Position over force: (k,) frequencies [rad/s], magnitude [m/N] and phase [degrees]."""

    frequency: FloatArray
    magnitude: FloatArray
    phase: FloatArray


def band(model: Model, points: int = 240) -> FloatArray:
    """Frequencies (points,) [rad/s] around the model's natural frequency; of a plain axis around b/m."""
    centre = math.sqrt(model.stiffness / model.mass) if model.stiffness > 0.0 else model.damping / model.mass
    return np.geomspace(centre / _SPAN, centre * _SPAN, points) if centre > 0.0 else np.geomspace(0.1, 1e3, points)


def modelled(model: Model, frequency: FloatArray) -> FrequencyResponse:
    """Response of all that is linear in the model at the frequencies (k,) [rad/s]."""
    from msd_ident.model.linear import transfer_function

    response = np.asarray(transfer_function(model)(1j * frequency))
    return _response(frequency, response)


def measured(records: Sequence[Record], frequency: FloatArray) -> FrequencyResponse | None:
    """Response of the rig within the range of ``frequency``, where the force excites it and the motion follows.

    ``None`` where the force never changes, or no band is coherent.
    """
    edges = _edges(float(frequency[0]), float(frequency[-1]))
    size = edges.size - 1
    cross: Complex = np.zeros(size, dtype=np.complex128)
    power, moved = np.zeros(size), np.zeros(size)
    weighted, lines = np.zeros(size), np.zeros(size)
    for record in records:
        omega, force, position = _spectra(record)
        place = np.searchsorted(edges, omega) - 1
        inside = (place >= 0) & (place < size) & (omega < 0.25 * math.pi / record.period)
        place, omega, force, position = place[inside], omega[inside], force[inside], position[inside]
        product = position * np.conj(force)
        cross += np.bincount(place, product.real, size) + 1j * np.bincount(place, product.imag, size)
        power += np.bincount(place, np.abs(force) ** 2, size)
        moved += np.bincount(place, np.abs(position) ** 2, size)
        weighted += np.bincount(place, omega * np.abs(force) ** 2, size)
        lines += np.bincount(place, minlength=size)
    if not power.any():
        return None
    usable = power > 0.0
    density = np.where(usable, power / np.maximum(lines, 1.0), 0.0)
    usable &= density > _POWER * density.max()
    coherence = np.abs(cross) ** 2 / np.maximum(power * moved, 1e-300)
    usable &= coherence > _COHERENT
    if not usable.any():
        return None
    return _response(weighted[usable] / power[usable], cross[usable] / power[usable])


def _edges(low: float, high: float) -> FloatArray:
    return np.geomspace(low, high, max(int(_BANDS * math.log10(high / low)), 2))


def _spectra(record: Record) -> tuple[FloatArray, Complex, Complex]:
    """Frequencies [rad/s] and transforms of the differences of force and position, on an even grid."""
    time = record.time[0] + record.period * np.arange(int(record.duration / record.period) + 1)
    position = np.interp(time, record.time, record.position)
    # The mean force of each interval: a step between two samples is then where it was.
    fine = (time[:-1, None] + record.period * (np.arange(4) + 0.5) / 4.0).ravel()
    force = record.force_at(fine).reshape(-1, 4).mean(axis=1)
    before = float(record.force_at([np.nextafter(record.time[0], -np.inf)])[0])
    pushed = np.diff(np.concatenate(([before], force)))
    omega = np.asarray(2.0 * math.pi * np.fft.rfftfreq(pushed.size, record.period), dtype=np.float64)
    # Differences of mean forces belong to a sample's instant, those of positions half a period later.
    late = np.exp(-0.5j * omega * record.period)
    return omega[1:], np.fft.rfft(pushed)[1:], (np.fft.rfft(np.diff(position)) * late)[1:]


def _response(frequency: FloatArray, response: Complex) -> FrequencyResponse:
    phase = np.degrees(np.unwrap(np.angle(response)))
    turns = 360.0 * np.round((phase[0] + 45.0) / 360.0) if phase.size else 0.0
    return FrequencyResponse(np.asarray(frequency), np.abs(response), np.asarray(phase - turns))
