"""What keeps the causes of one fitted set from being certain."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from msd_ident.model.declarations import PLACE
from msd_ident.model.effects import Effect, by_name
from msd_ident.selection.certainty import CERTAIN_ODDS, FORM_ODDS, FORM_PART, probability_at, uncertain, usual
from msd_ident.selection.hypothesis import Causes, kinds

#: A cause -> sets without it, with the odds of the set beside each.
Others = Mapping[str, Mapping[Causes, float]]


@dataclass(frozen=True)
class Caveats:
    """What the records say against the causes of a set, or cannot say for them.

    Attributes:
        causes: the set.
        exact: whether it leaves only noise: no error of its laws is seen.
        leaves: what it leaves above the noise, as a part of what it explains, if that is more than ``LEFT_PART``, else
            0: its laws are not those of the rig, so none of its causes is certain.
        missed: error on left-out data over that of the fit, where most of it is not noise (``generalization``), else 0:
            the laws follow this record.
        further: causes that may be another form of the other laws, each with the part of what those explain that it
            explains (``law_errors.further_parts``).
        clear: how clearly the set needs each of its causes (``law_errors.clearness``).
        rubs: laws with Coulomb friction as a limit, and how clearly the set needs one of the two
            (``law_errors.clear_as_friction``).
        instead: of a set within ``NEAR`` that leaves more than noise, the sets without each of its causes, with the
            odds of this set beside each (``law_errors.instead``).
        slow: causes of whose periods the records hold too few: less than one of a motion that they bring, or less than
            two along the travel. A drift, or a bend, of another kind may do the same: they are not certain.
        seldom: tones of a set that leaves more than noise, of which the records hold too few periods to show that they
            repeat: one force that does not repeat may make both the tone and what is left, so they are not certain.
        held: causes that hold the cart at rest and do hardly anything in motion: a force that acts only while the drive
            is on, or off, may do the same, so they are not certain.
        sampled: causes that explain no more than twice what the force may do between its samples: each is at most as
            likely as that.
        open: causes whose strength the data leaves open (``undetermined``): other numbers of the model can take their
            place, so each is as likely not to act.
        bending: curves over the speed that bend freely, in whose place one of another cause leaves only noise too
            (``speed_curves.also_bent``): the evidence tells their shapes apart, and the rig's may be a third one, so
            they are not certain.
        alike: laws, each with a law of another cause that gives the same motion in its place (``equal_motion``): each
            is as likely as the other.
    """

    causes: Causes
    exact: bool = False
    leaves: float = 0.0
    missed: float = 0.0
    further: Mapping[str, float] = field(default_factory=dict)
    clear: Mapping[str, float] = field(default_factory=dict)
    rubs: Mapping[str, float] = field(default_factory=dict)
    instead: Others = field(default_factory=dict)
    slow: frozenset[str] = frozenset()
    seldom: frozenset[str] = frozenset()
    held: frozenset[str] = frozenset()
    sampled: frozenset[str] = frozenset()
    open: frozenset[str] = frozenset()
    bending: frozenset[str] = frozenset()
    alike: Mapping[str, str] = field(default_factory=dict)

    def renamed(self, names: Mapping[str, str]) -> Caveats:
        """The same of the set in which these laws stand in the place of others, by the old name."""

        def new(laws: frozenset[str]) -> frozenset[str]:
            return frozenset(names.get(name, name) for name in laws)

        return replace(
            self,
            causes=new(self.causes),
            further={names.get(name, name): part for name, part in self.further.items()},
            clear={names.get(name, name): odds for name, odds in self.clear.items()},
            rubs={names.get(name, name): odds for name, odds in self.rubs.items()},
            instead={names.get(name, name): odds for name, odds in self.instead.items()},
            slow=new(self.slow),
            seldom=new(self.seldom),
            held=new(self.held),
            sampled=new(self.sampled),
            open=new(self.open),
            bending=new(self.bending),
            alike={names.get(name, name): twin for name, twin in self.alike.items()},
        )

    def with_those(self, other: Caveats | None) -> Caveats:
        """The same, with what another judgement of this set says about all that it leaves, if that is worse."""
        if other is None:
            return self
        return replace(self, exact=self.exact and other.exact, leaves=max(self.leaves, other.leaves))

    def greatest(
        self, law: str, among: frozenset[str] = frozenset(), *, rich: bool, steered: bool, rubs: bool = False
    ) -> float:
        """Greatest probability that a law of the set acts, or one of other causes in its place, if the set is right.

        Args:
            law: of the set.
            among: the causes that may act in its place.
            rich: whether the experiment excites more than one kind of motion (``excitation.poor``).
            steered: whether a controller computes the force from the readings.
            rubs: whether Coulomb friction may act in the place of a law that holds it as a limit.
        """
        either = rubs and law in self.rubs
        clear = (self.rubs if either else self.clear).get(law, math.inf)
        limits = [self._beside_same_motion(law, among, rich), self._beside_what_is_left(law, among, clear)]
        if law in self.further and not either:
            limits.append(self._of_its_own(law, rich))
        if self._never_certain(law, rich, steered):
            limits.append(CERTAIN_ODDS)
        if self.curved_by(law):
            limits += [uncertain(by_name(law)), CERTAIN_ODDS]
        return probability_at(min(limits))

    def of_same_motion(self, law: str, *, rich: bool, steered: bool) -> float:
        """Greatest probability that the law acts which gives the same motion as one of the set, in that one's place."""
        likelier = max(1.0 / self._prior_beside_same_motion(law), 1.0)
        return min(self.greatest(law, rich=rich, steered=steered) * likelier, probability_at(1.0))

    def _never_certain(self, law: str, rich: bool, steered: bool) -> bool:
        """Whether something that the records do not show may do what a law does.

        In a poor experiment the amplitude falls with time, so that no stiffness and no friction that changes with time
        is certain: it may change with the amplitude. Nor is the stiffness where more than noise is left: a mass that
        changes with time moves nearly alike. Nor is what may be another shape of the other laws, or of the controller's
        (``steered``), nor what is seen once only, nor a cause of a set that leaves much (``leaves``). Nor is a linear
        filter of the force beside two others: with three of them a set follows a filter of another kind to the noise.
        Nor is a curve over the speed that bends freely beside another one (``bent``): the two follow any third. Nor is
        it where one of another cause does as well in its place (``bending``).
        """
        effect = by_name(law)
        aged = (effect.ages() and not rich) or (effect.ages_spring() and not (rich and self.exact))
        shape = effect.is_shape_beside(by_name(one) for one in self.causes - {law})
        pushed_back = steered and effect.is_spring()
        seen_once = law in self.slow | self.seldom | self.held
        bent = law in self.filters() | self.bent() | self.bending
        return aged or shape or pushed_back or seen_once or bent or self.leaves > 0.0

    def filters(self) -> frozenset[str]:
        """Linear filters of the force in the set, if there are three or more."""
        found = frozenset(one for one in self.causes if by_name(one).filters_force())
        return found if len(found) > 2 else frozenset()

    def bent(self) -> frozenset[str]:
        """Curves over the speed in the set that are another form of a simple law, if there are two or more."""
        found = frozenset(one for one in self.causes if by_name(one).form_of and by_name(one).is_curve_over_speed())
        return found if len(found) > 1 else frozenset()

    def _beside_same_motion(self, law: str, among: frozenset[str], rich: bool) -> float:
        """Greatest odds of a law beside what gives the same motion.

        A law of another cause (``alike``) is as likely, or more by what it is likelier before any data. As likely is
        what the force may do between its samples (``sampled``), what can take the place of a law whose strength is open
        (``open``), another shape of a drift in the place of a law that is slower than the record beside it, and, in a
        poor experiment, another shape of a drift of the sensor in the place of a law that creeps beside one.
        """
        odds, settles = math.inf, by_name(law).creeps_as
        if settles and not rich and by_name(settles).cause() not in among:
            odds = 1.0 if by_name(settles).cause() in kinds(self.causes - {law}) else CERTAIN_ODDS
        if (twin := self.alike.get(law)) and by_name(twin).cause() not in among:
            odds = min(odds, self._prior_beside_same_motion(law))
        if law in self.sampled | self.open or self._drifts_beside_a_drift(law):
            odds = min(odds, 1.0)
        return odds

    def _prior_beside_same_motion(self, law: str) -> float:
        """Odds before any data of a law beside the one that gives the same motion (``alike``), at most 1."""
        other = self.alike.get(law)
        return min(by_name(law).prior_odds / by_name(other).prior_odds, 1.0) if other else math.inf

    def _drifts_beside_a_drift(self, law: str) -> bool:
        """Whether a law is slower than the record, beside one that changes with time as slowly: two slow curves over
        time come near any third.
        """
        effect = by_name(law)
        along = effect.is_scale() or (effect.harmonic is not None and effect.harmonic.over == PLACE)
        others = [by_name(one) for one in self.causes - {law}]
        drifts = any(not one.steady and (one.harmonic is None or one.name in self.slow) for one in others)
        return law in self.slow and not along and drifts

    def _beside_what_is_left(self, law: str, among: frozenset[str], over_left: float) -> float:
        """Greatest odds of a law beside what the set leaves above the noise, which may move like it.

        They are no more than what the cause explains over what is left, ``over_left``, and than what ``instead`` gives,
        but not less than ``FORM_ODDS`` allows; of one that explains less than is left, its usual odds, even for most.
        More than these count only as far as it explains more than is left.
        """
        if self.exact:
            return math.inf
        effect, others = by_name(law), self.beside_others(law, among)
        clear = min(over_left, self._shaped(law))
        clear = min(clear * max(min(clear, usual(effect)), 1.0), others)
        least = FORM_ODDS * Effect.prior_odds
        return max(clear, least if min(over_left, others) >= 1.0 else min(usual(effect), least))

    def beside_others(self, law: str, among: frozenset[str] = frozenset()) -> float:
        """Least odds of a law beside sets without its cause (``instead``) and without the causes ``among``."""
        others = self.instead.get(law, {}).items()
        return min((odds for other, odds in others if among.isdisjoint(kinds(other))), default=math.inf)

    def curved_by(self, law: str) -> frozenset[str]:
        """Further curves, of the spring or of the sensor as a law is, or filters of the force, that explain so much
        beyond the others that the curve has not the law's form.

        Where the set leaves more than noise, a further curve may be an error of the first one's form (``further``). If
        that error is more than ``FORM_PART``, the first law is not this rig's either: two curves come near any third.
        """
        return frozenset(one for one, part in self._curves_beside(law) if part > FORM_PART)

    def _shaped(self, law: str) -> float:
        """How many times more a law explains than each further curve beside it, which may be an error of its form."""
        return min((1.0 / part for _, part in self._curves_beside(law) if part > 0.0), default=math.inf)

    def _curves_beside(self, law: str) -> Iterator[tuple[str, float]]:
        """Further curves beside a law of their kind in a set that leaves more than noise, with what they explain."""
        if not self.exact:
            yield from (
                (one, part) for one, part in self.further.items() if one != law and by_name(law).bends_as(by_name(one))
            )

    def _of_its_own(self, law: str, rich: bool) -> float:
        """Greatest odds that a cause which may be another form of the other laws acts by itself.

        In a set that leaves only noise, that form would have to agree with the cause but for what the noise can hide:
        the more clearly the cause is seen above this, the surer it is. A poor experiment makes none certain, and no
        experiment a law of less than the usual prior odds, which bends to much, or a spring or a sensor's scale beside
        another one: two curves over the position come near any third one. Nor is a curve over the speed certain beside
        another form of such a law, which is a curve that bends more than the simple one.
        """
        odds = by_name(law).prior_odds
        if not self.exact:
            return FORM_ODDS * odds
        clear = self.clear.get(law, math.inf)
        effect, others = by_name(law), [by_name(one) for one in self.causes - {law}]
        bends = any(effect.bends_as(one) for one in others)
        bends |= effect.is_curve_over_speed() and any(one.form_of and one.is_curve_over_speed() for one in others)
        if not rich or odds < Effect.prior_odds or bends:
            clear = min(clear, CERTAIN_ODDS)
        return clear * odds / Effect.prior_odds
