"""Search for the set of causes: add, replace or remove one, until no neighbour has more evidence.

A greedy search that only adds causes cannot take back an early mistake (friction looks like hysteresis until the spring
is right). Here every cause of the library is fitted at every step, and the search ends when all sets that differ from
the leading one by one cause have been fitted and none has more evidence.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from operator import is_

from msd_ident.estimate.effort import KEPT, LOOK
from msd_ident.estimate.levels import MOST_OF
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.model.effects import by_name
from msd_ident.selection import starting_points
from msd_ident.selection.fitted_sets import FittedSets, named
from msd_ident.selection.hypothesis import COULOMB, NOTHING, Causes, Hypothesis, causes_that_fit
from msd_ident.selection.hypothesis_fit import COMPARABLE, FAR, refine
from msd_ident.selection.neighbours import only_another_form
from msd_ident.selection.observer import can_follow, followed
from msd_ident.selection.promising import explaining, explains, pairs
from msd_ident.selection.ranking import Ranking
from msd_ident.selection.simpler_sets import nearest
from msd_ident.selection.speed_curves import merged
from msd_ident.selection.subset_regression import likely
from msd_ident.tuning import fixed

#: A set, its model, and each record's state and zero, as fitted to less data.
Remembered = tuple[Causes, Model, Sequence[Initial]]

_MOST_WORK = fixed(
    600_000,
    "resources",
    "samples simulated for each set, summed over the sets that were tried, after which a search far from the noise "
    "ends: 360 sets of 1667 samples, of which measured records of 10 000 samples take 220 at most; of 48 809 samples "
    "of a disc in 800 swings, of which 16 270 are searched on, 37 sets took a minute, and 250 would take ten",
)
#: Rounds of a walk whose leader stays far from the noise: what these do not repair, the library does not repair.
_ROUNDS_FAR = LOOK // 2


@dataclass
class Search(FittedSets):
    """Search on one experiment.

    Attributes:
        pruned: leading sets whose simpler sets were fitted again already.
        followed: sets that were fitted through observers already.
        regressed: the sets with whose values the last regression was made.
        unfinished: whether sets were left untried because the search had become long (``_MOST_WORK``).
    """

    pruned: set[Causes] = field(default_factory=set)
    followed: set[Causes] = field(default_factory=set)
    regressed: tuple[Hypothesis, ...] = ()
    unfinished: bool = False

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
        if self.experiment.begun:  # the search of the record itself has done the rest, and copies begin with its sets
            return self._walk()
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

    def _fit(self, wanted: Iterable[Causes], start: float, end: float) -> bool:
        """``FittedSets._fit``, while the search is not too long."""
        if not self._is_long():
            return super()._fit(wanted, start, end)
        self.unfinished |= any(causes not in self.tried and causes_that_fit(causes) for causes in wanted)
        return False

    def _is_long(self) -> bool:
        """Whether a search that leaves far more than noise has done its share of work; no cause is certain there."""
        samples = sum(part.record.samples for part in self.experiment.readings)
        far = self._least.chi > FAR * self.experiment.evidence
        return far and len(self.tried) * samples > _MOST_WORK

    def _fit_regressed(self) -> bool:
        """Fit sets that a regression of the equation of motion calls for: each cause may explain nothing by itself.

        Returns:
            Whether one of them may leave less than all fitted sets. False where nothing changed since the last time.
        """
        base, least = self.sets[NOTHING], self._least.chi
        known = (base, *self._fronts(self._leader()))
        if self._is_long():
            return False
        if len(known) == len(self.regressed) and all(map(is_, known, self.regressed)):
            return False
        self.regressed = known
        new = likely(self.experiment, base, known[1:])
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

    def beside_its_parts(self, starts: Mapping[Causes, Remembered]) -> Ranking:
        """Fit the sets that lack one cause of the leading one, as far as they were found on part of the data.

        How much a cause explains is judged by them, whatever they leave. Where the leading set is another one than on
        the part, they were not refined with it.

        Args:
            starts: sets that were fitted to part of the data, each with its values there.
        """
        ranking = self.ranking()
        for _ in range(KEPT):
            parts = {ranking.best.causes - {name} for name in ranking.best.causes}
            missing = sorted((one for one in parts if one in starts and one not in self.sets), key=sorted)
            if not missing:
                break
            for one in missing:
                self.tried.add(one)
                self._keep(refine(self.experiment, *starts[one]))
            if all(one not in self.sets for one in missing):
                break  # none is kept: a second mass of less than a swing
            ranking = self.ranking()
        return ranking

    def _rubs(self, base: Hypothesis) -> bool:
        """Whether Coulomb friction explains something and leaves more than noise: then the causes beside it come first.

        Friction is what most often stands beside another cause. Where the two leave only noise, a single cause need be
        followed only if it may come near to that.
        """
        rubbing = self.sets.get(frozenset({COULOMB}))
        return rubbing is not None and explains(rubbing, base) and not self.at_floor(rubbing)

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

        The leading sets, and those of one law, the likeliest before any data first: in wrong minima all leave about as
        much. Not in copies that begin with what was fitted to the measured records.
        """
        if self._least.chi < FAR * self.experiment.evidence or self.experiment.begun or self._is_long():
            return
        alone = [one for one in self.sets.values() if len(one.causes) == 1]
        alone.sort(key=lambda one: (-by_name(*one.causes).prior_odds, one.chi))
        ahead = {one.causes: one for one in (*self._fronts(self._leader()), *alone) if can_follow(one.model)}
        for causes, one in list(ahead.items())[:KEPT]:
            if causes not in self.followed and not self.at_floor(self._least):
                self.followed.add(causes)
                self.progress("search", self.told, named(causes))
                simple = len(causes) == 1 and causes <= set(self.experiment.tried_alone)
                begun = starting_points.starts(self.experiment, causes, self.sets[NOTHING]) if simple else []
                found = followed(self.experiment, causes, [one.model, *begun], one.initial)
                if found is not None:
                    self._keep(found)
