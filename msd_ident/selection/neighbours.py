"""The sets of causes that differ from one by a cause: which sets the search fits next."""

from __future__ import annotations

from dataclasses import dataclass

from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes
from msd_ident.tuning import tuned

LARGEST = tuned(4, unit="causes", why="largest set that is fitted", chosen="by hand")


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


def with_coulomb(causes: Causes) -> list[Causes]:
    """The sets with Coulomb friction in place of a law that holds it as a limit."""
    laws = sorted(causes & set(HOLDING_COULOMB))
    return [causes - {name} | {COULOMB} for name in laws if COULOMB not in causes]
