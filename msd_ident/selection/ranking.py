"""Sets of causes in the order of their evidence, with the probabilities that follow for each cause, and ties."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

from msd_ident.estimate.levels import BEYOND_DOUBT
from msd_ident.model.declarations import PLACE
from msd_ident.model.effects import Effect, by_name
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.tuning import fixed, tuned

FAINT = tuned(3.0, unit="noise floors", why="below it the form of what a set leaves is not seen", chosen="by hand")
#: Noise floors below which the form of what a set leaves is seen roughly: only beyond them no part of it is noise.
ROUGH = BEYOND_DOUBT
FORM_PART = tuned(
    0.2,
    unit="1",
    why="part of what the other causes explain (rms of the position) below which a further cause may be another "
    "form of their laws",
    chosen="on 152 rigs of foreign laws (`python -m bench.blind --variants`, seeds 81000 and 91000) 10 of 12 false "
    "further causes lie below it, and below `ROUGH` or `LEAST_SPREAD`",
)
LEFT_PART = tuned(
    0.15,
    unit="1",
    why="part of what a set explains that it leaves above the noise, beyond which its laws are not the rig's",
    chosen="on 470 rigs of foreign laws and of MuJoCo (`python -m bench.blind --variants`, seeds 463000, 473000 and "
    "493000, `--mujoco`, 475000 and 495000) 5 right causes and a false one are certain between it and 0.2, and 11 "
    "right ones between 0.1 and it",
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
ROUNDING = fixed(1e-9, "accuracy", "sums of the same probabilities in another order differ by no more")


def certain(probability: float) -> bool:
    """Whether a cause is named with certainty. Limits of 9 to 1 that add up to 9 to 1 are not, in no digit."""
    return probability > CERTAIN + ROUNDING


def kinds(causes: Iterable[str]) -> frozenset[str]:
    """Causes to which these laws belong: two forms of a law are one cause."""
    return frozenset(by_name(name).cause() for name in causes)


_Said = TypeVar("_Said")


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
            that it explains (``law_errors.further_parts``).
        leaves: what a set leaves above the noise, as a part of what it explains, if that is more than ``LEFT_PART``:
            its laws are not those of the rig, so none of its causes is certain.
        exact: sets that leave only noise: no error of their laws is seen.
        clear: how clearly a set needs each of its causes (``law_errors.clearness``).
        instead: of sets within ``NEAR`` that leave more than noise, the sets without each of their causes, with the
            odds of the first one beside each (``law_errors.instead``).
        slow: causes of a set of whose periods the records hold too few: less than one of a motion that they bring, or
            less than two along the travel. A drift, or a bend, of another kind may do the same: they are not certain.
        seldom: tones of a set that leaves more than noise, of which the records hold too few periods to show that they
            repeat: one force that does not repeat may make both the tone and what is left, so they are not certain.
        held: causes of a set that hold the cart at rest and do hardly anything in motion: a force that acts only while
            the drive is on, or off, may do the same, so they are not certain.
        sampled: causes of a set that explain no more than twice what the force may do between its samples: each is at
            most as likely as that.
        alike: laws of a set, each with a law of another cause that gives the same motion in its place
            (``equal_motion``): each is as likely as the other.
        rubbing: sets beside which Coulomb friction was fitted but is no explanation (``ordering.rank``), each with the
            set that has it: friction too weak to be seen is possible on every rig.
        unchecked: whether a poor experiment has no copies that check the leading set (``replication``), or left-out
            data do not confirm it: the odds of a cause are limited (``limit``).
        foretold: whether the leading set has its place from left-out data, against the evidence (``naming``): no cause
            is certain but those of ``called``.
        called: causes that the evidence alone calls for where left-out data lead, with the probability that it gives
            them.
        rich: whether the experiment excites more than one kind of motion (``excitation.poor``).
        steered: whether a controller computes the force from the readings. It brings the cart to the same places, so
            nothing tells a law that pushes back at a place from what holds the cart there: none is certain.
        pushed_unseen: whether the cart moves before the force is known: no cause is certain.
        balanced: whether a controller holds an unstable motion, of which stretches are fitted: what disturbs the rig
            moves the force too, so no cause is certain.
    """

    sets: tuple[Hypothesis, ...]
    evidence: tuple[float, ...]
    probability: tuple[float, ...]
    left: Mapping[Causes, float] = field(default_factory=dict)
    further: Mapping[Causes, Mapping[str, float]] = field(default_factory=dict)
    leaves: Mapping[Causes, float] = field(default_factory=dict)
    exact: frozenset[Causes] = frozenset()
    clear: Mapping[Causes, Mapping[str, float]] = field(default_factory=dict)
    instead: Mapping[Causes, Mapping[str, Mapping[Causes, float]]] = field(default_factory=dict)
    slow: Mapping[Causes, frozenset[str]] = field(default_factory=dict)
    seldom: Mapping[Causes, frozenset[str]] = field(default_factory=dict)
    held: Mapping[Causes, frozenset[str]] = field(default_factory=dict)
    sampled: Mapping[Causes, frozenset[str]] = field(default_factory=dict)
    alike: Mapping[Causes, Mapping[str, str]] = field(default_factory=dict)
    rubbing: Mapping[Causes, Hypothesis] = field(default_factory=dict)
    unchecked: bool = False
    foretold: bool = False
    called: Mapping[str, float] = field(default_factory=dict)
    rich: bool = False
    steered: bool = False
    pushed_unseen: bool = False
    balanced: bool = False

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
        """The same led by another law of one cause of the leading set, which the data does not tell from this one.

        Both share the probability of the leading set.
        """
        old, new = self.best.causes, law.causes
        names = dict(zip(sorted(old - new), sorted(new - old), strict=True))
        rest = [i for i in range(1, len(self.sets)) if self.sets[i].causes != new]
        known = sum(p for p, one in zip(self.probability[1:], self.sets[1:], strict=True) if one.causes == new)
        both = (law, self.best) if names else (law,)
        share = self.probability[0] / len(both)

        def told(parts: Mapping[str, _Said]) -> dict[str, _Said]:
            return {names.get(name, name): part for name, part in parts.items()}

        return replace(
            self,
            sets=(*both, *(self.sets[i] for i in rest)),
            evidence=(*(self.evidence[0] for _ in both), *(self.evidence[i] for i in rest)),
            probability=(share + known, *(share for _ in both[1:]), *(self.probability[i] for i in rest)),
            left={**self.left, **({new: self.left[old]} if old in self.left else {})},
            further={**self.further, new: told(self.further.get(old, {}))},
            leaves={**self.leaves, **({new: self.leaves[old]} if old in self.leaves else {})},
            exact=self.exact | ({new} if old in self.exact else set()),
            clear={**self.clear, new: told(self.clear.get(old, {}))},
            instead={**self.instead, new: told(self.instead.get(old, {}))},
            slow={**self.slow, new: frozenset(names.get(name, name) for name in self.slow.get(old, ()))},
            seldom={**self.seldom, new: frozenset(names.get(name, name) for name in self.seldom.get(old, ()))},
            held={**self.held, new: frozenset(names.get(name, name) for name in self.held.get(old, ()))},
            sampled={**self.sampled, new: frozenset(names.get(name, name) for name in self.sampled.get(old, ()))},
            alike={**self.alike, new: {names.get(name, name): one for name, one in self.alike.get(old, {}).items()}},
        )

    def of_set(self, causes: Causes) -> float:
        """Probability of a set; 0 if it is not ranked."""
        return next((p for p, one in zip(self.probability, self.sets, strict=True) if one.causes == causes), 0.0)

    def of_cause(self, name: str) -> float:
        """Probability that a cause acts, in whatever law: of all sets that hold it together.

        What cannot be certain in the leading set is made certain by no other. Where that leaves so much that the rig
        follows another law (``leaves``), sets that leave hardly less make its causes no surer at all.
        """
        return self.of_any((name,))

    def of_any(self, names: Iterable[str]) -> float:
        """Probability that at least one of these causes acts, in whatever law: of all sets that hold any of them.

        What makes it doubtful which of them acts does not make it doubtful that one does.
        """
        asked = kinds(names)
        found = self._of_any_by_sets(asked)
        own = [law for law in self.best.causes if by_name(law).cause() in asked]
        most = max((self._greatest(self.best.causes, law, asked) for law in own), default=1.0)
        if not certain(most):
            found = min(found, most if self.best.causes in self.leaves else max(most, CERTAIN))
        if self.pushed_unseen or self.balanced:
            found = min(found, probability_at(CERTAIN_ODDS))
        if not (self.unchecked or self.foretold):
            return found
        return min(found, max(max(self.called.get(kind, 0.0), probability_at(self.limit(kind))) for kind in asked))

    def of_cause_by_sets(self, name: str) -> float:
        """Probability of a cause that the sets give together, before what limits it whatever the set."""
        return self._of_any_by_sets(kinds((name,)))

    def _of_any_by_sets(self, asked: frozenset[str]) -> float:
        """Probability that one of these causes acts, as the sets give it together.

        A set with a law of another cause that gives the same motion as one of them (``alike``) counts as well.
        """
        found = 0.0
        for fitted, p in zip(self.sets, self.probability, strict=True):
            own = [self._greatest(fitted.causes, law, asked) for law in fitted.causes if by_name(law).cause() in asked]
            twins = self.alike.get(fitted.causes, {}).items()
            here = [self._of_twin(fitted.causes, law) for law, twin in twins if by_name(twin).cause() in asked]
            found += p * max((*own, *here), default=0.0)
        return found

    def _of_twin(self, causes: Causes, law: str) -> float:
        """Greatest probability that a law acts which gives the same motion as one of a set, in that one's place."""
        likelier = max(1.0 / self._prior_beside_twin(causes, law), 1.0)
        return min(self._greatest(causes, law) * likelier, probability_at(1.0))

    def _prior_beside_twin(self, causes: Causes, law: str) -> float:
        """Odds before any data of a law of a set beside the law that gives the same motion (``alike``), at most 1."""
        other = self.alike.get(causes, {}).get(law)
        return min(by_name(law).prior_odds / by_name(other).prior_odds, 1.0) if other else math.inf

    def of_law(self, law: str) -> float:
        """Probability of all sets with this very law of a cause."""
        return sum(p for p, one in zip(self.probability, self.sets, strict=True) if law in one.causes)

    def stated(self, causes: Causes) -> float:
        """Probability of a set as it is stated: lowered as that of each of its causes is, so that all sets with a cause
        are together no likelier than the cause.
        """
        return self.of_set(causes) * min((1.0, *map(self._lowered, kinds(causes))))

    def _lowered(self, kind: str) -> float:
        """Probability of a cause over that of all sets that hold it."""
        whole = sum(p for p, one in zip(self.probability, self.sets, strict=True) if kind in kinds(one.causes))
        return self.of_cause(kind) / whole if whole > 0.0 else 1.0

    def _greatest(self, causes: Causes, law: str, among: frozenset[str] = frozenset()) -> float:
        """Greatest probability that a law of a set, or one of the causes ``among`` in its place, acts, if the set is
        the right one.

        What a set leaves above the noise may move like one of its causes. So the odds of a cause are no more than what
        it explains over what is left (``clear``), but not less than ``FORM_ODDS`` allows; of one that explains less
        than is left, its usual odds, even for most. More than these count only as far as it explains more than is left.
        In a poor experiment the amplitude falls with time, so that no stiffness and no friction that changes with time
        is certain: it may change with the amplitude. Nor is the stiffness where more than noise is left: a mass that
        changes with time moves nearly alike. Nor is what may be another shape of the other laws, or of the controller's
        (``steered``), nor a tone of few periods (``seldom``), nor a cause of a set that leaves much (``leaves``). A law
        of another cause that gives the same motion (``alike``) is as likely, or more by what it is likelier before any
        data. As likely is what the force may do between its samples (``sampled``), another shape of a drift in the
        place of a law that is slower than the record beside it, and, in a poor experiment, another shape of a drift of
        the sensor in the place of a law that creeps beside one.
        """
        odds = self._of_its_own(causes, law) if law in self.further.get(causes, ()) else math.inf
        effect, plain = by_name(law), self.rich and causes in self.exact
        if (twin := effect.creeps_as if not self.rich else "") and by_name(twin).cause() not in among:
            beside = by_name(twin).cause() in kinds(causes - {law})
            odds = min(odds, 1.0 if beside else CERTAIN_ODDS)
        aged = (effect.ages() and not self.rich) or (effect.ages_spring() and not plain)
        same_motion = self.alike.get(causes, {}).get(law)
        if same_motion and by_name(same_motion).cause() not in among:
            odds = min(odds, self._prior_beside_twin(causes, law))
        if law in self.sampled.get(causes, ()) or self._drifts_beside_a_drift(causes, law):
            odds = min(odds, 1.0)
        shape = effect.is_shape_beside(by_name(one) for one in causes - {law}) or (self.steered and effect.is_spring())
        seen_once = any(law in laws.get(causes, ()) for laws in (self.slow, self.seldom, self.held))
        if aged or shape or seen_once or causes in self.leaves:
            odds = min(odds, CERTAIN_ODDS)
        if self.curved_by(causes, law):
            odds = min(odds, uncertain(effect), CERTAIN_ODDS)
        if causes not in self.exact:
            over_left, others = self.clear.get(causes, {}).get(law, math.inf), self.beside_others(causes, law, among)
            clear = min(over_left, self._shaped(causes, law))
            clear = min(clear * max(min(clear, _usual(effect)), 1.0), others)
            least = FORM_ODDS * Effect.prior_odds
            odds = min(odds, max(clear, least if min(over_left, others) >= 1.0 else min(_usual(effect), least)))
        return probability_at(odds)

    def beside_others(self, causes: Causes, law: str, among: frozenset[str] = frozenset()) -> float:
        """Least odds of a law of a set beside sets without its cause (``instead``) and without the causes ``among``."""
        others = self.instead.get(causes, {}).get(law, {}).items()
        return min((odds for other, odds in others if among.isdisjoint(kinds(other))), default=math.inf)

    def _drifts_beside_a_drift(self, causes: Causes, law: str) -> bool:
        """Whether a law is slower than the record, beside one that changes with time as slowly: two slow curves over
        time come near any third.
        """
        slow, effect = self.slow.get(causes, frozenset()), by_name(law)
        along = effect.is_scale() or (effect.harmonic is not None and effect.harmonic.over == PLACE)
        others = [by_name(one) for one in causes - {law}]
        drifts = any(not one.steady and (one.harmonic is None or one.name in slow) for one in others)
        return law in slow and not along and drifts

    def curved_by(self, causes: Causes, law: str) -> frozenset[str]:
        """Further curves of a set, of the spring or of the sensor as a law is, that explain so much beyond the others
        that the curve has not the law's form.

        Where the set leaves more than noise, a further curve may be an error of the first one's form (``further``). If
        that error is more than ``FORM_PART``, the first law is not this rig's either: two curves come near any third.
        """
        return frozenset(one for one, part in self._curves_beside(causes, law).items() if part > FORM_PART)

    def _shaped(self, causes: Causes, law: str) -> float:
        """How many times more a law explains than each further curve beside it, which may be an error of its form."""
        errors = self._curves_beside(causes, law).values()
        return min((1.0 / part for part in errors if part > 0.0), default=math.inf)

    def _curves_beside(self, causes: Causes, law: str) -> dict[str, float]:
        """Further curves beside a law of their kind in a set that leaves more than noise, with what they explain."""
        if causes in self.exact:
            return {}
        others = ((one, part) for one, part in self.further.get(causes, {}).items() if one != law)
        return {one: part for one, part in others if by_name(law).bends_as(by_name(one))}

    def _of_its_own(self, causes: Causes, law: str) -> float:
        """Greatest odds that a cause which may be another form of the other laws acts by itself.

        In a set that leaves only noise, that form would have to agree with the cause but for what the noise can hide:
        the more clearly the cause is seen above this, the surer it is. A poor experiment makes none certain, and no
        experiment a law of less than the usual prior odds, which bends to much, or a spring or a sensor's scale beside
        another one: two curves over the position come near any third one. Nor is a curve over the speed certain beside
        another form of such a law, which is a curve that bends more than the simple one.
        """
        odds = by_name(law).prior_odds
        if causes not in self.exact:
            return FORM_ODDS * odds
        clear = self.clear.get(causes, {}).get(law, math.inf)
        effect, others = by_name(law), [by_name(one) for one in causes - {law}]
        bends = any(effect.bends_as(one) for one in others)
        bends |= effect.is_curve_over_speed() and any(one.form_of and one.is_curve_over_speed() for one in others)
        if not self.rich or odds < Effect.prior_odds or bends:
            clear = min(clear, CERTAIN_ODDS)
        return clear * odds / Effect.prior_odds

    def limit(self, name: str) -> float:
        """Greatest odds of a cause if no copies check it (``unchecked``), or the evidence is against the set."""
        exact = self.best.causes in self.exact
        if self.foretold:  # what speaks for a set and what speaks against it are even, unless no error is seen
            return CERTAIN_ODDS if exact else 1.0
        effect = by_name(by_name(name).cause())
        return CERTAIN_ODDS * _usual(effect) if exact else uncertain(effect)

    def within(self, nats: float) -> list[Hypothesis]:
        """Sets whose evidence is not more than this below the leading one."""
        least = self.evidence[0] - nats
        return [fitted for fitted, value in zip(self.sets, self.evidence, strict=True) if value >= least]


def uncertain(effect: type[Effect]) -> float:
    """Greatest odds of a cause whose law is not this rig's, or that needs copies and has none."""
    return FORM_ODDS * Effect.prior_odds * _usual(effect)


def _usual(effect: type[Effect]) -> float:
    """Prior odds over those of most causes; lower ones do not count once more."""
    return max(effect.prior_odds / Effect.prior_odds, 1.0)


def probability_at(odds: float) -> float:
    """Probability at these odds."""
    return odds / (1.0 + odds) if math.isfinite(odds) else 1.0
