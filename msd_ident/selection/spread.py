"""Range of the parameters over explanations that the data cannot tell apart."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.model.base_model import FRICTION_FORCE, PLANT
from msd_ident.selection.hypothesis import Hypothesis

_WATCHED = (*PLANT, FRICTION_FORCE)


def between(sets: Sequence[Hypothesis]) -> dict[str, tuple[float, float]]:
    """Least and largest value of m, b, k and Fc over sets that fit alike and have them; empty for a single set."""
    if len(sets) < 2:
        return {}
    found = {}
    for name in _WATCHED:
        values = [fitted.model[name] for fitted in sets if name in fitted.model.names]
        if len(values) > 1:
            found[name] = (min(values), max(values))
    return found
