"""A common factor of all forces that the data shows on one side alone.

A cart that dry friction holds under a force, and that is let go, tells the ratios of its parameters. Of their scale it
tells an inequality: the force that held it and the spring's differ by no more than the friction. A fit that ends on the
edge of that slides a little on one side, and not on the other. The derivative there, and the interval that follows from
it, are those of one side; the cost itself says on which side nothing changes.
"""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import ALIKE, BEYOND_DOUBT, TENTH
from msd_ident.estimate.objective import SquaredError
from msd_ident.estimate.problem import Problem
from msd_ident.model.parameters import FORCES
from msd_ident.tuning import fixed

#: Measured: of carts let go from 1.5 N, with 0.12 N of friction, the cost rose by 0.003 to 0.03 of what its curvature
#: says at ten on the flat side; with a creep of two counts by 0.39, and at thirty by 0.04.
_FAR = fixed((3.0, 10.0, 30.0), "accuracy", "standard deviations by which the factor is changed: kinks are smaller")
#: Largest change of the factor: further away any motion is as wrong as any other.
_MOST = ALIKE - 1.0


def open_scale(
    problem: Problem, point: FloatArray, bread: FloatArray, covariance: FloatArray, soft: float
) -> FloatArray | None:
    """The direction (p,) that scales all forces, where on one side the cost hardly rises; None where it does on both.

    Args:
        problem: what was fitted.
        point: (p,) where the fit ended.
        bread: (p, p) JᵀJ there.
        covariance: (p, p) of the entries.
        soft: residual [m] beyond which the loss grows linearly; 0 for plain squares.
    """
    forces = np.array([name in FORCES for name in problem.names])
    if any(problem.model[name] != 0.0 for name in FORCES.intersection(problem.model.names) - set(problem.names)):
        return None  # what is not fitted sets the scale
    direction = np.where(forces, point, 0.0)
    size = np.abs(direction)
    main = int(np.argmax(np.where(size > 0.0, size / problem.scale, 0.0)))
    if not size[main] > 0.0 or not covariance[main, main] > 0.0:
        return None
    spread = float(np.sqrt(covariance[main, main])) / size[main]
    error = SquaredError(problem, soft=soft)
    curvature, before = float(direction @ bread @ direction), error.cost(point)

    def rise(step: float) -> float:
        moved = np.clip(point + step * direction, problem.lower, problem.upper)
        return error.cost(moved) - before

    def is_flat(step: float) -> bool:
        """Whether the cost rises little, and no further: that of a motion that bends much rises on."""
        near, further = rise(step), rise(2.0 * step)
        little = near < min(TENTH * 0.5 * curvature * step**2, BEYOND_DOUBT * before)
        return little and further < ALIKE * max(near, TENTH * before)

    steps = [times * spread for times in _FAR if times * spread <= _MOST]
    return direction if any(is_flat(side * step) for step in steps for side in (-1.0, 1.0)) else None
