"""Fitted sets that are worth more than they show alone: simple laws that explain something, and pairs of the best."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

from msd_ident.estimate.effort import KEPT
from msd_ident.estimate.levels import TENTH
from msd_ident.model.effects import by_name
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import COMPARABLE
from msd_ident.selection.ranking import LEADERS, NEAR, Ranking


def explaining(experiment: Experiment, sets: Mapping[Causes, Hypothesis]) -> list[Causes]:
    """The simple laws that leave least by themselves, and less than the base model does.

    Evidence counts features of the error: a law that takes most of one feature away may lose it to no law at all, where
    another form of it takes all away. And a third law that acts like two of them may leave far less than each alone.

    Args:
        experiment: says which laws are simple.
        sets: all fitted sets by their causes, the base model among them.
    """
    alone = [sets[one] for name in experiment.tried_alone if (one := frozenset({name})) in sets]
    alone.sort(key=lambda fitted: fitted.chi)
    return [one.causes for one in alone[:KEPT] if explains(one, sets[frozenset()])]


def explains(fitted: Hypothesis, base: Hypothesis) -> bool:
    """Whether a set leaves less than the base model does, by more than a ``TENTH`` of it."""
    return fitted.chi < (1.0 - TENTH) * base.chi


def pairs(experiment: Experiment, sets: Mapping[Causes, Hypothesis], ranking: Ranking) -> list[Causes]:
    """Pairs of the simple laws that leave least by themselves, of the likeliest ones, and of laws that are linear in
    their parameters. Another form of a law is tried where the simple one leads.

    Where two causes act, each alone may leave more than a third one does that acts a little like both. That leaves
    least where it is flexible; the evidence, which knows how much that says, still has both near. Two linear laws have
    no start that could be missed.

    Args:
        experiment: says which laws are simple.
        sets: all fitted sets by their causes.
        ranking: the same by evidence.
    """
    simple = [frozenset({name}) for name in experiment.tried_alone]
    alone = sorted((sets[causes] for causes in simple if causes in sets), key=lambda fitted: fitted.chi)
    near = [one.causes for one in alone[:LEADERS] if one.chi < COMPARABLE * alone[0].chi]
    likely = [one.causes for one in ranking.within(NEAR) if one.causes in simple][:LEADERS]
    plain = [frozenset({name}) for name in experiment.tried_alone if by_name(name).is_linear()]
    return [one | other for group in (near, likely, plain) for one, other in combinations(group, 2)]
