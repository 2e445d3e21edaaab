"""Laws of a fitted set whose strength the data leaves open: other numbers of the model can take its place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from msd_ident.estimate import identifiability
from msd_ident.model.effects import by_name
from msd_ident.selection.experiment import weigh
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.rest_constraint import information, rest_constraints


def undetermined(fitted: Hypothesis) -> frozenset[str]:
    """Laws all of whose strengths take part in an open direction: along it they may vanish, and nothing is seen of it.

    A factor that all forces share leaves no law open: none of them vanishes beside the others.

    Args:
        fitted: a set, at its minimum.
    """
    problem, point = fitted.problem, fitted.point
    steps = 10.0 * weigh(problem, fitted.readings).steps(fitted.state)  # as a fit takes them for its intervals
    matrix = np.zeros((problem.size, problem.size))
    for r in range(len(problem.records)):
        _, jacobian = problem.central(point, r, steps)
        matrix[np.ix_(problem.entries(r), problem.entries(r))] += jacobian @ jacobian.T
    reference = np.maximum(np.abs(point), problem.scale)
    pinned = information(problem, point, rest_constraints(fitted))
    exchanged: frozenset[str] = frozenset()
    for direction in identifiability.null_directions(matrix, reference, pinned):
        exchanged |= identifiability.exchanged(direction, problem.names, point, reference)
    return frozenset(name for name in fitted.causes if set() < _strengths(name, problem.names) <= exchanged)


def _strengths(name: str, free: Sequence[str]) -> frozenset[str]:
    """Parameters that were fitted and without which a law does nothing."""
    return frozenset(strength for strength, _ in by_name(name).neutral if strength in free)
