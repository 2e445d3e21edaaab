"""Figures of a blind study."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import binomtest

from bench.blind.cases import Outcome

#: An effect counts as visible when the truth without it leaves this many noise floors.
VISIBLE = 3.0
FAINT = 20.0
BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0001)
#: Least probability of a cause that counts as stated, and causes from which on a bin says something.
NEGLIGIBLE, POPULATED = 0.01, 10


@dataclass(frozen=True)
class Figure:
    """One line of the table: what, how many of how many, must and aim in per cent."""

    what: str
    good: int
    total: int
    must: str
    aim: str

    @property
    def percent(self) -> float:
        """Share in per cent."""
        return 100.0 * self.good / self.total if self.total else math.nan


def main_experiment(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Two amplitudes, both directions, 1 kHz."""
    return [o for o in outcomes if o.case.experiment == "steps" and o.case.rate == 1000.0]


def visible(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Known effects that can be seen."""
    return [o for o in outcomes if o.case.hidden and not o.odd and o.without_floors >= VISIBLE]


def named_first(outcome: Outcome) -> bool:
    """The hidden cause leads, or is tied with the one that does."""
    if not outcome.named:
        return False
    first, _, ties = outcome.named[0]
    return outcome.case.hidden == first or (outcome.case.hidden in ties and len(ties) <= 2)


def found_both(outcome: Outcome) -> bool:
    """All effects of the rig are named, whatever else is."""
    return all(outcome.counts_as(name) for name in outcome.truth)


def confident_and_wrong(outcome: Outcome) -> bool:
    """An explanation is claimed with certainty while what is left says otherwise."""
    sure = any(p > 0.9 for _, p, _ in outcome.named)
    return outcome.verdict == "explained" and sure and outcome.extended_floors > 2.0


def confidently_misnamed(outcome: Outcome) -> bool:
    """A cause that is not there, and not tied with one that is, is named in an explanation with p > 0.9."""
    wrong = [p for name, p, ties in outcome.named if name not in outcome.truth and not (set(ties) & set(outcome.truth))]
    return outcome.verdict == "explained" and max(wrong, default=0.0) > 0.9


def figures(outcomes: Sequence[Outcome]) -> list[Figure]:
    """The issue's table, on the main experiment."""
    chosen = main_experiment(outcomes)
    seen = visible(chosen)
    single = [o for o in seen if not o.case.beside]
    double = [o for o in seen if o.case.beside]
    faint = [o for o in seen if o.without_floors <= FAINT]
    clean = [o for o in outcomes if o.case.hidden is None]
    odd = [o for o in chosen if o.odd and o.base_floors >= VISIBLE]
    return [
        Figure("single cause named first or tied", sum(map(named_first, single)), len(single), ">= 95", "99"),
        Figure("hidden cause and Coulomb both named", sum(map(found_both, double)), len(double), ">= 90", "97"),
        Figure("cause invented on clean data", sum(bool(o.named) for o in clean), len(clean), "<= 1", "0.1"),
        Figure("oddity: confident and wrong", sum(map(confident_and_wrong, odd)), len(odd), "<= 5", "0"),
        Figure("oddity: called unexplained", sum(o.verdict == "unexplained" for o in odd), len(odd), "", ""),
        Figure("exact set, single", sum(o.exact for o in single), len(single), ">= 90", "98"),
        Figure("exact set, beside Coulomb", sum(o.exact for o in double), len(double), ">= 85", "95"),
        Figure("faint (3 to 20 floors), named", sum(found_both(o) for o in faint), len(faint), ">= 90", "97"),
        Figure("right and unambiguous", sum(o.exact and o.verdict == "explained" for o in seen), len(seen), "", ""),
    ]


def heldout(outcomes: Sequence[Outcome]) -> float:
    """Median SEE on left-out data over the noise where the cause is right."""
    right = [o.heldout_floors for o in visible(main_experiment(outcomes)) if o.exact]
    return float(np.median(right)) if right else math.nan


def removed(outcomes: Sequence[Outcome]) -> float:
    """Median share of the removable error that was removed, over all visible effects."""
    shares = [o.removed for o in visible(outcomes) if math.isfinite(o.removed)]
    return float(np.median(shares)) if shares else math.nan


@dataclass(frozen=True)
class Bin:
    """Causes whose stated probability lies in [low, high): how many, their mean, and how many of them act."""

    low: float
    high: float
    count: int
    stated: float
    right: int

    @property
    def observed(self) -> float:
        """Share that acts."""
        return self.right / self.count

    @property
    def range(self) -> tuple[float, float]:
        """95 % interval (Wilson) of the share, of which so many causes are a sample."""
        interval = binomtest(self.right, self.count).proportion_ci(method="wilson")
        return float(interval.low), float(interval.high)


def reliability(outcomes: Sequence[Outcome]) -> list[Bin]:
    """Bins with any cause in them, oddities and unexplained ones aside.

    Over all causes that a diagnosis states a probability for: those named, and those of rival sets beside them. A cause
    is right when it itself acts; that another one tied with it does, does not count.
    """
    stated_causes = [
        (o, cause)
        for o in outcomes
        if not o.odd and o.verdict != "unexplained"
        for cause in (*((name, p) for name, p, _ in o.named), *o.beside)
    ]
    pairs = [(p, name in o.truth) for o, (name, p) in stated_causes if p >= NEGLIGIBLE]
    bins = []
    for low, high in pairwise(BINS):
        inside = [(p, right) for p, right in pairs if low <= p < high]
        if inside:
            stated = float(np.mean([p for p, _ in inside]))
            bins.append(Bin(low, min(high, 1.0), len(inside), stated, sum(right for _, right in inside)))
    return bins


def miscalibration(outcomes: Sequence[Outcome]) -> float:
    """Largest difference of stated and observed in a populated bin."""
    return max((abs(b.stated - b.observed) for b in reliability(outcomes) if b.count >= POPULATED), default=math.nan)


def confusion(outcomes: Sequence[Outcome]) -> dict[str, Counter[str]]:
    """For each visible hidden effect, what was named in its place (Coulomb beside it left out)."""
    table: dict[str, Counter[str]] = {}
    for o in visible(outcomes):
        hidden = str(o.case.hidden)
        others = set(o.names) - (set(o.truth) - {hidden})
        answer = hidden if o.counts_as(hidden) else " + ".join(sorted(others)) or o.verdict
        table.setdefault(hidden, Counter())[answer] += 1
    return table


def smallest(outcomes: Sequence[Outcome]) -> dict[str, float]:
    """For each effect, the least visibility (noise floors without it) from which on it was always found."""
    found: dict[str, float] = {}
    known = [o for o in main_experiment(outcomes) if o.case.hidden and not o.odd]
    for name in sorted({str(o.case.hidden) for o in known}):
        missed = [o.without_floors for o in known if o.case.hidden == name and not o.counts_as(name)]
        hit = [o.without_floors for o in known if o.case.hidden == name and o.counts_as(name)]
        above = [value for value in hit if value > max(missed, default=0.0)]
        found[name] = min(above, default=math.inf)
    return found


def oddities(outcomes: Sequence[Outcome]) -> dict[str, Counter[str]]:
    """For each visible oddity of the main experiment, the verdicts."""
    table: dict[str, Counter[str]] = {}
    for o in main_experiment(outcomes):
        if o.odd and o.base_floors >= VISIBLE:
            answer = o.verdict + (": " + " + ".join(sorted(o.names)) if o.named else "")
            table.setdefault(str(o.case.hidden), Counter())[answer] += 1
    return table
