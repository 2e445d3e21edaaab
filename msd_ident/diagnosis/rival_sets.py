"""The other sets of causes that a diagnosis lists."""

from __future__ import annotations

from collections.abc import Callable

from msd_ident.diagnosis.result import Rival
from msd_ident.selection import ties
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import LEADERS, Ranking
from msd_ident.tuning import fixed

_RIVAL = fixed(1e-4, "interface", "probability below which a rival is not listed")


def listed(ranking: Ranking, best: Hypothesis, left: Callable[[Hypothesis], float]) -> tuple[Rival, ...]:
    """Other sets by falling probability, none more probable than its least probable cause, but for what a named cause
    leaves to its rivals (``ties.in_place``).

    Args:
        ranking: all sets.
        best: the one that is named.
        left: what a set leaves, in the noise floors of the models beside it.
    """
    least = ties.in_place(ranking, best.causes)
    others = [fitted for fitted in ranking.sets if fitted.causes != best.causes]
    found = [(max(ranking.stated(one.causes), least.get(one.causes, 0.0)), one) for one in others]
    found.sort(key=lambda pair: -pair[0])
    kept = [pair for pair in found if pair[0] > _RIVAL]
    return tuple(Rival(tuple(sorted(one.causes)), p, left(one)) for p, one in (kept or found[:3])[:LEADERS])
