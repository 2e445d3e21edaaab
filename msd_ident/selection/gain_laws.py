"""Other laws of the force gain that a record cannot distinguish from the leading one.

A record with two sizes of force shows only the ratio of their gains. A slope, a limit, a dead zone and a gain that
depends on the sign then fit equally well, each with its own mass, damping and stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_ident.model.effects import by_name
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment, switched_off
from msd_ident.selection.hypothesis import Causes, Hypothesis, causes_that_fit, without
from msd_ident.selection.hypothesis_fit import COMPARABLE, REACH, StartingPoint, begin, finish, refine
from msd_ident.selection.ranking import CALLED, DECISIVE
from msd_ident.selection.starting_points import proposals


def alike(experiment: Experiment, best: Hypothesis, scale: NoiseScale) -> list[Hypothesis]:
    """The leading set with each other law of the force's gain that is not decisively less likely.

    Args:
        experiment: all data.
        best: the leading set, fitted to it.
        scale: how likelihoods are read there.
    """
    found = []
    for name in sorted(best.causes):
        if "input_map" not in by_name(name).laws():
            continue
        bare = refine(experiment, best.causes - {name}, *without(best, name))
        for form in (name, *experiment.forms(name)):
            causes = best.causes - {name} | {form}
            if causes_that_fit(causes) and by_name(form).cause() == by_name(name).cause():
                found += _fitted(experiment, causes, bare, best)
    return [one for one in found if scale.of(one) > scale.of(best) - DECISIVE]


def leading(best: Hypothesis, laws: Sequence[Hypothesis], scale: NoiseScale) -> Hypothesis:
    """The law of the gain that leads where several fit alike.

    The commands are calibrated forces, so a law comes first that keeps their gain over a range (a dead zone, a limit):
    a law that changes the gain at every command moves mass, damping and stiffness away from this calibration.

    Args:
        best: the leading set.
        laws: result of ``alike``.
        scale: how likelihoods are read there.
    """
    near = [one for one in laws if scale.of(one) > scale.of(best) - CALLED]
    keeping = [one for one in (best, *near) if all(effect.keeps_gain() for effect in one.model.effects)]
    return best if best in keeping else max(keeping, key=scale.of, default=best)


def shares(
    laws: Sequence[Hypothesis], best: Hypothesis, scale: NoiseScale, whole: float
) -> list[tuple[float, Hypothesis]]:
    """The probability of the leading set, shared with each other law of the gain by their likelihoods.

    Args:
        laws: result of ``alike``.
        best: the leading set.
        scale: how likelihoods are read there.
        whole: probability of the leading set, whatever law of the gain it has.
    """
    odds = [math.exp(min(scale.of(one) - scale.of(best), DECISIVE)) for one in laws]
    return [(whole * one / (1.0 + math.fsum(odds)), law) for one, law in zip(odds, laws, strict=True)]


def _fitted(experiment: Experiment, causes: Causes, bare: Hypothesis, best: Hypothesis) -> list[Hypothesis]:
    """A set in each of its shapes (a slope, a limit), but for the one that ``best`` is."""
    shapes: dict[Causes, list[StartingPoint]] = {}
    for start in proposals(experiment, causes, [bare]):
        shapes.setdefault(switched_off(start.fitted.model), []).append(start)
    if causes == best.causes:
        shapes.pop(switched_off(best.model), None)
    reach = experiment.worse(best.chi, REACH)
    ended = [finish(experiment, begin(experiment, starts, reach), best.chi) for starts in shapes.values()]
    # From one law of the gain to another all forces change together, which a search that is given up early only begins.
    return [
        refine(experiment, causes, one.model, one.initial) if one.chi < COMPARABLE * best.chi else one for one in ended
    ]
