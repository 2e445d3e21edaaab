"""Range of the parameters over explanations that the data cannot tell apart."""

from __future__ import annotations

import inspect
import math
from collections.abc import Sequence

from scipy.optimize import brentq

from msd_ident.model import Model
from msd_ident.model.base_model import FRICTION_FORCE, PLANT
from msd_ident.model.effects import Effect
from msd_ident.model.effects.base import ARGUMENTS, PLAY

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


def stiffness_at_rest(model: Model) -> float:
    """Slope [N/m] of a bent spring at the place where it balances a constant force; NaN if the model has not both.

    It is the stiffness of the same curve with its zero at that place, which needs no constant force.
    """
    bent = any(_bends(effect) for effect in model.effects)
    loaded = any("constant" in effect.laws() for effect in model.effects)
    if not (bent and loaded and model.stiffness > 0.0) or model.structure(PLAY):
        return math.nan
    far = -2.0 * _force(model, 0.0) / model.stiffness
    if not _force(model, 0.0) * _force(model, far) < 0.0:
        return math.nan
    place, step = float(brentq(lambda x: _force(model, x), 0.0, far)), 1e-6 * abs(far)
    return (_force(model, place + step) - _force(model, place - step)) / (2.0 * step)


def _bends(effect: Effect) -> bool:
    """Whether its force is a curve over the position that does not repeat along it."""
    return effect.is_spring() and effect.harmonic is None


def _force(model: Model, x: float) -> float:
    """Force [N] of the spring, its bends and the constant forces at a position [m]."""
    known = {**dict.fromkeys(ARGUMENTS, 0.0), **dict(zip(model.names, model.values.tolist(), strict=True)), "x": x}
    laws = [law for effect in model.effects if _bends(effect) for kind, law in effect.laws().items() if kind == "force"]
    laws += [effect.laws()["constant"] for effect in model.effects if "constant" in effect.laws()]
    return model.stiffness * x + math.fsum(law(*(known[n] for n in inspect.signature(law).parameters)) for law in laws)
