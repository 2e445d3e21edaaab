"""Sets of causes in the order of their evidence, with the probabilities that follow for each cause, and ties."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from msd_ident.model.effects import by_name
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.certainty import CERTAIN, CERTAIN_ODDS, certain, probability_at, uncertain, usual
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis, kinds
from msd_ident.tuning import tuned

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


@dataclass(frozen=True)
class Ranking:
    """Sets of causes by falling evidence.

    Attributes:
        sets: the fitted sets.
        evidence: log evidence [nats] of each.
        probability: posterior probability of each.
        left: residual that every fitted set leaves, in noise floors, also of those that were fitted to a part of the
            data alone.
        caveats: of every set, what keeps its causes from being certain.
        rubbing: sets beside which Coulomb friction was fitted but is no explanation (``ordering.rank``), each with the
            set that has it: friction too weak to be seen is possible on every rig.
        unchecked: whether a poor experiment has no copies that check the leading set (``replication``), or left-out
            data do not confirm it: the odds of a cause are limited (``limit``).
        far: whether it has none because the leading set leaves far more than noise: no cause is certain.
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
        unfinished: how many sets a search had tried that ended, far from the noise, before it had tried all; 0 where it
            had. No cause is certain then.
    """

    sets: tuple[Hypothesis, ...]
    evidence: tuple[float, ...]
    probability: tuple[float, ...]
    left: Mapping[Causes, float] = field(default_factory=dict)
    caveats: Mapping[Causes, Caveats] = field(default_factory=dict)
    rubbing: Mapping[Causes, Hypothesis] = field(default_factory=dict)
    unchecked: bool = False
    far: bool = False
    foretold: bool = False
    called: Mapping[str, float] = field(default_factory=dict)
    rich: bool = False
    steered: bool = False
    pushed_unseen: bool = False
    balanced: bool = False
    unfinished: int = 0

    @property
    def best(self) -> Hypothesis:
        """The leading set: the likeliest, without causes that the data does not call for."""
        return self.sets[0]

    @property
    def leader_caveats(self) -> Caveats:
        """What keeps the causes of the leading set from being certain."""
        return self.caveats_of(self.best.causes)

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
        before, known_of = self.caveats_of(old), self.caveats.get(new)
        names = dict(zip(sorted(old - new), sorted(new - old), strict=True))
        rest = [i for i in range(1, len(self.sets)) if self.sets[i].causes != new]
        known = sum(p for p, one in zip(self.probability[1:], self.sets[1:], strict=True) if one.causes == new)
        both = (law, self.best) if names else (law,)
        share = self.probability[0] / len(both)
        return replace(
            self,
            sets=(*both, *(self.sets[i] for i in rest)),
            evidence=(*(self.evidence[0] for _ in both), *(self.evidence[i] for i in rest)),
            probability=(share + known, *(share for _ in both[1:]), *(self.probability[i] for i in rest)),
            left={**self.left, **({new: self.left[old]} if old in self.left else {})},
            caveats={**self.caveats, new: before.renamed(names).with_those(known_of)},
        )

    def caveats_of(self, causes: Causes) -> Caveats:
        """What keeps the causes of a set from being certain."""
        return self.caveats.get(causes) or Caveats(causes)

    def with_caveats(self, causes: Causes, **changed: Any) -> Ranking:
        """The same with other caveats about a set."""
        return replace(self, caveats={**self.caveats, causes: replace(self.caveats_of(causes), **changed)})

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

        What makes it doubtful which of them acts does not make it doubtful that one does. Coulomb friction among
        others may act in the place of a law that holds it as a limit, also of one that is a form of it.
        """
        names = frozenset(names)
        asked = kinds(names)
        rubs = names & set(HOLDING_COULOMB) if COULOMB in names else frozenset[str]()
        found = self._of_any_by_sets(asked, rubs)
        own = [law for law in self.best.causes if by_name(law).cause() in asked]
        told = {"rich": self.rich, "steered": self.steered}
        most = max(
            (self.leader_caveats.greatest(law, asked, rubs=_rubs(law, rubs), **told) for law in own), default=1.0
        )
        if not certain(most):
            found = min(found, most if self.leader_caveats.leaves else max(most, CERTAIN))
        if self.pushed_unseen or self.balanced or self.unfinished:
            found = min(found, probability_at(CERTAIN_ODDS))
        if not (self.unchecked or self.foretold):
            return found
        return min(found, max(max(self.called.get(kind, 0.0), probability_at(self.limit(kind))) for kind in asked))

    def of_cause_by_sets(self, name: str) -> float:
        """Probability of a cause that the sets give together, before what limits it whatever the set."""
        return self._of_any_by_sets(kinds((name,)))

    def _of_any_by_sets(self, asked: frozenset[str], rubs: frozenset[str] = frozenset()) -> float:
        """Probability that one of these causes acts, as the sets give it together.

        A set with a law of another cause that gives the same motion as one of them (``alike``) counts as well.
        """
        found, told = 0.0, {"rich": self.rich, "steered": self.steered}
        for fitted, p in zip(self.sets, self.probability, strict=True):
            caveats = self.caveats_of(fitted.causes)
            laws = [law for law in fitted.causes if by_name(law).cause() in asked]
            own = [caveats.greatest(law, asked, rubs=_rubs(law, rubs), **told) for law in laws]
            twins = [law for law, twin in caveats.alike.items() if by_name(twin).cause() in asked]
            found += p * max((*own, *(caveats.of_same_motion(law, **told) for law in twins)), default=0.0)
        return found

    def of_law(self, law: str) -> float:
        """Probability of all sets with this very law of a cause."""
        return sum(p for p, one in zip(self.probability, self.sets, strict=True) if law in one.causes)

    def of_other_laws(self, law: str) -> float:
        """Probability of all sets that hold the cause of a law, and not this law of it."""
        cause = by_name(law).cause()
        pairs = zip(self.probability, self.sets, strict=True)
        return sum(p for p, one in pairs if law not in one.causes and cause in kinds(one.causes))

    def stated(self, causes: Causes) -> float:
        """Probability of a set as it is stated: lowered as that of each of its causes is, so that all sets with a cause
        are together no likelier than the cause.
        """
        return self.of_set(causes) * min((1.0, *map(self._lowered, kinds(causes))))

    def _lowered(self, kind: str) -> float:
        """Probability of a cause over that of all sets that hold it."""
        whole = sum(p for p, one in zip(self.probability, self.sets, strict=True) if kind in kinds(one.causes))
        return self.of_cause(kind) / whole if whole > 0.0 else 1.0

    def limit(self, name: str) -> float:
        """Greatest odds of a cause if no copies check it (``unchecked``), or the evidence is against the set."""
        exact = self.leader_caveats.exact
        if self.foretold:  # what speaks for a set and what speaks against it are even, unless no error is seen
            return CERTAIN_ODDS if exact else 1.0
        effect = by_name(by_name(name).cause())
        if self.far:  # no copies could confirm laws that are not the rig's
            return min(uncertain(effect), CERTAIN_ODDS)
        return CERTAIN_ODDS * usual(effect) if exact else uncertain(effect)

    def within(self, nats: float) -> list[Hypothesis]:
        """Sets whose evidence is not more than this below the leading one."""
        least = self.evidence[0] - nats
        return [fitted for fitted, value in zip(self.sets, self.evidence, strict=True) if value >= least]


def _rubs(law: str, asked: frozenset[str]) -> bool:
    """Whether Coulomb friction may act in the place of a law: of one of ``asked``, and beside these of a form of it."""
    return law in asked or (bool(asked) and law in HOLDING_COULOMB and by_name(law).cause() == COULOMB)
