"""Which sets of a round are begun.

A round is all sets that differ from a leading one by a cause: some fifty. Most of them lose, and where nothing explains
a record, round follows round. The first Gauss–Newton step of a start predicts what its set will leave: that is enough
to leave out most sets before the first step.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from msd_ident.estimate.levels import MOST_OF
from msd_ident.selection.evidence import NoiseScale, log_prior, occam
from msd_ident.selection.hypothesis import COULOMB, Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import StartingPoint
from msd_ident.selection.ranking import LEADERS, NEAR
from msd_ident.tuning import tuned

_BEGUN = tuned(
    16,
    unit="sets",
    why="sets of a round that are begun, those whose starts promise to leave least",
    chosen="on 112 rigs (`python -m bench.blind`, seeds 482000 and 483000; `--variants`, 473000): in 175 of 176 rounds "
    "that lowered the error by a tenth, the set that lowered it most was among the first 15",
)


def within_reach(
    new: Sequence[Causes], sets: Mapping[Causes, Hypothesis], beyond: Collection[Causes], reach: float
) -> list[Causes]:
    """The sets of which no set with one cause more leaves, or promises, more than ``reach``.

    A set leaves at least as much as one that has all its causes.

    Args:
        new: sets that may be fitted.
        sets: fitted sets by their causes.
        beyond: sets whose starts promise more than ``reach``; those that were fitted all the same do not count.
        reach: chi² up to which a set can count.
    """
    far = {causes for causes, one in sets.items() if one.chi > reach} | (set(beyond) - set(sets))
    return [causes for causes in new if not any(one > causes and len(one) == len(causes) + 1 for one in far)]


def promising(
    group: list[list[StartingPoint]], scale: NoiseScale, fitted: Collection[Hypothesis]
) -> list[list[StartingPoint]]:
    """The sets of a round whose starts promise to leave least, and those that promise most evidence.

    A flexible law leaves less than a plain one that is likelier. A set that promises to leave more than twice what the
    best one leaves, and too little evidence to count, is left out, but for the first one of a round: far from the
    noise, half of all simulations were of such sets, and of 917 on eleven measured rigs 4 ended below 1.5 times the
    best one, one of them below it. Sets of one cause, alone or beside Coulomb friction, are all promising: larger ones
    are made of them.

    Args:
        group: the starts of each set.
        scale: in which evidence is stated.
        fitted: all fitted sets.
    """
    if any(_basic(starts[0].fitted.causes) for starts in group):
        return group
    most = min(one.chi for one in fitted) / MOST_OF
    least = max(_evidence(one, one.chi, scale) for one in fitted) - NEAR
    left = [(min(min(start.promise, start.least) for start in starts), starts) for starts in group]
    likely = [(max(_evidence(start.fitted, start.promise, scale) for start in starts), starts) for starts in group]
    ahead = sorted(left, key=lambda pair: pair[0])[:_BEGUN]
    first = [starts for place, (chi, starts) in enumerate(ahead) if place == 0 or chi < most]
    then = [starts for nats, starts in sorted(likely, key=lambda pair: -pair[0])[:LEADERS] if nats > least]
    return first + [starts for starts in then if all(starts is not one for one in first)]


def _basic(causes: Causes) -> bool:
    """One cause, alone or beside Coulomb friction: larger sets are made of these, however little they explain."""
    return len(causes - {COULOMB}) <= 1


def _evidence(fitted: Hypothesis, chi: float, scale: NoiseScale) -> float:
    """Log evidence [nats] that a set would have with a chi², all octaves alike."""
    return scale.log_likelihood(chi) - occam(fitted, scale.spread(chi)) + log_prior(fitted.causes)
