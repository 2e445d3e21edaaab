"""Probabilities calibrated on this record: what would the diagnosis have named if another cause had acted?

The experiment is simulated under each of the leading explanations (``copies``) and every copy is diagnosed again. The
counts are a confusion matrix of this experiment: rows are what was simulated, columns what was said. It shows what the
evidence cannot: that the search ends elsewhere, that Laplace's approximation fails at the knee of a law, that a law of
most strengths looks like another one here.

**The correction.** That a cause c was named is one outcome; r(T) is the share of copies of T in which it is named too.
With the leading set S that holds c, and R rivals T that have another law in its place, Bayes' rule gives the odds

    P(T | c was named) / P(S | c was named) = r(T) / (e R r(S)).

Before, the leading set is e times as likely as all its rivals together, the least that a cause must bring to be named
(``CALLED``, 1 nat), and these are alike: their prior odds have done their work when they were chosen, and how often one
law of a family acts on rigs, and how often another, nobody knows. (With the prior odds of the evidence, Coulomb
friction was stated with 0.95 where it acted in 10 of 12 rigs; with 1 in the place of e, with 0.74 on average where it
acted in 15 of 15.) No cause is certain that would not be with 1 in the place of e. For the leading set with nothing in
the place of c, R is 1.
Shares are estimated as (k + ½) / (n + 1) (Jeffreys). Where no copy of T led to c, the replicates say nothing against
it and the stated odds stand. Where no copy of S itself led to c, they say nothing for it either: the copies are not
like the record, and c has the odds of a cause that no copies check (``Ranking.limit``). A rival's odds are never
lowered: the copies are drawn from the fitted explanations, so they cannot make any of them surer than the record itself
does. r(T) counts as larger than r(S) only where it is so by more than chance. Last, N copies without c, none called c,
allow no more certainty than (N + 1) / (N + 2) (Laplace's rule of succession).

Sources: parametric bootstrap of model selection, E.-J. Wagenmakers et al. 2004, J. Math. Psychol. 48; a summary
as data, as in approximate Bayesian computation, K. Csilléry et al. 2010, Trends Ecol. Evol. 25.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from msd_ident.estimate.levels import CONFIDENCE
from msd_ident.model.effects import by_name
from msd_ident.selection.certainty import CERTAIN, certain, probability_at
from msd_ident.selection.hypothesis import Causes, Hypothesis, kinds
from msd_ident.selection.ranking import CALLED, Ranking


@dataclass(frozen=True)
class Row:
    """Copies of one explanation, and the diagnoses of these copies: a row of the confusion matrix.

    Attributes:
        causes: the simulated causes.
        any_strength: whether their strengths were drawn by lot; else from the posterior of the fit.
        said: sets of causes that the diagnoses named, and in how many copies.
    """

    causes: Causes
    any_strength: bool
    said: Mapping[Causes, int]

    @property
    def copies(self) -> int:
        """Number of copies."""
        return sum(self.said.values())

    @property
    def right(self) -> int:
        """Copies in which the diagnosis named the simulated causes."""
        return self.said.get(self.causes, 0)

    def named(self, cause: str) -> int:
        """Copies in which a cause was named, in any of its laws and with any other causes."""
        kind = by_name(cause).cause()
        return sum(count for causes, count in self.said.items() if kind in kinds(causes))

    def share(self, cause: str) -> float:
        """Estimated probability that the cause is named, (k + ½)/(n + 1)."""
        return (self.named(cause) + 0.5) / (self.copies + 1.0)


@dataclass(frozen=True)
class Calibration:
    """The confusion matrix of an experiment, and the causes' probabilities before and after the correction.

    Attributes:
        rows: of the matrix, the leading explanation first.
        stated: probability of each named cause from the evidence alone.
        corrected: the same, corrected by the copies.
    """

    rows: tuple[Row, ...]
    stated: Mapping[str, float]
    corrected: Mapping[str, float]

    def confirms(self, cause: str) -> bool:
        """Whether some copy of the leading explanation, which holds the cause, was diagnosed with it."""
        return self.rows[0].named(cause) > 0

    @property
    def columns(self) -> tuple[Causes, ...]:
        """All sets that were named: those of the rows in their order, then the others, the most frequent first."""
        own = [row.causes for row in self.rows]
        total: Counter[Causes] = Counter()
        for row in self.rows:
            total.update(row.said)
        others = sorted(set(total) - set(own), key=lambda causes: (-total[causes], sorted(causes)))
        return tuple([causes for causes in own if total[causes]] + others)

    @property
    def copies(self) -> int:
        """Number of copies of all rows."""
        return sum(row.copies for row in self.rows)

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "copies": self.copies,
            "causes": [
                {"name": name, "stated": value, "corrected": self.corrected[name]}
                for name, value in self.stated.items()
            ],
            "rows": [
                {
                    "causes": sorted(row.causes),
                    "any_strength": row.any_strength,
                    "copies": row.copies,
                    "right": row.right,
                    "said": [
                        {"causes": sorted(causes), "copies": row.said[causes]}
                        for causes in self.columns
                        if row.said.get(causes)
                    ],
                }
                for row in self.rows
            ],
        }


def odds(lead: Row, rival: Row, cause: str) -> float:
    """Odds of a rival against the leading set, given that the cause was named.

    Args:
        lead: copies of the leading set.
        rival: copies of the rival, in which the cause does not act.
        cause: one of the leading set.

    Returns:
        The ratio of the shares of copies in which the cause was named. It is larger than 1 only if Fisher's exact test
        confirms that the rival's share is the larger one. 0 if the cause was named in no copy of the rival.
    """
    if not rival.named(cause):
        return 0.0
    ratio = rival.share(cause) / lead.share(cause)
    table = np.array([[row.named(cause), row.copies - row.named(cause)] for row in (rival, lead)])
    from scipy.stats import fisher_exact  # imported here: it takes a quarter of a second

    return ratio if fisher_exact(table, "greater")[1] < 1.0 - CONFIDENCE else min(ratio, 1.0)


def corrected(ranking: Ranking, rows: Sequence[Row], standins: Mapping[Causes, Hypothesis]) -> Ranking:
    """The ranking with probabilities corrected by the copies.

    Args:
        ranking: led by the explanation of the first row.
        rows: of the confusion matrix.
        standins: for rows of any strength that are not in the ranking, a fitted set that stands for them.
    """
    lead = rows[0]
    before = {cause: ranking.of_cause(cause) for cause in lead.causes}
    lacking = {cause: [row for row in rows[1:] if not _holds(row.causes, cause)] for cause in lead.causes}
    against = {cause: _against(lead, lacking[cause], cause) for cause in lead.causes}
    even = _with_rivals(ranking, rows, against, 1.0, standins)
    ranking = _with_rivals(ranking, rows, against, math.exp(-CALLED), standins)
    for cause in sorted(lead.causes):
        limits = [before[cause]]
        if not lead.named(cause):
            limits.append(probability_at(ranking.limit(cause)))
        if not certain(even.of_cause(cause)):
            limits.append(CERTAIN)
        if copies := sum(row.copies for row in lacking[cause]):
            limits.append((copies + 1.0) / (copies + 2.0))
        ranking = _capped(ranking, cause, min(limits), kinds(lead.causes))
    return ranking


def _against(lead: Row, rivals: Sequence[Row], cause: str) -> dict[Causes, float]:
    """Odds of each rival without a cause against the leading set, had that been as likely before as all of them."""
    drawn = sum(row.any_strength for row in rivals)
    return {row.causes: odds(lead, row, cause) / (drawn if row.any_strength else 1) for row in rivals}


def _with_rivals(
    ranking: Ranking,
    rows: Sequence[Row],
    against: Mapping[str, Mapping[Causes, float]],
    factor: float,
    standins: Mapping[Causes, Hypothesis],
) -> Ranking:
    """The ranking in which each rival has at least the odds that the copies give it, times a factor."""
    for rival in rows[1:]:
        most = factor * max(found.get(rival.causes, 0.0) for found in against.values())
        if most > 0.0:
            ranking = _raised(ranking, rival.causes, most, standins)
    return ranking


def _holds(causes: Causes, cause: str) -> bool:
    """Whether a set holds a cause, in any of its laws."""
    return by_name(cause).cause() in kinds(causes)


def _raised(ranking: Ranking, causes: Causes, odds: float, standins: Mapping[Causes, Hypothesis]) -> Ranking:
    """The ranking in which a set, or its stand-in, has at least these odds against the leading one."""
    known = [i for i, one in enumerate(ranking.sets) if one.causes == causes]
    lead = ranking.probability[0]
    sets, evidence, weights = list(ranking.sets), list(ranking.evidence), list(ranking.probability)
    if not known and causes not in standins:
        return ranking
    if not known:
        sets.append(standins[causes])
        evidence.append(-math.inf)
        weights.append(0.0)
        known = [len(sets) - 1]
    place = known[0]
    if weights[place] < odds * lead:
        weights[place] = odds * lead
        evidence[place] = max(evidence[place], evidence[0] + math.log(odds))
    return _ordered(replace(ranking, sets=tuple(sets), evidence=tuple(evidence), probability=tuple(weights)))


def _ordered(ranking: Ranking) -> Ranking:
    """The leading set first, the others by falling probability, scaled to the sum 1."""
    total = sum(ranking.probability)
    order = [0, *sorted(range(1, len(ranking.sets)), key=lambda i: -ranking.probability[i])]
    return replace(
        ranking,
        sets=tuple(ranking.sets[i] for i in order),
        evidence=tuple(ranking.evidence[i] for i in order),
        probability=tuple(ranking.probability[i] / total for i in order),
    )


def _capped(ranking: Ranking, cause: str, most: float, named: frozenset[str]) -> Ranking:
    """The ranking in which a cause has at most the probability ``most``.

    What a set with it loses goes to sets without it that hold as many as possible of its other ``named`` causes and no
    further one, if there are such: so no named cause gets more.
    """
    holding = [_holds(one.causes, cause) for one in ranking.sets]
    if ranking.of_cause(cause) <= most or all(holding):
        return ranking
    kept = most / ranking.of_cause_by_sets(cause)
    known = [kinds(one.causes) & named for one in ranking.sets]
    free = [i for i, held in enumerate(holding) if not held]
    found = [p * kept if held else p for p, held in zip(ranking.probability, holding, strict=True)]
    for causes, p, held in zip(known, ranking.probability, holding, strict=True):
        if not held:
            continue
        fewer = [i for i in free if known[i] <= causes]
        near = max((len(known[i]) for i in fewer), default=0)
        heirs = [i for i in fewer if len(known[i]) == near] or free
        total = sum(ranking.probability[i] for i in heirs)
        for i in heirs:
            found[i] += p * (1.0 - kept) * (ranking.probability[i] / total if total > 0.0 else 1.0 / len(heirs))
    return replace(ranking, probability=tuple(found))
