"""One law of the speed in the place of several that together give nearly the same force over the speeds of a record.

Coulomb friction beside drag comes near a Stribeck curve in one decay. A fit of Stribeck's law that begins with Coulomb
friction alone may end in a wrong minimum, where the cart comes to rest at another place, and the two laws are named. So
each law of the speed is begun with the curve of the leading set: its parameters b, p follow by least squares from

    b·v + F(v; p) = b'·v + sum of the set's laws at v

over speeds v up to the largest of the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.model.effects import LIBRARY, Effect, by_name
from msd_ident.model.effects.typical import speed
from msd_ident.selection.evidence import LEAST_SPREAD
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, Hypothesis, causes_that_fit
from msd_ident.selection.law_errors import leaves_noise
from msd_ident.selection.simpler_sets import Start
from msd_ident.tuning import fixed

_FARTHEST = fixed(40.0, "accuracy", "logarithm of the largest and the smallest number that is tried")
_TRIALS = fixed(200, "accuracy", "curves of a law that are tried")
_SPEEDS = fixed(12, "accuracy", "speeds at which two curves are compared: more than twice the numbers of a law")


def merged(experiment: Experiment, fitted: Hypothesis) -> Iterator[Start]:
    """Sets with one law of the speed in the place of all that a fitted set has, if these are two or more.

    Only laws that hold the cart at rest as theirs do, or do not, and whose curve differs from theirs by no more than
    laws of one cause do (``LEAST_SPREAD``). Other forms of a law that comes so near are begun from it, as ever.

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
    begun: set[str] = set()
    for law in sorted(curves, key=lambda law: bool(law.form_of)):
        causes = frozenset({law.name, *(effect.name for effect in others)})
        known = law.form_of in begun or any(isinstance(one, law) for one in laws)
        if known or _holds(law) is not holding or not causes_that_fit(causes):
            continue
        damping, found, error = _nearest(law, law.guess(experiment.records[0], bare), speeds, force)
        if error < LEAST_SPREAD:
            begun.add(law.name)
            yield causes, replace(bare, damping=damping) + found, fitted.initial


def also_bent(fitted: Hypothesis, sets: Mapping[Causes, Hypothesis], noise: float) -> frozenset[str]:
    """Curves of a set that bend freely, in whose place one of another cause that bends freely leaves only noise too.

    Args:
        fitted: the set.
        sets: all fitted sets by their causes.
        noise: the chi² that noise leaves.
    """
    laws = list(filter(_bends, fitted.causes))
    curves = [law for law in LIBRARY if _bends(law.name)] if laws else []
    return frozenset(
        law
        for law in laws
        for other in curves
        if other.cause() != by_name(law).cause()
        and (instead := sets.get(fitted.causes - {law} | {other.name})) is not None
        and leaves_noise(instead, noise)
    )


def _bends(name: str) -> bool:
    """Whether a law is a curve over the speed whose shape is free."""
    return bool(by_name(name).form_of) and by_name(name).is_curve_over_speed()


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

    The search begins with the nearest guess, and moves the logarithms of damping and values, which are positive, but
    for those that are never fitted (``held``).
    """
    from scipy.optimize import least_squares  # imported here: few searches come to this

    curve, size = _along(law, speeds), float(np.sqrt(force @ force))
    free = np.array([True, *(parameter.name not in law.held for parameter in law.parameters)])

    def values(point: FloatArray, start: FloatArray) -> FloatArray:
        whole = start.copy()
        whole[free] = point
        moved: FloatArray = np.exp(np.clip(whole, -_FARTHEST, _FARTHEST))
        return np.array([moved[0], *law.within_bounds(*moved[1:]).values])

    def error(point: FloatArray, start: FloatArray) -> FloatArray:
        damping, *own = values(point, start)
        left: FloatArray = damping * speeds + curve(own) - force
        return left / size

    damping = max(float(np.mean(force / speeds)), 1e-9)
    points = [np.log(np.maximum([damping, *guess.values], 1e-9)) for guess in guesses]
    start = min(points, key=lambda point: float(np.sum(error(point[free], point) ** 2)))
    found = least_squares(error, start[free], args=(start,), method="lm", max_nfev=_TRIALS)
    damping, *own = values(found.x, start).tolist()
    return damping, law.within_bounds(*own), float(np.sqrt(found.fun @ found.fun))
