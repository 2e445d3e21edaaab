"""Rankings with given probabilities, of sets that were never fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import Ranking


@dataclass(frozen=True, eq=False)
class Set:
    """What a ranking asks of a fitted set."""

    causes: frozenset[str]
    chi: float = 0.0


def ranking(probabilities: Mapping[tuple[str, ...], float], first: tuple[str, ...] | None = None) -> Ranking:
    """Sets with given probabilities; as ``ordering.rank`` has it, ``first`` leads, the others by falling evidence."""
    order = sorted(probabilities, key=lambda causes: (causes != first, -probabilities[causes]))
    total = sum(probabilities.values())
    chances = tuple(probabilities[causes] / total for causes in order)
    sets = tuple(cast(Hypothesis, Set(frozenset(causes))) for causes in order)
    return Ranking(sets, tuple(np.log(chances).tolist()), chances)
