"""Range of the parameters over explanations that the data cannot tell apart."""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_ident.model import Model
from msd_ident.model.base_model import FRICTION_FORCE, PLANT
from msd_ident.model.rest import stiffness_at_rest

_WATCHED = (*PLANT, FRICTION_FORCE)


def between(models: Sequence[Model]) -> dict[str, tuple[float, float]]:
    """Least and largest value of m, b, k and Fc over models that fit alike and have them.

    A bent spring beside a constant force is another bent spring about the place of rest, without that force: it has the
    stiffness there, which counts as well.

    Args:
        models: the explanations, each fitted in the same way.

    Returns:
        The ranges by name; without those of one value, or of two that are printed alike.
    """
    found = {}
    for name in _WATCHED:
        values = [model[name] for model in models if name in model.names]
        if name == "stiffness":
            values += [value for model in models if math.isfinite(value := stiffness_at_rest(model))]
        if values and f"{min(values):.4g}" != f"{max(values):.4g}":
            found[name] = (min(values), max(values))
    return found
