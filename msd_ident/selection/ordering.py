"""Order of the fitted sets by their evidence.

A set counts if it is more than a simpler one: no law is exact, so what a set leaves may be another form of its laws and
not a further cause.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from msd_ident.estimate.levels import FEWEST, NEGLIGIBLE, SHAPES, TENTH
from msd_ident.model.effects import by_name
from msd_ident.model.effects.typical import speed
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.certainty import LEFT_PART
from msd_ident.selection.evidence import NoiseScale, log_evidence, log_prior
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis, imitated_by, kinds
from msd_ident.selection.law_errors import (
    clear_as_friction,
    clearness,
    instead,
    leaves_noise,
    left_over,
    other_forms,
    within_law_error,
    within_sampling,
)
from msd_ident.selection.ranking import CALLED, NEAR, Ranking
from msd_ident.selection.simpler_sets import equal_to


def rank(sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> Ranking:
    """Fitted sets by falling evidence.

    A set that is equal to a simpler one is left out, e.g. if an effect ended without strength. The first set is the
    likeliest one, or the simplest one without further causes whose evidence is lower by at most ``CALLED``. Where
    other sets give the motion of the likeliest one, a set with fewer causes is compared with all of them together.

    Args:
        sets: every fitted set by its causes.
        scale: noise and number of features of the error.
    """
    values = _values(sets, scale)
    order = sorted(values, key=lambda causes: -values[causes])
    top = values[order[0]]
    first = _first(order, values, sets, scale)
    order.remove(first)
    order.insert(0, first)
    weights = np.exp(np.array([values[causes] for causes in order]) - top)
    weights /= weights.sum()
    return Ranking(
        tuple(sets[causes] for causes in order),
        tuple(values[causes] for causes in order),
        tuple(float(w) for w in weights),
        caveats={causes: _caveats(causes, sets, scale, values[causes] >= top - NEAR) for causes in order},
        rubbing={causes: sets[rubs] for causes in order if (rubs := causes | {COULOMB}) in sets and rubs not in values},
    )


def _caveats(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale, near: bool) -> Caveats:
    """What keeps the causes of a set from being certain; ``instead`` only of sets ``near`` the likeliest one."""
    fitted = sets[causes]
    exact, left = leaves_noise(fitted, scale.noise), left_over(causes, sets, scale.noise)
    return Caveats(
        causes,
        exact=exact,
        leaves=left if left > LEFT_PART else 0.0,
        further=other_forms(causes, sets, scale.noise),
        clear=clearness(causes, sets, scale),
        rubs=clear_as_friction(causes, sets, scale),
        instead=instead(causes, sets, scale) if near else {},
        slow=fitted.kept("slow", partial(_slow, fitted)),
        seldom=frozenset() if exact else fitted.kept("seldom", partial(_seldom, fitted)),
        held=fitted.kept("held", partial(_held, fitted)),
        sampled=within_sampling(causes, sets),
    )


def leading(sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> Hypothesis:
    """The first set of ``rank``, without what is asked of the others."""
    values = _values(sets, scale)
    return sets[_first(sorted(values, key=lambda causes: -values[causes]), values, sets, scale)]


def _values(sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> dict[Causes, float]:
    """Log evidence [nats] of the sets that are more than a simpler one."""
    own = {causes: log_evidence(one, scale) for causes, one in sets.items() if _called_for(causes, sets, scale)}
    return {causes: min([value, *_ceilings(causes, own, sets, scale)]) for causes, value in own.items()}


def _first(
    order: Sequence[Causes], values: Mapping[Causes, float], sets: Mapping[Causes, Hypothesis], scale: NoiseScale
) -> Causes:
    """The set that leads, of those in ``order`` by falling evidence (``rank``)."""
    same = [one for one in order if _same_motion(sets[one], sets[order[0]], scale)]
    simpler = [one for one in order if kinds(one) <= kinds(order[0])]
    near = [one for one in simpler if values[one] >= _beyond(one, same, values) - CALLED]
    return min(near, key=lambda one: (len(one), _forms(one), -values[one]))


def _called_for(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> bool:
    """Whether a set is more than a simpler one.

    It is not if an effect has no strength, if a cause explains no more than an error of the other laws could, or if the
    set is hardly likelier (``CALLED``) than one without a cause that leaves only noise, one with the limit of a law in
    its place, or one with another effect that it is equal to. Nor is it if a cause adds nothing to the likelihood: less
    than ``TENTH`` of a nat.
    """
    if not set(sets).isdisjoint(equal_to(sets[causes])):
        return False
    if scale.shapes <= SHAPES and (within_law_error(causes, sets, scale.noise) or _adds_nothing(causes, sets, scale)):
        return False
    simpler = (*_sufficient(causes, sets, scale), *limits(causes), *imitated_by(sets[causes]))
    known = [sets[one] for one in simpler if one in sets]
    return all(scale.of(sets[causes]) > scale.of(limit) + CALLED for limit in known)


def _adds_nothing(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> bool:
    """Whether one of the causes adds nothing to the likelihood: less than ``TENTH`` of a nat."""
    smaller = [sets[causes - {name}] for name in causes if causes - {name} in sets]
    return any(scale.of(sets[causes]) < scale.of(one) + TENTH for one in smaller)


def _sufficient(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> Iterator[Causes]:
    """Sets without one of the causes that leave only noise already."""
    smaller = (causes - {name} for name in causes)
    return (one for one in smaller if one in sets and leaves_noise(sets[one], scale.most))


def limits(causes: Causes) -> Iterator[Causes]:
    """Sets in which a law is replaced by its limit: the simple law of its cause, or Coulomb friction.

    A set counts only if it is likelier than these (``rank``).

    Args:
        causes: of the set.
    """
    for name in causes:
        if form_of := by_name(name).form_of:
            yield causes - {name} | {form_of}
        if name in HOLDING_COULOMB:
            yield causes - {name} | {COULOMB}


def _ceilings(
    causes: Causes, own: Mapping[Causes, float], sets: Mapping[Causes, Hypothesis], scale: NoiseScale
) -> Iterator[float]:
    """Upper bounds on the evidence of a set, one from each smaller set.

    Each is the evidence of the smaller set, plus the gain in likelihood and the prior of the further causes. The
    marginal likelihood of a larger model is an average of such values over the further parameters. Laplace's
    determinant, computed where a law has a kink, may exceed that.
    """
    for smaller, value in own.items():
        if smaller < causes:
            gain = scale.of(sets[causes]) - scale.of(sets[smaller])
            yield value + max(gain, 0.0) + log_prior(causes - smaller)


def _same_motion(one: Hypothesis, other: Hypothesis, scale: NoiseScale) -> bool:
    """Whether two sets of as many causes give the same motion, as far as the records show it (``unseen``)."""
    if len(one.causes) != len(other.causes):
        return False
    between = one.state.residual - other.state.residual
    return bool(between @ between < scale.unseen(min(one.chi, other.chi)))


def _beyond(simple: Causes, same: Sequence[Causes], values: Mapping[Causes, float]) -> float:
    """Log evidence [nats] that a set must come near to lead in place of the likeliest one.

    It is that of all sets together that give the likeliest one's motion and have further causes than this set. No data
    tells them apart (an offset and an asymmetric spring beside a cubic one), so each has only a part of the evidence
    that a further cause acts.

    Args:
        simple: the set.
        same: the likeliest set first, then those that give the same motion.
        values: log evidence of each.
    """
    further = [values[one] for one in same if kinds(simple) < kinds(one)]
    return float(np.logaddexp.reduce(further)) if further else values[same[0]]


def _slow(fitted: Hypothesis) -> frozenset[str]:
    """Effects that bring a motion of which the longest record holds less than a period, or repeat along the travel and
    are not seen twice on the longest way.
    """
    longest = max(record.duration for record in fitted.problem.records)
    widest = max(float(np.ptp(record.position)) for record in fitted.problem.records)
    return frozenset(
        effect.name
        for effect in fitted.model.effects
        if effect.longest_period() > longest or 2.0 * effect.repeats_after() > widest
    )


def _seldom(fitted: Hypothesis) -> frozenset[str]:
    """Effects that bring a tone of which the longest record holds fewer than ``FEWEST`` periods."""
    longest = max(record.duration for record in fitted.problem.records)
    toned = [effect for effect in fitted.model.effects if effect.tones()]
    return frozenset(effect.name for effect in toned if FEWEST * effect.longest_period() > longest)


def _held(fitted: Hypothesis) -> frozenset[str]:
    """Effects that hold the cart at rest, and of which hardly anything is left as soon as it moves."""
    slowest = NEGLIGIBLE * max(speed(record) for record in fitted.problem.records)
    return frozenset(
        effect.name
        for effect in fitted.model.effects
        if effect.holding > 0.0 and effect.rubs(slowest) <= TENTH * effect.holding
    )


def _forms(causes: Causes) -> int:
    """Number of laws that are not the first, simple one of their cause."""
    return sum(bool(by_name(name).form_of) for name in causes)
