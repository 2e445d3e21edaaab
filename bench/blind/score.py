"""Counts a blind study: exact and false sets of causes, calibration of the probabilities, errors of the plant."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.stats import binomtest

from bench.blind.cases import Outcome
from bench.blind.truth import FAMILIES, UNNAMED, allowed, undecidable
from msd_ident.quantity import Z95

#: An effect counts as visible when the truth without it leaves this many noise floors.
VISIBLE = 3.0
FAINT = 20.0
#: Largest relative error of mass and stiffness of a plant that counts as found.
NEAR = 0.02
#: Noise floors below which what a diagnosis leaves is noise alone.
NOISE_ALONE = 1.2
#: Probability above which a cause is stated as certain.
SURE = 0.9
BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0001)
#: Least probability of a cause that counts as stated, and causes from which on a bin says something.
NEGLIGIBLE, POPULATED = 0.01, 10
#: Imagined studies of a forecaster whose probabilities are right.
_STUDIES = 10_000


@dataclass(frozen=True)
class Figure:
    """One line of the table: what is counted, how many of how many, required share and goal in per cent."""

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


def found_both(outcome: Outcome) -> bool:
    """All effects of the rig are named, whatever else is."""
    return all(outcome.counts_as(name) for name in outcome.truth)


def surely_false(outcome: Outcome) -> bool:
    """A cause that is not in the rig is named with p > 0.9, whatever the verdict, and whatever can be seen."""
    return any(p > SURE for _, p in outcome.false)


def kinds(outcomes: Sequence[Outcome], experiment: str = "") -> list[Outcome]:
    """Outcomes of one kind of experiment, at all rates; of all experiments where none is named. Oddities aside."""
    return [o for o in outcomes if not o.odd and experiment in ("", o.case.experiment)]


def figures(outcomes: Sequence[Outcome]) -> list[Figure]:
    """The figures that must hold. What is exact is counted where it can be seen, what is false everywhere."""
    white = [o for o in main_experiment(outcomes) if o.case.noise == "white"]
    seen = visible(white)
    odd = [o for o in white if o.case.kind == "odd" and o.base_floors >= VISIBLE]
    hidden = [o for o in white if o.case.hidden and not o.odd and o.without_floors < VISIBLE]
    found = [
        _exact("one hidden effect", [o for o in seen if o.case.kind == "single"], ">= 98", "99"),
        _exact("one hidden effect and Coulomb friction", [o for o in seen if o.case.kind == "beside"], ">= 97", "98"),
        _exact("two hidden effects, no Coulomb friction", [o for o in seen if o.case.kind == "pair"], ">= 95", "97"),
        *(
            _exact(f"{noise} noise", [o for o in visible(outcomes) if o.case.noise == noise], "", "")
            for noise in ("coloured", "speed")
        ),
        _exact("visibility of 3 to 20 noise floors", [o for o in seen if o.without_floors <= FAINT], "", ""),
        Figure("hidden effect not visible: a false cause named", *_share([bool(o.false) for o in hidden]), "", ""),
    ]
    for experiment in sorted({o.case.experiment for o in outcomes}):
        share = _share([surely_false(o) for o in kinds(outcomes, experiment)])
        found.append(Figure(f"a false cause with p > {SURE:g}: {experiment}", *share, "<= 1", "0.1"))
    share = _share([surely_false(o) for o in kinds(outcomes)])
    found.append(Figure(f"a false cause with p > {SURE:g}: all experiments", *share, "<= 0.3", "0.1"))
    for noise in ("white", "coloured", "speed"):
        clean = [o for o in outcomes if o.case.hidden is None and o.case.noise == noise]
        named, doubted = [bool(o.false) for o in clean], [o.verdict != "adequate" for o in clean]
        found.append(Figure(f"no hidden effect, {noise} noise: a false cause named", *_share(named), "<= 0.3", "0"))
        found.append(Figure(f"no hidden effect, {noise} noise: verdict not `adequate`", *_share(doubted), "", ""))
    found += [
        Figure(f"visible unknown law: false cause with p > {SURE:g}", *_share([surely_false(o) for o in odd]), "", ""),
        Figure("visible unknown law: `unexplained`", *_share([o.verdict == "unexplained" for o in odd]), "", ""),
    ]
    return [figure for figure in found if figure.total]


def _share(hits: Sequence[bool]) -> tuple[int, int]:
    return sum(hits), len(hits)


def _exact(what: str, outcomes: Sequence[Outcome], must: str, aim: str) -> Figure:
    return Figure(f"exact set, {what}", *_share([o.exact for o in outcomes]), must, aim)


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
    """Bins with any cause in them, whatever the verdict; oddities aside, of which the library has no law.

    Over all causes that a diagnosis states a probability for: those named, and those of rival sets beside them. A cause
    is right when it itself acts; that another one tied with it does, does not count. What no experiment can tell from
    the truth is neither right nor wrong.
    """
    return _bins(_stated(outcomes))


#: What of a named cause is compared: its own probability, or that it or one of those tied with it acts.
Statement = Literal["cause", "cause or tied"]


def named_reliability(outcomes: Sequence[Outcome], of: Statement = "cause") -> list[Bin]:
    """Bins of the named causes alone, oddities and laws that the library lacks included.

    A named cause is right when it is not false: it acts, or it is of the family of a law that acts.
    """
    return _bins(_named(outcomes, of))


#: Stated probability of a cause, and whether it is right.
_Pair = tuple[float, bool]


def _stated(outcomes: Sequence[Outcome]) -> list[_Pair]:
    return [
        (p, name in o.truth)
        for o in outcomes
        if not o.odd
        for name, p in (*((name, p) for name, p, *_ in o.named), *o.beside)
        if p >= NEGLIGIBLE and name not in undecidable(frozenset(o.truth))
    ]


def _named(outcomes: Sequence[Outcome], of: Statement) -> list[_Pair]:
    pairs = []
    for o in outcomes:
        right = allowed(frozenset(o.truth))
        for name, p, tied, either in o.named:
            pairs.append((p, name in right) if of == "cause" else (either, not right.isdisjoint((name, *tied))))
    return pairs


def _binned(pairs: Sequence[_Pair]) -> list[tuple[float, float, list[_Pair]]]:
    """Ends of each bin that is not empty, and what is in it."""
    bins = [(low, high, [(p, right) for p, right in pairs if low <= p < high]) for low, high in pairwise(BINS)]
    return [one for one in bins if one[2]]


def _bins(pairs: Sequence[_Pair]) -> list[Bin]:
    bins = []
    for low, high, inside in _binned(pairs):
        stated = float(np.mean([p for p, _ in inside]))
        bins.append(Bin(low, min(high, 1.0), len(inside), stated, sum(right for _, right in inside)))
    return bins


def largest_gap(bins: Sequence[Bin]) -> float:
    """Largest difference of stated and observed in a populated bin."""
    return max((abs(b.stated - b.observed) for b in bins if b.count >= POPULATED), default=math.nan)


def miscalibration(outcomes: Sequence[Outcome]) -> float:
    """``largest_gap`` over all causes that a diagnosis states a probability for (``reliability``)."""
    return largest_gap(reliability(outcomes))


def by_chance(outcomes: Sequence[Outcome]) -> tuple[float, float]:
    """``miscalibration`` if each cause acted by a lot of its stated probability: median and 95th percentile."""
    return _chance_gap(_stated(outcomes))


def named_by_chance(outcomes: Sequence[Outcome], of: Statement = "cause") -> tuple[float, float]:
    """The same of the named causes alone (``named_reliability``)."""
    return _chance_gap(_named(outcomes, of))


def _chance_gap(pairs: Sequence[_Pair]) -> tuple[float, float]:
    rng = np.random.default_rng(0)
    stated = [np.array([p for p, _ in inside]) for _, _, inside in _binned(pairs) if len(inside) >= POPULATED]
    if not stated:
        return math.nan, math.nan
    gaps = [np.abs(np.mean(rng.random((_STUDIES, p.size)) < p, axis=1) - np.mean(p)) for p in stated]
    median, most = np.percentile(np.max(gaps, axis=0), (50.0, 95.0))
    return float(median), float(most)


def confusion(outcomes: Sequence[Outcome]) -> dict[str, Counter[str]]:
    """For each visible hidden effect, what was named in its place (Coulomb beside it left out)."""
    table: dict[str, Counter[str]] = {}
    for o in visible(outcomes):
        hidden = str(o.case.hidden)
        if hidden not in o.truth:  # it counts as no cause
            continue
        others = set(o.names) - (set(o.truth) - {hidden})
        answer = hidden if o.counts_as(hidden) else " + ".join(sorted(others)) or o.verdict
        table.setdefault(hidden, Counter())[answer] += 1
    return table


def smallest(outcomes: Sequence[Outcome]) -> dict[str, float]:
    """For each effect, the least visibility (noise floors without it) from which on it was always found."""
    found: dict[str, float] = {}
    known = [o for o in main_experiment(outcomes) if not o.odd and o.case.hidden in o.truth]
    for name in sorted({str(o.case.hidden) for o in known}):
        missed = [o.without_floors for o in known if o.case.hidden == name and not o.counts_as(name)]
        hit = [o.without_floors for o in known if o.case.hidden == name and o.counts_as(name)]
        above = [value for value in hit if value > max(missed, default=0.0)]
        found[name] = min(above, default=math.inf)
    return found


def family_named(outcome: Outcome) -> bool:
    """A cause of the family of each hidden law is named, or tied with one that is, or the library has none. Without a
    diagnosis nothing is right.
    """
    hidden = (outcome.case.hidden, outcome.case.other)
    return outcome.diagnosed and families_named(outcome) == sum(name is not None for name in hidden)


def families_named(outcome: Outcome) -> int:
    """How many of the hidden laws have a cause of their family named, or tied with a named one, or need none."""
    said = outcome.names | {one for _, _, ties, _ in outcome.named for one in ties}
    laws = [name for name in (outcome.case.hidden, outcome.case.other) if name is not None]
    return sum(name in UNNAMED or bool(said & FAMILIES[name]) for name in laws)


def explained_falsely(outcome: Outcome) -> bool:
    """Called explained with a cause that is not in the rig, nor of its law's family, however sure."""
    return outcome.verdict == "explained" and bool(outcome.false)


