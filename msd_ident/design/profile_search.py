"""Search through the family of profiles, from short to long, until one decides well enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident import cancellation
from msd_ident.data.record import FloatArray
from msd_ident.design import rival_refits
from msd_ident.design.evaluation import ENOUGH, Option, Question, choose, judge_again, options
from msd_ident.design.profile import Profile
from msd_ident.design.rival_refits import Refitted
from msd_ident.estimate.effort import LOOK
from msd_ident.estimate.levels import MOST_OF, NEGLIGIBLE
from msd_ident.selection.ranking import LEADERS
from msd_ident.tuning import tuned

#: A rival that is found out less often than this by the best of all profiles cannot be parted by any.
HOPELESS = MOST_OF
_VAIN = tuned(2, unit="looks", why="looks that found nothing better, after which no more are taken", chosen="by hand")
_SCREENING = tuned(
    12e6,
    unit="readings simulated",
    why="work after which no more profiles are screened; half as much may go into closer looks then (a reading: one "
    "instant of one rival, as it is or with one parameter moved)",
    chosen="one core of 2026 does some 3 million a second",
)

Refits = list[list[Refitted | None]]


@dataclass(frozen=True)
class Found:
    """Result of a search for a profile.

    Attributes:
        best: the chosen profile, evaluated with real refits.
        refits: the refits of its rivals.
        all: all profiles that were evaluated.
    """

    best: Option
    refits: Refits
    all: tuple[Option, ...]


def search(question: Question, profiles: Sequence[Profile]) -> Found | None:
    """The first profile that decides well enough with rivals really refitted; else the best one.

    Args:
        question: rivals and limits.
        profiles: in the order in which they are tried.

    Returns:
        None if no profile fits within the limits.
    """
    work = 0.0
    seen: list[Option] = []
    closer: list[tuple[Option, Refits]] = []
    for begin in range(0, len(profiles), LEADERS):
        cancellation.raise_if_cancelled()
        if seen and work > _SCREENING:
            break
        batch = options(question, profiles[begin : begin + LEADERS])
        work += sum(question.work(profile) for profile in profiles[begin : begin + LEADERS])
        seen += batch
        good = [one for one in batch if one.probability >= ENOUGH]
        if good and len(closer) < LOOK:
            closer.append(_closely(question, min(good, key=lambda one: one.profile.duration)))
            work += _refitting(closer[-1][1])
            if closer[-1][0].probability >= ENOUGH:
                return Found(*closer[-1], tuple(seen))
    if not seen:
        return None
    question = _decidable(question, seen)
    seen = [_asked(question, one) for one in seen]
    closer = [(_asked(question, one), refits) for one, refits in closer]
    known = {one.profile.name for one, _ in closer}
    for pick in _promising(seen):
        cancellation.raise_if_cancelled()
        if closer and (_in_vain(closer) or work > _SCREENING + MOST_OF * _SCREENING):
            break
        if pick.profile.name in known:
            continue
        closer.append(_closely(question, pick))
        work += _refitting(closer[-1][1])
        if closer[-1][0].probability >= ENOUGH:
            break
    best = choose([one for one, _ in closer])
    return Found(*next(pair for pair in closer if pair[0] is best), tuple(seen))


def _promising(seen: Sequence[Option]) -> list[Option]:
    """Profiles to evaluate with real refits: the shortest good ones, and those that distinguish the rivals best."""
    first = choose(seen)
    best = max(one.probability for one in seen)
    good = [one for one in seen if one.probability >= best - 0.05 and one is not first]
    good.sort(key=lambda one: -one.strength)
    return ([first] if first else []) + good[: LOOK - 1]


def _decidable(question: Question, seen: Sequence[Option]) -> Question:
    """The question without those that no profile can find out: they get a measurement instead."""
    best = np.max([one.parting.decided for one in seen], axis=0)
    truths: FloatArray = np.where(best < HOPELESS, 0.0, question.truths)
    return replace(question, truths=truths) if truths.any() else question


def _in_vain(closer: Sequence[tuple[Option, Refits]]) -> bool:
    """Whether the last real refits found nothing better than the ones before."""
    probabilities = [one.probability for one, _ in closer]
    return len(closer) > _VAIN and max(probabilities[-_VAIN:]) <= max(probabilities[:-_VAIN]) + NEGLIGIBLE


def _asked(question: Question, option: Option) -> Option:
    """The option with the probability that it answers this question, the rivals being as they were."""
    return replace(option, parting=option.parting.asked(question.truths))


def _refitting(refits: Refits) -> float:
    """Readings that real refits took."""
    return float(sum(one.simulated for row in refits for one in row if one is not None))


def _closely(question: Question, option: Option) -> tuple[Option, Refits]:
    """The option judged with rivals really refitted."""
    kept, refits = rival_refits.shares(question.predictors, option.predictions, option.grid, question.sensing)
    return judge_again(question, option, kept), refits
