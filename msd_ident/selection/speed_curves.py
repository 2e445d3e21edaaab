"""One law of the speed in the place of several that together give nearly the same force over the speeds of a record.

Coulomb friction beside drag comes near a Stribeck curve in one decay. A fit of Stribeck's law that begins with Coulomb
friction alone may end in a wrong minimum, where the cart comes to rest at another place, and the two laws are named. So
each law of the speed is begun with the curve of the leading set: its parameters b, p follow by least squares from

    b·v + F(v; p) = b'·v + sum of the set's laws at v

over all speeds v that the motion has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.model.effects import Effect, by_name
from msd_ident.model.effects.typical import speed
from msd_ident.selection.evidence import LEAST_SPREAD
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis, causes_that_fit
from msd_ident.selection.simpler_sets import Start
from msd_ident.tuning import fixed

_FARTHEST = fixed(40.0, "accuracy", "logarithm of the largest and the smallest number that is tried")
_TRIALS = fixed(200, "accuracy", "curves of a law that are tried")
_SPEEDS = fixed(12, "accuracy", "speeds at which two curves are compared: more than twice the numbers of a law")


def merged(experiment: Experiment, fitted: Hypothesis) -> Iterator[Start]:
    """Sets with one law of the speed in the place of all that a fitted set has, if these are two or more.

    Only laws that hold the cart at rest where theirs do, and whose curve differs from theirs by no more than laws of
    one cause do (``LEAST_SPREAD``). Other forms of such a law are begun from it, as ever.

    Args:
        experiment: readings with their weights.
        fitted: the set.
    """
    laws = [effect for effect in fitted.model.effects if effect.is_curve_over_speed()]
    if len(laws) < 2:
        return
    top = max(speed(record) for record in experiment.records)
    speeds = np.linspace(top / _SPEEDS, top, _SPEEDS)
    force = fitted.model.damping * speeds
    for effect in laws:
        force = force + _along(type(effect), speeds)(effect.values)
    if not force.any():
        return
    others = tuple(effect for effect in fitted.model.effects if effect not in laws)
    bare = replace(fitted.model, effects=others)
    holding = any(map(_holds, laws))
    curves = [by_name(name) for name in experiment.library if by_name(name).is_curve_over_speed()]
    asked = [law for law in curves if _holds(law) is holding and not any(isinstance(one, law) for one in laws)]
    for law in asked:
        causes = frozenset({law.name, *(effect.name for effect in others)})
        if not causes_that_fit(causes) or any(law.form_of == one.name for one in asked):
            continue
        damping, found, error = _nearest(law, law.guess(experiment.records[0], bare), speeds, force)
        if error < LEAST_SPREAD:
            yield causes, replace(bare, damping=damping) + found, fitted.initial


def _holds(law: Effect | type[Effect]) -> bool:
    """Whether it holds the cart at rest."""
    return "breakaway" in law.laws()


def _along(law: type[Effect], speeds: FloatArray) -> Callable[[Sequence[float]], FloatArray]:
    """Force (n,) [N] of a law at speeds (n,) [m/s], as a function of its values."""
    force, places = law.curve_over_speed(), speeds.tolist()
    return lambda values: np.array([force(v, values) for v in places])


def _nearest(
    law: type[Effect], guesses: Sequence[Effect], speeds: FloatArray, force: FloatArray
) -> tuple[float, Effect, float]:
    """Damping [N·s/m] and law whose force is nearest to a curve (n,) [N], and the rms of what is left as a part of it.

    The search begins with the nearest guess, and moves the logarithms of damping and values, which are positive.
    """
    from scipy.optimize import least_squares  # imported here: few searches come to this

    curve = _along(law, speeds)
    size = float(np.sqrt(force @ force))

    def error(point: FloatArray) -> FloatArray:
        values = np.exp(np.clip(point, -_FARTHEST, _FARTHEST))
        left: FloatArray = values[0] * speeds + curve(law.within_bounds(*values[1:]).values) - force
        return left / size

    damping = max(float(np.mean(force / speeds)), 1e-9)
    points = [np.log(np.maximum([damping, *guess.values], 1e-9)) for guess in guesses]
    start = min(points, key=lambda point: float(np.sum(error(point) ** 2)))
    found = least_squares(error, start, method="lm", max_nfev=_TRIALS)
    values, left = np.exp(np.clip(found.x, -_FARTHEST, _FARTHEST)), found.fun
    return float(values[0]), law.within_bounds(*values[1:]), float(np.sqrt(left @ left))