def variants(outcomes: Sequence[Outcome]) -> dict[str, tuple[int, int, int, int, int, int]]:
    """For each hidden variant: visible cases, family named; of all: surely false, explained falsely, plant near, and
    near to what is stated of it.
    """
    table = {}
    for name in sorted({str(o.case.hidden) for o in outcomes if o.case.kind == "variant"}):
        chosen = [o for o in outcomes if o.case.hidden == name]
        seen = [o for o in chosen if o.base_floors >= VISIBLE]
        near = sum(o.plant_error <= NEAR for o in chosen), sum(o.plant_stated <= NEAR for o in chosen)
        false = sum(map(surely_false, chosen)), sum(map(explained_falsely, chosen))
        table[name] = (len(seen), sum(map(family_named, seen)), *false, *near)
    return table


def failed(outcome: Outcome) -> list[str]:
    """What is wrong with an outcome, in words; nothing where it is right."""
    wrong = []
    if outcome.case.kind in ("variant", "variant_pair"):
        if outcome.base_floors >= VISIBLE and not family_named(outcome):
            wrong.append("family not named")
    elif (outcome.without_floors >= VISIBLE or outcome.case.hidden is None) and not outcome.exact:
        wrong.append("set not exact")
    if surely_false(outcome):
        wrong.append(f"false cause with p > {SURE:g}")
    if explained_falsely(outcome):
        wrong.append("`explained` with a false cause")
    if not outcome.plant_error <= NEAR:
        stated = "" if not outcome.plant_stated <= NEAR else ", covered"
        off = f"off by {100.0 * outcome.plant_error:.1f} %{stated}" if outcome.diagnosed else "not found"
        wrong.append(f"m or k {off}")
    return wrong


