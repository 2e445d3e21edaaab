"""Where the kernel finds a model's numbers, and which effects have which kinds of laws, in sets of bits.

Nothing here is compiled, and nothing imports numba.
"""

from __future__ import annotations

from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.law import STRUCTURAL, VELOCITY_LAG
from msd_ident.model.plant import PLANT_PARAMETERS

#: Place of every parameter of the library in the kernel's one parameter vector.
INDEX: dict[str, int] = {p.name: i for i, p in enumerate(PLANT_PARAMETERS)}
for _effect in LIBRARY:
    for _parameter in _effect.parameters:
        INDEX.setdefault(_parameter.name, len(INDEX))

#: Bit of every effect in the kernel's set of active effects.
BIT: dict[str, int] = {effect.name: 1 << i for i, effect in enumerate(LIBRARY)}

#: Place of every remembered number in the kernel's memory vector, with its start value.
MEMORY: dict[str, int] = {}
MEMORY_START: list[float] = []
for _effect in LIBRARY:
    for _name, _start in _effect.memory:
        MEMORY[_name] = len(MEMORY_START)
        MEMORY_START.append(_start)

#: Effects whose laws leave the motion piecewise linear: the exact path carries them.
EXACT_BITS = sum(BIT[effect.name] for effect in LIBRARY if effect.piecewise_linear)
#: Effects with a dry friction law, with a force on the second mass, with a contact that takes part of all other forces,
#: with a reading, with a map of the command.
DRY_BITS, SECOND_BITS, CONTACT_BITS, READING_BITS, MAP_BITS = (
    sum(BIT[effect.name] for effect in LIBRARY if kind in effect.laws())
    for kind in ("friction", "second_force", "contact", "reading", "input_map")
)
#: Effects that make another force of the same command at another time.
TIMED_MAP_BITS = sum(BIT[effect.name] for effect in LIBRARY if "input_map" in effect.laws() and not effect.steady)
TURNING_BITS = sum(BIT[effect.name] for effect in LIBRARY if effect.turns or effect.memory)
#: Effects whose force may change quickly just after a turn.
QUICK_BITS = sum(BIT[e.name] for e in LIBRARY if e.memory or ("friction" in e.laws() and not e.piecewise_linear))
#: Effects whose force changes with the speed in another way than damping does.
SPEED_BITS = sum(BIT[e.name] for e in LIBRARY if e.asks_speed())
#: Effects whose force depends on the commanded one, or on whether there is any.
DRIVEN_BITS = sum(BIT[effect.name] for effect in LIBRARY if effect.asks_drive())
#: Effects beside which a jump of the force is no jump of the acceleration by that force alone.
JUMPING_BITS = DRIVEN_BITS | CONTACT_BITS
#: Effects whose force has two formulas beyond a knee.
GRIP_BITS = sum(BIT[effect.name] for effect in LIBRARY if "grip" in effect.laws())
#: Effects whose force changes by itself while the cart is at rest.
RESTLESS_BITS = sum(BIT[effect.name] for effect in LIBRARY if effect.acts_on == "force" and not effect.steady)


def bits(*names: str) -> int:
    """Set of those of the named effects that the library has."""
    return sum(BIT.get(name, 0) for name in names)


def structure(role: str) -> tuple[int, tuple[int, ...]]:
    """Bits of the effects with this part in the structure (0 without one), and where the parameters stand."""
    count = STRUCTURAL[role]
    having = [effect for effect in LIBRARY if effect.structure == role]
    places = {tuple(INDEX[parameter.name] for parameter in effect.parameters[:count]) for effect in having}
    (place,) = places or {(0,) * count}  # the same names for all
    return sum(BIT[effect.name] for effect in having), place


def velocity_lag() -> tuple[int, int]:
    """Bits of the effects whose law is given ``lagged_v`` (0 without any), and where their one time constant stands."""
    lagged = [effect for effect in LIBRARY if effect.structure == VELOCITY_LAG]
    places = {INDEX[effect.parameters[-1].name] for effect in lagged} or {0}
    (place,) = places  # one name for all
    return sum(BIT[effect.name] for effect in lagged), place


#: See ``velocity_lag``.
LAGGED_BITS, RELAXATION_TIME = velocity_lag()
