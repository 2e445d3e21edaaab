"""All parameters of the plant and of the library, by name: the same name means the same thing in every effect."""

from __future__ import annotations

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import LIBRARY
from msd_ident.model.plant import PLANT_PARAMETERS

#: Name → parameter, the plant's own first.
PARAMETERS: dict[str, Parameter] = {
    parameter.name: parameter
    for parameter in (*PLANT_PARAMETERS, *(own for effect in LIBRARY for own in effect.parameters))
}

#: Those of a force that acts on the mass: a record knows them only up to the gain of the force signal.
FORCES = frozenset(
    parameter.name
    for parameter in (*PLANT_PARAMETERS, *(own for law in LIBRARY if law.acts_on == "force" for own in law.parameters))
    if parameter.unit.startswith(("N", "kg"))
)
