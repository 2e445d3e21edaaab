"""Whether the effort of a joint can be the force that moves it.

A drive that measures its torque reports a force: the effort follows acceleration, speed and position as mechanics
requires. A geared position servo reports the load of its motor, which is dominated by friction in the gear and tells
nothing about the mass, so that a fit finds any mass. The inverse dynamics, linear in their parameters, are regressed:
effort on acceleration, speed, sign of the speed, position, its sine and cosine, all filtered alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from msd_ident.data.motion import observe
from msd_ident.data.record import FloatArray, Record

#: Samples that the filter needs, and the part of a swing that it spans.
_LEAST_SAMPLES, _LEAST_WINDOW, _PART = 60, 7, 0.12
#: Part of the effort's variance that motion must explain, and the inertia in its standard deviations. A drive with a
#: force of its own (EMPS) has 0.98 and 9, a simulated direct drive 1.00 and 80; the simulated load of a geared servo
#: has 0.96, for friction follows the speed, and less than 1 (test/test_effort.py).
LEAST_EXPLAINED, LEAST_CERTAIN = 0.5, 4.0
#: What an effort without the inertia of its joint is, and what to do.
_GRAVITY = (
    "its effort carries gravity, a spring or what other joints do; move it alone and faster, with the others at rest"
)


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
    motion, levels = observe(record), np.unique(record.position).size
    unit = record.position_unit
    if motion.still:
        return Judgement(
            False,
            f"it stands still ({levels} different readings within {motion.span:.2g} {unit}; noise and rounding alone "
            f"make {motion.rest_span:.2g} {unit}), so there is no model: move it, or leave it out",
        )
    if x.size < _LEAST_SAMPLES or levels < 10:
        return Judgement(False, f"it hardly moves ({levels} different readings of {x.size}): move it, or leave it out")
    found = _regressed(x, f, float(np.median(np.diff(record.time))), record.position_unit == "rad")
    reason = _reason(found)
    numbers = f"the motion explains {100 * max(found.explained, 0.0):.0f} % of it, inertia {_inertia(found)}"
    sentence = f"{reason} ({numbers})" if reason else f"its effort can be the force ({numbers})"
    return Judgement(not reason, sentence, found.explained, found.inertia, found.std)


@dataclass(frozen=True)
class _Regression:
    """Inverse dynamics of a joint.

    Attributes:
        explained: part of the effort's variance that all columns explain.
        inertia, std: coefficient of the acceleration, and its standard deviation.
        loss, loss_std: mean power that the terms of the speed take, and its standard deviation.
        by_position, by_speed: part of the variance that the columns of the position, and of the speed, explain alone.
    """

    explained: float
    inertia: float
    std: float
    loss: float
    loss_std: float
    by_position: float
    by_speed: float


def _inertia(found: _Regression) -> str:
    return f"{found.inertia:.3g} ± {found.std:.1g}"


def _reason(found: _Regression) -> str:
    """Why an effort cannot be the force, and what to do; empty if it can."""
    drives = found.loss < -LEAST_CERTAIN * found.loss_std
    if found.explained < LEAST_EXPLAINED:
        return (
            "the motion does not explain its effort: other joints or a contact load it, or it is another quantity; "
            "move it alone, with the others at rest"
        )
    if found.inertia < -LEAST_CERTAIN * found.std:
        turned = "its sign may be turned: read the joint with --force-scale -1" if drives else _GRAVITY
        return f"no model, as its inertia would be negative: {turned}"
    if drives:
        return f"no model, as its friction would drive it instead of braking: {_GRAVITY}"
    if found.inertia > LEAST_CERTAIN * found.std:
        return ""
    if found.by_position > found.by_speed:
        return f"no model, as its inertia does not show: {_GRAVITY}"
    return (
        "its effort is not the force that moves it, as of a geared position servo whose load is friction: measure a "
        "torque or a current behind no gear, or identify with --force none after a release"
    )


def _uniform(record: Record) -> tuple[FloatArray, FloatArray]:
    """Position and force at even instants."""
    time = np.linspace(record.time[0], record.time[-1], record.time.size)
    if record.hold == "zero":
        place = np.clip(np.searchsorted(record.force_time, time, side="right") - 1, 0, record.force.size - 1)
        force = record.force[place]
    else:
        force = np.interp(time, record.force_time, record.force)
    return np.interp(time, record.time, record.position), np.asarray(force, dtype=np.float64)


def _regressed(x: FloatArray, f: FloatArray, step: float, revolute: bool) -> _Regression:
    """Effort (n,) on acceleration, speed and position of samples that are ``step`` [s] apart."""
    from scipy.signal import savgol_coeffs  # imported here: it takes a quarter of a second

    window = _window(x)
    smooth, slope, bend = (savgol_coeffs(window, 3, deriv=order, delta=step) for order in (0, 1, 2))

    def filtered(values: FloatArray, kernel: FloatArray) -> FloatArray:
        return np.convolve(values, kernel, mode="valid")

    speed, target = filtered(x, slope), filtered(f, smooth)
    of_speed = np.column_stack([speed, np.tanh(speed / (0.05 * np.abs(speed).max() + 1e-300))])
    places = [filtered(values, smooth) for values in ((x, np.sin(x), np.cos(x)) if revolute else (x,))]
    of_position = np.column_stack([*places, np.ones(speed.size)])
    matrix = np.column_stack([filtered(x, bend), of_speed, of_position])
    solution, left, unscaled = _solved(matrix, target)
    free = max(target.size / window - matrix.shape[1], 1.0)  # the filter ties neighbours
    covariance = unscaled * float(left @ left) / free
    taken = speed @ of_speed / speed.size
    return _Regression(
        explained=_explained(matrix, target),
        inertia=float(solution[0]),
        std=float(np.sqrt(max(covariance[0, 0], 0.0))),
        loss=float(taken @ solution[1:3]),
        loss_std=float(np.sqrt(max(taken @ covariance[1:3, 1:3] @ taken, 0.0))),
        by_position=_explained(of_position, target),
        by_speed=_explained(np.column_stack([of_speed, np.ones(speed.size)]), target),
    )


def _solved(matrix: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Least squares: solution, residual (n,), and covariance of the solution for a residual of variance 1."""
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0.0] = 1.0
    scaled = matrix / scale
    solution, *_ = np.linalg.lstsq(scaled, target, rcond=1e-10)
    covariance = np.linalg.pinv(scaled.T @ scaled, rcond=1e-10) / np.outer(scale, scale)
    return solution / scale, target - scaled @ solution, covariance


def _explained(matrix: FloatArray, target: FloatArray) -> float:
    """Part of the variance of a target (n,) that columns explain."""
    left = _solved(matrix, target)[1]
    spread = float(np.sum((target - target.mean()) ** 2))
    return 1.0 - float(left @ left) / spread if spread > 0.0 else 0.0


def _window(x: FloatArray) -> int:
    """Length of the filter: a part of the time between two crossings of the mean, odd."""
    crossings = np.flatnonzero(np.diff(np.sign(x - x.mean())) != 0)
    swing = float(np.median(np.diff(crossings))) if crossings.size > 3 else x.size / 4.0
    longest = max(_LEAST_WINDOW, x.size // 10)
    return int(min(max(_LEAST_WINDOW, _PART * 2.0 * swing), longest)) | 1
