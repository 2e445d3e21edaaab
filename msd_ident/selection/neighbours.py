"""The sets of causes that differ from one by a cause: which the search fits next, and what it starts them from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from msd_ident.estimate.levels import TENTH
from msd_ident.estimate.ripple_regression import found_in
from msd_ident.model.effects import by_name
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import COMPARABLE
from msd_ident.selection.ordering import limits
from msd_ident.tuning import fixed, tuned

LARGEST = tuned(
    5,
    unit="causes",
    why="largest set that is fitted",
    chosen="by hand",
)
_FEW = fixed(
    3, "resources", "causes of a set beside whose parents the base may be one: more have too many combinations"
)


@dataclass(frozen=True)
class Neighbours:
    """Sets next to a set of causes, from the laws that an experiment may show.

    Attributes:
        experiment: the data.
    """

    experiment: Experiment

    def swapped(self, causes: Causes) -> list[Causes]:
        """Sets with another law of a cause, with one cause dropped, or with one replaced by another."""
        found = []
        for name in sorted(causes):
            rest = causes - {name}
            found.append(rest)
            found += [rest | {other} for other in self.experiment.tried_alone if other not in causes]
        return self.reformed(causes) + found

    def reformed(self, causes: Causes) -> list[Causes]:
        """Sets with another law of one of the causes."""
        return [causes - {name} | {form} for name in sorted(causes) for form in self.experiment.forms(name)]

    def resolved(self, causes: Causes) -> list[Causes]:
        """Sets that a law with Coulomb friction as its limit may imitate: Coulomb friction and one cause more."""
        found = []
        for name in sorted(causes & set(HOLDING_COULOMB)):
            found += self.grown(causes - {name} | {COULOMB})
        return [wanted for wanted in found if not wanted & (causes & set(HOLDING_COULOMB))]

    def grown(self, causes: Causes) -> list[Causes]:
        """Sets with one cause more; none beyond ``LARGEST``."""
        if len(causes) >= LARGEST:
            return []
        return [causes | {name} for name in self.experiment.tried_alone if name not in causes]

    @cached_property
    def rippled(self) -> Causes:
        """A force that repeats along the travel, if a regression shows one that leaves less than a tenth.

        By itself it leaves much where another law is missing: the cart comes to rest in another ripple.
        """
        found = [one for record in self.experiment.records for one in found_in(record)[:1]]
        shown = any(one.share > 1.0 - TENTH for one in found)
        return frozenset(name for name in self.experiment.tried_alone if shown and by_name(name).ripple())

    def parents(self, causes: Causes, known: Mapping[Causes, Hypothesis]) -> list[Hypothesis]:
        """Fitted sets to start from: the best two that lack just one of the causes, or else the largest known part; and
        those that have the limit of one of the laws in its place, e.g. Coulomb friction. A smaller set that leaves far
        more than one of the others is left out. A single cause starts next to the base in any case, and so does a set
        of up to three simple laws with a ripple that a regression shows: there regressions are made. Of more causes
        beside the base the combinations of guesses are too many, and of a form, which its simple law leads to.

        Args:
            causes: of the set.
            known: all fitted sets by their causes.
        """
        smaller = [known[causes - {name}] for name in sorted(causes) if causes - {name} in known]
        twins = with_coulomb(causes)
        twins += [causes - {name} | {by_name(name).form_of} for name in sorted(causes) if by_name(name).form_of]
        alike = [known[twin] for twin in twins if twin in known]
        smaller.sort(key=lambda fitted: fitted.chi)
        least = min((fitted.chi for fitted in smaller[:1] + (alike if len(causes) > 1 else [])), default=0.0)
        worth = [fitted for fitted in smaller[:2] if fitted.chi < COMPARABLE * least]
        simple = len(causes) <= _FEW and not any(by_name(name).form_of for name in causes)
        rippled = causes & self.rippled and worth and worth[0].causes and simple
        plain = [known[frozenset()]] if rippled else []
        return worth + plain + alike or [_largest_part(causes, known)]

    def singles_beside(self, causes: Causes, known: Mapping[Causes, Hypothesis]) -> int:
        """How many single causes a set may start from, see ``parents``."""
        return sum(len(one.causes) == 1 for one in self.parents(causes, known))


def _largest_part(causes: Causes, known: Mapping[Causes, Hypothesis]) -> Hypothesis:
    """The known set of most of the causes, of several that which leaves least; the base model if none is known.

    Each combination of guesses for the other causes is simulated.
    """
    parts = (one for one in known.values() if one.causes < causes)
    return min(parts, key=lambda one: (-len(one.causes), one.chi))


def with_coulomb(causes: Causes) -> list[Causes]:
    """The sets with Coulomb friction in place of a law that holds it as a limit."""
    laws = sorted(causes & set(HOLDING_COULOMB))
    return [causes - {name} | {COULOMB} for name in laws if COULOMB not in causes]


def only_another_form(causes: Causes, simple: Causes) -> bool:
    """Whether a set differs from a simpler one only by another form of a law, which this form holds as a limit.

    Where the simpler one leaves only noise, such a form has more numbers and nothing more to explain.

    Args:
        causes: the set.
        simple: the simpler one.
    """
    return simple in limits(causes) and all(by_name(name).form_of for name in causes - simple)


def rubs_and_is_linear(causes: Causes) -> bool:
    """Whether a set is Coulomb friction beside linear laws, which a law that holds Coulomb friction may imitate.

    It is fitted where such a law leads, whatever its first step promises: the cart comes to rest elsewhere.
    """
    return COULOMB in causes and all(by_name(name).is_linear() for name in causes)
