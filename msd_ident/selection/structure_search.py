"""Search for the set of causes: add, replace or remove one, until no neighbour has more evidence.

A greedy search that only adds causes cannot take back an early mistake (friction looks like hysteresis until the spring
is right). Here every cause of the library is fitted at every step, and the search ends when all sets that differ from
the leading one by one cause have been fitted and none has more evidence.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from operator import is_not
from typing import TypeVar

from msd_ident import parallel
from msd_ident.estimate.effort import KEPT, LOOK
from msd_ident.estimate.explained import LEAST
from msd_ident.estimate.levels import MOST_OF
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.selection import starting_points
from msd_ident.selection.evidence import NoiseScale, scale_from
from msd_ident.selection.experiment import SOUGHT, Experiment, formulated
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis, causes_that_fit
from msd_ident.selection.hypothesis_fit import COMPARABLE, FAR, REACH, StartingPoint, begin, finish, refine
from msd_ident.selection.neighbours import Neighbours, only_another_form, rubs_and_is_linear, with_coulomb
from msd_ident.selection.observer import can_follow, followed
from msd_ident.selection.ordering import leading, rank
from msd_ident.selection.promising import explaining, explains, pairs
from msd_ident.selection.ranking import Ranking
from msd_ident.selection.second_masses import swing
from msd_ident.selection.simpler_sets import equal_to, nearest
from msd_ident.selection.speed_curves import merged
from msd_ident.selection.subset_regression import likely
from msd_ident.selection.worthwhile import promising, within_reach

_Task = TypeVar("_Task", Causes, list[StartingPoint], list[Hypothesis])
_Done = TypeVar("_Done")

#: ``progress(stage, fraction of the work done, cause being tried)``; what it raises ends the diagnosis.
Progress = Callable[[str, float, str], None]

#: A set, its model, and each record's state and zero, as fitted to less data.
Remembered = tuple[Causes, Model, Sequence[Initial]]

NOTHING: Causes = frozenset()
#: Rounds of a walk whose leader stays far from the noise: what these do not repair, the library does not repair.
_ROUNDS_FAR = LOOK // 2


@dataclass
class Search:
    """Search on one experiment.

    Attributes:
        experiment: the data.
        at_floor: tells whether a fitted set leaves nothing but noise; then no cause is added to it.
        progress: called for each set, see ``Progress``.
        sets: all fitted sets by their causes.
        tried: sets that need not be fitted again.
        pruned: leading sets whose simpler sets were fitted again already.
        followed: sets that were fitted through observers already.
        told: fraction of the work that was reported last.
        led: fitted sets, and the leading one of these, when it was asked last.
        beyond: sets whose starts promise too little beside a leading set that leaves only noise.
    """

    experiment: Experiment
    at_floor: Callable[[Hypothesis], bool]
    progress: Progress
    sets: dict[Causes, Hypothesis] = field(default_factory=dict)
    tried: set[Causes] = field(default_factory=set)
    pruned: set[Causes] = field(default_factory=set)
    followed: set[Causes] = field(default_factory=set)
    told: float = 0.0
    led: tuple[tuple[Hypothesis, ...], Hypothesis] | None = None
    beyond: set[Causes] = field(default_factory=set)

    @cached_property
    def neighbours(self) -> Neighbours:
        """Sets next to a set."""
        return Neighbours(self.experiment)

    def run(self, base: Hypothesis, known: Sequence[Hypothesis] = (), remembered: Sequence[Remembered] = ()) -> Ranking:
        """Search from the base model.

        Args:
            base: the base model, fitted.
            known: further fitted sets.
            remembered: sets that explained a part of the data, each with its model and initial states; they are refined
                on all of it.

        Returns:
            All fitted sets by evidence.
        """
        self._know((base, *known))
        for causes, model, initial in remembered:
            self._keep(refine(self.experiment, causes, model, initial))
        beside = self.neighbours.grown(frozenset({COULOMB})) if self._rubs(base) else []
        if beside:
            self._fit(beside, 0.05, 0.2)
        self._fit([frozenset({name}) for name in self.experiment.tried_alone], 0.05, 0.35)
        leader = self._leader()
        if not self.at_floor(leader):
            self.tried -= {pair for pair in beside if self.neighbours.singles_beside(pair, self.sets) > 1}
            explain = [leader.causes, *explaining(self.experiment, self.sets)]
            forms = [other for causes in explain for other in self.neighbours.reformed(causes)]
            # A form, which has more numbers, may do what friction does beside a simple law: none comes first.
            self._fit([*forms, *(causes | {COULOMB} for causes in explain)], 0.35, 0.36)
            leader = self._leader()
        if self.carries_nothing:
            return self.ranking()
        if not self.at_floor(leader):
            # What a set leaves may be another form of its laws, before it is a cause more.
            self._fit(self.neighbours.reformed(leader.causes), 0.35, 0.36)
        self._follow_readings()
        if not self.at_floor(leader := self._leader()):
            # Friction is what most often stands beside another cause.
            fronts = [one.causes for one in self._fronts(leader)]
            companions = [causes for causes in (*fronts, frozenset({COULOMB}), self.neighbours.rippled) if causes]
            self._fit([pair for causes in companions for pair in self.neighbours.grown(causes)], 0.35, 0.55)
        if not self.at_floor(self._leader()):
            self._fit(pairs(self.experiment, self.sets, self.ranking()), 0.55, 0.6)
        if not self.at_floor(self._leader()):
            # A cause may explain nothing until another one is there.
            alone = explaining(self.experiment, self.sets)
            self._fit([pair for one in alone for pair in self.neighbours.grown(one)], 0.55, 0.6)
        if not self.at_floor(self._leader()) and self._fit_regressed():
            ahead = self._fronts(self._leader())
            self._fit([larger for one in ahead for larger in self.neighbours.grown(one.causes)], 0.6, 0.6)
        found = self._walk()
        if not self.at_floor(self._leader()) and self._fit_regressed():
            found = self._walk()  # the values that the first walk has found show what they hid
        return found

    def _fit_regressed(self) -> bool:
        """Fit sets that a regression of the equation of motion calls for: each cause may explain nothing by itself.

        Returns:
            Whether one of them may leave less than all fitted sets.
        """
        base, leader, least = self.sets[NOTHING], self._leader(), self._least.chi
        new = likely(self.experiment, base, self._fronts(leader))
        starts = [starting_points.from_values(self.experiment, one.model, one.initial, base.chi) for one in new]
        ahead = [start for start in starts if start.promise < least]
        self.tried.update(start.fitted.causes for start in ahead)
        self._fit_group([[start] for start in ahead], (0.6, 0.6))
        return bool(ahead)

    def resume(self, sets: Sequence[Hypothesis]) -> Ranking:
        """Continue from sets that were found on part of the data and are fitted to all of it."""
        self._know(sets)
        return self._walk()

    def compared(self, sets: Sequence[Hypothesis]) -> Ranking:
        """Compare sets that were found on part of the data and are fitted to all of it.

        Sets simpler than the leading one are fitted again, starting from its parameters, because their own fits may
        have ended in a local minimum.
        """
        self._know(sets)
        best = self.ranking().best
        for causes, model, initial in nearest(self.experiment, best):
            self._look_again(causes, model, initial, math.inf if causes in self.sets else COMPARABLE * best.chi)
        return self.ranking()

    def _know(self, sets: Iterable[Hypothesis]) -> None:
        """Take over sets that are fitted to all of the experiment."""
        for fitted in sets:
            self.sets[fitted.causes] = fitted
            self.tried.add(fitted.causes)

    def _rubs(self, base: Hypothesis) -> bool:
        """Whether Coulomb friction explains something and leaves more than noise: then the causes beside it come first.

        Friction is what most often stands beside another cause. Where the two leave only noise, a single cause need be
        followed only if it may come near to that.
        """
        rubbing = self.sets.get(frozenset({COULOMB}))
        return rubbing is not None and explains(rubbing, base) and not self.at_floor(rubbing)

    @property
    def carries_nothing(self) -> bool:
        """Whether no set explains even half of the motion: such a record is refused (``estimate.explained``)."""
        return min(fitted.chi for fitted in self.sets.values()) > (1.0 - LEAST) * self.experiment.motion

    def _walk(self) -> Ranking:
        """Move to the best neighbouring set until no neighbour has more evidence."""
        if self.carries_nothing:
            return self.ranking()
        for turn in range(LOOK):
            self._follow_readings()
            best = self._pruned(self._leader())
            if turn >= _ROUNDS_FAR and best.chi > FAR * self.experiment.evidence:
                break
            if not any(self._advance(one, min(0.6 + 0.03 * turn, 0.85)) for one in self._fronts(best)):
                break
        self._around_likeliest()
        if self.at_floor(leader := self._leader()):
            self._rejoined(leader)
        return self.ranking()

    def _around_likeliest(self) -> None:
        """Fit the sets that differ from the likeliest one by a cause, until none is new, a few rounds at most.

        The walk is led by an evidence that counts more features of the error. Far from the noise a flexible law may
        lead it, e.g. a disturbance, to which the ranking gives little: then these sets are not among its neighbours.
        """
        for _ in range(_ROUNDS_FAR):
            likeliest = self.ranking().likeliest
            near = self.neighbours.swapped(likeliest.causes) + self.neighbours.grown(likeliest.causes)
            if self.at_floor(likeliest) or not self._fit(near, 0.85, 0.86):
                break

    def _fronts(self, best: Hypothesis) -> list[Hypothesis]:
        """The sets whose neighbours are tried: the leading one, and one that leaves far less, half for each cause more.

        Far from the noise the evidence counts features of the error, and may prefer a set that leaves more.
        """
        if self.at_floor(best):
            return [best]

        def most(fitted: Hypothesis) -> float:
            return best.chi * MOST_OF ** (1 + max(len(fitted.causes) - len(best.causes), 0))

        rivals = [one for one in self.sets.values() if one.chi <= most(one)]
        return [best, *sorted(rivals, key=lambda fitted: fitted.chi)[:1]]

    def _advance(self, front: Hypothesis, share: float) -> bool:
        """Fit the neighbours of a set, larger ones only if all others were fitted; False if all were."""
        near, middle = self.neighbours, share + 0.015
        swapped = near.swapped(front.causes)
        if self.at_floor(front):
            swapped = [causes for causes in swapped if not only_another_form(causes, front.causes)]
        if self._fit(swapped + near.resolved(front.causes), share, middle):
            return True
        return not self.at_floor(front) and self._fit(near.grown(front.causes), middle, middle + 0.015)

    def _rejoined(self, best: Hypothesis) -> None:
        """Fit sets that differ from the leading one in one cause again, from the parameters that both share.

        A leading set that leaves only noise determines these better than when the rivals were tried first: with too
        much friction the cart sticks at other turning points, and the fit does not get away from there.
        """
        rivals = [
            one.causes
            for one in self.sets.values()
            if len(one.causes) == len(best.causes) == len(one.causes & best.causes) + 1
            and best.chi < one.chi < COMPARABLE * best.chi
        ]
        for fitted in self._each(partial(self._rejoin, best), rivals, (0.86, 0.87)):
            self._keep(fitted)

    def _rejoin(self, best: Hypothesis, causes: Causes) -> Hypothesis:
        model = self.sets[causes].model
        known = dict(zip(best.model.names, best.model.values.tolist(), strict=True))
        shared = {name: known[name] for name in model.names if name in known and name not in ("mass", "stiffness")}
        return refine(self.experiment, causes, model.with_values(shared), best.initial)

    def _pruned(self, best: Hypothesis) -> Hypothesis:
        """The leading set, after sets simpler than it were fitted again from its parameters.

        With friction, stops and delays the error has many minima. A simpler set that ended in a wrong one loses against
        a larger one that found the right one, unless it is fitted again from there.
        """
        if best.causes in self.pruned:
            return best
        self.pruned.add(best.causes)
        for causes, model, initial in nearest(self.experiment, best):
            self._look_again(causes, model, initial)
        for causes, model, initial in merged(self.experiment, best):
            if causes not in self.sets or self.sets[causes].chi > best.chi:
                self._look_again(causes, model, initial)
        return self._leader()

    def _follow_readings(self) -> None:
        """Fit sets again through observers (``observer``), if all sets leave far more than noise: with a cart that
        sticks they may be in wrong minima.

        The leading sets, and those of one law that leave least.
        """
        if self._least.chi < FAR * self.experiment.evidence:
            return
        alone = sorted((one for one in self.sets.values() if len(one.causes) == 1), key=lambda one: one.chi)
        ahead = {one.causes: one for one in (*self._fronts(self._leader()), *alone) if can_follow(one.model)}
        for causes, one in list(ahead.items())[:KEPT]:
            if causes not in self.followed and not self.at_floor(self._least):
                self.followed.add(causes)
                self.progress("search", self.told, _named(causes))
                simple = len(causes) == 1 and causes <= set(self.experiment.tried_alone)
                begun = starting_points.starts(self.experiment, causes, self.sets[NOTHING]) if simple else []
                self._keep(followed(self.experiment, causes, [one.model, *begun], one.initial))

    def _look_again(self, causes: Causes, model: Model, initial: Sequence[Initial], most: float = math.inf) -> None:
        """Fit a set again from a start that leaves less than ``most``, and less than ``COMPARABLE`` times a still cart.

        A start that leaves many times as much as a cart that does not move at all says nothing about the minimum, and
        a fit from there simulates a stiff or unstable model step by tiny step. A set with such a start may still be
        tried from others.
        """
        _, weighting, point = formulated(self.experiment, model, initial)
        left = weighting.residual(point)
        if left @ left < min(most, COMPARABLE * self.experiment.motion):
            self.tried.add(causes)
            self._keep(refine(self.experiment, causes, model, initial))

    def _keep(self, fitted: Hypothesis) -> None:
        """A set's best fit so far, also of simpler sets that it is equal to.

        A second mass of which the record holds less than a swing is a weak spring, or any other slow force: no fit with
        it is kept.
        """
        before = self.sets.get(fitted.causes)
        if before is not None and before.chi <= fitted.chi or swing(fitted.model) > self.experiment.scales.duration:
            return
        least = min((one.chi for one in self.sets.values()), default=math.inf) if before is None else before.chi
        self.sets[fitted.causes] = fitted
        if fitted.chi < MOST_OF * least:
            self.tried -= set(self._larger_that_leave_more(fitted))
        for causes, model in equal_to(fitted).items():
            if causes in self.sets and fitted.chi < MOST_OF * self.sets[causes].chi:
                self._keep(refine(self.experiment, causes, model, fitted.initial))

    def _larger_that_leave_more(self, fitted: Hypothesis) -> Iterable[Causes]:
        """Larger sets that were begun, or dropped, before this one was found to leave so little.

        With one cause more, the least that a set can leave is less: they ended in a wrong minimum.
        """
        larger = (causes for causes in self.tried if causes > fitted.causes)
        return (one for one in larger if one not in self.sets or self.sets[one].chi > fitted.chi)

    def scale(self) -> NoiseScale:
        """Noise scale that follows from the best set."""
        return scale_from(list(self.sets.values()), self.experiment.readings)

    def ranking(self) -> Ranking:
        """All sets by evidence."""
        return rank(self.sets, self.scale())

    def _leader(self) -> Hypothesis:
        """The set whose neighbours are tried, by an evidence that counts more features of the error (``SOUGHT``)."""
        fitted = tuple(self.sets.values())
        if self.led is None or len(fitted) != len(self.led[0]) or any(map(is_not, fitted, self.led[0])):
            self.led = fitted, leading(self.sets, scale_from(fitted, self.experiment.readings, SOUGHT))
        return self.led[1]

    def _fit(self, wanted: Iterable[Causes], start: float, end: float) -> bool:
        """Fit those of the sets that are new; False when none was.

        A set with a law that holds Coulomb friction as a limit follows the same set with Coulomb friction, from which
        it is begun too: from a smaller set alone, whose other laws make up for all friction, it may end in this limit.
        """
        new = [causes for causes in dict.fromkeys(wanted) if causes not in self.tried and causes_that_fit(causes)]
        self.tried.update(new)
        after = [causes for causes in new if not set(new).isdisjoint(with_coulomb(causes))]
        middle = end - (end - start) * len(after) / max(len(new), 1)
        for sets, part in (([one for one in new if one not in after], (start, middle)), (after, (middle, end))):
            if sets:
                self._fit_new(sets, *part)
        return bool(new)

    def _fit_new(self, new: Sequence[Causes], start: float, end: float) -> None:
        near = start + 0.3 * (end - start)
        found = [starts for starts in self._each(self._propose, self._within_reach(new), (start, near)) if starts]
        self._fit_group(found, (near, end))

    def _within_reach(self, new: Sequence[Causes]) -> Sequence[Causes]:
        """Beside a set that leaves only noise, those of the sets that may come near to it (``within_reach``)."""
        leads = self._least
        if not self.at_floor(leads):
            return new
        return within_reach(new, self.sets, self.beyond, self.experiment.worse(leads.chi, REACH))

    @property
    def _least(self) -> Hypothesis:
        """The set that leaves least."""
        return min(self.sets.values(), key=lambda fitted: fitted.chi)

    def _fit_group(self, group: list[list[StartingPoint]], share: tuple[float, float]) -> None:
        """Fit sets from their starts, the most promising few first: if one leaves only noise, few others can count."""
        likely = sorted(group, key=lambda starts: starts[0].promise)
        first = likely[:KEPT]
        for some in (first, [starts for starts in group if all(starts is not one for one in first)]):
            if some:
                self._follow(some, share)

    def _follow(self, group: list[list[StartingPoint]], share: tuple[float, float]) -> None:
        leads, resolved = self._least, []
        least, reach = leads.chi, self.experiment.worse(leads.chi, REACH)
        if self.at_floor(leads):
            near = [starts for starts in group if any(start.worth(reach) for start in starts)]
            far = [starts for starts in group if all(starts is not one for one in near)]
            self.beyond |= {starts[0].fitted.causes for starts in far}
            if leads.causes & set(HOLDING_COULOMB):
                resolved = [starts for starts in far if rubs_and_is_linear(starts[0].fitted.causes)]
            group = near
        begun = self._each(lambda starts: begin(self.experiment, starts, reach), promising(group, self.scale()), share)
        begun.sort(key=lambda tries: tries[0].chi)
        # The best goes first, alone: what counts as hopeless must not depend on which thread is faster.
        for tries in (begun[:1], begun[1:]):
            for fitted in self._each(partial(finish, self.experiment, least=least), tries, share):
                least = min(least, self._converged(fitted, least).chi)
        # A set that ends in a wrong minimum would be what larger ones are begun from.
        for starts in resolved:
            fitted = finish(self.experiment, begin(self.experiment, starts, reach), least)
            if fitted.chi < reach:
                self._keep(fitted)

    def _converged(self, fitted: Hypothesis, least: float) -> Hypothesis:
        """Keep a set; one that leaves less than all others is fitted to the end: it decides what is tried next."""
        if fitted.chi < least and not self.at_floor(fitted):
            ended = refine(self.experiment, fitted.causes, fitted.model, fitted.initial)
            fitted = min(fitted, ended, key=lambda one: one.chi)
        self._keep(fitted)
        return fitted

    def _each(self, work: Callable[[_Task], _Done], tasks: Sequence[_Task], share: tuple[float, float]) -> list[_Done]:
        """Results of all tasks in their order, with progress between the two shares of the work."""

        def told(done: int, task: _Task) -> None:
            fraction = share[0] + (share[1] - share[0]) * done / len(tasks)
            self.told = max(self.told, fraction)  # a bar that runs backwards tells nobody anything
            self.progress("search", self.told, _named(task))

        return parallel.each(work, tasks, told if len(tasks) > 1 else None)

    def _propose(self, causes: Causes) -> list[StartingPoint]:
        return starting_points.proposals(self.experiment, causes, self.neighbours.parents(causes, dict(self.sets)))


def _named(task: Causes | list[StartingPoint] | list[Hypothesis]) -> str:
    if isinstance(task, frozenset):
        return " + ".join(sorted(task))
    one = task[0]
    return _named((one.fitted if isinstance(one, StartingPoint) else one).causes)
