"""Stiffness of a bent spring where it balances a constant force."""

from __future__ import annotations

import inspect
import math

from scipy.optimize import brentq

from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import ARGUMENTS, PLAY
from msd_ident.model.plant import Model

#: Name of the derived quantity.
AT_REST = "stiffness_at_rest"


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


def slope_at_rest(model: Model) -> float:
    """Stiffness [N/m] at rest: that parameter, unless a constant force moves the place of rest on a bent spring."""
    slope = stiffness_at_rest(model)
    return model.stiffness if math.isnan(slope) else slope


def _bends(effect: Effect) -> bool:
    """Whether its force is a curve over the position that does not repeat along it."""
    return effect.is_spring() and effect.harmonic is None


def _force(model: Model, x: float) -> float:
    """Force [N] of the spring, its bends and the constant forces at a position [m]."""
    known = dict.fromkeys(ARGUMENTS, 0.0) | dict(zip(model.names, model.values.tolist(), strict=True))
    known |= {"x": x, "piece_x": x}
    laws = [law for effect in model.effects if _bends(effect) for kind, law in effect.laws().items() if kind == "force"]
    laws += [effect.laws()["constant"] for effect in model.effects if "constant" in effect.laws()]
    return model.stiffness * x + math.fsum(law(*(known[n] for n in inspect.signature(law).parameters)) for law in laws)
