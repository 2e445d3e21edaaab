"""Ranges of the parameters over the explanations that the data cannot tell apart, about the stated model."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.estimate import FitResult
from msd_ident.estimate.base_fits import Shared
from msd_ident.estimate.result import scale_known
from msd_ident.model import Model
from msd_ident.model.parameters import FORCES
from msd_ident.selection import handover, spread
from msd_ident.selection.hypothesis import Hypothesis


def over(
    stated: FitResult, others: Sequence[Hypothesis], exact: bool, shared: Shared
) -> dict[str, tuple[float, float]]:
    """Least and largest m, b, k and Fc of the stated model and of other explanations that fit alike.

    A set that leaves more than noise has other values where it fits its readings best, each weighted by its noise, and
    where it simulates with the least error. The stated model is a fit of the second kind, so the others are too.
    A parameter that the data leaves open has no range: that of the values at which the fits happen to end says nothing.

    Args:
        stated: the extended model.
        others: the other explanations.
        exact: whether the stated set leaves only noise: then both kinds of fit agree to within that.
        shared: the fits of an identification of the same records, from which a refit may start.
    """
    models = [stated.model, *(one.model if exact else _simulating(one, shared) for one in others)]
    unknown = frozenset() if scale_known(stated.quantities) else FORCES
    unmoved = {name for name, quantity in stated.quantities.items() if quantity.std == 0.0 or not quantity.known}
    found = spread.between(models)
    return {name: ends for name, ends in found.items() if name not in unmoved and name not in unknown}


def _simulating(fitted: Hypothesis, shared: Shared) -> Model:
    """A set refitted as the stated one is."""
    values = fitted.problem.values(handover.simulating(fitted, shared).point)
    return fitted.model.with_values(values)
