"""The effects of the paper's own base model, by what they are in it: the one place outside the library that names them.

Equation 2 of the paper puts Coulomb's friction beside mass, damper and spring; an axis without a spring has a constant
force in place of the spring's zero.
"""

from __future__ import annotations

from msd_ident.model.effects.coulomb_friction import CoulombFriction as DryFriction
from msd_ident.model.effects.force_offset import ForceOffset as Offset
from msd_ident.model.plant import PLANT_PARAMETERS, Model

__all__ = [
    "DRY_FRICTION",
    "FRICTION_FORCE",
    "OFFSET",
    "OFFSET_FORCE",
    "PLANT",
    "DryFriction",
    "Offset",
    "friction_force",
]

#: Names of the two effects.
DRY_FRICTION, OFFSET = DryFriction.name, Offset.name
#: Names of their parameters [N].
FRICTION_FORCE, OFFSET_FORCE = DryFriction.parameters[0].name, Offset.parameters[0].name
#: Names of the plant's own parameters: m [kg], b [N·s/m], k [N/m].
PLANT = tuple(parameter.name for parameter in PLANT_PARAMETERS)


def friction_force(model: Model) -> float:
    """Sliding dry friction Fc [N] of a model, 0 where it has none."""
    return model[FRICTION_FORCE] if FRICTION_FORCE in model.names else 0.0
