"""The final model of a diagnosis: its causes, refitted to the least simulation error.

Causes are found with each run of equal readings counted once, and each record in units of its own noise. A model is
used for simulation and is compared by its SEE (eq. 14), as that of an identification is. So it is refitted to the least
SEE, starting from the end of the diagnosis. If this leaves more than an identification of the same records does, a
second fit starts from the identification.
"""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate import FitResult, see
from msd_ident.estimate.base_fits import Shared
from msd_ident.estimate.least_squares import Solution, minimise
from msd_ident.estimate.multistart import limits
from msd_ident.estimate.objective import SquaredError
from msd_ident.model.base_model import friction_force
from msd_ident.model.effects import by_name
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Hypothesis


def simulating(fitted: Hypothesis, shared: Shared) -> Solution:
    """Refit of a set to the least plain sum of squares, from its own values and, where needed, from the shared fit.

    Args:
        fitted: the set as the diagnosis fitted it.
        shared: the fits of an identification of the same records.

    Returns:
        The solution with the smaller SEE; its cost is half the sum of squares [m²].
    """
    problem, objective = fitted.problem, SquaredError(fitted.problem)
    best = minimise(objective, fitted.point, limits(problem))
    known = _comparable(fitted, shared)
    if _see(fitted, best.point) <= known.see:
        return best
    other = minimise(objective, _from_shared(fitted, known), limits(problem))
    return min(best, other, key=lambda outcome: _see(fitted, outcome.point))


def _see(fitted: Hypothesis, point: FloatArray) -> float:
    """SEE [m] over all records."""
    return see([fitted.problem.residual(point, r) for r in range(len(fitted.problem.records))])


def _comparable(fitted: Hypothesis, shared: Shared) -> FitResult:
    """The shared fit whose causes a set holds too: the joint one where it can, else the linear one."""
    held = set(fitted.causes)
    if held & set(HOLDING_COULOMB):
        held.add(COULOMB)
    return shared.joint if set(shared.joint.model.effect_names) <= held else shared.linear


def _from_shared(fitted: Hypothesis, known: FitResult) -> FloatArray:
    """Vector (p,) of the set at the shared fit: what that does not have is without strength, inside the bounds."""
    model, problem = fitted.model, fitted.problem
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    for effect in model.effects:
        values |= {name: value for name, value in by_name(effect.name).neutral if np.isfinite(value)}
    values |= {name: known.model[name] for name in known.model.names if name in values}
    rubs = friction_force(known.model)
    for law, name in HOLDING_COULOMB.items():
        if law in fitted.causes:
            values[name] = rubs
    for parameter in model.parameters:
        if parameter.not_below:
            values[parameter.name] = values[parameter.not_below]
    return np.clip(problem.vector(values, known.initial), problem.lower, problem.upper)
