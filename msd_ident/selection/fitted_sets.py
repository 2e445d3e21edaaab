"""The fitted sets of causes of one experiment, and how further ones are fitted beside them.

Which sets are fitted, and in what order, is the matter of ``structure_search``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from operator import is_not
from typing import TypeVar

from msd_ident import parallel
from msd_ident.estimate.effort import KEPT
from msd_ident.estimate.explained import LEAST
from msd_ident.estimate.levels import MOST_OF
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.selection import starting_points
from msd_ident.selection.evidence import NoiseScale, scale_from
from msd_ident.selection.experiment import SOUGHT, Experiment
from msd_ident.selection.force_share import explains_force
from msd_ident.selection.hypothesis import HOLDING_COULOMB, Causes, Hypothesis, causes_that_fit
from msd_ident.selection.hypothesis_fit import COMPARABLE, REACH, StartingPoint, begin, finish, refine, refine_near
from msd_ident.selection.neighbours import Neighbours, rubs_and_is_linear, with_coulomb
from msd_ident.selection.ordering import leading, rank
from msd_ident.selection.ranking import Ranking
from msd_ident.selection.second_masses import swing
from msd_ident.selection.simpler_sets import equal_to
from msd_ident.selection.worthwhile import promising, within_reach

_Task = TypeVar("_Task", Causes, list[StartingPoint], list[Hypothesis])
_Done = TypeVar("_Done")

#: ``progress(stage, fraction of the work done, cause being tried)``; what it raises ends the diagnosis.
Progress = Callable[[str, float, str], None]


@dataclass
class FittedSets:
    """Sets that are fitted to one experiment.

    Attributes:
        experiment: the data.
        at_floor: tells whether a fitted set leaves nothing but noise; then no cause is added to it.
        progress: called for each set, see ``Progress``.
        sets: all fitted sets by their causes.
        tried: sets that need not be fitted again.
        told: fraction of the work that was reported last.
        led: fitted sets, and the leading one of these, when it was asked last.
        beyond: sets whose starts promise too little beside a leading set that leaves only noise.
    """

    experiment: Experiment
    at_floor: Callable[[Hypothesis], bool]
    progress: Progress
    sets: dict[Causes, Hypothesis] = field(default_factory=dict)
    tried: set[Causes] = field(default_factory=set)
    told: float = 0.0
    led: tuple[tuple[Hypothesis, ...], Hypothesis] | None = None
    beyond: set[Causes] = field(default_factory=set)

    @cached_property
    def neighbours(self) -> Neighbours:
        """Sets next to a set."""
        return Neighbours(self.experiment)

    @property
    def carries_nothing(self) -> bool:
        """Whether no set explains even half of the motion: such a record is refused (``estimate.explained``)."""
        return min(fitted.chi for fitted in self.sets.values()) > (1.0 - LEAST) * self.experiment.motion

    @property
    def _least(self) -> Hypothesis:
        """The set that leaves least."""
        return min(self.sets.values(), key=lambda fitted: fitted.chi)

    def _leader(self) -> Hypothesis:
        """The set whose neighbours are tried, by an evidence that counts more features of the error (``SOUGHT``)."""
        fitted = tuple(self.sets.values())
        if self.led is None or len(fitted) != len(self.led[0]) or any(map(is_not, fitted, self.led[0])):
            self.led = fitted, leading(self.sets, scale_from(fitted, self.experiment.readings, SOUGHT))
        return self.led[1]

    def scale(self) -> NoiseScale:
        """Noise scale that follows from the best set."""
        return scale_from(list(self.sets.values()), self.experiment.readings)

    def ranking(self) -> Ranking:
        """All sets by evidence."""
        return rank(self.sets, self.scale())

    def _know(self, sets: Iterable[Hypothesis]) -> None:
        """Take over sets that are fitted to all of the experiment."""
        for fitted in sets:
            self.sets[fitted.causes] = fitted
            self.tried.add(fitted.causes)

    def _keep(self, fitted: Hypothesis) -> None:
        """A set's best fit so far, also of simpler sets that it is equal to.

        A second mass of which the record holds less than a swing is a weak spring, or any other slow force: no fit with
        it is kept; nor, where a controller leads the motion, one that explains too little of the force.
        """
        before = self.sets.get(fitted.causes)
        if before is not None and before.chi <= fitted.chi or swing(fitted.model) > self.experiment.scales.duration:
            return
        if self.experiment.led and fitted.causes and not explains_force(fitted):
            return
        least = min((one.chi for one in self.sets.values()), default=math.inf) if before is None else before.chi
        self.sets[fitted.causes] = fitted
        if fitted.chi < MOST_OF * least:
            self.tried -= set(self._larger_that_leave_more(fitted))
        for causes, model in equal_to(fitted).items():
            if causes in self.sets and fitted.chi < MOST_OF * self.sets[causes].chi:
                self._keep(refine(self.experiment, causes, model, fitted.initial))
        self._look_below(fitted)

    def _look_below(self, fitted: Hypothesis) -> None:
        """Fit sets again that lack one of a set's causes, from there, where that start leaves less than half of what
        they do: they ended in a wrong minimum, as over many swings a law does that changes their period.
        """
        for name in sorted(fitted.causes):
            known = self.sets.get(fitted.causes - {name})
            if known is not None and known.causes and known.chi > COMPARABLE * fitted.chi:
                model = fitted.model.without(name)
                self._look_again(known.causes, model, fitted.initial, MOST_OF * known.chi)

    def _larger_that_leave_more(self, fitted: Hypothesis) -> Iterable[Causes]:
        """Larger sets that were begun, or dropped, before this one was found to leave so little.

        With one cause more, the least that a set can leave is less: they ended in a wrong minimum.
        """
        larger = (causes for causes in self.tried if causes > fitted.causes)
        return (one for one in larger if one not in self.sets or self.sets[one].chi > fitted.chi)

    def _look_again(self, causes: Causes, model: Model, initial: Sequence[Initial], most: float = math.inf) -> None:
        """Fit a set again from a start that is near enough (``refine_near``); from others it may still be tried."""
        found = refine_near(self.experiment, causes, model, initial, most)
        if found is not None:
            self.tried.add(causes)
            self._keep(found)

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
        chosen = promising(group, self.scale(), self.sets.values())
        begun = self._each(lambda starts: begin(self.experiment, starts, reach), chosen, share)
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
            self.progress("search", self.told, named(task))

        return parallel.each(work, tasks, told if len(tasks) > 1 else None)

    def _propose(self, causes: Causes) -> list[StartingPoint]:
        return starting_points.proposals(self.experiment, causes, self.neighbours.parents(causes, dict(self.sets)))


def named(task: Causes | list[StartingPoint] | list[Hypothesis]) -> str:
    """The causes of a task, as the progress tells them."""
    if isinstance(task, frozenset):
        return " + ".join(sorted(task))
    one = task[0]
    return named((one.fitted if isinstance(one, StartingPoint) else one).causes)
