"""Whether the effort of a joint can be the force that moves it.

A drive that measures its torque reports a force: the effort follows acceleration, speed and position as mechanics
requires. A geared position servo reports the load of its motor, which is dominated by friction in the gear and tells
nothing about the mass, so that a fit finds any mass. The inverse dynamics, linear in their parameters, are regressed:
effort on acceleration, speed, sign of the speed, position, its sine and cosine, all filtered alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray, Record

#: Samples that the filter needs, and the part of a swing that it spans.
_LEAST_SAMPLES, _LEAST_WINDOW, _PART = 60, 7, 0.12
#: Part of the effort's variance that motion must explain, and the inertia in its standard deviations. A drive with a
#: force of its own (EMPS) has 0.98 and 9, a simulated direct drive 1.00 and 80; the simulated load of a geared servo
#: has 0.96, for friction follows the speed, and less than 1 (test/test_effort.py).
LEAST_EXPLAINED, LEAST_CERTAIN = 0.5, 4.0


@dataclass(frozen=True)
class Judgement:
    """What was found of an effort.

    Attributes:
        usable: whether it can be the force.
        sentence: why, or why not and what to do.
        explained: part of its variance that the motion explains; NaN where none was computed.
        inertia, std: coefficient of the acceleration and its standard deviation; NaN likewise.
    """

    usable: bool
    sentence: str
    explained: float = float("nan")
    inertia: float = float("nan")
    std: float = float("nan")


def judge(record: Record) -> Judgement:
    """Whether the force of a record, a joint's effort, can be what moves it."""
    x, f = _uniform(record)
    if np.ptp(f) == 0.0:
        return Judgement(False, f"its effort is {f[0]:g} all the time: none is measured")
    levels = np.unique(record.position).size
    if x.size < _LEAST_SAMPLES or levels < 10:
        return Judgement(False, f"it hardly moves ({levels} different readings): move it, or leave it out")
    explained, inertia, std = _regressed(x, f, float(np.median(np.diff(record.time))), record.position_unit == "rad")
    numbers = f"the motion explains {100 * max(explained, 0.0):.0f} % of it, inertia {inertia:.3g} ± {std:.1g}"
    if explained < LEAST_EXPLAINED or not inertia > LEAST_CERTAIN * std:
        advice = (
            "its effort is not the force that moves it, as of a geared position servo whose load is friction "
            f"({numbers}): measure a torque or a current behind no gear, or identify with --force none after a release"
        )
        return Judgement(False, advice, explained, inertia, std)
    return Judgement(True, f"its effort can be the force ({numbers})", explained, inertia, std)


def _uniform(record: Record) -> tuple[FloatArray, FloatArray]:
    """Position and force at even instants."""
    time = np.linspace(record.time[0], record.time[-1], record.time.size)
    if record.hold == "zero":
        place = np.clip(np.searchsorted(record.force_time, time, side="right") - 1, 0, record.force.size - 1)
        force = record.force[place]
    else:
        force = np.interp(time, record.force_time, record.force)
    return np.interp(time, record.time, record.position), np.asarray(force, dtype=np.float64)


def _regressed(x: FloatArray, f: FloatArray, step: float, revolute: bool) -> tuple[float, float, float]:
    """Explained part of the variance of the effort, inertia and its standard deviation."""
    from scipy.signal import savgol_coeffs  # imported here: it takes a quarter of a second

    window = _window(x)
    smooth, slope, bend = (savgol_coeffs(window, 3, deriv=order, delta=step) for order in (0, 1, 2))

    def filtered(values: FloatArray, kernel: FloatArray) -> FloatArray:
        return np.convolve(values, kernel, mode="valid")

    speed = filtered(x, slope)
    columns = [filtered(x, bend), speed, np.tanh(speed / (0.05 * np.abs(speed).max() + 1e-300)), filtered(x, smooth)]
    if revolute:
        columns += [filtered(np.sin(x), smooth), filtered(np.cos(x), smooth)]
    matrix = np.column_stack([*columns, np.ones(speed.size)])
    target = filtered(f, smooth)
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0.0] = 1.0
    solution, *_ = np.linalg.lstsq(matrix / scale, target, rcond=1e-10)
    left = target - (matrix / scale) @ solution
    free = max(target.size / window - matrix.shape[1], 1.0)  # the filter ties neighbours
    covariance = np.linalg.pinv((matrix / scale).T @ (matrix / scale), rcond=1e-10)
    std = np.sqrt(max(covariance[0, 0], 0.0) * float(left @ left) / free) / scale[0]
    spread = float(np.sum((target - target.mean()) ** 2))
    return 1.0 - float(left @ left) / spread if spread > 0.0 else 0.0, float(solution[0] / scale[0]), float(std)


def _window(x: FloatArray) -> int:
    """Length of the filter: a part of the time between two crossings of the mean, odd."""
    crossings = np.flatnonzero(np.diff(np.sign(x - x.mean())) != 0)
    swing = float(np.median(np.diff(crossings))) if crossings.size > 3 else x.size / 4.0
    longest = max(_LEAST_WINDOW, x.size // 10)
    return int(min(max(_LEAST_WINDOW, _PART * 2.0 * swing), longest)) | 1
