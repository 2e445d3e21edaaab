"""How much of the applied force a fitted set explains, along the measured motion.

Under a controller the motion is planned, and smooth. A heavy mass on a spring that swings as slowly follows it without
any force, better than the rig's own law, which is never exact: over short stretches, each with a start of its own, it
leaves the smaller error. In the equation of motion such a set leaves more force than was applied. (Robots are
identified by that equation: Gautier and Khalil 1988, IEEE ICRA. Its weak form stands in ``estimate.weak_form``.)
"""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.explained import LEAST
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.weak_form import WIDTHS, Means, uniform
from msd_ident.model import Model
from msd_ident.residuals.noise_model import Readings
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.law_signals import along, column


def explains_force(fitted: Hypothesis) -> bool:
    """Whether a set explains at least half of the mean square of the applied force, beside the noise of the readings.

    True where the records are too short to tell, and for a law whose force does not follow from the motion.
    """
    found = [_left(fitted.model, part, initial) for part, initial in zip(fitted.readings, fitted.initial, strict=True)]
    left, noise, force = (np.concatenate(parts) for parts in zip(*found, strict=True))
    missing = float(left @ left) - float(noise @ noise)
    return missing <= (1.0 - LEAST) * float(force @ force)


def _left(model: Model, part: Readings, initial: Initial) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(left, noise, force), each (r,): what the model leaves of the force over each bump [N], how much of it noise of
    the readings makes (rms), and the force; empty where nothing can be told.
    """
    record, half = part.record, WIDTHS[0]
    nothing = np.empty(0)
    if record.samples <= 2 * half + 1:
        return nothing, nothing, nothing
    means = Means(uniform(record, initial.zero), half)  # not kept: each set has a zero of its own
    motion = along(means, model.stiffness)
    if not all(motion.can_tell(type(effect)) for effect in model.effects):
        return nothing, nothing, nothing
    plant = (model.mass, model.damping, model.stiffness)
    left = means.force - means.plant_columns(motion.position) @ plant
    for effect in model.effects:
        left = left - column(effect, motion, means, model)
    noise = np.full(left.size, part.noise * means.noise_gain(plant))
    return left, noise, means.force
