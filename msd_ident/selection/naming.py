"""Choice of the set to name among sets that the data cannot tell apart.

The set leads that ``ordering.rank`` puts first, unless it names a cause with less probability than one that it
leaves out: then the next that does not.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from msd_ident.estimate.effort import KEPT
from msd_ident.estimate.levels import ALIKE, MOST_OF, TENTH
from msd_ident.model.effects import by_name
from msd_ident.selection.certainty import FAINT, ROUNDING, probability_at, uncertain
from msd_ident.selection.cross_validation import HeldOut, predict
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, Hypothesis, kinds
from msd_ident.selection.ranking import CALLED, DECISIVE, Ranking


def leading(ranking: Ranking) -> Ranking:
    """The ranking led by a set that names no cause with less probability than a cause that it leaves out.

    Candidates are the present leading set and those within ``DECISIVE`` of the likeliest set, in their order. If each
    of them names such a cause, the set with the smallest difference leads, and ``ties.tied`` lists what it leaves out.
    A leading set without causes keeps the lead.
    """
    if not ranking.best.causes:
        return ranking
    near = max(ranking.evidence) - DECISIVE
    found = [one for one, value in zip(ranking.sets, ranking.evidence, strict=True) if value >= near and one.causes]
    asked = [ranking.best, *(one for one in found if one is not ranking.best)]
    margins = [margin(ranking, one.causes) for one in asked]
    fair = [one for one, value in zip(asked, margins, strict=True) if value >= -ROUNDING]
    return ranking.led_by(fair[0] if fair else asked[margins.index(max(margins))])


def predicting(experiment: Experiment, base: Hypothesis, ranking: Ranking) -> tuple[Ranking, Hypothesis, HeldOut]:
    """The leading set that predicts left-out data better than the base model, or the base model.

    A set that does not is dropped from the ranking, and the next one is tried, ``KEPT`` times at most. If the base
    model leads, the likeliest set with causes replaces it when the interval of its gain is above 0. Where another set
    leaves far less than the leading one, left-out data decide first (``_leaving_less``).

    Args:
        experiment: readings with their weights.
        base: the fitted base model.
        ranking: sets by evidence, the leading one first.

    Returns:
        The ranking without the dropped sets (as it was, if the base model is chosen), the chosen set, and its
        prediction of left-out data.
    """
    if found := _foretold(ranking, experiment, base):
        return found
    if not ranking.best.causes and len(ranking.sets) > 1:
        likeliest = max(zip(ranking.evidence, ranking.sets, strict=True), key=lambda pair: pair[0])[1]
        other = leading(ranking.led_by(likeliest))
        heldout = predict(experiment, base, other.best)
        if likeliest.causes and heldout.interval_percent[0] > 0.0:
            return other, other.best, heldout
    left = leading(ranking)
    for _ in range(KEPT):
        if not left.best.causes:
            break
        heldout = predict(experiment, base, left.best)
        if heldout.better:
            return left, left.best, heldout
        if len(left.sets) == 1:
            break
        left = leading(without(left, left.best))
    if len(left.sets) < len(ranking.sets) and (found := _foretold(left, experiment, base)):
        return found
    return ranking, base, predict(experiment, base, base)


def _foretold(ranking: Ranking, experiment: Experiment, base: Hypothesis) -> tuple[Ranking, Hypothesis, HeldOut] | None:
    """The result of ``predicting`` if left-out data call for a set that leaves less than the leading one does.

    They are asked again of what leaves less than that set, ``KEPT`` times at most.
    """
    found, leader = None, ranking.best
    for _ in range(KEPT):
        less = _leaving_less(ranking, experiment, base)
        if less is None:
            break
        heldout = predict(experiment, base, less.best)
        if not heldout.better or (leader.causes and not predict(experiment, leader, less.best).better):
            break
        found = less, less.best, heldout
        ranking, leader = less, less.best
    return found


def _leaving_less(ranking: Ranking, experiment: Experiment, base: Hypothesis) -> Ranking | None:
    """The ranking of the sets that leave less than half of the error, if the leading one leaves more than it explains
    or the evidence is not decisively better for it, or less than a tenth of it; of those that leave only noise, if
    there are any; where there is none, of those that leave clearly less (``ALIKE``) with the same evidence but for
    ``CALLED``.

    Evidence gives what a set leaves a few features in each octave, whatever it is, and asks of a law each of its
    numbers. A law of many sharp numbers (frequencies, pitches, phases) may lose to no law, or to one that moves a
    little like it, although little is left of it. Samples that it did not see decide that: by chance no law predicts
    them. As the evidence does not call for the law, none of its causes is certain but those that the leading set holds
    too (``_called``).

    Args:
        ranking: sets by evidence, the leading one first.
        experiment: readings with their weights.
        base: the fitted base model.

    Returns:
        None if there is no such set, or if the leading one leaves too little for its form to be seen.
    """
    chi = ranking.best.chi
    if chi < FAINT**2 * experiment.evidence:
        return None
    most = TENTH if chi < MOST_OF * base.chi else MOST_OF
    even = [one.causes for one in ranking.within(DECISIVE)]
    less = [one for one in _with_less(ranking) if one.chi < most**2 * chi or one.causes in even]
    less = less or [one for one in ranking.within(CALLED) if one.chi * ALIKE**2 < chi]
    noise = [one for one in less if ranking.caveats_of(one.causes).exact]
    only = ranking
    for one in ranking.sets:
        if one not in (noise or less):
            only = without(only, one)
    if not only.sets:
        return None
    called = ranking.called if ranking.foretold else _called(ranking)
    return leading(replace(only, foretold=True, called=called).led_by(_plainest(only)))


def _called(ranking: Ranking) -> dict[str, float]:
    """Causes of the set that the evidence puts first, with their probability; in a poor experiment, of which no copies
    are made then, no more than one without copies allows.
    """
    found = {kind: ranking.of_cause(kind) for kind in kinds(ranking.best.causes)}
    if ranking.rich:
        return found
    return {kind: min(p, probability_at(uncertain(by_name(kind)))) for kind, p in found.items()}


def _plainest(ranking: Ranking) -> Hypothesis:
    """The likeliest set, or the one with the fewest of its causes whose evidence is lower by at most ``CALLED``."""
    likeliest = max(zip(ranking.evidence, ranking.sets, strict=True), key=lambda pair: pair[0])[1]
    near = max(ranking.evidence) - CALLED
    parts = [
        one
        for one, value in zip(ranking.sets, ranking.evidence, strict=True)
        if value >= near and kinds(one.causes) <= kinds(likeliest.causes)
    ]
    return min(parts, key=lambda one: len(one.causes))


def leaving_less(ranking: Ranking, noise: float) -> list[Causes]:
    """Causes of the likeliest sets that leave less than half of what the leading one leaves above the noise, ``KEPT``
    at most, none of them with all causes of another or with more than two: many laws follow anything.

    Args:
        ranking: sets by evidence, the leading one first.
        noise: chi² that noise alone leaves.
    """
    most = noise + MOST_OF**2 * (ranking.best.chi - noise) if ranking.best.chi > noise else 0.0
    found = [one.causes for one in ranking.sets if 0 < len(one.causes) <= 2 and one.chi < most]
    return [causes for causes in found if not any(other < causes for other in found)][:KEPT]


def _with_less(ranking: Ranking) -> list[Hypothesis]:
    """Sets that leave less than half of the error of the leading one, the likeliest first."""
    return [one for one in ranking.sets if one.chi < MOST_OF**2 * ranking.best.chi]


def margin(ranking: Ranking, named: Causes) -> float:
    """Least probability of a named cause, minus the greatest probability of a cause that is not named.

    Args:
        ranking: sets with their probabilities.
        named: the named causes; the result is infinite if there are none.
    """
    others = kinds(_all(ranking.sets)) - kinds(named)
    least = min((ranking.of_cause(name) for name in named), default=math.inf)
    return least - max((ranking.of_cause(name) for name in others), default=0.0)


def without(ranking: Ranking, refused: Hypothesis) -> Ranking:
    """The ranking without one of its sets; the other probabilities are scaled to the sum 1.

    Args:
        ranking: sets with their probabilities.
        refused: the set to drop, the very object of the ranking.
    """
    kept = [i for i, one in enumerate(ranking.sets) if one is not refused]
    total = sum(ranking.probability[i] for i in kept)
    return replace(
        ranking,
        sets=tuple(ranking.sets[i] for i in kept),
        evidence=tuple(ranking.evidence[i] for i in kept),
        probability=tuple(ranking.probability[i] / total if total > 0.0 else 1.0 / len(kept) for i in kept),
    )


def chances(ranking: Ranking) -> dict[Causes, float]:
    """Probability of each set, as parameters have it that differ between them.

    Where a named cause may be another form of the law of the others, the likeliest set without it has at least the
    probability that the cause does not act.

    Args:
        ranking: sets by evidence, the leading one first.
    """
    found = {one.causes: p for p, one in zip(ranking.probability, ranking.sets, strict=True)}
    for name in ranking.leader_caveats.further:
        lacking = [causes for causes in found if by_name(name).cause() not in kinds(causes)]
        if lacking:
            likeliest = max(lacking, key=lambda causes: found[causes])
            found[likeliest] = max(found[likeliest], 1.0 - ranking.of_cause(name))
    return found


def _all(sets: Iterable[Hypothesis]) -> frozenset[str]:
    """All causes of these sets."""
    return frozenset().union(*(one.causes for one in sets))
