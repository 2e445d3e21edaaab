"""What an effect is to a format, read off what it says of itself: formats have elements for these, whatever their name.

So a further law of a known kind (a second disturbance, a stop on the other side) needs no change in any target.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Mapping

from msd_ident.model.base_model import DRY_FRICTION, OFFSET
from msd_ident.model.effects import Effect
from msd_ident.model.effects.law import BOTH, OUTSIDE

#: Coulomb's friction, a constant force, a limited or bent force.
FRICTION, CONSTANT, GAIN = "friction", "constant", "gain"
#: Stops that push and never pull: a spring on either side, on one side, a spring and a damper with a force of its own.
STOPS, ONE_STOP, BUFFERS = "stops", "one stop", "buffers"
#: Stops that push, and take a part of all other forces.
CONSTRAINT = "constraint"
#: A second mass with a force on it alone.
LOADED_SECOND = "loaded second mass"
#: Forces c·x², c·x³ and c·v·|v|, of the one parameter c.
SQUARE, CUBE, DRAG = "square of the position", "cube of the position", "square of the speed"
#: What depends on the time: a force, the spring, the reading, the gain of the force.
DISTURBANCE, SPRING_DRIFT, READING_DRIFT = "disturbance", "drift of the spring", "drift of the reading"
GAIN_DRIFT = "drift of the gain"
#: A reading that follows the force, and dry friction that changes with time.
FORCED_READING, FRICTION_DRIFT = "reading that follows the force", "drift of the friction"

_POWERS: Mapping[str, Callable[[float, float], float]] = {
    SQUARE: lambda x, v: x * x,
    CUBE: lambda x, v: x**3,
    DRAG: lambda x, v: v * abs(v),
}
#: Motions at which a law is compared with a power.
_MOTIONS = ((0.5, 1.0), (2.0, -3.0), (-2.0, 0.5), (-1.0, -2.0))


def role(effect: type[Effect]) -> str:
    """One of the above, its part in the structure (``Effect.structure``), or empty for a law of another kind."""
    laws = effect.laws()
    if effect.structure:
        return LOADED_SECOND if "second_force" in laws else effect.structure
    if effect.name in (DRY_FRICTION, OFFSET):
        return FRICTION if effect.name == DRY_FRICTION else CONSTANT
    if effect.limits_force:
        return GAIN
    if "disturbance" in laws:
        return DISTURBANCE
    if not effect.steady and "friction" in laws:
        return FRICTION_DRIFT
    if not effect.steady:
        return READING_DRIFT if "reading" in laws else GAIN_DRIFT if "input_map" in laws else SPRING_DRIFT
    if "reading" in laws and "u" in inspect.signature(laws["reading"]).parameters:
        return FORCED_READING
    return _stop(effect) or _power(effect)


def of_role(effects: Iterable[Effect], wanted: str) -> Effect | None:
    """The effect of a model that has this role; ``None`` where none has."""
    return next((effect for effect in effects if role(type(effect)) == wanted), None)


def _stop(effect: type[Effect]) -> str:
    """Which kind of stop an effect is; empty for none, as for a spring that may bend either way."""
    if effect.knee is None or not effect.stops():
        return ""
    side = effect.knee[2]
    if not effect.laws():
        return {BOTH: STOPS, OUTSIDE: ONE_STOP}.get(side, "")
    if "contact" in effect.laws():
        return CONSTRAINT
    return BUFFERS if effect.jumps else ""


def _power(effect: type[Effect]) -> str:
    """Which power of the motion the force of an effect is; empty for another law."""
    law = effect.laws().get("force")
    if law is None or len(effect.parameters) != 1:
        return ""
    known = {"x", "v", "speed", effect.parameters[0].name}
    arguments = list(inspect.signature(law).parameters)
    if not known.issuperset(arguments):
        return ""

    def force(x: float, v: float) -> float:
        given = {"x": x, "v": v, "speed": abs(v), effect.parameters[0].name: 1.0}
        return law(*(given[name] for name in arguments))

    for name, power in _POWERS.items():
        if all(math.isclose(force(x, v), power(x, v)) for x, v in _MOTIONS):
            return name
    return ""
