"""The other sets of causes that a diagnosis lists."""

from __future__ import annotations

import math

from msd_ident.diagnosis.result import Rival
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import LEADERS, Ranking
from msd_ident.tuning import fixed

_RIVAL = fixed(1e-4, "interface", "probability below which a rival is not listed")


def listed(ranking: Ranking, best: Hypothesis, experiment: Experiment) -> tuple[Rival, ...]:
    """Other sets by falling probability, none more probable than its least probable cause.

    Args:
        ranking: all sets.
        best: the one that is named.
        experiment: gives the pieces of evidence, for what each leaves in noise floors.
    """
    pieces = experiment.evidence
    found = [
        Rival(tuple(sorted(fitted.causes)), ranking.stated(fitted.causes), math.sqrt(fitted.chi / pieces))
        for fitted in ranking.sets
        if fitted is not best
    ]
    found.sort(key=lambda rival: -rival.probability)
    kept = [rival for rival in found if rival.probability > _RIVAL]
    return tuple(kept or found[:3])[:LEADERS]
