"""Sets of causes in the order of their evidence, their probabilities, and ties.

A set counts if it is more than a simpler one: no law is exact, so what a set leaves may be another form of its laws and
not a further cause.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from msd_ident.estimate.levels import TENTH
from msd_ident.model.effects import Effect, by_name
from msd_ident.residuals.noise_model import NOISE_ERROR
from msd_ident.selection.evidence import LEAST_SPREAD, SHAPES, NoiseScale, log_evidence, log_prior
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis, imitated
from msd_ident.selection.simpler_sets import equal_to
from msd_ident.tuning import tuned

FAINT = tuned(3.0, unit="noise floors", why="below it the form of what a set leaves is not seen", chosen="by hand")
ROUGH = tuned(10.0, unit="noise floors", why="below it the form of what a set leaves is seen roughly", chosen="by hand")
FORM_PART = tuned(
    0.2,
    unit="1",
    why="part of what the other causes explain (rms of the position) below which a further cause may be another "
    "form of their laws",
    chosen="on 152 rigs of foreign laws (`python -m bench.blind --variants`, seeds 81000 and 91000) 10 of 12 false "
    "further causes lie below it, and below `ROUGH` or `LEAST_SPREAD`",
)
FORM_ODDS = tuned(
    60.0,
    unit="prior odds",
    why="greatest odds of a cause below `FORM_PART` in a set that leaves more than noise, and of one that a poor "
    "experiment without copies shows: 3 to 1 for most",
    chosen="by hand",
)
CERTAIN = tuned(0.9, unit="1", why="probability above which a cause is named with certainty", chosen="by hand")
DECISIVE = tuned(
    3.5,
    unit="nats",
    why="evidence below which one set is not decisively better than another: about 30 to 1",
    chosen="by hand",
)
NEAR = tuned(
    12.0,
    unit="nats",
    why="evidence that a set may lack and still be judged on all data, and copied; half of it to be kept for a design",
    chosen="by hand",
)
LEADERS = tuned(8, unit="sets", why="explanations that are judged on all data, kept and told", chosen="by hand")
CALLED = tuned(
    1.0, unit="nats", why="evidence that a cause must bring to a set to be named: about 3 to 1", chosen="by hand"
)


#: The same as odds.
CERTAIN_ODDS = CERTAIN / (1.0 - CERTAIN)


def kinds(causes: Iterable[str]) -> frozenset[str]:
    """Causes to which these laws belong: two forms of a law are one cause."""
    return frozenset(by_name(name).cause() for name in causes)


@dataclass(frozen=True)
class Ranking:
    """Sets of causes by falling evidence.

    Attributes:
        sets: the fitted sets.
        evidence: log evidence [nats] of each.
        probability: posterior probability of each.
        left: residual that every fitted set leaves, in noise floors, also of those that were fitted to a part of the
            data alone.
        further: causes of a set that may be another form of its other laws, each with the part of what those explain
            that it explains (``further_parts``).
        leaves: what a set leaves above the noise, as a part of what it explains, if that is more than ``FORM_PART``:
            its laws are not those of the rig, so none of its causes is certain.
        exact: sets that leave only noise: no error of their laws is seen.
        clear: how clearly a set needs each of its causes (``_clearness``).
        unchecked: whether a poor experiment has no copies that check the leading set (``replication``): no cause is
            certain.
        foretold: whether the leading set has its place from left-out data, against the evidence (``naming``): no cause
            is certain.
        rich: whether the experiment excites more than one kind of motion (``excitation.poor``).
    """

    sets: tuple[Hypothesis, ...]
    evidence: tuple[float, ...]
    probability: tuple[float, ...]
    left: Mapping[Causes, float] = field(default_factory=dict)
    further: Mapping[Causes, Mapping[str, float]] = field(default_factory=dict)
    leaves: Mapping[Causes, float] = field(default_factory=dict)
    exact: frozenset[Causes] = frozenset()
    clear: Mapping[Causes, Mapping[str, float]] = field(default_factory=dict)
    unchecked: bool = False
    foretold: bool = False
    rich: bool = False

    @property
    def best(self) -> Hypothesis:
        """The leading set: the likeliest, without causes that the data does not call for."""
        return self.sets[0]

    @property
    def likeliest(self) -> Hypothesis:
        """The set with causes that has the most evidence; the base model if no set has causes."""
        pairs = zip(self.evidence, self.sets, strict=True)
        return max(pairs, key=lambda pair: (bool(pair[1].causes), pair[0]))[1]

    def led_by(self, leader: Hypothesis) -> Ranking:
        """The same with one of its sets first."""
        order = sorted(range(len(self.sets)), key=lambda i: self.sets[i] is not leader)
        return replace(
            self,
            sets=tuple(self.sets[i] for i in order),
            evidence=tuple(self.evidence[i] for i in order),
            probability=tuple(self.probability[i] for i in order),
        )

    def with_law(self, law: Hypothesis) -> Ranking:
        """The same with another law of one cause of the leading set, which the data does not tell from this one."""
        old, new = self.best.causes, law.causes
        renamed = {
            name: {new if one == old else one: part for one, part in getattr(self, name).items()}
            for name in ("left", "further", "leaves", "clear")
        }
        exact = frozenset(new if one == old else one for one in self.exact)
        return replace(self, sets=(law, *self.sets[1:]), exact=exact, **renamed)

    def of_set(self, causes: Causes) -> float:
        """Probability of a set; 0 if it is not ranked."""
        return next((p for p, one in zip(self.probability, self.sets, strict=True) if one.causes == causes), 0.0)

    def of_cause(self, name: str) -> float:
        """Probability that a cause acts, in whatever law: of all sets that hold it together."""
        kind = by_name(name).cause()
        found = sum(
            p * self._greatest(fitted.causes, law)
            for fitted, p in zip(self.sets, self.probability, strict=True)
            for law in fitted.causes
            if by_name(law).cause() == kind
        )
        if not (self.unchecked or self.foretold):
            return found
        return min(found, _probability(self.greatest_odds(Effect if self.foretold else by_name(kind))))

    def _greatest(self, causes: Causes, law: str) -> float:
        """Greatest probability that a law of a set acts, if the set is the right one.

        What a set leaves above the noise may move like one of its causes. So the odds of a cause are no more than what
        it explains over what is left (``_clearness``), but not less than ``FORM_ODDS`` allows. More than the usual
        prior odds count only as far as it explains more than is left. In a poor experiment the amplitude falls with
        time, so that no stiffness that changes with time is certain: it may change with the amplitude.
        """
        odds = self._of_its_own(causes, law) if law in self.further.get(causes, ()) else math.inf
        if by_name(law).ages_spring() and not self.rich:
            odds = min(odds, CERTAIN_ODDS)
        if causes in self.leaves:
            odds = min(odds, _uncertain(by_name(law)), CERTAIN_ODDS)
        if causes not in self.exact:
            clear = self.clear.get(causes, {}).get(law, math.inf)
            clear *= max(min(clear, _usual(by_name(law))), 1.0)
            odds = min(odds, max(clear, FORM_ODDS * Effect.prior_odds))
        return _probability(odds)

    def _of_its_own(self, causes: Causes, law: str) -> float:
        """Greatest odds that a cause which may be another form of the other laws acts by itself.

        In a set that leaves only noise, that form would have to agree with the cause but for what the noise can hide:
        the more clearly the cause is seen above this, the surer it is. A poor experiment makes none certain, and no
        experiment a law of less than the usual prior odds, which bends to much.
        """
        odds = by_name(law).prior_odds
        if causes not in self.exact:
            return FORM_ODDS * odds
        clear = self.clear.get(causes, {}).get(law, math.inf)
        if not self.rich or odds < Effect.prior_odds:
            clear = min(clear, CERTAIN_ODDS)
        return clear * odds / Effect.prior_odds

    def greatest_odds(self, effect: type[Effect]) -> float:
        """Greatest odds of a cause if the experiment is poor and has no copies, or the evidence is against the set."""
        return _uncertain(effect) if self.best.causes not in self.exact else CERTAIN_ODDS * _usual(effect)

    def within(self, nats: float) -> list[Hypothesis]:
        """Sets whose evidence is not more than this below the leading one."""
        least = self.evidence[0] - nats
        return [fitted for fitted, value in zip(self.sets, self.evidence, strict=True) if value >= least]


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


def _sufficient(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> Iterator[Causes]:
    """Sets without one of the causes that leave only noise already."""
    smaller = (causes - {name} for name in causes)
    return (one for one in smaller if one in sets and _exact(sets[one], scale.most))


def _simpler(causes: Causes) -> Iterator[Causes]:
    """Sets in which a law is replaced by its limit: the simple law of its cause, or Coulomb friction."""
    for name in causes:
        if form_of := by_name(name).form_of:
            yield causes - {name} | {form_of}
        if name in HOLDING_COULOMB:
            yield causes - {name} | {COULOMB}


def further_parts(causes: Causes, sets: Mapping[Causes, Hypothesis]) -> dict[str, float]:
    """What each cause of a set explains beyond the other causes, as a part of what these explain.

    For a set S and a cause c it is √((χ²(S − c) − χ²(S)) / (χ²(base) − χ²(S − c))). A cause is left out if S − c
    (``_fitted``) explains no more than the base model does.

    Args:
        causes: the set.
        sets: all fitted sets by their causes.
    """
    found = {name: _part_beyond(_fitted(causes - {name}, sets), causes, sets) for name in causes}
    return {name: part for name, part in found.items() if math.isfinite(part)}


def _fitted(causes: Causes, sets: Mapping[Causes, Hypothesis]) -> Causes:
    """The fitted set of these causes; if they were not worth a fit, that of some of them which leaves least."""
    if causes in sets:
        return causes
    return min((one for one in sets if one < causes), key=lambda one: sets[one].chi, default=causes)


def _part_beyond(limit: Causes, causes: Causes, sets: Mapping[Causes, Hypothesis]) -> float:
    """What a set explains beyond a simpler one, as a part of what that one explains; infinite where the simpler one was
    not fitted or explains nothing.
    """
    base, simple = sets.get(frozenset()), sets.get(limit)
    if base is None or simple is None or simple.chi >= base.chi:
        return math.inf
    return math.sqrt(max(simple.chi - sets[causes].chi, 0.0) / (base.chi - simple.chi))


def _within_law_error(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> bool:
    """Whether one of the causes explains no more than an error of the other laws could.

    No law is exact, so what a set leaves may come from another form of its laws. A further cause does not count if it
    explains at most ``LEAST_SPREAD`` of what the others do, or ``FORM_PART`` where less than ``FAINT`` noise floors are
    left without it. Where the set leaves only noise, no error of a law is seen: every cause counts, and
    ``_other_forms`` limits its probability.
    """
    exact = _exact(sets[causes], noise)
    for name, part in further_parts(causes, sets).items():
        smaller = sets.get(causes - {name})
        if exact or smaller is None:
            continue
        if part <= (FORM_PART if smaller.chi < FAINT**2 * noise else LEAST_SPREAD):
            return True
    return False


def _exact(fitted: Hypothesis, noise: float) -> bool:
    """Whether a set leaves only noise."""
    return fitted.chi < (1.0 + NOISE_ERROR) * noise


def _other_forms(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> dict[str, float]:
    """Causes of a set that may be another form of its other laws, with what they explain beyond these, as a part of
    what these explain. A law that holds Coulomb friction as a limit is compared with Coulomb friction in its place too.

    Where the set leaves more than noise, each spring beside the one that explains most may be an error of its shape,
    whatever it explains: two curves over the position come near any third one.
    """
    parts = further_parts(causes, sets)
    found = {
        name: part
        for name, part in parts.items()
        if part <= (FORM_PART if sets[_fitted(causes - {name}, sets)].chi < ROUGH**2 * noise else LEAST_SPREAD)
    }
    if not _exact(sets[causes], noise):
        springs = [name for name in sorted(causes) if by_name(name).is_spring()]
        springs.sort(key=lambda name: -parts.get(name, math.inf))  # a set that was not worth a fit explains little
        found |= {name: parts[name] for name in springs[1:] if name in parts}
    for name in causes & set(HOLDING_COULOMB):
        limit = causes - {name} | {COULOMB}
        part = _part_beyond(limit, causes, sets)
        if part <= LEAST_SPREAD or (part <= FORM_PART and sets[limit].chi < FAINT**2 * noise):
            found[name] = min(part, found.get(name, part))
    return found


def _clearness(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> dict[str, float]:
    """How clearly a set needs each of its causes: what the cause explains, in units of what the set leaves.

    It is (χ²(S − c) − χ²(S)) / max(χ²(S) − N, δN). Where the set leaves only noise, it leaves what the noise can hide,
    whose variance is known to δ = ``NOISE_ERROR``. If only the set's own residual tells of this noise, an error of its
    laws may be a part of it: then no cause is certain that may be one. A law that holds Coulomb friction as a limit is
    compared with Coulomb friction in its place too. Causes without a fitted smaller set are left out.
    """
    found, left, most = {}, sets[causes].chi - scale.noise, math.inf
    if _exact(sets[causes], scale.noise):
        left, most = NOISE_ERROR * scale.noise, CERTAIN_ODDS if scale.other_noise else math.inf
    for name in causes:
        limits = [_fitted(causes - {name}, sets), causes - {name} | {COULOMB}][: 1 + (name in HOLDING_COULOMB)]
        gains = [sets[limit].chi - sets[causes].chi for limit in limits if limit in sets]
        if gains:
            found[name] = min(max(min(gains), 0.0) / left, most)
    return found


def _left_over(causes: Causes, sets: Mapping[Causes, Hypothesis], noise: float) -> float:
    """What a set leaves above the noise, as a part of what it explains (rms of the position); 0 if unknown.

    It is √((χ² − N) / (χ²(base) − χ²)), where the noise N may be larger than estimated by ``NOISE_ERROR``.
    """
    base, chi = sets.get(frozenset()), sets[causes].chi
    if base is None or base.chi <= chi:
        return 0.0
    return math.sqrt(max(chi - (1.0 + NOISE_ERROR) * noise, 0.0) / (base.chi - chi))


def _uncertain(effect: type[Effect]) -> float:
    """Greatest odds of a cause whose law is not this rig's, or that needs copies and has none."""
    return FORM_ODDS * Effect.prior_odds * _usual(effect)