def variant_pairs(outcomes: Sequence[Outcome]) -> list[Figure]:
    """Figures of rigs with two laws that the library does not have."""
    seen = [o for o in outcomes if o.base_floors >= VISIBLE]
    laws = sum(map(families_named, seen)), 2 * len(seen)
    return [
        Figure("both families named", *_share([family_named(o) for o in seen]), "", ""),
        Figure("hidden laws whose family is named", *laws, "", ""),
        Figure("a false cause named", *_share([bool(o.false) for o in outcomes]), "", ""),
        Figure(f"a false cause with p > {SURE:g}", *_share([surely_false(o) for o in outcomes]), "", "0"),
        Figure("verdict `explained` with a false cause", *_share([explained_falsely(o) for o in outcomes]), "", "0"),
        Figure(f"m and k within {100.0 * NEAR:g} %", *_share([o.plant_error <= NEAR for o in outcomes]), "", ""),
        Figure(
            f"m and k within {100.0 * NEAR:g} % of their stated range",
            *_share([o.plant_stated <= NEAR for o in outcomes]), "", "",
        ),
    ]  # fmt: skip


def second_author(outcomes: Sequence[Outcome]) -> list[Figure]:
    """Figures of MuJoCo's rigs."""
    seen = [o for o in outcomes if o.case.hidden is None or o.without_floors >= VISIBLE]
    found = [
        Figure("exact set, visible or no hidden effect", *_share([o.exact for o in seen]), ">= 95", "98"),
        Figure(f"a false cause with p > {SURE:g}", *_share([surely_false(o) for o in outcomes]), "", "0"),
        Figure("verdict `explained` with a false cause", *_share([explained_falsely(o) for o in outcomes]), "", "0"),
        Figure(f"m and k within {100.0 * NEAR:g} %", *_share([o.plant_error <= NEAR for o in outcomes]), "", ""),
    ]
    for name in ("mass", "damping", "stiffness"):
        found.append(Figure(f"interval of {name} contains the truth", *_share(_covers(outcomes, name)), "92 to 98", ""))
        right = [o for o in outcomes if o.exact]
        found.append(Figure(f"the same, exact sets only: {name}", *_share(_covers(right, name)), "", ""))
    return found