def _usual(effect: type[Effect]) -> float:
    """Prior odds over those of most causes; lower ones do not count once more."""
    return max(effect.prior_odds / Effect.prior_odds, 1.0)


def _probability(odds: float) -> float:
    """Probability at these odds."""
    return odds / (1.0 + odds) if math.isfinite(odds) else 1.0


def _called_for(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> bool:
    """Whether a set is more than a simpler one.

    It is not if an effect has no strength, if a cause explains no more than an error of the other laws could, or if the
    set is hardly likelier (``CALLED``) than one without a cause that leaves only noise, one with the limit of a law in
    its place, or one with another effect that it is equal to. Nor is it if a cause adds nothing to the likelihood: less
    than ``TENTH`` of a nat.
    """
    if not set(sets).isdisjoint(equal_to(sets[causes])):
        return False
    if scale.shapes <= SHAPES and (_within_law_error(causes, sets, scale.noise) or _adds_nothing(causes, sets, scale)):
        return False
    limits = (*_sufficient(causes, sets, scale), *_simpler(causes), *imitated(sets[causes].model, alike=True))
    known = [sets[one] for one in limits if one in sets]
    return all(scale.of(sets[causes]) > scale.of(limit) + CALLED for limit in known)


def _adds_nothing(causes: Causes, sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> bool:
    """Whether one of the causes adds nothing to the likelihood: less than ``TENTH`` of a nat."""
    smaller = [sets[causes - {name}] for name in causes if causes - {name} in sets]
    return any(scale.of(sets[causes]) < scale.of(one) + TENTH for one in smaller)


def rank(sets: Mapping[Causes, Hypothesis], scale: NoiseScale) -> Ranking:
    """Fitted sets by falling evidence.

    A set that is equal to a simpler one is left out, e.g. if an effect ended without strength. The first set is the
    likeliest one, or the simplest one without further causes whose evidence is lower by at most ``CALLED``. Where
    other sets give the motion of the likeliest one, a set with fewer causes is compared with all of them together.

    Args:
        sets: every fitted set by its causes.
        scale: noise and number of features of the error.
    """
    own = {causes: log_evidence(one, scale) for causes, one in sets.items() if _called_for(causes, sets, scale)}
    values = {causes: min([value, *_ceilings(causes, own, sets, scale)]) for causes, value in own.items()}
    order = sorted(values, key=lambda causes: -values[causes])
    top = values[order[0]]
    same = [one for one in order if _same_motion(sets[one], sets[order[0]], scale)]
    simpler = [one for one in order if kinds(one) <= kinds(order[0])]
    near = [one for one in simpler if values[one] >= _beyond(one, same, values) - CALLED]
    first = min(near, key=lambda one: (len(one), _forms(one), -values[one]))
    order.remove(first)
    order.insert(0, first)
    weights = np.exp(np.array([values[causes] for causes in order]) - top)
    weights /= weights.sum()
    return Ranking(
        tuple(sets[causes] for causes in order),
        tuple(values[causes] for causes in order),
        tuple(float(w) for w in weights),
        further={causes: _other_forms(causes, sets, scale.noise) for causes in order},
        exact=frozenset(causes for causes in order if _exact(sets[causes], scale.noise)),
        clear={causes: _clearness(causes, sets, scale) for causes in order},
        leaves={causes: part for causes in order if (part := _left_over(causes, sets, scale.noise)) > FORM_PART},
    )


def _same_motion(one: Hypothesis, other: Hypothesis, scale: NoiseScale) -> bool:
    """Whether two sets of as many causes give the same motion.

    With the difference d of their motions, in units of the noise, and the variance v of what they leave, d²/(2 v) is
    the log likelihood ratio [nats] that records of this length are expected to show: less than ``TENTH``.
    """
    if len(one.causes) != len(other.causes):
        return False
    between = one.state.residual - other.state.residual
    return bool(between @ between < 2.0 * TENTH * scale.spread(min(one.chi, other.chi)))


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


def _forms(causes: Causes) -> int:
    """Number of laws that are not the first, simple one of their cause."""
    return sum(bool(by_name(name).form_of) for name in causes)


def alternatives(ranking: Ranking, name: str) -> tuple[str, ...]:
    """Causes that could replace one cause of the leading set, by falling evidence of the sets that contain them.

    Args:
        ranking: sets by evidence, the leading one first.
        name: a cause of the leading set.

    Returns:
        Causes of sets within ``DECISIVE`` of the leading one that lack ``name`` in any law but contain all its other
        causes.
    """
    kind, rest = by_name(name).cause(), kinds(ranking.best.causes - {name})
    found: list[str] = []
    for fitted in ranking.within(DECISIVE):
        if kind in kinds(fitted.causes) or not rest <= kinds(fitted.causes):
            continue
        for other in sorted(fitted.causes):
            if by_name(other).cause() not in rest and other not in found:
                found.append(other)
    return tuple(found)