#: Noise floors by which the readings change without a fault (nothing is refitted) that counts as plain.
PLAIN = 30.0


def several_faults(outcomes: Sequence[Outcome]) -> list[Figure]:
    """Figures of rigs with several faults at once."""
    pairs = [(o, name) for o in outcomes for name in o.truth]
    plain = [(o, name) for o, name in pairs if o.strength[name] >= PLAIN]
    named = [(p, (name, p) not in o.false) for o in outcomes for name, p, *_ in o.named]
    return [
        Figure("nothing but noise is left", *_share([o.extended_floors < NOISE_ALONE for o in outcomes]), "", ""),
        Figure("all faults named", *_share([found_both(o) for o in outcomes]), "", ""),
        Figure("fault named", *_share([o.counts_as(name) for o, name in pairs]), "", ""),
        Figure("plain fault named", *_share([o.counts_as(name) for o, name in plain]), "", ""),
        Figure(f"named cause is stated with p > {SURE:g}", *_share([p > SURE for p, _ in named]), "", ""),
        Figure("of these right", *_share([right for p, right in named if p > SURE]), "", "100"),
        Figure(f"rig with a false cause with p > {SURE:g}", *_share([surely_false(o) for o in outcomes]), "<= 1", "0"),
        Figure("verdict `explained` with a false cause", *_share([explained_falsely(o) for o in outcomes]), "", "0"),
        Figure(f"m and k within {100.0 * NEAR:g} %", *_share([o.plant_error <= NEAR for o in outcomes]), "", ""),
        *(
            Figure(f"interval of {name} contains the truth", *_share(_covers(outcomes, name)), "", "")
            for name in ("mass", "damping", "stiffness")
        ),
    ]


def _covers(outcomes: Sequence[Outcome], name: str) -> list[bool]:
    """Whether the 95 % interval of a parameter holds its truth, where there is one."""
    return [
        abs(value - truth) <= Z95 * std
        for o in outcomes
        for one, value, std, truth in o.plant
        if one == name and math.isfinite(std)
    ]


def oddities(outcomes: Sequence[Outcome]) -> dict[str, Counter[str]]:
    """For each visible oddity of the main experiment, the verdicts."""
    table: dict[str, Counter[str]] = {}
    for o in main_experiment(outcomes):
        if o.case.kind == "odd" and o.base_floors >= VISIBLE:
            answer = o.verdict + (": " + " + ".join(sorted(o.names)) if o.named else "")
            table.setdefault(str(o.case.hidden), Counter())[answer] += 1
    return table
